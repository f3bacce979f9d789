"""The integers of a rig in SI, and back."""

import numpy as np
import pytest

from pneudrive import Rig, Units


def test_integers_are_si_and_back(rig: Rig) -> None:
    units = Units(rig)
    assert units.position_m(8192) == pytest.approx(0.0987136)
    assert units.pressure_pa(4095) == pytest.approx(1e6)
    assert units.spool_m(0) == pytest.approx(-1.25e-3)
    assert units.time_s(1000) == pytest.approx(1.3)
    raw = np.arange(0, 4096, 91)
    assert np.array_equal(units.position_counts(units.position_m(raw)), raw)
    assert np.array_equal(units.pressure_raw(units.pressure_pa(raw)), raw)
    assert np.array_equal(units.spool_raw(units.spool_m(raw)), raw)
    back = units.position_counts(0.0987136)
    assert (back, type(back)) == (8192, int)
    assert Units("servo-b-tuned").time_s(np.array([1, 2])) == pytest.approx([0.0013, 0.0026])


def test_units_are_those_of_a_run(rig: Rig) -> None:
    run = rig.simulate(ensemble=1, check_convergence=False)
    positions = Units(rig).position_m(run.samples["position_counts"])
    seen = np.interp(Units(rig).time_s(run.samples["index"]), run["time_s"], run["position_m"])
    assert np.max(np.abs(positions - seen)) < 2 * Units(rig).position_m(1)


def test_what_a_rig_has_no_unit_of_is_refused() -> None:
    with pytest.raises(ValueError, match="measures no pressures"):
        Units(Rig("servo-b", sensors__pressure=False)).pressure_pa(1)
    with pytest.raises(ValueError, match="counted in steps"):
        Units("servo-a-tuned").spool_m(1)
