use pneudrive_sim::Rig;
use pneudrive_sim::rig::{BUILTIN, builtin};

use super::gains::Space;
use super::trial::Trial;
use super::*;
use crate::evaluation::{Doubt, LimitCycle, Move, Oscillation};

const GOAL: Goal = Goal { step_mm: 60.0, settled_mm: 0.05, overshoot_percent: 1.0, time_s: 1.5 };

fn task(rig: &str, settings: &[&str]) -> Task {
    Task {
        source: (rig.to_owned(), builtin(rig).expect("a built-in rig").to_owned()),
        settings: settings.iter().map(|&setting| setting.to_owned()).collect(),
        held: Vec::new(),
        goal: Goal { settled_mm: 2.0, overshoot_percent: 20.0, ..GOAL },
        spread: Relative { load: 0.3, friction: 0.3, supply: 0.0 },
        between_mm: [None, None],
        draws: 4,
        budget: Budget { population: 4, generations: 2, seed: 5 },
        threads: NonZeroUsize::MIN,
    }
}

fn rig(name: &str, settings: &[String]) -> Rig {
    let text = builtin(name).expect("a built-in rig");
    Rig::read_with(name, text, settings).unwrap_or_else(|problems| panic!("{problems}"))
}

/// The rigs that have gains to be looked for.
fn rigs_with_gains() -> impl Iterator<Item = (&'static str, Rig, Space)> {
    BUILTIN.iter().filter_map(|(name, _)| {
        let rig = rig(name, &[]);
        let space = Space::of(&rig, GOAL.settled_mm, &[]).ok()?;
        Some((*name, rig, space))
    })
}

#[test]
fn all_genes_become_keys_that_their_rig_takes() {
    assert!(rigs_with_gains().count() >= 7);
    for (name, _, space) in rigs_with_gains() {
        for share in [0.0, 0.5, 1.0] {
            rig(name, &space.settings(&vec![share; space.len()]));
        }
    }
}

#[test]
fn a_profile_opens_the_valve_whole_at_the_errors_that_its_genes_say() {
    let rig_b = rig("servo-b", &[]);
    let space = Space::of(&rig_b, GOAL.settled_mm, &[]).expect("gains");
    let tuned = rig("servo-b", &space.settings(&vec![0.4; space.len()]));
    let Some(pneudrive_sim::rig::Value::Integers(profile)) = tuned.value("controller.gain_profile") else {
        panic!("a profile");
    };
    let (first, last) = (profile[0] as f64, *profile.last().expect("entries") as f64);
    // Ratios between the ends of each range: 0.15 (200)^0.4 mm and 3 (50)^0.4 mm.
    let whole_at = |gain: f64| 2048.0 * 256.0 / gain * 0.01205;
    assert!((whole_at(last) / (3.0 * 50.0_f64.powf(0.4)) - 1.0).abs() < 0.01, "{}", whole_at(last));
    assert!((whole_at(first) / (0.15 * 200.0_f64.powf(0.4)) - 1.0).abs() < 0.03, "{}", whole_at(first));
    assert!(profile.is_sorted_by(|a, b| a >= b), "the smaller the error, the higher the gain: {profile:?}");
}

#[test]
fn what_cannot_be_tuned_is_refused_by_what_to_change() {
    let said =
        |rig: &str, settings: &[&str]| tune(&task(rig, settings), |_| {}).expect_err("refused").to_string();
    assert!(said("servo-b", &["controller.law=on-off"]).contains("choose controller.law=gain-profile"));
    assert!(
        said("servo-b", &["controller.loop=open", "test.moves=[[0.0, 1]]"])
            .contains("controller.loop=closed")
    );
    let long = Task { goal: Goal { step_mm: 299.0, ..GOAL }, ..task("servo-b", &[]) };
    let error = tune(&long, |_| {}).expect_err("too long").to_string();
    assert!(error.contains("does not fit between 3.0 and 297.0 mm of the stroke of 300 mm"), "{error}");
}

/// A step that settles after 0.4 s.
fn step() -> Move {
    Move {
        start_s: 0.1,
        from_mm: 100.0,
        to_mm: Some(160.0),
        end_mm: 160.0,
        rise_s: Some(0.2),
        overshoot_mm: Some(0.3),
        settling_s: Some(0.4),
        steady_error_mm: Some(0.01),
        mean_error_mm: Some(0.01),
        range_mm: 0.0,
        limit_cycle: LimitCycle::None { below_mm: 0.03, for_s: 0.5 },
        top_speed_mm_s: 500.0,
        air: None,
    }
}

fn performance(there: Move, back: Move) -> Performance {
    Performance::of(&[&there, &back], GOAL.step_mm, 1.5)
}

#[test]
fn a_step_that_is_as_asked_costs_its_settling_time_and_all_others_more() {
    let good = performance(step(), Move { settling_s: Some(0.3), ..step() });
    assert_eq!((good.cost(&GOAL), good.faults(&GOAL)), (0.4, vec![]));
    let late = performance(step(), Move { settling_s: None, mean_error_mm: Some(-0.2), ..step() });
    assert_eq!(late.faults(&GOAL), ["it does not settle"]);
    assert!((late.cost(&GOAL) - (1.5 + 4.0)).abs() < 1e-12, "its time, and four times the allowed error");
    let passing = performance(step(), Move { settling_s: Some(1.4), mean_error_mm: Some(0.1), ..step() });
    assert_eq!((passing.settling_s, passing.faults(&GOAL)), (None, vec!["it does not settle"]));
    let far = performance(step(), Move { overshoot_mm: Some(1.2), ..step() });
    assert_eq!(far.faults(&GOAL), ["it overshoots"]);
    assert!((far.cost(&GOAL) - (0.4 + 0.2)).abs() < 1e-12, "2 % of the step, 1 % is allowed");
    let cycle = Oscillation {
        swing_mm: 0.2,
        range_mm: [0.2, 0.2],
        frequency_hz: 4.0,
        cycles: 3,
        during_s: [0.5, 1.2],
    };
    let swings = performance(Move { limit_cycle: LimitCycle::Sustained(cycle), ..step() }, step());
    assert_eq!(swings.faults(&GOAL), ["it limit-cycles"]);
    assert!((swings.cost(&GOAL) - (0.4 + 0.5 + 2.0)).abs() < 1e-12);
    let undecided = LimitCycle::Undecided(Doubt::FewCycles);
    let unclear = performance(Move { limit_cycle: undecided, range_mm: 0.1, ..step() }, step());
    assert_eq!(unclear.faults(&GOAL), ["it may limit-cycle"], "what is not decidable is not met");
    assert!((unclear.cost(&GOAL) - (0.4 + 0.5 + 1.0)).abs() < 1e-12);
    let going_on = performance(step(), Move { overshoot_mm: None, ..step() });
    assert_eq!(going_on.faults(&GOAL), ["it may overshoot"]);
    let failed = Performance::failed("encoder-step at sample 3".to_owned());
    assert!(failed.cost(&GOAL) > late.cost(&GOAL) && !failed.meets(&GOAL));
}

#[test]
fn gains_are_tuned_on_the_corners_at_both_ends_of_the_stroke_in_both_directions() {
    let spread = Relative { load: 0.3, friction: 0.2, supply: 0.0 };
    let corners = spread::corners(&spread);
    assert_eq!(corners.len(), 5);
    assert_eq!(corners[0].name(), "as in the file");
    assert_eq!(corners[1].name(), "load -30 %, friction -20 %");
    let all = spread::tuned_on(&spread, 3);
    assert_eq!((all.len(), &all[0], all == spread::tuned_on(&spread, 3)), (16, &Variant::NOMINAL, true));
    for corner in &corners {
        let of_it = || all[1..].iter().filter(|one| one.name() == corner.name());
        assert!([0.0, 1.0].iter().all(|place| of_it().any(|one| one.place == *place)), "{corner:?}");
        assert!([false, true].iter().all(|extends| of_it().any(|one| one.extends == *extends)), "{corner:?}");
    }
    let still = Relative { load: 0.0, friction: 0.0, supply: 0.0 };
    assert_eq!(spread::tuned_on(&still, 3).len(), 4, "a drive that is known well is moved all the same");
}

#[test]
fn fresh_draws_cover_the_whole_spread_and_are_none_that_gains_were_tuned_on() {
    let spread = Relative { load: 0.3, friction: 0.2, supply: 0.1 };
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
fn a_corner_changes_the_keys_of_load_and_friction() {
    let corners = spread::corners(&Relative { load: 0.3, friction: 0.2, supply: 0.0 });
    let rig_b = rig("servo-b", &[]);
    let heavier = rig("servo-b", &corners[4].settings(&rig_b));
    for (key, factor) in
        [("load.mass_kg", 1.3), ("load.static_extend_n", 1.2), ("load.viscous_n_s_per_m", 1.2)]
    {
        assert!((heavier.number(key) / rig_b.number(key) - factor).abs() < 1e-12, "{key}");
    }
}

#[test]
fn a_rig_without_one_of_its_imperfections_is_a_rig() {
    for (name, rig, _) in rigs_with_gains() {
        let suspects = obstacle::suspects(&rig);
        assert!(suspects.len() >= 4, "{name}");
        for suspect in suspects {
            let trial = Trial::of(&task(name, &[]), &suspect.settings);
            trial.unwrap_or_else(|error| panic!("{name}, {}: {error:#}", suspect.what));
        }
    }
}

/// Else a rig without one of its imperfections is judged with gains for another one.
#[test]
fn genes_of_a_rig_with_another_encoder_or_period_are_in_its_own_counts_and_samples() {
    let task = task("servo-b", &[]);
    let gain = |more: &[&str], key: &str| {
        let more: Vec<String> = more.iter().map(|&one| one.to_owned()).collect();
        let drive = Drive::of(&task, &more).expect("a drive");
        let settings = drive.space.settings(&vec![0.4; drive.space.len()]);
        let value = settings.iter().find_map(|one| one.strip_prefix(&format!("{key}="))).expect("a gain");
        value.parse::<f64>().expect("a number")
    };
    let velocity = "controller.velocity_gain";
    let ratio = |more: &[&str], key: &str| gain(more, key) / gain(&[], key);
    assert!((ratio(&["encoder.mm_per_count=0.0030125"], velocity) - 0.25).abs() < 0.01);
    let faster = ["controller.delay_s=0.000125", "controller.period_s=0.000325"];
    assert!((ratio(&faster, velocity) - 4.0).abs() < 0.02, "a window covers a quarter of the way");
}

#[test]
fn the_same_gains_are_found_on_any_number_of_threads_and_they_are_no_worse_than_those_of_the_file() {
    let task = task("servo-a", &[]);
    let [one, three] = [1, 3].map(|threads| {
        let threads = NonZeroUsize::new(threads).expect("some");
        tune(&Task { threads, ..task.clone() }, |_| {}).expect("a tuning")
    });
    assert_eq!(one.after.settings, three.after.settings);
    assert_eq!((&one.progress, &one.after), (&three.progress, &three.after));
    assert!(one.after.cost(&task.goal) <= one.before.cost(&task.goal));
    assert!(one.progress.is_sorted_by(|a, b| a >= b));
    assert!(one.runs > 4 * 3, "{}", one.runs);
    assert_eq!((one.after.fresh.len(), one.after.neighbours.len()), (4, 8));

    let text = report::rig_file(&task, &one).expect("TOML");
    let tuned = Rig::read("tuned.toml", &text).unwrap_or_else(|problems| panic!("{problems}"));
    let expected = rig("servo-a", &one.after.settings);
    assert!(text.starts_with(report::MARK));
    for key in ["controller.gain_profile", "controller.velocity_gain", "controller.null_offset_counts"] {
        assert_eq!(tuned.value(key), expected.value(key), "{key}");
    }
}

/// Where a trial starts and between which setpoints it moves, mm.
fn way_of(trial: &Trial, variant: &Variant) -> (f64, Vec<f64>) {
    let (transient, _) = trial.transient(&[], variant).expect("a run");
    let mut setpoints = transient.channels[crate::transient::SETPOINT].clone();
    setpoints.dedup();
    (transient.channels[crate::transient::POSITION][0], setpoints)
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
        let (start, setpoints) = way_of(&trial, &variant);
        assert!((start - from).abs() < 0.02, "{place} {extends}: {start}");
        let expected = [from, to, from];
        assert_eq!(setpoints.len(), 3);
        for (setpoint, expected) in setpoints.iter().zip(expected) {
            assert!((setpoint - expected).abs() < 0.02, "{place} {extends}: {setpoints:?}");
        }
        assert!(setpoints.iter().all(|mm| *mm >= 20.0), "the software end: {setpoints:?}");
    }
    let typed = Task { between_mm: [Some(100.0), Some(170.0)], ..task };
    let trial = Trial::of(&typed, &[]).expect("a trial");
    let [low, high] = trial.way_mm();
    assert!((100.0..100.02).contains(&low) && (169.98..=170.0).contains(&high), "{low} to {high}");
}

/// A file has a test of its own, which need not be one of timed moves.
#[test]
fn moves_of_the_file_do_not_disturb_the_step() {
    let plain = way_of(&Trial::of(&task("servo-a", &[]), &[]).expect("a trial"), &Variant::NOMINAL);
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
        let (start, setpoints) = way_of(&trial, &Variant::NOMINAL);
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

fn keys_of(settings: &[String]) -> Vec<&str> {
    settings.iter().filter_map(|setting| Some(setting.split_once('=')?.0)).collect()
}

#[test]
fn a_held_key_is_not_looked_for_and_the_others_go_by_it() {
    let space = |held: &[&str]| {
        let held: Vec<String> = held.iter().map(|&key| key.to_owned()).collect();
        let settings: Vec<String> = held.clone();
        let keys: Vec<String> =
            held.iter().map(|one| one.split_once('=').expect("a value").0.to_owned()).collect();
        Space::of(&rig("servo-b", &settings), GOAL.settled_mm, &keys).expect("a space")
    };
    let settings = |held: &[&str]| {
        let space = space(held);
        space.settings(&vec![0.4; space.len()])
    };
    let value = |settings: &[String], key: &str| {
        settings.iter().find_map(|one| one.strip_prefix(&format!("{key}="))).map(str::to_owned)
    };
    let all = space(&[]).len();
    assert!(!keys_of(&settings(&["operator.dither_mm=0.1"])).contains(&"operator.dither_mm"));
    assert_eq!(space(&["operator.dither_mm=0.1"]).len(), all - 1);
    assert_eq!(space(&["operator.dither_mm=0.0"]).len(), all - 2, "no dither has no frequency");

    let (velocity, window) = ("controller.velocity_gain", "controller.velocity_window_samples");
    let number =
        |settings: &[String]| value(settings, velocity).expect("a gain").parse::<f64>().expect("a number");
    let ratio = number(&settings(&["controller.velocity_window_samples=3"]))
        / number(&settings(&["controller.velocity_window_samples=12"]));
    assert!((ratio - 4.0).abs() < 0.01, "{ratio}");
    assert_eq!(value(&settings(&["controller.velocity_window_samples=3"]), window), None);

    let profile = settings(&["controller.gain_profile=[900, 300]", "controller.profile_span_counts=7"]);
    assert!(!keys_of(&profile).iter().any(|key| key.contains("profile")), "{profile:?}");
    let steeper = settings(&["controller.gain_profile=[900, 600]", "controller.profile_span_counts=7"]);
    assert!((number(&steeper) / number(&profile) - 2.0).abs() < 0.02, "the damping goes with the last entry");
    let span = settings(&["controller.profile_span_counts=7"]);
    assert!(
        keys_of(&span).contains(&"controller.gain_profile")
            && value(&span, "controller.profile_span_counts").is_none()
    );
}

#[test]
fn a_key_that_cannot_be_held_is_refused_by_what_can() {
    let refused = |held: &str| {
        let task = Task { held: vec![held.to_owned()], ..task("servo-b", &[]) };
        held::check(&task).expect_err("refused").to_string()
    };
    for (held, why) in [
        ("operator.ditter_mm=0", "did you mean dither_mm?"),
        ("controller.velocity_gian=3", "did you mean velocity_gain?"),
        ("operator.dither_mm=loud", "must be a number"),
        ("load.mass_kg=2", "the spread draws load.mass_kg"),
        ("load.viscous_n_s_per_m=2", "the spread draws"),
        ("test.moves=[[0.0, 1]]", "the step itself sets test.moves"),
    ] {
        let said = refused(held);
        assert!(said.contains(why) && said.contains("operator.dither_mm, operator.dither_hz"), "{said}");
    }
    let known = Relative { load: 0.0, friction: 0.3, supply: 0.0 };
    let held = ["load.mass_kg=2.0", "controller.period_s=0.002", "controller.velocity_gain=100"];
    let held = held.map(str::to_owned).to_vec();
    held::check(&Task { held, spread: known, ..task("servo-b", &[]) }).expect("any other key can be held");
    let all = ["proportional_gain", "velocity_gain", "acceleration_gain", "velocity_window_samples"]
        .into_iter()
        .chain(["acceleration_window_samples", "dead_band_counts", "null_offset_counts"]);
    let all: Vec<String> = all.map(|key| format!("controller.{key}")).collect();
    let rig_a = rig("servo-a", &["controller.law=proportional".to_owned()]);
    let error = Space::of(&rig_a, GOAL.settled_mm, &all).expect_err("nothing is left").to_string();
    assert!(error.contains("every key that tune looks for is held"), "{error}");
}

#[test]
fn what_was_found_at_an_end_of_its_range_is_told_with_the_range() {
    let space = Space::of(&rig("servo-b", &[]), GOAL.settled_mm, &[]).expect("a space");
    let limits = |share: f64| {
        let places = space.places(&vec![share; space.len()]);
        places.into_iter().filter(|place| place.at_limit).map(|place| place.what).collect::<Vec<_>>()
    };
    assert_eq!(limits(0.5), [""; 0]);
    assert_eq!(limits(1.0).len(), space.len() - 1, "a dead band cannot be wider than what counts as settled");
    let low = limits(0.0);
    assert!(low.contains(&"time of the velocity feedback, T_d"));
    assert!(!low.iter().any(|what| what.starts_with("dither of")), "none is a natural end: {low:?}");
    let dither =
        space.places(&vec![1.0; space.len()]).into_iter().find(|place| place.what == "dither of the spool");
    assert_eq!(dither.map(|place| (place.range, place.value, place.unit)), Some(([0.0, 0.6], 0.6, "mm")));
    let settings = ["controller.velocity_gain=65535", "controller.gain_profile=[65535, 30]", "x=6"];
    assert_eq!(
        Space::saturated(&settings.map(str::to_owned)),
        ["controller.velocity_gain", "controller.gain_profile"]
    );
}

#[test]
fn progress_counts_the_runs_of_each_stage_to_their_end() {
    let task = task("servo-a", &[]);
    let mut told = Vec::new();
    let tuned = tune(&task, |at| told.push(at)).expect("a tuning");
    let of = |stage: Stage| told.iter().filter(move |at| at.stage == stage).collect::<Vec<_>>();
    let trials = tuned.tuned_on.len();
    for (stage, all) in [
        (Stage::Search, 4 * 2 * trials),
        (Stage::Finalists, 4 * (trials + 8)),
        (Stage::Draws, if tuned.is_changed() { 2 * 4 } else { 4 }),
    ] {
        let at = of(stage);
        assert!(at.is_sorted_by_key(|at| at.done) && at.iter().all(|at| at.all == all), "{stage:?}");
        assert_eq!(at.last().map(|at| at.done), Some(all), "{stage:?}");
    }
    let obstacles = of(Stage::Obstacles);
    assert_eq!(obstacles.is_empty(), tuned.obstacles.is_empty());
    assert!(obstacles.last().is_none_or(|at| at.done == at.all), "{:?}", obstacles.last());
    assert!(tuned.runs <= Stage::ALL.iter().filter_map(|stage| of(*stage).last().map(|at| at.all)).sum());
}

#[test]
fn without_a_generation_the_gains_of_the_file_are_judged() {
    let task =
        Task { budget: Budget { generations: 0, ..task("servo-a", &[]).budget }, ..task("servo-a", &[]) };
    let judged = tune(&task, |_| {}).expect("figures");
    assert!(!judged.is_changed() && judged.obstacles.is_empty() && judged.progress.is_empty());
    assert_eq!(judged.after, judged.before);
    assert_eq!(judged.after.fresh.len(), 4);
    let said = report::verdict(&task, &judged);
    let met = judged.after.met(&task.goal);
    assert!(said.starts_with(&format!("The goal is met in {} of 4, ", met.met)), "{said}");
    assert!(said.contains(" of the fresh draws, with the gains of the file"), "{said}");
}

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
        neighbours: [vec![good.clone(); 5], vec![performance(late.clone(), step()); 3]].concat(),
        fresh: fresh.collect(),
    }
}

fn tuned(after: Found, without: &[(&'static str, Found)]) -> Tuned {
    let obstacle = |(what, found): &(&'static str, Found)| Obstacle {
        suspect: obstacle::Suspect { what, settings: Vec::new() },
        found: found.clone(),
    };
    Tuned {
        tuned_on: vec![Variant::NOMINAL; 3],
        fresh: vec![Variant::NOMINAL; after.fresh.len()],
        before: Found { settings: Vec::new(), ..after.clone() },
        after,
        progress: vec![1.0],
        obstacles: without.iter().map(obstacle).collect(),
        runs: 1,
    }
}

#[test]
fn the_verdict_says_the_fresh_draws_first_and_what_is_not_decided() {
    let task = Task { goal: GOAL, ..task("servo-b", &[]) };
    let notes = |tuned: &Tuned| report::notes(&task, tuned).join("\n");
    let said = notes(&tuned(found(6, 2, 20), &[("no rod", found(20, 0, 20)), ("no air", found(9, 11, 20))]));
    assert!(said.starts_with("The goal is met in 6 of 20, 30 % (15 to 52 %) of the fresh draws"), "{said}");
    assert!(said.contains("in 3 of 3 trials that the gains were tuned on"), "{said}");
    assert!(
        said.contains("is not decided: it and its neighbours") && said.contains("in 5 of 8 runs"),
        "{said}"
    );
    assert!(said.contains("With no rod, it is met in 20 of 20, 100 % (84 to 100 %) of them."), "{said}");
    assert!(said.contains("controller.velocity_gain at 65535, the largest"), "{said}");

    let settles =
        notes(&tuned(found(0, 1, 60), &[("no rod", found(5, 41, 60)), ("no air", found(0, 3, 60))]));
    assert!(settles.contains("With no rod, the drive settles in 46 of 60"), "{settles}");
    let chance = notes(&tuned(found(6, 2, 20), &[("no rod", found(9, 3, 20))]));
    assert!(chance.contains("No single imperfection"), "{chance}");
}
