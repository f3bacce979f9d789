//! Steps beside the bang-bang bound.

use pneudrive_evaluate::evaluation::moves_of_run;
use pneudrive_sim::{Accuracy, Rig, run};

use crate::positioning::{beside_bound, bound};

fn sentences(rig: &Rig) -> Vec<String> {
    let run = run(rig, Accuracy::of(rig)).expect("runs");
    beside_bound(rig, &moves_of_run(rig, &run))
}

/// The step of the press is 125 mm, about its middle.
#[test]
fn a_step_of_a_law_that_knows_its_drive_is_told_with_its_bound() {
    let rig = Rig::builtin("press").expect("a built-in rig");
    let found = sentences(&rig);
    let bound = bound(&rig, 125.0, true).expect("it runs").expect("a bound").time_s;
    let step = found.last().expect("a step");
    assert!(step.starts_with("Move 2, 62.5 to 187.5 mm: 0."), "{found:?}");
    let words: Vec<&str> = step.split(' ').collect();
    let place = words.iter().position(|word| *word == "times").expect("a ratio");
    let ratio: f64 = words[place - 1].parse().expect("a number");
    assert!((1.0..3.0).contains(&ratio), "{step}");
    let told: f64 = words[words.len() - 2].parse().expect("a number");
    assert!((told - bound).abs() < 2e-3, "{told} for {bound} s");
}

#[test]
fn gains_and_profiles_have_no_bound_beside_them() {
    let gains = Rig::builtin("servo-b-tuned").expect("a built-in rig");
    assert_eq!(sentences(&gains.with_numbers(&[("test.duration_s", 0.6)]).expect("valid")), [""; 0]);
    let profile = "test.move=[{profile=\"trapezoid\", at_s=0.2, to_counts=18750, velocity_mm_s=200.0, acceleration_mm_s2=4000.0}]";
    let test = [profile, "test.position_m=0.062505", "test.duration_s=1.5"].map(str::to_owned);
    let led = Rig::builtin("press").expect("a built-in rig").with_test(&test).expect("valid");
    assert_eq!(sentences(&led), [""; 0]);
}
