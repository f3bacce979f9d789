//! Rig files: what is accepted, and what every refusal says.

use crate::component::tubing::TubingKind;
use crate::keys;
use crate::rig::tests::{only_problem, problems, read};
use crate::rig::{Problems, Rig};

#[test]
fn an_unknown_key_is_named_with_file_line_and_a_guess() {
    assert_eq!(
        only_problem("[load]\n# a comment\nmass_kgs = 2\n"),
        "rig.toml:3: load.mass_kgs: unknown key; did you mean mass_kg?"
    );
    assert_eq!(
        only_problem("[lode]\nmass_kg = 2\n"),
        "rig.toml:2: lode: there is no table [lode]; did you mean load?"
    );
    assert!(only_problem("xyzzy = 1").contains("rig.toml:1: xyzzy: unknown key; `pneudrive rig explain`"));
}

#[test]
fn a_wrong_unit_is_named_with_the_right_one() {
    assert_eq!(
        only_problem("[actuator]\nbore_mm = 50\n"),
        "rig.toml:2: actuator.bore_mm: wrong unit: this key is bore_m, so give it in m instead of mm"
    );
    assert_eq!(
        only_problem("[supply]\npressure_bar = 5.9\n"),
        "rig.toml:2: supply.pressure_bar: wrong unit: this key is pressure_pa, so give it in Pa instead of bar"
    );
    assert_eq!(
        only_problem("[supply]\npressure = 589000\n"),
        "rig.toml:2: supply.pressure: there is no such key; with its unit it is pressure_pa (in Pa); or write the unit with the number, in quotes: \"589000 Pa(a)\"?"
    );
    assert_eq!(
        only_problem("[supply]\npressure_pa = \"5.9 bar\"\n"),
        "rig.toml:2: supply.pressure_pa: must be a number in Pa without the unit, not a string; with its unit write pressure = \"5.9 bar\""
    );
    assert_eq!(
        only_problem("[actuator]\nbore_m = 50\n"),
        "rig.toml:2: actuator.bore_m: must be between 0.001 m and 2 m, is 50"
    );
}

#[test]
fn a_negative_diameter_is_refused_with_its_range() {
    assert_eq!(
        only_problem("[valve]\nport_diameter_mm = -3.3\n"),
        "rig.toml:2: valve.port_diameter_mm: must be between 0.01 mm and 500 mm, is -3.3"
    );
}

#[test]
fn a_missing_bracket_is_found_at_its_line_and_key() {
    for (text, expected) in [
        (
            "[test]\nmoves = [[0.0, 8192], [0.3, 16384]\nduration_s = 3.1\n",
            "rig.toml:2: test.moves: a bracket",
        ),
        ("[load]\nmass_kg = 2\n\n[test\nduration_s = 3\n", "rig.toml:4: [test]: a bracket is opened"),
        ("[load]\nmass_kg = 2\n[load]\nviscous_n_s_per_m = 2\n", "rig.toml:3: [load]: it is given twice"),
        ("[load]\nmass_kg 2\n", "rig.toml:2: [load]: this is not TOML"),
        ("[load]\nmass_kg = 2\nviscous_n_s_per_m = = 3\n", "rig.toml:3: load.viscous_n_s_per_m: this is not"),
    ] {
        let message = only_problem(text);
        assert!(message.starts_with(expected), "{message}");
    }
}

#[test]
fn everything_wrong_is_said_at_once() {
    let found = problems("[load]\nmass_kg = -1\nviscous_n_s_per_m = \"x\"\n[valve]\nmodel = \"flaps\"\n");
    assert_eq!(found.len(), 3, "{found:?}");
}

#[test]
fn a_model_that_is_not_built_is_refused_in_just_those_words() {
    let message = only_problem("[tubing]\nmodel = \"dynamic\"\n");
    assert!(message.contains("tubing.model = \"dynamic\" is not built yet"), "{message}");
    let message = only_problem("[valve]\ndischarge_reverse = 0.9\n");
    assert!(message.contains("valve.discharge_reverse has no effect"), "{message}");
    read("[valve]\ndischarge_reverse = 1\n");
}

#[test]
fn settings_of_the_command_line_count_like_lines_of_the_file() {
    let settings =
        ["load.mass_kg=2.5".to_owned(), "tubing.model=none".to_owned(), "test.moves=[[0.0, 5]]".to_owned()];
    let rig = Rig::read_with("servo-b", "", &settings).expect("valid");
    assert_eq!((rig.get(&keys::load::MASS_KG), rig.get(&keys::tubing::MODEL)), (2.5, TubingKind::None));
    assert_eq!(rig.moves(), [(0.0, 5)]);
    for (setting, expected) in [
        ("load.mass_kg", "--set: load.mass_kg: write key=value"),
        ("load.mass_kg=heavy", "--set: load.mass_kg: must be a number in kg"),
        ("load.mas_kg=1", "--set: load.mas_kg: unknown key; did you mean mass_kg?"),
        ("laod.mass_kg=1", "--set: laod.mass_kg: unknown key; did you mean load.mass_kg?"),
    ] {
        let Problems(found) = Rig::read_with("servo-b", "", &[setting.to_owned()]).expect_err("refused");
        assert!(found[0].to_string().contains(expected), "{}", found[0]);
    }
}
