//! Every key of a rig file at the ends of its range: the rig is refused with a message, or its run
//! ends with numbers or with an error that has a name. Never a panic, never a run without end.

use pneudrive_sim::rig::builtin;
use pneudrive_sim::rig::keys::{KEYS, Key, Kind};
use pneudrive_sim::{Accuracy, Rig, Run, run};
use proptest::prelude::*;

/// A test of the closed loop, one that opens the valve fully either way, and one into a stop.
const TESTS: [&[&str]; 3] = [
    &["test.moves=[[0.0, 8192], [0.002, 16384]]", "test.duration_s=0.02"],
    &["controller.loop=open", "test.moves=[[0.0, 2048], [0.02, -2048]]", "test.duration_s=0.03"],
    &["controller.loop=open", "test.moves=[[0.0, 2048]]", "test.duration_s=0.04", "test.position_m=0.2995"],
];

/// The rigs whose plants differ.
const RIGS: [&str; 3] = ["servo-a", "servo-b", "servo-c"];

/// The settings under which a key counts for something.
fn companions(key: &Key) -> Vec<String> {
    let mut settings: Vec<&str> = match key.path {
        "actuator.leakage_coefficient" => vec!["actuator.leakage=laminar"],
        "actuator.passage_resistance" | "actuator.passage_clearance_m" => vec!["actuator.leakage=adiabatic"],
        "valve.spool_rod_diameter_mm" | "valve.land_length_m" => vec!["valve.flow_force=analytical"],
        "tubing.lag_s" => vec!["valve.upstream_mach=false"],
        _ => Vec::new(),
    };
    if key.models.contains(&"iso-6358") {
        settings.extend(["valve.sonic_conductance_m3_per_s_pa=2e-8", "valve.critical_ratio=0.3"]);
    }
    let mut settings: Vec<String> = settings.into_iter().map(str::to_owned).collect();
    settings.extend(key.models.first().map(|model| format!("{}.model={model}", key.table())));
    settings
}

/// `key=value` at both ends of a key's range; nothing for a key without one. How long a test is and
/// how many rows it has are no parameters of the rig.
fn ends(key: &Key) -> Vec<String> {
    match key.kind {
        _ if ["test.duration_s", "test.trace_period_s"].contains(&key.path) => Vec::new(),
        Kind::Number { min, max } => [min, max].map(|end| format!("{}={end:?}", key.path)).to_vec(),
        Kind::Integer { min, max } => [min, max].map(|end| format!("{}={end}", key.path)).to_vec(),
        _ => Vec::new(),
    }
}

/// What came of a rig.
#[derive(Debug, PartialEq)]
enum Outcome {
    Refused,
    Ran,
    /// The error's words.
    Ended(String),
}

fn has_physical_numbers(run: &Run) -> bool {
    run.rows.iter().all(|row| {
        let air = row.plant.pressures.iter().chain(&row.plant.temperatures);
        row.values().iter().all(|value| value.is_finite()) && air.into_iter().all(|value| *value > 0.0)
    })
}

fn outcome(name: &str, settings: &[String]) -> Outcome {
    let text = builtin(name).expect("a built-in rig");
    let rig = match Rig::read_with(name, text, settings) {
        Ok(rig) => rig,
        Err(problems) => {
            assert!(problems.0.iter().all(|problem| !problem.message.is_empty()), "{name} {settings:?}");
            return Outcome::Refused;
        }
    };
    match run(&rig, Accuracy { tolerance: 1e-8, ..Accuracy::default() }) {
        Ok(run) => {
            assert!(has_physical_numbers(&run), "{name} {settings:?}");
            Outcome::Ran
        }
        Err(error) => Outcome::Ended(error.to_string()),
    }
}

fn settings(test: &[&str], changes: &[String]) -> Vec<String> {
    test.iter().map(|&setting| setting.to_owned()).chain(changes.iter().cloned()).collect()
}

fn every_key_at_its_ends_runs_or_is_refused(name: &str) {
    let mut ended = Vec::new();
    for key in KEYS {
        for end in ends(key) {
            for test in TESTS {
                let mut changes = companions(key);
                changes.push(end.clone());
                if let Outcome::Ended(why) = outcome(name, &settings(test, &changes)) {
                    ended.push(format!("{end}: {why}"));
                }
            }
        }
    }
    assert!(ended.is_empty(), "{name}: {ended:#?}");
}

#[test]
fn servo_drive_a_runs_or_is_refused_with_any_key_at_an_end_of_its_range() {
    every_key_at_its_ends_runs_or_is_refused("servo-a");
}

#[test]
fn servo_drive_b_runs_or_is_refused_with_any_key_at_an_end_of_its_range() {
    every_key_at_its_ends_runs_or_is_refused("servo-b");
}

#[test]
fn servo_drive_c_runs_or_is_refused_with_any_key_at_an_end_of_its_range() {
    every_key_at_its_ends_runs_or_is_refused("servo-c");
}

/// Once a row at which Newton's method did not find the flows had none: the run went on, with holes in
/// its trace.
#[test]
fn a_row_has_flows_where_they_are_hard_to_find() {
    let extremes = [
        "tubing.model=analytical",
        "tubing.length_m=1000.0",
        "exhaust.pressure_pa=10000.0",
        "valve.null_offset_mm=10.0",
        "actuator.leakage=laminar",
        "actuator.leakage_coefficient=1e-6",
    ];
    assert_eq!(outcome("servo-a", &settings(TESTS[0], &extremes.map(str::to_owned))), Outcome::Ran);
}

/// Settings of several keys at an end of their ranges.
fn several_ends() -> impl Strategy<Value = Vec<String>> {
    let all: Vec<(&Key, String)> =
        KEYS.iter().flat_map(|key| ends(key).into_iter().map(move |end| (key, end))).collect();
    let one = prop::sample::select(all);
    prop::collection::vec(one, 2..5).prop_map(|chosen| {
        let mut settings: Vec<String> = chosen.iter().flat_map(|(key, _)| companions(key)).collect();
        settings.extend(chosen.into_iter().map(|(_, end)| end));
        settings
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(100) })]

    /// Here an error with a name will do: several extremes at once may be too stiff for any method.
    #[test]
    fn several_keys_at_an_end_of_their_ranges_at_once_never_panic_and_never_run_for_ever(
        name in prop::sample::select(RIGS.to_vec()),
        test in prop::sample::select(TESTS.to_vec()),
        changes in several_ends(),
    ) {
        outcome(name, &settings(test, &changes));
    }
}
