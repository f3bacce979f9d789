//! Motions of closed form are judged as they are, and scores count them.

use std::f64::consts::PI;

use pneudrive_design::six_drives::SIX_DRIVES;
use pneudrive_evaluate::evaluation::{Doubt, LimitCycle};
use pneudrive_sim::component::controller::Law;
use pneudrive_sim::{Accuracy, keys, run};

use super::drive;
use crate::positioning::arrival::{Arrival, BANDS_MM};
use crate::positioning::{Plan, Sine, SineScore, Spread, StepScore, sine, steps, usual_step_mm};

const PERIOD_S: f64 = 1e-3;
const WAY_MM: f64 = 60.0;
const RESTS: LimitCycle = LimitCycle::None { below_mm: 0.02, for_s: 1.0 };

/// A step from 100 to 160 mm, or to 40 mm, along a share of its distance over the time, for 3 s.
fn step(direction: f64, share: impl Fn(f64) -> f64) -> Arrival {
    let time: Vec<f64> = (0..3000).map(|k| 0.2 + f64::from(k) * PERIOD_S).collect();
    let to = 100.0 + direction * WAY_MM;
    let position: Vec<f64> = time.iter().map(|t| 100.0 + direction * WAY_MM * share(t - 0.2)).collect();
    Arrival::of(&time, &position, [100.0, to], RESTS)
}

/// 1 - exp(-t/T) is within b of its end after T ln(1/b).
#[test]
fn the_time_to_a_band_is_that_of_an_exponential_approach() {
    for direction in [1.0, -1.0] {
        let seen = step(direction, |t| 1.0 - (-t / 0.05).exp());
        for (band, within) in BANDS_MM.iter().zip(seen.within_s) {
            let exact = 0.05 * (WAY_MM / band).ln();
            let late = within.expect("it arrives") - exact;
            assert!((0.0..=PERIOD_S).contains(&late), "{band} mm: {late} s late");
        }
        assert_eq!(seen.beyond_mm, 0.0);
        assert!(!seen.moves() && seen.error_mm.abs() < 1e-9);
    }
}

/// A pair of poles of damping D goes beyond its end by exp(-pi D/sqrt(1 - D^2)) of the step.
#[test]
fn the_overshoot_is_that_of_a_pair_of_poles() {
    let (damping, w) = (0.5_f64, 30.0);
    let damped = (1.0 - damping * damping).sqrt();
    let poles = |t: f64| {
        let angle = w * damped * t;
        1.0 - (-damping * w * t).exp() * (angle.cos() + damping / damped * angle.sin())
    };
    let exact = WAY_MM * (-PI * damping / damped).exp();
    for direction in [1.0, -1.0] {
        let seen = step(direction, poles);
        // Between two samples the top is higher by less than the curve bends there.
        assert!(
            (0.0..WAY_MM * (w * PERIOD_S).powi(2)).contains(&(exact - seen.beyond_mm)),
            "{}",
            seen.beyond_mm
        );
    }
}

#[test]
fn a_step_that_arrives_too_late_to_be_seen_at_rest_has_not_arrived() {
    let arrives = |at: f64| step(1.0, |t| if t < at { 0.9 } else { 1.0 });
    assert!(arrives(1.49).within_s.iter().all(Option::is_some));
    assert!(arrives(1.51).within_s.iter().all(Option::is_none));
}

#[test]
fn a_piston_that_leaves_a_band_again_is_not_within_it_and_still_moves() {
    let swings = step(1.0, |t| 1.0 + 0.1 / WAY_MM * (2.0 * PI * 3.0 * t).sin());
    assert_eq!(swings.within_s.map(|within| within.is_some()), [true, true, false]);
    assert!(swings.moves() && (swings.range_mm - 0.2).abs() < 1e-3, "{}", swings.range_mm);
}

#[test]
fn a_score_counts_what_arrives_and_a_run_that_fails_has_not() {
    let fast = step(1.0, |t| 1.0 - (-t / 0.02).exp());
    let slow = step(1.0, |t| 1.0 - (-t / 0.10).exp());
    let open = Arrival { limit_cycle: LimitCycle::Undecided(Doubt::Moving), ..step(1.0, |_| 1.004) };
    let why = "limit at sample 12".to_owned();
    let runs = [Ok((&fast, true)), Ok((&slow, false)), Ok((&open, true)), Err(&why)];
    let score = StepScore::of(runs.into_iter());
    assert_eq!(score.within.map(|share| (share.met, share.of)), [(3, 4), (2, 4), (2, 4)]);
    let middle = f64::midpoint(fast.within_s[2].expect("fast"), slow.within_s[2].expect("slow"));
    assert_eq!(score.median_s[2], Some(middle));
    assert!((score.beyond_mm - 0.24).abs() < 1e-9);
    assert_eq!((score.without_overshoot.met, score.undecided, score.converged.met), (2, 1, 2));
    assert_eq!(score.failed, [why]);
}

#[test]
fn a_sine_is_scored_by_its_median_and_its_largest_error() {
    let runs = vec![Ok((0.2, true)), Ok((0.7, true)), Ok((0.5, false)), Err("a trip".to_owned())];
    let score = SineScore::of(runs);
    assert_eq!((score.followed.met, score.followed.of, score.converged.met), (2, 4, 2));
    assert_eq!(score.largest_mm, Some([0.5, 0.7]));
    assert_eq!(SineScore::of(Vec::new()).largest_mm, None);
}

/// A law without gains leaves its piston where it is: the largest error is the amplitude.
#[test]
fn a_piston_that_stands_is_the_amplitude_of_its_sine_off() {
    let idle = drive(
        "20x150",
        &[
            "controller.gain_profile=[0]",
            "controller.velocity_gain=0",
            "controller.acceleration_gain=0",
            "valve.leakage_percent=0.0",
        ],
    );
    let plan = Plan { spread: Spread::default(), draws: 2, seed: 1 };
    let score = sine(&idle, &plan, 60.0, 2.0).expect("runs");
    let [middle, largest] = score.largest_mm.expect("errors");
    let amplitude_mm = Sine::of(&idle, 60.0, 2.0).expect("it fits").amplitude as f64 * 0.01;
    assert!(
        (middle - amplitude_mm).abs() < 1e-3 && (largest - amplitude_mm).abs() < 1e-3,
        "{middle} {largest}"
    );
    assert_eq!(score.followed.met, 0);
}

/// The gains of `rig new` bring a drive near its target in most draws, whatever the number of threads.
#[test]
fn the_same_draws_have_the_same_score_on_any_number_of_threads() {
    let rig = drive("20x150", &[]);
    let plan = Plan { spread: Spread::default(), draws: 4, seed: 2 };
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| steps(&rig, &plan, 60.0)).expect("runs")
    };
    let [first, third] = on(1);
    assert_eq!([&first, &third], on(3).each_ref());
    assert!(first.failed.is_empty() && first.within[0].met >= 2, "{first:?}");
    assert_ne!(first, third);
}

/// A sine begins at its full speed, which no drive has: the law by a model joins it, on small cylinders and on large ones.
#[test]
fn the_law_by_a_model_follows_a_sine_on_each_of_six_drives() {
    for (name, _) in SIX_DRIVES {
        let law = keys::controller::LAW.setting(Law::Cascade.word());
        let rig = drive(name, &[&law]);
        let plan = Plan { spread: Spread::default(), draws: 3, seed: 1 };
        for hz in [0.5, 1.0] {
            let score = sine(&rig, &plan, usual_step_mm(&rig), hz).expect("a sine");
            let [_, worst] = score.largest_mm.expect("runs");
            assert!(score.failed.is_empty() && worst < 1.0, "{name}, {hz} Hz: {score}");
        }
    }
}

/// A sine ends on its target at full speed: the load is slowed down and brought back, it is not stopped at once.
#[test]
fn a_sine_that_ends_in_motion_is_left_without_a_jerk() {
    let law = keys::controller::LAW.setting(Law::Cascade.word());
    let test = [
        "test.moves=[]",
        "test.move=[{profile=\"step\", to_counts=12500}, {profile=\"sine\", at_s=0.5, to_counts=12500, amplitude_counts=3000, frequency_hz=1.0, cycles=2}]",
        "test.position_m=0.125005",
        "test.duration_s=4.0",
    ];
    let rig = drive("32x250", &[&[&*law], &test[..]].concat());
    let run = run(&rig, Accuracy::of(&rig)).expect("it runs");
    assert_eq!(run.fault, None);
    let after = run.rows.iter().filter(|row| row.time > 2.5);
    let farthest = after.clone().map(|row| (row.plant.position - 0.125_005).abs()).fold(0.0, f64::max);
    let last = run.rows.last().expect("rows").plant.position;
    assert!(farthest < 10e-3 && (last - 0.125_005).abs() < 0.05e-3, "{farthest} m beyond, {last} m");
    let open = after.filter(|row| row.observation.command.unsigned_abs() > 2000).count();
    assert!(open < 20, "{open} samples with a valve that is fully open");
}
