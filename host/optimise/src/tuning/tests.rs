mod holding;
mod message;
mod model;
mod places;
mod tracking;

use pneudrive_sim::Rig;
use pneudrive_sim::component::encoder;
use pneudrive_sim::rigfile::{BUILTIN, builtin};

use super::gains::Space;
use super::trial::Trial;
use super::*;
use pneudrive_evaluate::cancel::CancelToken;
use pneudrive_evaluate::evaluation::{Doubt, LimitCycle, Move, Oscillation};

const GOAL: Goal = Goal { step_mm: 60.0, settled_mm: 0.05, overshoot_percent: 1.0, time_s: 1.5 };

fn task(rig: &str, settings: &[&str]) -> Task {
    Task {
        source: (rig.to_owned(), builtin(rig).expect("a built-in rig").to_owned()),
        settings: settings.iter().map(|&setting| setting.to_owned()).collect(),
        fixed: Vec::new(),
        goal: Goal { settled_mm: 2.0, overshoot_percent: 20.0, ..GOAL },
        spread: Relative { load: 0.3, friction: 0.3, supply: 0.0, valve: 0.0 },
        between_mm: [None, None],
        draws: 4,
        budget: Budget { population: 4, generations: 2, seed: 5 },
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

/// Once a valve with an amplifier of its own, whose file has no dither, was tuned with one that nobody could have set.
#[test]
fn a_dither_is_searched_only_where_the_rig_says_that_its_user_can_set_it() {
    let sets_dither = |name: &str, settings: &[&str]| {
        let settings: Vec<String> = settings.iter().map(|&one| one.to_owned()).collect();
        let rig = rig(name, &settings);
        let space = Space::of(&rig, GOAL.settled_mm, &[]).expect("gains");
        let set = space.settings(&vec![0.5; space.len()]);
        let is_set = set.iter().any(|one| one.starts_with("operator."));
        assert_eq!(is_set, Space::left_alone(&rig).is_empty(), "{name} {settings:?}: {set:?}");
        is_set
    };
    for model in ["solenoid", "solenoid-empirical"] {
        let model = format!("operator.model={model}");
        assert!(sets_dither("servo-b", &[&model, "operator.dither_adjustable=true"]), "{model}");
        assert!(!sets_dither("servo-b", &[&model, "operator.dither_adjustable=false"]), "{model}");
    }
    assert!(sets_dither("servo-b-tuned", &[]), "the amplifier of the thesis mixes its dither in");
    let own = Rig::read("own.toml", "name = \"own\"\n").expect("a rig");
    let space = Space::of(&own, GOAL.settled_mm, &[]).expect("gains");
    let set = space.settings(&vec![0.5; space.len()]);
    assert!(!set.iter().any(|one| one.starts_with("operator.")), "a file that says nothing: {set:?}");
}

#[test]
fn what_cannot_be_tuned_is_refused_by_what_to_change() {
    let message = |rig: &str, settings: &[&str]| {
        tune(&task(rig, settings), |_| {}, CancelToken::NEVER).expect_err("refused").to_string()
    };
    assert!(message("servo-b", &["controller.law=on-off"]).contains("choose controller.law=gain-profile"));
    let positions = ["controller.law=cascade", "operator.model=solenoid-empirical", "operator.dither_mm=0"];
    assert!(message("servo-b", &positions).contains("cascade"), "it says why");
    assert!(
        message("servo-b", &["controller.loop=open", "test.moves=[[0.0, 1]]"])
            .contains("controller.loop=closed")
    );
    let long = Task { goal: Goal { step_mm: 299.0, ..GOAL }, ..task("servo-b", &[]) };
    let error = tune(&long, |_| {}, CancelToken::NEVER).expect_err("too long").to_string();
    assert!(error.contains("does not fit between 3.0 and 297.0 mm of the stroke of 300 mm"), "{error}");
}

/// A step that settles after 0.4 s.
fn step() -> Move {
    Move {
        number: 1,
        is_cut: false,
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
        tracking: None,
        limit_cycle: LimitCycle::None { below_mm: 0.03, for_s: 0.5 },
        top_speed_mm_s: 500.0,
        air: None,
    }
}

fn performance(there: Move, back: Move) -> Performance {
    Performance::of(&[&there, &back], GOAL.step_mm, 1.5)
}

#[test]
fn a_step_that_is_as_asked_is_its_settling_time_from_the_goal_and_all_others_are_further() {
    let good = performance(step(), Move { settling_s: Some(0.3), ..step() });
    assert_eq!((good.distance_s(&GOAL), good.faults(&GOAL)), (0.4, vec![]));
    let late = performance(step(), Move { settling_s: None, mean_error_mm: Some(-0.2), ..step() });
    assert_eq!(late.faults(&GOAL), ["it does not settle"]);
    assert!(
        (late.distance_s(&GOAL) - (1.5 + 4.0)).abs() < 1e-12,
        "its time, and four times the allowed error"
    );
    let passing = performance(step(), Move { settling_s: Some(1.4), mean_error_mm: Some(0.1), ..step() });
    assert_eq!((passing.settling_s, passing.faults(&GOAL)), (None, vec!["it does not settle"]));
    let far = performance(step(), Move { overshoot_mm: Some(1.2), ..step() });
    assert_eq!(far.faults(&GOAL), ["it overshoots"]);
    assert!((far.distance_s(&GOAL) - (0.4 + 0.2)).abs() < 1e-12, "2 % of the step, 1 % is allowed");
    let cycle = Oscillation {
        swing_mm: 0.2,
        range_mm: [0.2, 0.2],
        frequency_hz: 4.0,
        cycles: 3,
        during_s: [0.5, 1.2],
    };
    let swings = performance(Move { limit_cycle: LimitCycle::Sustained(cycle), ..step() }, step());
    assert_eq!(swings.faults(&GOAL), ["it limit-cycles"]);
    assert!((swings.distance_s(&GOAL) - (0.4 + 0.5 + 2.0)).abs() < 1e-12);
    let undecided = LimitCycle::Undecided(Doubt::FewCycles);
    let unclear = performance(Move { limit_cycle: undecided, range_mm: 0.1, ..step() }, step());
    assert_eq!(unclear.faults(&GOAL), ["it may limit-cycle"], "what is not decidable is not met");
    assert!((unclear.distance_s(&GOAL) - (0.4 + 0.5 + 1.0)).abs() < 1e-12);
    let going_on = performance(step(), Move { overshoot_mm: None, ..step() });
    assert_eq!(going_on.faults(&GOAL), ["it may overshoot"]);
    let failed = Performance::failed("encoder-step at sample 3".to_owned());
    assert!(failed.distance_s(&GOAL) > late.distance_s(&GOAL) && !failed.meets(&GOAL));
}

/// Else a trial that no gains can help would be bought with all others.
#[test]
fn gains_cost_less_the_more_trials_meet_the_goal() {
    let good = performance(step(), step());
    let late = |error_mm: f64| {
        performance(step(), Move { settling_s: None, mean_error_mm: Some(error_mm), ..step() })
    };
    let slow = performance(step(), Move { settling_s: Some(1.0), ..step() });
    let cost = |all: &[&Performance]| {
        let tuned_on = all.iter().map(|&one| one.clone()).collect();
        Found { settings: vec![], places: vec![], tuned_on, members: vec![], fresh: vec![] }.cost(&GOAL)
    };
    assert!((good.cost(&GOAL) - 0.4 / 1.5).abs() < 1e-12);
    assert!(good.cost(&GOAL) < slow.cost(&GOAL) && slow.cost(&GOAL) < 1.0);
    assert!(1.0 < late(0.06).cost(&GOAL) && late(0.06).cost(&GOAL) < late(0.6).cost(&GOAL));
    assert!(Performance::failed("a trip".to_owned()).cost(&GOAL) < 2.0);
    let (hopeless, near) = (late(5.0), late(0.2));
    assert!(cost(&[&good, &good, &hopeless]) < cost(&[&near, &near, &near]), "two of three are met");
    assert!(cost(&[&slow, &slow, &near]) < cost(&[&good, &near, &near]));
}

#[test]
fn a_rig_without_one_of_its_imperfections_is_a_rig() {
    for (name, rig, _) in rigs_with_gains() {
        let suspects = limiting_imperfection::suspects(&rig);
        assert!(suspects.len() >= 4, "{name}");
        for suspect in suspects {
            let trial = Trial::of(&task(name, &[]), &suspect.settings);
            trial.unwrap_or_else(|error| panic!("{name}, {}: {error:#}", suspect.what));
        }
    }
}

/// Whatever encoder it has.
#[test]
fn an_encoder_four_times_as_fine_has_counts_a_quarter_as_long() {
    let quadrature: &[&str] = &[];
    let models = [
        quadrature,
        &["encoder.model=ssi", "encoder.bits=16"],
        &[
            "encoder.model=potentiometer",
            "encoder.bits=12",
            "encoder.zero_mm=-5",
            "encoder.range_mm=400",
            "test.moves=[[0.0, 1000]]",
        ],
    ];
    for settings in models {
        let settings: Vec<String> = settings.iter().map(|&one| one.to_owned()).collect();
        let rig_b = rig("servo-b", &settings);
        let suspects = limiting_imperfection::suspects(&rig_b);
        let finer = suspects.iter().find(|one| one.what.contains("encoder")).expect("a finer encoder");
        let finer = rig("servo-b", &[settings.clone(), finer.settings.clone()].concat());
        let ratio = encoder::mm_per_count(&finer) / encoder::mm_per_count(&rig_b);
        assert!((ratio - 0.25).abs() < 1e-4, "{settings:?}: {ratio}");
    }
    let widest = ["encoder.model=ssi", "encoder.bits=30"].map(str::to_owned);
    let suspects = limiting_imperfection::suspects(&rig("servo-b", &widest));
    assert!(suspects.iter().all(|one| !one.what.contains("encoder")), "there is no finer one");
}

/// Else a rig without one of its imperfections is judged with gains for another one.
#[test]
fn genes_of_a_rig_with_another_encoder_or_period_are_in_its_own_counts_and_samples() {
    let task = task("servo-b", &[]);
    let gain = |more: &[&str], key: &str| {
        let more: Vec<String> = more.iter().map(|&one| one.to_owned()).collect();
        let with = Companions { cancel: CancelToken::NEVER, memory: &Memory::default() };
        let drive = TunedDrive::of(&task, &more, with).expect("a drive");
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
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| tune(&task, |_| {}, CancelToken::NEVER)).expect("a tuning")
    });
    assert_eq!(one.after.settings, three.after.settings);
    assert_eq!((&one.progress, &one.after), (&three.progress, &three.after));
    assert!(one.after.cost(&task.goal) <= one.before.cost(&task.goal));
    assert!(one.progress.is_sorted_by(|a, b| a >= b));
    assert!(one.runs > 4 * 3, "{}", one.runs);
    assert_eq!((one.after.fresh.len(), one.after.members.len()), (4, 8));

    let text = report::rig_file(&task, &one).expect("TOML");
    let tuned = Rig::read("tuned.toml", &text).unwrap_or_else(|problems| panic!("{problems}"));
    let expected = rig("servo-a", &one.after.settings);
    assert!(text.starts_with(report::MARK));
    for key in ["controller.gain_profile", "controller.velocity_gain", "controller.null_offset_counts"] {
        assert_eq!(tuned.value(key), expected.value(key), "{key}");
    }
}

#[test]
fn progress_counts_the_runs_of_each_stage_to_their_end() {
    let task = task("servo-a", &[]);
    let mut told = Vec::new();
    let tuned = tune(&task, |at| told.push(at), CancelToken::NEVER).expect("a tuning");
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
    let judged = tune(&task, |_| {}, CancelToken::NEVER).expect("figures");
    assert!(!judged.is_changed() && judged.obstacles.is_empty() && judged.progress.is_empty());
    assert_eq!(judged.after, judged.before);
    assert_eq!(judged.after.fresh.len(), 4);
    let message = report::verdict(&task, &judged);
    let met = judged.after.met(&task.goal);
    assert!(message.starts_with(&format!("The goal is met in {} of 4, ", met.met)), "{message}");
    assert!(message.contains(" of the fresh draws, with the gains of the file"), "{message}");
}
