//! What an ensemble costs and shows.

#[path = "ensemble_members/leaving.rs"]
mod leaving;

use pneudrive_optimise::ensemble::members;
use pneudrive_records::judged::Spacing;
use pneudrive_sim::{Accuracy, Rig, run};

const CASES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../sim/tests/cases");

fn evaluations(rig: &Rig, accuracy: Accuracy) -> u64 {
    run(rig, accuracy).expect("a transient").work.integrator.n_rhs_evaluations
}

/// What they take in instructions is in docs/explanation/speed.md.
#[test]
fn eight_perturbed_runs_cost_the_evaluations_of_four_runs_at_most_and_of_a_stepper_drive_of_two() {
    for (case, most) in [("B_closed_damped", 4.0), ("A_closed", 2.0)] {
        let text = std::fs::read_to_string(format!("{CASES}/{case}.toml")).expect("a case in the repository");
        let rig = Rig::read(case, &text).expect("valid");
        let spacing = Spacing { runs: 9, ..Spacing::default() };
        let accuracy = Accuracy::of_member(&rig, spacing.relative);
        let all = members(&rig, spacing).into_iter().map(|one| evaluations(&one.expect("valid"), accuracy));
        let runs = all.sum::<u64>() as f64 / evaluations(&rig, Accuracy::of(&rig)) as f64;
        assert!(runs < most, "{case}: {runs}");
    }
}

#[test]
fn a_perturbed_run_that_is_hardly_apart_is_as_exact_as_the_motion_needs() {
    let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig");
    assert_eq!(Accuracy::of_member(&rig, 1e-9), Accuracy::of_motion(&rig));
    let at = |apart: f64| Accuracy::of_member(&rig, apart).tolerance;
    assert!((at(1e-4) / at(1e-5) - 10.0).abs() < 1e-9);
}

/// The closed loops are the same at all three tolerances, and so are most of the figures that leave.
#[test]
fn perturbed_runs_leave_the_band_of_a_drawn_loop_as_often_as_at_the_tolerance_of_the_run() {
    let apart = Spacing::default().relative;
    let [exact, usual, coarse] = leaving::of_drawn(30_000..30_024, |rig| {
        [Accuracy::of(rig), Accuracy::of_member(rig, apart), Accuracy::of_member(rig, 300.0 * apart)]
            .map(|accuracy| accuracy.tolerance)
    });
    println!("{exact:?} {usual:?} {coarse:?}");
    // Three standard errors, if the figures were draws of their own.
    let open = 3.0 * (2.0 * exact.share() * (1.0 - exact.share()) / f64::from(exact.figures)).sqrt();
    assert!((usual.share() - exact.share()).abs() < open, "{exact:?} {usual:?}");
    assert!(coarse.share() - exact.share() > open, "{exact:?} {coarse:?}");
}
