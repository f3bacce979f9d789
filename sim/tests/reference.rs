//! The transients of an independent implementation of the same equations, with the tolerances that
//! its authors state (tests/cases/README.md). What parts two programs in the closed loops is one
//! flipped encoder count; the closest approach to the edge of one is 3e-9 m.

#[path = "cases/loosest.rs"]
mod loosest;

use loosest::LOOSEST;
use pneudrive_sim::{Accuracy, Rig, run};

/// The largest deviations from a case up to `until` seconds: position in m, pressures in Pa. At the accuracy that
/// its drive needs, or at another tolerance.
fn deviation(case: &str, until: f64, tolerance: Option<f64>) -> (f64, f64) {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/cases");
    let read = |ending: &str| {
        std::fs::read_to_string(format!("{folder}/{case}.{ending}")).expect("a case in the repository")
    };
    let rig = Rig::read(case, &read("toml")).unwrap_or_else(|problems| panic!("{problems}"));
    let own = Accuracy::of(&rig);
    let accuracy = Accuracy { tolerance: tolerance.unwrap_or(own.tolerance), ..own };
    let rows = run(&rig, accuracy).expect("a transient").rows;
    let csv = read("csv");
    let mut lines = csv.lines();
    let header: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let column = |name: &str| header.iter().position(|other| *other == name).expect("a known column");
    let columns = ["time_s", "position_m", "pressure_1_pa", "pressure_2_pa"].map(column);
    let (mut position, mut pressure) = (0.0_f64, 0.0_f64);
    let mut compared = 0;
    for (line, row) in lines.zip(&rows) {
        let values: Vec<f64> = line.split(',').map(|text| text.parse().expect("a number")).collect();
        let [time, y, p1, p2] = columns.map(|column| values[column]);
        assert!((time - row.time).abs() < 1e-9, "{case}: row {compared} is at {}, not {time}", row.time);
        if time <= until {
            position = position.max((y - row.plant.position).abs());
            let off = (p1 - row.plant.pressures[0]).abs().max((p2 - row.plant.pressures[1]).abs());
            pressure = pressure.max(off);
        }
        compared += 1;
    }
    assert_eq!(compared, csv.lines().count() - 1, "{case}: every row of the reference has a partner");
    println!(
        "{case} to {until} s at {:e}: position {position:.1e} m, pressure {pressure:.1e} Pa",
        accuracy.tolerance
    );
    (position, pressure)
}

fn agrees(case: &str, until: f64, position_m: f64, pressure_pa: f64) {
    let (position, pressure) = deviation(case, until, None);
    assert!(position < position_m, "{case} to {until} s: position off by {position:e} m");
    assert!(pressure < pressure_pa, "{case} to {until} s: pressure off by {pressure:e} Pa");
}

#[test]
fn open_loop_without_dither() {
    agrees("B_open_nodither", f64::INFINITY, 1e-6, 10.0);
}

#[test]
fn open_loop_with_dither() {
    agrees("B_open_dither", f64::INFINITY, 1e-6, 10.0);
}

#[test]
fn damped_closed_loop() {
    agrees("B_closed_damped", 0.30, 1e-6, 10.0);
    agrees("B_closed_damped", f64::INFINITY, 1e-5, 100.0);
}

#[test]
fn closed_loop_with_the_gains_of_the_thesis() {
    agrees("B_closed_default", 0.55, 1e-6, 10.0);
    agrees("B_closed_default", f64::INFINITY, 1e-5, 100.0);
}

#[test]
fn stepper_drive_in_open_loop() {
    agrees("A_open_quarter", f64::INFINITY, 1e-7, 1.0);
    agrees("A_open_endstop", f64::INFINITY, 1e-6, 10.0);
}

#[test]
fn stepper_drive_without_tubes() {
    agrees("A_open_notube", f64::INFINITY, 1e-6, 10.0);
}

#[test]
fn stepper_drive_in_closed_loop() {
    agrees("A_closed", f64::INFINITY, 1e-7, 1.0);
}

#[test]
fn rodless_drive_in_open_loop() {
    agrees("C_open", f64::INFINITY, 1e-6, 10.0);
}

#[test]
fn single_restriction_valve() {
    agrees("A_open_single", f64::INFINITY, 1e-7, 1.0);
}

#[test]
fn connectors_in_place_of_tubes() {
    agrees("A_open_multinode", f64::INFINITY, 1e-6, 10.0);
}

#[test]
fn tubes_that_lag_behind_the_flow() {
    agrees("A_open_taulag", f64::INFINITY, 1e-7, 1.0);
}

#[test]
fn continuous_controller() {
    agrees("B_closed_cont", 0.70, 1e-6, 10.0);
}

/// What docs/explanation/speed.md compares is as exact as what it is compared with.
#[test]
fn at_their_loosest_tolerances_the_compared_cases_are_within_a_micrometre_and_10_pa() {
    let holds = |case: &str, tolerance: f64| {
        let (position, pressure) = deviation(case, f64::INFINITY, Some(tolerance));
        position < 1e-6 && pressure < 10.0
    };
    for (case, tolerance) in LOOSEST {
        assert!(holds(case, tolerance), "{case} at {tolerance:e}");
    }
}
