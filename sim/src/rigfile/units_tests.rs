//! Values with units of their own, and where values come from.

use crate::keys;
use crate::rig::{Origin, Problems, Rig, Source};

fn read(text: &str) -> Rig {
    Rig::read("rig.toml", text).unwrap_or_else(|problems| panic!("{problems}"))
}

fn only_problem(text: &str, settings: &[&str]) -> String {
    let settings: Vec<String> = settings.iter().map(|setting| (*setting).to_owned()).collect();
    let Problems(mut found) = Rig::read_with("rig.toml", text, &settings).expect_err(text);
    assert_eq!(found.len(), 1, "{found:?}");
    found.remove(0).to_string()
}

#[test]
fn a_value_with_its_unit_is_the_same_key() {
    let rig = read(
        "[actuator]\nstroke = \"250 mm\"\nbore = \"32 mm\"\nrod_diameter = \"12 mm\"\n[load]\nmass = \"8 kg\"\n",
    );
    assert_eq!(rig.get(&keys::actuator::STROKE_M), 0.25);
    assert_eq!(rig.get(&keys::actuator::BORE_M), 0.032);
    assert_eq!(rig.get(&keys::load::MASS_KG), 8.0);
    assert!(rig.is_set(&keys::load::MASS_KG));
}

#[test]
fn gauge_pressures_count_from_the_exhaust_wherever_that_stands() {
    for text in [
        "[supply]\npressure = \"6 bar(g)\"\n[exhaust]\npressure_pa = 95e3\n",
        "[exhaust]\npressure = \"950 mbar\"\n[supply]\npressure = \"6 bar(g)\"\n",
    ] {
        assert_eq!(read(text).get(&keys::supply::PRESSURE_PA), 695e3, "{text}");
    }
    let settings = ["exhaust.pressure_pa=90e3".to_owned(), "supply.pressure=\"6 bar(g)\"".to_owned()];
    let rig = Rig::read_with("rig.toml", "", &settings).expect("a rig");
    assert_eq!(rig.get(&keys::supply::PRESSURE_PA), 690e3);
    let absolute = ["supply.pressure_pa=500e3".to_owned()];
    let rig = Rig::read_with("rig.toml", "[supply]\npressure = \"6 bar(g)\"\n", &absolute).expect("a rig");
    assert_eq!(rig.get(&keys::supply::PRESSURE_PA), 500e3, "what is typed last holds");
}

#[test]
fn a_key_with_and_without_its_unit_is_given_twice() {
    assert_eq!(
        only_problem("[supply]\npressure_pa = 589e3\npressure = \"6 bar(g)\"\n", &[]),
        "rig.toml:3: supply.pressure: supply.pressure_pa is given twice, with and without its unit"
    );
}

#[test]
fn a_unit_of_something_else_is_refused_at_its_line() {
    for (text, expected) in [
        (
            "[actuator]\nstroke = \"250 kg\"\n",
            "rig.toml:2: actuator.stroke: kg is not a unit of the same quantity as m",
        ),
        ("[actuator]\nstroke = \"250\"\n", "rig.toml:2: actuator.stroke: needs a unit"),
        (
            "[actuator]\nbore = \"32 m\"\n",
            "rig.toml:2: actuator.bore: must be between 0.001 m and 2 m, is 32",
        ),
        ("[exhaust]\npressure = \"0 bar(g)\"\n", "rig.toml:2: exhaust.pressure: the surroundings are what"),
        ("[supply]\npressure = \"-1.5 bar(g)\"\n", "rig.toml:2: supply.pressure: must be between"),
        (
            "[actuator]\nstroke = { given = 0.25 }\n",
            "rig.toml:2: actuator.stroke: must be a text with its unit",
        ),
    ] {
        let message = only_problem(text, &[]);
        assert!(message.starts_with(expected), "{message}");
    }
    assert!(
        only_problem("", &["load.mass=8 stone"]).starts_with("--set: load.mass: stone is not a known unit")
    );
}

#[test]
fn a_rig_knows_where_its_values_come_from() {
    let rig = read(
        "[load]\nmass = { given = \"8 kg\" }\nstatic_extend_n = { typical = 70.0, low = 20, high = \"0.1 kN\", from = \"a book\" }\nviscous_n_s_per_m = 40\n",
    );
    let mass = rig.origin(&keys::load::MASS_KG);
    assert_eq!((mass.source, mass.range, mass.from.as_str()), (Source::Given, None, ""));
    let friction = rig.origin(&keys::friction::STATIC_EXTEND_N);
    assert_eq!(friction.source, Source::Typical);
    assert_eq!((friction.range, friction.from.as_str()), (Some([20.0, 100.0]), "a book"));
    assert_eq!(rig.origin(&keys::load::VISCOUS_N_S_PER_M).source, Source::Given);
    assert_eq!(rig.origin(&keys::load::SPRING_N_PER_M).source, Source::Default);
}

#[test]
fn a_new_value_has_a_new_origin() {
    let rig = read("[load]\nmass = { typical = \"8 kg\", low = 7, high = 9 }\n");
    let rig = rig.with_settings(&["load.mass_kg=3".to_owned()]).expect("a rig");
    assert_eq!(
        rig.origin(&keys::load::MASS_KG),
        Origin { source: Source::Given, range: None, from: String::new() }
    );
}

#[test]
fn an_origin_that_says_nothing_is_refused() {
    for (text, expected) in [
        ("{ value = 8 }", "has one of given, computed, typical and unknown"),
        ("{ given = 8, typical = 7 }", "has one of given, computed, typical and unknown"),
        ("{ unknown = 8 }", "an unknown value needs low and high"),
        ("{ typical = 8, low = 7 }", "low and high go together"),
        ("{ typical = 8, low = 9, high = 10 }", "must lie between its low, 9, and its high, 10, is 8"),
        ("{ given = 8, source = \"x\" }", "source is not one of given, computed"),
        ("{ given = 8, from = 3 }", "from must be a text"),
    ] {
        let message = only_problem(&format!("[load]\nmass_kg = {text}\n"), &[]);
        assert!(message.starts_with(&format!("rig.toml:2: load.mass_kg: {expected}")), "{message}");
    }
}

/// Gauge and absolute are a bar apart, and a run with the wrong one looks as good.
#[test]
fn a_pressure_that_does_not_say_from_where_it_counts_is_refused() {
    for (table, name) in [("supply", "pressure"), ("sensors", "pressure_max"), ("test", "pressure_1")] {
        let of = |text: &str| format!("[{table}]\n{name} = \"{text}\"\n");
        let message = only_problem(&of("6.5 bar"), &[]);
        assert!(
            message.ends_with(r#""6.5 bar" may be gauge or absolute: write "6.5 bar(g)" or "6.5 bar(a)""#),
            "{message}"
        );
        for said in ["6.5 bar(g)", "6.5 bar(a)"] {
            read(&of(said));
        }
    }
    read("[exhaust]\npressure = \"1013 hPa\"\n");
}
