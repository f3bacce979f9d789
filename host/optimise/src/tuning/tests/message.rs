//! What a tuning says.

use super::*;

/// Of draws, this many settle and meet the goal, these settle but may limit-cycle, and the rest do neither.
fn found(met: usize, settle: usize, of: usize) -> Found {
    let good = performance(step(), step());
    let unclear = Move { limit_cycle: LimitCycle::Undecided(Doubt::JustStopped), ..step() };
    let late = Move { settling_s: None, ..step() };
    let fresh = (0..of).map(|n| match n {
        n if n < met => good.clone(),
        n if n < met + settle => performance(unclear.clone(), step()),
        _ => performance(late.clone(), step()),
    });
    Found {
        settings: vec!["controller.velocity_gain=65535".to_owned()],
        places: Vec::new(),
        tuned_on: vec![good.clone(); 3],
        members: [vec![good.clone(); 5], vec![performance(late.clone(), step()); 3]].concat(),
        fresh: fresh.collect(),
    }
}

fn tuned(after: Found, without: &[(&'static str, Found)]) -> Tuned {
    let limiting_imperfection = |(what, found): &(&'static str, Found)| LimitingImperfection {
        suspect: limiting_imperfection::Suspect { what, settings: Vec::new() },
        found: found.clone(),
    };
    Tuned {
        tuned_on: vec![Variant::NOMINAL; 3],
        fresh: vec![Variant::NOMINAL; after.fresh.len()],
        before: Found { settings: Vec::new(), ..after.clone() },
        after,
        progress: vec![1.0],
        obstacles: without.iter().map(limiting_imperfection).collect(),
        runs: 1,
    }
}

#[test]
fn the_verdict_says_the_fresh_draws_first_and_what_cannot_be_decided() {
    let task = Task { goal: GOAL, ..task("servo-b", &[]) };
    let notes = |tuned: &Tuned| report::notes(&task, tuned).join("\n");
    let message =
        notes(&tuned(found(6, 2, 20), &[("no rod", found(20, 0, 20)), ("no air", found(9, 11, 20))]));
    assert!(
        message.starts_with("The goal is met in 6 of 20, 30 % (15 to 52 %) of the fresh draws"),
        "{message}"
    );
    assert!(message.contains("in 3 of 3 trials that the gains were tuned on"), "{message}");
    assert!(
        message.contains("may or may not meet it: it and its perturbed runs")
            && message.contains("in 5 of 8 runs"),
        "{message}"
    );
    assert!(
        message.contains("With no rod, it is met in 20 of 20, 100 % (84 to 100 %) of them."),
        "{message}"
    );
    assert!(message.contains("controller.velocity_gain at 65535, the largest"), "{message}");

    let settles =
        notes(&tuned(found(0, 1, 60), &[("no rod", found(5, 41, 60)), ("no air", found(0, 3, 60))]));
    assert!(settles.contains("With no rod, the drive settles in 46 of 60"), "{settles}");
    let chance = notes(&tuned(found(6, 2, 20), &[("no rod", found(9, 3, 20))]));
    assert!(chance.contains("Removing any single imperfection"), "{chance}");
}
