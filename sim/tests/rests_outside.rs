//! A load that rests where it is not in position says so.

use pneudrive_controller::{Config, Move, Sequence, State, output, sample};
use pneudrive_sim::rigfile::builtin;
use pneudrive_sim::{Accuracy, Plant, Rig};

const START: i32 = 12_500;

fn press(settings: &[&str]) -> Rig {
    let settings: Vec<String> = settings.iter().map(|&setting| setting.to_owned()).collect();
    let text = builtin("press").expect("a built-in rig");
    Rig::read_with("press", text, &settings).unwrap_or_else(|problems| panic!("{problems}"))
}

/// What the drive says at each sample of a step on a plant with a multiple of the friction: whether it rests outside, and its error.
fn step(counts: i32, tolerance: u16, friction: f64) -> Vec<(bool, u32)> {
    let at = format!("test.position_m={}", (f64::from(START) + 0.5) * 1e-5);
    let known = press(&[&format!("controller.tolerance_counts={tolerance}"), &at]);
    let number = |key: &str| known.number_at(key).expect("a number");
    let of_friction = ["static_extend_n", "coulomb_extend_n", "static_retract_n", "coulomb_retract_n"];
    let stiff = of_friction.map(|key| format!("load.{key}={}", friction * number(&format!("load.{key}"))));
    let real = known.with_plant(&stiff).unwrap_or_else(|problems| panic!("{problems}"));
    let config = Config::new(&known.parameters()).expect("a checked rig");
    let mut sequence = Sequence::new(1500);
    sequence.push(Move::step(0, START)).expect("room");
    sequence.push(Move::step(50, START + counts)).expect("room");
    let (mut state, mut plant) = (State::default(), Plant::new(&real, Accuracy::of(&real), 1));
    state.locate(0);
    state.supervisor.arm().expect("at rest");
    state.start(&config, &sequence).expect("a run");
    let mut seen = plant.sample().expect("a sample");
    let mut said = Vec::new();
    for _ in 0..=sequence.duration_samples {
        sample(&config, &sequence, &mut state, &seen);
        let command = output(&config, &mut state);
        said.push((state.rests_outside(&config), state.observation().error.unsigned_abs()));
        seen = plant.advance(command).expect("a sample");
    }
    said
}

#[test]
fn a_load_that_arrives_never_rests_outside() {
    let said = step(6000, 8, 1.0);
    assert!(said.iter().all(|(outside, _)| !outside));
    assert!(said.last().is_some_and(|(_, error)| *error <= 8), "{:?}", said.last());
}

#[test]
fn a_load_that_friction_holds_off_its_target_says_so_as_long_as_it_is_off() {
    let said = step(15, 2, 3.0);
    assert!(said.last().is_some_and(|last| last.0 && last.1 > 2), "{:?}", said.last());
    assert!(said.iter().all(|(outside, error)| !outside || *error > 2), "never within");
    assert!(said[..50].iter().all(|(outside, _)| !outside), "nor before it has a target");
}
