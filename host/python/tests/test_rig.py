"""Rigs: from a name, a file and a dict; their keys; what is wrong with them."""

import pickle
from pathlib import Path

import numpy as np
import pytest

import pneudrive
from pneudrive import Controller, Rig, RigError, Sample


def test_a_rig_from_a_name_a_file_and_a_dict_is_the_same(tmp_path: Path) -> None:
    named = Rig("servo-a", load__mass_kg=2)
    named.save(tmp_path / "mine.toml")
    assert Rig(tmp_path / "mine.toml") == Rig(str(tmp_path / "mine.toml")) == named
    assert Rig(named.to_dict()) == named
    assert Rig({"load": {"mass_kg": 2}}) == Rig({"load.mass_kg": 2.0}) != Rig({})


def test_keys_are_attributes_with_the_help_text_of_explain(rig: Rig) -> None:
    assert rig.load.mass_kg == rig["load.mass_kg"] == 1.6
    assert type(rig.controller.velocity_gain) is int
    assert rig.controller.loop == "closed"
    assert rig.test.moves[0] == (0.0, 8192)
    documented = type(rig.load).mass_kg.__doc__
    assert documented == pneudrive.explain("load.mass_kg")
    assert "kg" in documented
    for key in pneudrive.keys():
        table, _, name = key["path"].rpartition(".")
        assert key["help"] == pneudrive.explain(key["path"])
        assert not table or name in dir(getattr(rig, table))


def test_with_makes_another_rig_and_leaves_this_one(rig: Rig) -> None:
    heavy = rig.with_(load__mass_kg=2)
    assert (heavy.load.mass_kg, rig.load.mass_kg) == (2.0, 1.6)
    assert rig.with_({"load.mass_kg": 2}) == heavy
    assert rig.with_(load__mass="2000 g") == heavy
    assert rig.with_(load__mass_kg=np.float64(2)) == heavy
    with pytest.raises(AttributeError, match=r"rig.with_\(load__mass_kg=3\)"):
        rig.load.mass_kg = 3  # type: ignore[misc]


def test_moves_come_from_a_table_of_numpy(rig: Rig) -> None:
    moved = rig.with_(test__moves=np.array([[0.0, 8192], [0.1, 9000]]))
    assert moved.test.moves == [(0.0, 8192), (0.1, 9000)]
    with pytest.raises(RigError, match=r"values: test.moves: must be a list of \[time in s, counts\]"):
        rig.with_(test__moves=np.array([[0.0, 8192.5]]))


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"load.mas_kg": 2}, "values: load.mas_kg: unknown key; did you mean mass_kg?"),
        ({"load.mass": 2}, "there is no such key; with its unit it is mass_kg"),
        ({"lod.mass_kg": 2}, "lod.mass_kg: unknown key"),
        ({"load.mass_kg": -1}, "load.mass_kg: must be between"),
        ({"load.mass_kg": float("nan")}, "load.mass_kg: must be between .* is NaN"),
        ({"load.mass_kg": float("inf")}, "load.mass_kg: must be between .* is inf"),
        ({"load.mass_kg": "heavy"}, "load.mass_kg: must be a number in kg"),
        ({"load.mass_kg": True}, "load.mass_kg: must be a number in kg"),
        ({"controller.velocity_gain": 1.5}, "must be a whole number, not a float"),
        ({"valve.model": "magic"}, 'must be one of "flow-node"'),
        ({"exhaust.pressure_pa": 6e5}, "air must flow from the supply to the exhaust"),
    ],
)
def test_a_wrong_value_is_refused_with_its_key(rig: Rig, values: dict[str, object], message: str) -> None:
    with pytest.raises(RigError, match=message.replace("?", r"\?")) as raised:
        rig.with_(values)
    assert isinstance(raised.value, ValueError)
    assert {problem.key for problem in raised.value.problems} == set(values)


@pytest.mark.parametrize("value", [None, object(), 1j, {1, 2}, b"2"])
def test_a_value_of_another_type_is_refused_with_its_key(rig: Rig, value: object) -> None:
    with pytest.raises(TypeError, match="load.mass_kg: a rig file has numbers, texts, switches and lists"):
        rig.with_(load__mass_kg=value)  # type: ignore[arg-type]


def test_every_problem_of_a_file_is_named_with_its_line(tmp_path: Path) -> None:
    file = tmp_path / "bad.toml"
    file.write_text("[load]\nmass_kg = -1\n\n[valve]\nmodle = 'flow-node'\n")
    with pytest.raises(RigError) as raised:
        Rig(file)
    assert [(one.line, one.key) for one in raised.value.problems] == [(2, "load.mass_kg"), (5, "valve.modle")]
    assert str(raised.value).startswith(f"{file}:2: load.mass_kg: must be between")
    copy = pickle.loads(pickle.dumps(raised.value))
    assert copy.problems == raised.value.problems


def test_a_key_that_there_is_not_is_named(rig: Rig) -> None:
    with pytest.raises(KeyError, match="did you mean mass_kg?"):
        rig["load.mas_kg"]
    with pytest.raises(AttributeError, match="did you mean mass_kg?"):
        rig.load.mas_kg  # type: ignore[attr-defined]
    assert not hasattr(rig.load, "mas_kg")
    with pytest.raises(RigError, match="there is no such key or table"):
        pneudrive.explain("lod")


def test_what_is_no_rig_is_refused() -> None:
    with pytest.raises(FileNotFoundError, match="there is no rig file servo-z, and no built-in rig"):
        Rig("servo-z")
    with pytest.raises(TypeError, match="a rig is the name of a built-in one, a file, or a dict of its keys, not int"):
        Rig(7)  # type: ignore[arg-type]


def test_a_rig_goes_to_another_process(rig: Rig) -> None:
    copy = pickle.loads(pickle.dumps(rig.with_(load__mass_kg=2)))
    assert copy == rig.with_(load__mass_kg=2)
    assert copy.to_toml() == rig.with_(load__mass_kg=2).to_toml()


def test_a_spread_rig_is_drawn_within_the_fraction(rig: Rig) -> None:
    drawn = rig.spread(0.1, seed=3)
    assert drawn == rig.spread(0.1, seed=3) != rig.spread(0.1, seed=4)
    assert 1.6 * 0.9 <= drawn.load.mass_kg <= 1.6 * 1.1
    assert drawn.load.mass_kg != 1.6


def test_a_spread_changes_the_plant_and_not_what_the_controller_knows() -> None:
    press = Rig("press")
    readings = [Sample(2000 + 3 * k, 1500 + 7 * k, 1400 - 5 * k) for k in range(60)]

    def commands(rig: Rig) -> list[int]:
        controller = Controller(rig)
        return [controller.step(reading).counts for reading in readings]

    for seed in range(50):
        drawn = press.spread(0.1, seed=seed)
        assert drawn.load.mass_kg != press.load.mass_kg
        assert drawn.nominal == press
        assert commands(drawn) == commands(press)
    assert commands(press.with_(load__mass_kg=2 * press.load.mass_kg)) != commands(press), "it knows its mass"


def test_a_plant_of_its_own_outlives_pickling_and_other_settings(rig: Rig) -> None:
    drawn = rig.spread(0.1, seed=3)
    copy = pickle.loads(pickle.dumps(drawn))
    assert copy == drawn and copy.nominal == rig
    heavier = drawn.with_plant(load__mass_kg=3)
    assert heavier.load.mass_kg == 3 and heavier.load.viscous_n_s_per_m == drawn.load.viscous_n_s_per_m
    assert heavier.nominal == rig
    told = heavier.with_({"load.mass": "4 kg"})
    assert told.load.mass_kg == 4 and told.load.viscous_n_s_per_m == drawn.load.viscous_n_s_per_m
    assert told.nominal == rig.with_(load__mass_kg=4), "what is set, the controller knows"
    assert "values of its own plant" in repr(told)


def test_a_plant_of_its_own_has_no_file(rig: Rig, tmp_path: Path) -> None:
    drawn = rig.spread(0.1, seed=3)
    for refused in (
        drawn.to_toml,
        lambda: drawn.save(tmp_path / "drawn.toml"),
        lambda: drawn.export_fmu(tmp_path / "drawn.fmu"),
        lambda: pneudrive.tune(drawn, generations=0, draws=1),
        lambda: pneudrive.sweep(drawn, vary={"load.mass_kg": [1, 2]}, metrics={}),
        lambda: pneudrive.identify(drawn, []),
    ):
        with pytest.raises(ValueError, match=r"rig\.nominal is the rig that the controller knows"):
            refused()
    assert not list(tmp_path.iterdir())


def test_where_a_value_comes_from_is_told() -> None:
    text = {"load": {"mass_kg": {"unknown": 8, "low": 6, "high": 10, "from": "a guess"}}}
    assert Rig(text).origin("load.mass_kg") == ("unknown", (6.0, 10.0), "a guess")
    assert Rig({}).origin("load.mass_kg")[0] == "default"
