//! What a run costs, in counts: a slower program fails here without a clock. An unexplained saving
//! fails too; change the numbers with the reason in the commit.

use pneudrive_sim::{Accuracy, Rig, run};

#[test]
fn the_run_of_servo_b_costs_what_it_cost() {
    let rig = Rig::builtin("servo-b").expect("a built-in rig");
    let work = run(&rig, Accuracy::default()).expect("a transient").work;
    let counts = [
        ("steps", work.integrator.steps, 15_154),
        ("rejected steps", work.integrator.rejected, 1_196),
        ("evaluations", work.integrator.evaluations, 101_516),
        ("restarts", work.integrator.restarts, 3_423),
        ("events", work.integrator.events, 1_462),
        ("flow solutions", work.network.solutions, 101_803),
        ("flow iterations", work.network.iterations, 136_099),
        ("flow solutions by brackets", work.network.bracketed, 1),
    ];
    let wrong: Vec<String> = counts
        .iter()
        .filter(|(_, found, expected)| found != expected)
        .map(|(what, found, expected)| format!("{what}: {found}, not {expected}"))
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}
