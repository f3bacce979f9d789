//! Transients with the flows from a table (`valve.table`) beside those of the network itself.

use pneudrive_sim::rig::builtin;
use pneudrive_sim::{Accuracy, Rig, Run, run};

/// A built-in rig with settings, and how it runs.
fn ran(name: &str, settings: &[&str], tolerance: f64) -> Run {
    let all: Vec<String> = settings.iter().map(|setting| (*setting).to_owned()).collect();
    let rig = Rig::read_with(name, builtin(name).expect("built in"), &all)
        .unwrap_or_else(|problems| panic!("{problems}"));
    run(&rig, Accuracy { tolerance, ..Accuracy::of(&rig) }).expect("a transient")
}

/// The same with a table and without, at the tolerance that a table is integrated with.
fn both(name: &str, settings: &[&str]) -> [Run; 2] {
    ["valve.table=true", "valve.table=false"].map(|table| {
        let all: Vec<&str> = settings.iter().copied().chain(["valve.upstream_mach=false", table]).collect();
        ran(name, &all, 1e-6)
    })
}

/// The largest differences: position in m, pressures in Pa.
fn apart([one, two]: &[Run; 2]) -> [f64; 2] {
    assert_eq!(one.rows.len(), two.rows.len());
    let mut most = [0.0_f64; 2];
    for (one, two) in one.rows.iter().zip(&two.rows) {
        most[0] = most[0].max((one.plant.position - two.plant.position).abs());
        for (one, two) in one.plant.pressures.iter().zip(&two.plant.pressures) {
            most[1] = most[1].max((one - two).abs());
        }
    }
    most
}

/// The part of the flows that the table answered.
fn answered(run: &Run) -> f64 {
    run.work.network.tabulated as f64 / run.work.network.solutions as f64
}

const OPEN: [&str; 3] = [
    "controller.loop=open",
    "test.moves=[[0.0, 0], [0.1, 400], [0.4, -400], [0.7, 0]]",
    "test.duration_s=0.9",
];

/// Where nothing is fed back a flow that is off by 0.1 % moves the piston 0.1 % farther at the most.
#[test]
fn in_open_loop_servo_b_goes_where_it_goes_without_a_table() {
    let runs = both("servo-b", &OPEN);
    let [position, pressure] = apart(&runs);
    let stroke = runs[1].rows.iter().map(|row| row.plant.position);
    let (low, high) = stroke.fold((f64::MAX, 0.0_f64), |(low, high), x| (low.min(x), high.max(x)));
    println!("servo-b, open loop: {position:.1e} m of {:.3} m, {pressure:.1e} Pa", high - low);
    assert!(high - low > 0.05, "a move: {low} to {high} m");
    assert!(position < 1e-3 * (high - low), "{position:e} m");
    assert!(pressure < 400.0, "{pressure:e} Pa");
    assert!(answered(&runs[0]) > 0.9, "{}", answered(&runs[0]));
    assert_eq!(runs[1].work.network.tabulated, 0);
}

/// A stepper's spool does not shake, so few counts lie on an edge, and the loop closes on what is left.
#[test]
fn in_closed_loop_servo_a_moves_as_it_does_without_a_table() {
    let runs = both("servo-a", &[]);
    let [position, pressure] = apart(&runs);
    let end = runs.each_ref().map(|run| run.rows.last().expect("rows").plant.position);
    println!("servo-a: {position:.1e} m, {pressure:.1e} Pa, at the end {:.1e} m", end[0] - end[1]);
    assert!(position < 1e-4, "{position:e} m");
    assert!(answered(&runs[0]) > 0.8, "{}", answered(&runs[0]));
}

#[test]
fn a_table_gives_the_same_run_each_time() {
    let settings = ["valve.upstream_mach=false", "valve.table=true", "test.duration_s=0.3"];
    let [one, two] = [(); 2].map(|()| ran("servo-b", &settings, 1e-6));
    assert_eq!(one.work, two.work);
    assert!(one.rows.iter().zip(&two.rows).all(|(one, two)| one.plant == two.plant));
}
