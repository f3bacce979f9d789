"""A drive at a port: a virtual rig, which runs the firmware's application and speaks its protocol."""

import _thread
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import pneudrive
from pneudrive import Controller, Drive, Rig, Sample, Units, VirtualRig


@pytest.fixture
def port(rig: Rig) -> Iterator[str]:
    with VirtualRig(rig) as virtual:
        yield virtual.port


@pytest.fixture
def slow_port(rig: Rig) -> Iterator[str]:
    """A rig in real time."""
    with VirtualRig(rig, fast=False) as virtual:
        yield virtual.port


def test_a_run_on_a_drive_records_the_integers_of_the_simulation(port: str, rig: Rig) -> None:
    expected = rig.simulate(ensemble=1, check_convergence=False).samples
    with Drive(port) as drive:
        record = drive.run(rig)
        again = drive.record()
    for column in ("position_counts", "error_counts", "command_counts", "pressure_1_raw", "spool_raw"):
        assert np.array_equal(record[column], expected[column][: len(record[column])]), column
        assert np.array_equal(record[column], again[column]), column
    assert len(record["index"]) >= len(expected["index"]) - 1


def test_the_controller_repeats_the_commands_of_a_record(port: str, rig: Rig) -> None:
    with Drive(port) as drive:
        record = drive.run(rig)
    controller = Controller(rig)
    inputs = zip(*(record[name] for name in ("position_counts", "pressure_1_raw", "pressure_2_raw", "spool_raw")), strict=True)
    commands = [controller.step(Sample(*sample)).counts for sample in inputs]
    assert np.array_equal(commands, record["command_counts"])


def test_a_context_manager_disarms_the_drive_whatever_happens(port: str) -> None:
    with Drive(port) as drive:
        drive.arm()
        assert drive.status()["mode"] == "armed"
    with Drive(port) as other:
        assert other.status()["mode"] == "disarmed"
        other.arm()

    class Mishap(Exception):
        pass

    with pytest.raises(Mishap), Drive(port) as drive:
        drive.arm()
        raise Mishap
    with Drive(port) as other:
        assert other.status()["mode"] == "disarmed"


def test_a_drive_that_is_forgotten_is_disarmed(port: str) -> None:
    drive = Drive(port)
    drive.arm()
    del drive
    with Drive(port) as other:
        assert other.status()["mode"] == "disarmed"


def test_a_closed_drive_says_so(port: str) -> None:
    drive = Drive(port)
    drive.close()
    drive.close()
    assert drive.closed
    with pytest.raises(ValueError, match=r'was closed; open it again with Drive\("tcp://'):
        drive.status()
    assert "closed" in repr(drive)


def test_where_nobody_listens_there_is_no_answer() -> None:
    with pytest.raises(ConnectionError, match="cannot reach a rig at tcp://127.0.0.1:9"):
        Drive("tcp://127.0.0.1:9")
    with pytest.raises(pneudrive.NoAnswer, match="cannot open /dev/none"):
        Drive("/dev/none")


def test_two_programs_do_not_command_one_drive(slow_port: str) -> None:
    with Drive(slow_port) as first, Drive(slow_port) as second:
        first.arm()
        with pytest.raises(pneudrive.Refused):
            second.arm()
        assert second.status()["mode"] == "armed"
        second.close()
        assert first.status()["mode"] == "armed"


def test_a_stop_is_a_fault_until_the_drive_is_armed(port: str) -> None:
    with Drive(port) as drive:
        drive.arm()
        drive.stop()
        assert (drive.status()["mode"], drive.status()["fault"]) == ("fault", "stop")
        drive.arm()
        assert drive.status()["fault"] is None


def test_a_run_for_another_loop_is_refused(port: str, rig: Rig) -> None:
    with Drive(port) as drive:
        with pytest.raises(pneudrive.PneudriveError, match="controller.loop = closed on the rig"):
            drive.run(rig.with_(controller__loop="open", test__moves=[(0.0, 100)]))
        with pytest.raises(ValueError, match="duration_s must be more than 0"):
            drive.run(rig, duration_s=float("nan"))
        assert drive.status()["mode"] == "disarmed"


def test_gains_are_downloaded_when_asked_for(port: str, rig: Rig) -> None:
    other = rig.with_(controller__velocity_gain=1000)
    expected = other.simulate(ensemble=1, check_convergence=False).samples
    with Drive(port) as drive:
        record = drive.run(other, config=True)
    assert np.array_equal(record["command_counts"], expected["command_counts"][: len(record["command_counts"])])


def test_parameters_are_read_and_set_by_the_names_of_keys(port: str, rig: Rig) -> None:
    with Drive(port) as drive:
        held = drive.config()
        assert held["controller.velocity_gain"] == rig.controller.velocity_gain
        assert held["controller.law"] == "gain-profile"
        profile = held["controller.gain_profile"]
        assert isinstance(profile, list)
        given = rig.controller.gain_profile
        assert profile[: len(given)] == given
        assert set(profile[len(given) :]) == {given[-1]}, "the rest is as the last one"
        changed = drive.config({"controller.velocity_gain": 900, "safety.hold_s": 30}, save=True)
        assert {name for name, value in changed.items() if value != held[name]} == {"controller.velocity_gain", "safety.hold_s"}
        assert drive.config(rig)["controller.velocity_gain"] == rig.controller.velocity_gain
        for values, says in (({"load.mass_kg": 2}, "there is no parameter load.mass_kg"), ({"safety.hold_s": -1}, "safety.hold_s")):
            with pytest.raises(pneudrive.PneudriveError, match=says):
                drive.config(values)
        drive.arm()
        with pytest.raises(pneudrive.Refused, match="disarm"):
            drive.config({"controller.velocity_gain": 900})


def test_a_stream_has_every_sample_of_the_run(port: str, rig: Rig, tmp_path: Path) -> None:
    with Drive(port) as drive:
        streamed = drive.stream(rig, tmp_path / "stream.txt")
        record = drive.record()
        assert np.array_equal(streamed["position_counts"], record["position_counts"])
        assert streamed.transient().gaps == []
        with pytest.raises(pneudrive.PneudriveError, match="already exists; choose another file"):
            drive.stream(rig, tmp_path / "stream.txt")
        half = drive.stream(rig, tmp_path / "half.txt", every=2)
        assert np.array_equal(half["index"], streamed["index"][::2])
        with pytest.raises(ValueError, match="every must be 1 or more"):
            drive.stream(rig, tmp_path / "none.txt", every=0)


def test_control_c_stops_a_drive_that_moves(slow_port: str, rig: Rig) -> None:
    long = rig.with_(test__duration_s=30.0)
    with Drive(slow_port) as drive:
        threading.Timer(1.0, _thread.interrupt_main).start()
        begun = time.monotonic()
        with pytest.raises(KeyboardInterrupt):
            drive.run(long)
        assert time.monotonic() - begun < 10
        assert drive.status()["mode"] == "fault"


def test_a_drive_in_use_says_so_to_another_thread(slow_port: str, rig: Rig) -> None:
    with Drive(slow_port) as drive:
        thread = threading.Thread(target=lambda: drive.run(rig))
        thread.start()
        time.sleep(0.2)
        with pytest.raises(RuntimeError, match="another thread is using this drive"):
            drive.status()
        thread.join()


def test_a_fit_finds_what_a_virtual_rig_hides_and_a_model_that_does_not_fit_gives_no_rig() -> None:
    model = Rig("servo-b-tuned")
    hidden = {"load.mass_kg": 2.0, "supply.pressure_pa": 575e3}
    with VirtualRig(model.with_(hidden)) as virtual, Drive(virtual.port) as drive:
        first, *_ = targets = drive.run_identification_tests(model)
        assert drive.status()["mode"] == "disarmed"
    assert len(targets) == 6
    found = pneudrive.identify(model, [first], fit=list(hidden))
    assert found.fits
    for estimate in found.estimates:
        low, high = estimate.interval
        width = high - low
        assert estimate.is_95_percent
        assert low - width < hidden[estimate.key] < high + width, estimate
    assert found.fitted().load.mass_kg == pytest.approx(2.0, rel=1e-3)
    assert found.to_dict()["fits"] is True
    misfit = pneudrive.identify(model, [first], fit=["load.mass_kg"])
    assert not misfit.fits
    assert not misfit.estimates[0].is_95_percent
    with pytest.raises(pneudrive.NotBorneOut, match="does not explain the transients; despite_misfit=True"):
        misfit.fitted()
    assert misfit.fitted(despite_misfit=True).load.mass_kg == misfit.estimates[0].value


def test_an_axis_is_referenced_in_counts_or_in_millimetres(port: str) -> None:
    with Drive(port) as drive:
        drive.reference(counts=1000)
        assert drive.status()["position_counts"] == 1000
        drive.reference(mm=12.05)
        assert drive.status()["position_counts"] == 1000
        with pytest.raises(TypeError, match="either in counts or in mm"):
            drive.reference()
    assert set(Drive(port).info()) == {"firmware", "build", "board", "protocol", "record_capacity"}


def test_a_virtual_rig_that_there_cannot_be_is_refused(rig: Rig) -> None:
    with pytest.raises(pneudrive.PneudriveError, match="continuous"):
        VirtualRig(rig.with_(controller__model="continuous"))
    with pytest.raises(pneudrive.PneudriveError, match="tcp:HOST:PORT"):
        VirtualRig(rig, listen="nowhere")
    with pytest.raises(pneudrive.PneudriveError):
        VirtualRig(rig, spread=-1.0)


def test_rows_come_while_the_drive_runs_and_are_those_of_the_record(port: str, rig: Rig) -> None:
    with Drive(port) as drive:
        stream = drive.stream(rig)
        batches = list(stream)
        record = drive.record()
        for name in ("position_counts", "pressure_1_raw", "pressure_2_raw", "command_counts", "error_counts", "spool_raw"):
            rows = np.concatenate([batch[name] for batch in batches])
            assert np.array_equal(rows, record[name]), name
        assert stream.lost == 0
        assert list(stream) == []
        transient = record.transient()
        for name in ("time_s", "position_mm", "pressure_1_kpa", "pressure_2_kpa", "spool_mm"):
            rows = np.concatenate([batch[name] for batch in batches])
            assert rows == pytest.approx(transient[name], abs=1e-9), name
        tenth = np.concatenate([batch["index"] for batch in drive.stream(rig, every=10)])
        assert np.array_equal(tenth, record["index"][::10])


def test_rows_come_before_the_run_is_over(slow_port: str, rig: Rig) -> None:
    with Drive(slow_port) as drive:
        begun = time.monotonic()
        came = [(time.monotonic() - begun, batch["time_s"][-1]) for batch in drive.stream(rig.with_(test__duration_s=2.0))]
    assert len(came) > 5
    assert all(seconds - run < 1.0 for seconds, run in came), came


def test_leaving_the_loop_stops_the_drive(slow_port: str, rig: Rig) -> None:
    with Drive(slow_port) as drive:
        for rows in drive.stream(rig.with_(test__duration_s=30.0)):
            if rows["time_s"][-1] > 0.3:
                break
        status = drive.status()
        assert (status["mode"], status["fault"]) == ("fault", "stop")
        drive.arm()
        with drive.stream(rig, duration_s=float("inf")) as stream:
            next(stream)
        assert stream.lost == 0
        assert drive.status()["mode"] == "disarmed"
        with pytest.raises(ValueError, match="duration_s must be more than 0"):
            drive.run(rig, duration_s=float("inf"))


def test_a_drive_that_streams_can_be_stopped_and_nothing_else(slow_port: str, rig: Rig) -> None:
    long = rig.with_(test__duration_s=30.0)
    with Drive(slow_port) as drive:
        stream = drive.stream(long)
        next(stream)
        with pytest.raises(RuntimeError, match=r"a run is streamed from this drive; leave its loop, or close\(\)"):
            drive.status()
        drive.stop()
        assert drive.status()["mode"] == "fault"
        for _ in stream:
            pass
        drive.arm()
        stream = drive.stream(long)
        next(stream)
    with Drive(slow_port) as other:
        assert other.status()["mode"] == "fault", "the end of the with stops the run"


def test_control_c_stops_a_drive_whose_rows_are_awaited(slow_port: str, rig: Rig) -> None:
    with Drive(slow_port) as drive:
        threading.Timer(0.5, _thread.interrupt_main).start()
        with pytest.raises(KeyboardInterrupt):
            for _ in drive.stream(rig.with_(test__duration_s=30.0)):
                pass
        assert drive.status()["mode"] == "fault"


def test_a_trip_is_told_after_the_rows_before_it(rig: Rig) -> None:
    jumps = rig.with_({"faults.event": [{"kind": "encoder-jump", "at_s": 0.2, "counts": 4000}]})
    samples: list[int] = []
    with VirtualRig(jumps) as virtual, Drive(virtual.port) as drive:
        with pytest.raises(pneudrive.Tripped, match="encoder"):
            for rows in drive.stream(rig):
                samples.extend(rows["index"])
        assert drive.status()["fault"] == "encoder-step"
    assert samples == list(range(len(samples)))
    assert 140 < len(samples) < 170


def test_a_stream_takes_no_progress(port: str, rig: Rig) -> None:
    with Drive(port) as drive, pytest.raises(TypeError, match="a stream without a file shows how far it is"):
        drive.stream(rig, progress=True)  # type: ignore[call-overload]


def test_a_drive_goes_to_a_place_and_by_a_stretch(port: str, rig: Rig) -> None:
    with Drive(port) as drive:
        there = drive.go_to(rig, 120.0)
        assert there == pytest.approx(120.0, abs=1.0)
        assert drive.status()["mode"] == "done", "it holds"
        assert Units(rig).position_m(drive.status()["position_counts"]) == pytest.approx(1e-3 * there)
        assert drive.jog(rig, -5.0) == pytest.approx(there - 5.0, abs=1.0)
        with pytest.raises(pneudrive.Refused, match="out of reach: the drive goes from 0.0 to 300.0 mm"):
            drive.go_to(rig, 301.0)
        with pytest.raises(pneudrive.Refused, match="encoder.mm_per_count of the drive is not that of servo-b-tuned"):
            drive.jog(rig.with_(encoder__mm_per_count=0.01), 1.0)


def test_an_axis_is_homed(port: str) -> None:
    with Drive(port) as drive:
        with pytest.raises(pneudrive.Refused, match="the drive is not armed; arm it first"):
            drive.home()
        drive.arm()
        drive.home()
        status = drive.status()
        assert (status["mode"], status["referenced"]) == ("armed", True)


def test_ctrl_c_stops_a_homing_run(slow_port: str) -> None:
    with Drive(slow_port) as drive:
        drive.arm()
        threading.Timer(0.3, _thread.interrupt_main).start()
        with pytest.raises(KeyboardInterrupt):
            drive.home()
        assert drive.status()["fault"] == "stop"


def test_an_absolute_encoder_needs_no_homing() -> None:
    with VirtualRig(Rig("servo-b-tuned", encoder__model="ssi")) as virtual, Drive(virtual.port) as drive:
        before = drive.status()["position_counts"]
        drive.home()
        assert drive.status()["position_counts"] == before
