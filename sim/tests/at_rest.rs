//! Held cylinders whose flows come to rest: every model of tubes and valve, with and without a clearance
//! that leaks. No run ends early, and rest costs no steps.

use pneudrive_sim::{Accuracy, Rig, Run, run};

/// An open loop on a piston that does not move.
const HELD: [&str; 7] = [
    "controller.loop=open",
    "operator.dither_mm=0",
    "operator.hysteresis_percent=0",
    "load.static_extend_n=9000",
    "load.static_retract_n=9000",
    "test.duration_s=3",
    "test.trace_period_s=0.02",
];

const TUBES: [&[&str]; 6] = [
    &["tubing.model=none"],
    &["tubing.model=empirical"],
    &["tubing.model=analytical"],
    &["tubing.model=empirical", "tubing.lag_s=0.001", "valve.upstream_mach=false"],
    &["tubing.model=empirical", "tubing.lag_s=0.01", "valve.upstream_mach=false"],
    &["tubing.model=analytical", "tubing.lag_s=0.01", "valve.upstream_mach=false"],
];

const VALVES: [&[&str]; 5] = [
    &["valve.model=flow-node"],
    &["valve.model=flow-node", "valve.discharge_model=perry"],
    &["valve.model=single-restriction"],
    &["valve.model=multiple-flow-node"],
    &["valve.model=iso-6358", "valve.sonic_conductance_m3_per_s_pa=2e-8", "valve.critical_ratio=0.3"],
];

const COMMANDS: [&str; 5] = ["0", "100", "512", "2048", "-512"];
const LEAKY: &str = "valve.spool_diameter_mm=9.98";
const TIGHT: &str = "valve.spool_diameter_mm=10";
const MACH: &str = "valve.upstream_mach=true";
const STILL: &str = "valve.upstream_mach=false";

fn held(settings: &[&str], command: &str, tolerance: f64) -> Result<Run, String> {
    let moves = format!("test.moves=[[0.0, {command}]]");
    let settings: Vec<String> = HELD.iter().chain(settings).map(ToString::to_string).chain([moves]).collect();
    let rig = Rig::read_with("held", "", &settings).map_err(|problems| problems.to_string())?;
    run(&rig, Accuracy { tolerance, ..Accuracy::default() }).map_err(|error| error.to_string())
}

/// What is wrong with a run that ends early or takes more than `most` steps.
fn problem(settings: &[&str], command: &str, tolerance: f64, most: u64) -> Option<String> {
    let found = match held(settings, command, tolerance) {
        Ok(run) if run.work.integrator.n_steps + run.work.integrator.n_rejected_steps <= most => return None,
        Ok(run) => format!("{:?}", run.work.integrator),
        Err(why) => why,
    };
    Some(format!("{settings:?}, command {command}, tolerance {tolerance:e}: {found}"))
}

/// Of all tubes with some valves and commands.
fn problems(valves: &[&[&str]], commands: &[&str], [spool, mach]: [&str; 2], tolerance: f64) -> Vec<String> {
    let mut problems = Vec::new();
    // Lagged tubes want air without speed.
    let tubes = TUBES.iter().filter(|tubes| mach == STILL || tubes.len() == 1);
    for (tubes, valve) in tubes.flat_map(|tubes| valves.iter().map(move |valve| (tubes, valve))) {
        let settings = [&[mach, spool], *valve, *tubes].concat();
        let most = most_steps(tubes, tolerance);
        problems.extend(commands.iter().filter_map(|command| problem(&settings, command, tolerance, most)));
    }
    problems
}

/// Lagged tubes behind wide lands decay ten thousand times faster than their lag; a method of order 4(3)
/// follows that at a tight tolerance in short steps.
fn most_steps(tubes: &[&str], tolerance: f64) -> u64 {
    match (tubes.len() > 1, tolerance < 1e-10) {
        (true, true) => 120_000,
        (true, false) => 20_000,
        (false, true) => 15_000,
        (false, false) => 8_000,
    }
}

fn none(problems: &[String]) {
    assert!(problems.is_empty(), "{problems:#?}");
}

#[test]
fn a_valve_that_leaks_lets_the_flows_come_to_rest_in_few_steps() {
    none(&[MACH, STILL].map(|mach| problems(&VALVES, &COMMANDS, [LEAKY, mach], 1e-8)).concat());
}

#[test]
fn a_valve_that_shuts_lets_the_flows_come_to_rest_in_few_steps() {
    none(&[MACH, STILL].map(|mach| problems(&VALVES, &COMMANDS, [TIGHT, mach], 1e-8)).concat());
}

#[test]
fn the_tolerance_of_the_reference_transients_is_met_at_rest_as_well() {
    for spool in [LEAKY, TIGHT] {
        none(&problems(&VALVES[..1], &["2048"], [spool, STILL], 1e-11));
    }
}

/// A valve that shuts fills a chamber to the supply's pressure and empties one to the exhaust's.
#[test]
fn at_rest_a_chamber_has_the_pressure_that_it_is_open_to() {
    for tubes in TUBES.into_iter().filter(|tubes| tubes.len() == 1) {
        let run = held(&[&[TIGHT], tubes].concat(), "512", 1e-11).expect("a transient");
        let [filled, emptied] = run.rows.last().expect("rows").plant.pressures;
        assert!((filled - 589e3).abs() < 1.0 && (emptied - 101_300.0).abs() < 1.0, "{filled} {emptied}");
    }
}

/// Where one land is shut, flows below a thousandth of the choked flow creep (EQUATIONS section 3). That
/// is no more than a clearance of half a nanometre makes.
#[test]
fn tight_and_nearly_tight_valves_fill_a_chamber_alike() {
    let filling = |spool: &str| held(&[spool], "512", 1e-11).expect("a transient");
    let (tight, nearly) = (filling(TIGHT), filling("valve.spool_diameter_mm=9.999999"));
    for (a, b) in tight.rows.iter().zip(&nearly.rows) {
        for (a, b) in a.plant.pressures.iter().zip(&b.plant.pressures) {
            assert!((a - b).abs() < 20.0, "{a} {b}");
        }
    }
}
