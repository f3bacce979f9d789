//! A controller that starts when its drive has lived for a while (C(40), `controller.start_s`).

use pneudrive_sim::{Accuracy, Rig, Run, run};

fn simulate(settings: &[&str]) -> Run {
    let settings: Vec<String> = settings.iter().map(|text| (*text).to_owned()).collect();
    let rig = Rig::read_with("late", "", &settings).expect("a valid rig");
    run(&rig, Accuracy::default()).expect("a transient")
}

/// 0.26 s are 200 samples. An open loop is at the null until its first move, so that it lives through the same.
#[test]
fn a_late_start_is_a_late_first_move_of_an_open_loop() {
    let leak = "faults.event=[{ kind = \"leak\", at_s = 0.1, chamber = 2 }]";
    let later_leak = "faults.event=[{ kind = \"leak\", at_s = 0.36, chamber = 2 }]";
    let (late, whole) = (
        simulate(&[
            "controller.loop=open",
            "controller.start_s=0.26",
            "test.moves=[[0.0, 700]]",
            "test.duration_s=0.3",
            leak,
        ]),
        simulate(&["controller.loop=open", "test.moves=[[0.26, 700]]", "test.duration_s=0.56", later_leak]),
    );
    assert_eq!(late.rows.len() + 200, whole.rows.len());
    for (late, whole) in late.rows.iter().zip(&whole.rows[200..]) {
        assert!((whole.time - late.time - 0.26).abs() < 1e-9);
        let apart = (late.plant.position - whole.plant.position).abs();
        assert!(apart < 1e-9, "at {} s: {apart} m", late.time);
        assert_eq!(late.observation.pressure_1, whole.observation.pressure_1, "at {} s", late.time);
    }
    let moved = late.rows[late.rows.len() - 1].plant.position - late.rows[0].plant.position;
    assert!(moved > 0.01, "it moves by {moved} m");
}

/// What a leaking valve does to the chambers before the start is the initial state that the controller finds; the loop
/// closes at its first sample, not before.
#[test]
fn before_the_start_the_air_creeps_and_no_controller_holds_the_drive() {
    for model in ["controller.model=sampled", "controller.model=continuous"] {
        let of = |start: &str| simulate(&[model, start, "operator.dither_mm=0", "test.duration_s=0.4"]);
        let (late, at_once) = (of("controller.start_s=0.5"), of("controller.start_s=0"));
        let waited = simulate(&[
            "controller.loop=open",
            "operator.dither_mm=0",
            "test.moves=[[0.0, 0]]",
            "test.duration_s=0.5",
        ]);
        let (first, last) = (late.rows[0].plant, waited.rows[waited.rows.len() - 1].plant);
        let apart = [0, 1].map(|i| (first.pressures[i] - last.pressures[i]).abs());
        // The last row of the wait is up to a sample before its end.
        assert!(apart.iter().all(|&pa| pa < 2000.0), "{model}: {apart:?} Pa");
        let crept = (at_once.rows[0].plant.pressures[0] - first.pressures[0]).abs();
        assert!(crept > 20e3, "{model}: the air has crept by {crept} Pa");
        assert_ne!(late.rows[300].plant.position, at_once.rows[300].plant.position);
    }
}
