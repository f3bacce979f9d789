//! Rigs, places and directions.

use super::*;

#[test]
fn gains_are_tuned_on_the_whole_spread_and_stroke_in_both_directions() {
    let spread = Relative { load: 0.3, friction: 0.2, supply: 0.0, valve: 0.0 };
    let all = spread::tuned_on(&spread, 3);
    assert_eq!((all.len(), &all[0], all == spread::tuned_on(&spread, 3)), (21, &Variant::NOMINAL, true));
    let draws = &all[1..];
    let in_every_twentieth = |of: &dyn Fn(&Variant) -> f64| {
        let mut places: Vec<usize> = draws.iter().map(|one| (20.0 * of(one)) as usize).collect();
        places.sort_unstable();
        places.into_iter().eq(0..20)
    };
    assert!(in_every_twentieth(&|one| one.place));
    assert!(in_every_twentieth(&|one| (one.load - 0.7) / 0.6));
    assert!(in_every_twentieth(&|one| (one.friction - 0.8) / 0.4));
    assert!(draws.iter().all(|one| one.supply == 1.0));
    assert_eq!(draws.iter().filter(|one| one.extends).count(), 10);
    let still = Relative { load: 0.0, friction: 0.0, supply: 0.0, valve: 0.0 };
    let still = spread::tuned_on(&still, 3);
    assert!(still[1..].iter().all(|one| one.name() == "as in the file"));
    assert!(still[1] != still[2], "a drive that is known well is moved all the same");
}

#[test]
fn fresh_draws_cover_the_whole_spread_and_are_none_that_gains_were_tuned_on() {
    let spread = Relative { load: 0.3, friction: 0.2, supply: 0.1, valve: 0.0 };
    let draws = spread::fresh(&spread, 3, 200);
    assert_eq!(draws, spread::fresh(&spread, 3, 200));
    assert_ne!(draws, spread::fresh(&spread, 4, 200));
    let seen = spread::tuned_on(&spread, 3);
    assert!(draws.iter().all(|draw| seen.iter().all(|one| one.place != draw.place)));
    let covers = |of: &dyn Fn(&Variant) -> f64, low: f64, high: f64| {
        let values: Vec<f64> = draws.iter().map(of).collect();
        let (least, most) =
            (values.iter().copied().fold(f64::MAX, f64::min), values.iter().copied().fold(0.0, f64::max));
        let margin = 0.05 * (high - low);
        (low..low + margin).contains(&least) && (high - margin..=high).contains(&most)
    };
    assert!(covers(&|one| one.load, 0.7, 1.3) && covers(&|one| one.friction, 0.8, 1.2));
    assert!(covers(&|one| one.supply, 0.9, 1.1) && covers(&|one| one.place, 0.0, 1.0));
    let extending = draws.iter().filter(|one| one.extends).count();
    assert!((70..130).contains(&extending), "{extending} of 200");
}

#[test]
fn a_variant_changes_the_keys_of_load_and_friction() {
    let heavy = Variant { load: 1.3, friction: 1.2, ..Variant::NOMINAL };
    assert_eq!(heavy.name(), "load +30 %, friction +20 %");
    let rig_b = rig("servo-b", &[]);
    let heavier = rig("servo-b", &heavy.settings(&rig_b));
    for (key, factor) in
        [("load.mass_kg", 1.3), ("load.static_extend_n", 1.2), ("load.viscous_n_s_per_m", 1.2)]
    {
        assert!(
            (heavier.number_at(key).expect("a number") / rig_b.number_at(key).expect("a number") - factor)
                .abs()
                < 1e-12,
            "{key}"
        );
    }
}

/// Where a trial starts and between which setpoints it moves, mm.
fn setpoints_of(trial: &Trial, variant: &Variant) -> (f64, Vec<f64>) {
    let (transient, _) = trial.transient(&[], variant).expect("a run");
    let mut setpoints = transient.channels[pneudrive_evaluate::transient::SETPOINT].clone();
    setpoints.dedup();
    (transient.channels[pneudrive_evaluate::transient::POSITION][0], setpoints)
}

#[test]
fn a_step_begins_anywhere_between_the_ends_goes_either_way_and_stays_inside() {
    let task = task("servo-a", &["safety.end_min_mm=20", "test.moves=[[0.0, 8192]]"]);
    let trial = Trial::of(&task, &[]).expect("a trial");
    for (place, extends, [from, to]) in [
        (0.0, true, [20.0, 80.0]),
        (0.0, false, [80.0, 20.0]),
        (1.0, true, [228.0, 288.0]),
        (1.0, false, [288.0, 228.0]),
        (0.25, true, [72.0, 132.0]),
    ] {
        let variant = Variant { place, extends, ..Variant::NOMINAL };
        let (start, setpoints) = setpoints_of(&trial, &variant);
        assert!((start - from).abs() < 0.02, "{place} {extends}: {start}");
        let expected = [from, to, from];
        assert_eq!(setpoints.len(), 3);
        for (setpoint, expected) in setpoints.iter().zip(expected) {
            assert!((setpoint - expected).abs() < 0.02, "{place} {extends}: {setpoints:?}");
        }
        assert!(setpoints.iter().all(|mm| *mm >= 20.0), "the soft limit: {setpoints:?}");
    }
    let typed = Task { between_mm: [Some(100.0), Some(170.0)], ..task };
    let trial = Trial::of(&typed, &[]).expect("a trial");
    let [low, high] = trial.range_mm();
    assert!((100.0..100.02).contains(&low) && (169.98..=170.0).contains(&high), "{low} to {high}");
}

/// A file has a test of its own, which need not be one of timed moves.
#[test]
fn moves_of_the_file_do_not_disturb_the_step() {
    let plain = setpoints_of(&Trial::of(&task("servo-a", &[]), &[]).expect("a trial"), &Variant::NOMINAL);
    for own in [
        &["test.impulse=[0.5, 0.1, 2000]"][..],
        &["test.repeat_every_s=0.9", "test.moves=[[0.0, 8192]]"],
        &["test.targets=[8192, 16384]"],
        &["test.targets=[8192, 16384]", "controller.exit_on_dead_band=true"],
        &["test.trace_period_s=0.2"],
        &["safety.end_max_mm=190"],
    ] {
        let trial =
            Trial::of(&task("servo-a", own), &[]).unwrap_or_else(|error| panic!("{own:?}: {error:#}"));
        let (start, setpoints) = setpoints_of(&trial, &Variant::NOMINAL);
        if own[0].starts_with("safety") {
            assert!(setpoints.iter().all(|mm| *mm < 190.0), "{setpoints:?}");
        } else {
            assert_eq!((start, &setpoints), (plain.0, &plain.1), "{own:?}");
        }
    }
    let text = "[test]\nimpulse = [0.5, 0.1, 2000]\n\n[load]\nmass_kg = -1.0\n".to_owned();
    let error = Trial::of(&Task { source: ("mine.toml".to_owned(), text), ..task("servo-a", &[]) }, &[]);
    let error = error.expect_err("a negative mass").to_string();
    assert!(error.starts_with("mine.toml:5: load.mass_kg"), "the line of the file as it is: {error}");
}
