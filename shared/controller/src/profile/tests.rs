extern crate std;
use super::*;
use core::f64::consts::TAU;
use proptest::prelude::*;
use std::vec::Vec;

/// The samples of a profile behind its first one.
fn waypoints(profile: Profile, from: i32, target: i32) -> Vec<Waypoint> {
    let mut progress = Progress::new(&profile, from, target);
    let mut all = std::vec![];
    loop {
        all.push(progress.advance(&profile, target));
        if all[all.len() - 1].last {
            return all;
        }
    }
}

/// Its setpoints, the first one included.
fn setpoints(profile: Profile, from: i32, target: i32) -> Vec<i32> {
    let first = Progress::new(&profile, from, target).first();
    core::iter::once(first)
        .chain(waypoints(profile, from, target).iter().map(|point| point.setpoint))
        .collect()
}

fn ramp(averages: [u32; 3]) -> Profile {
    let [velocity, acceleration, jerk] = averages;
    Profile::Ramp(Ramp::new(velocity, acceleration, jerk).expect("lengths of a ramp"))
}

/// A step at sample 1, averaged as often as there are lengths, by the definition of a moving average.
fn averaged(lengths: [u32; 3]) -> Vec<f64> {
    let samples: u32 = lengths.iter().sum::<u32>() - 2;
    let mut s: Vec<f64> = (0..=samples).map(|k| f64::from(u32::from(k > 0))).collect();
    for length in lengths {
        let window = length as usize;
        s = (0..s.len())
            .map(|k| s[(k + 1).saturating_sub(window)..=k].iter().sum::<f64>() / f64::from(length))
            .collect();
    }
    s
}

fn differences(values: &[f64]) -> Vec<f64> {
    values.windows(2).map(|pair| pair[1] - pair[0]).collect()
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| value.abs().max(most))
}

/// Lengths of a ramp that keeps its limits: V >= A + J, A >= J.
fn lengths() -> impl Strategy<Value = [u32; 3]> {
    (1..40_u32, 0..60_u32, 0..200_u32).prop_map(|(jerk, a, v)| [2 * jerk + a + v, jerk + a, jerk])
}

#[test]
fn a_ramp_of_constant_velocity_is_a_straight_line_to_its_target() {
    assert_eq!(setpoints(ramp([4, 1, 1]), 100, 500), [100, 200, 300, 400, 500]);
    assert_eq!(setpoints(ramp([4, 1, 1]), 500, 100), [500, 400, 300, 200, 100], "and back");
    assert_eq!(setpoints(ramp([3, 1, 1]), 0, 1), [0, 0, 1, 1], "rounded to the nearest count");
    assert_eq!(setpoints(ramp([1, 1, 1]), 0, 1000), [0, 1000]);
}

#[test]
fn a_ramp_over_no_distance_stands_and_ends_on_time() {
    assert_eq!(setpoints(ramp([9, 4, 2]), 77, 77), [77; 14]);
    assert!(
        waypoints(ramp([9, 4, 2]), 77, 77).iter().all(|point| (point.velocity, point.acceleration) == (0, 0))
    );
}

#[test]
fn the_longest_ways_there_are_end_on_target_and_overshoot_nothing() {
    for (from, target) in [(i32::MIN, i32::MAX), (i32::MAX, i32::MIN), (i32::MAX, i32::MAX), (0, i32::MIN)] {
        let all = setpoints(ramp([50, 20, 10]), from, target);
        assert_eq!((all[0], all[all.len() - 1]), (from, target));
        assert!(all.is_sorted_by(|a, b| if from < target { a <= b } else { a >= b }), "{from} to {target}");
    }
}

#[test]
fn lengths_that_are_no_ramp_are_refused() {
    for [velocity, acceleration, jerk] in
        [[0, 1, 1], [1, 0, 1], [1, 1, 0], [LONGEST_AVERAGE + 1, 1, 1], [1 << 20, 1 << 20, 2], [u32::MAX; 3]]
    {
        assert_eq!(Ramp::new(velocity, acceleration, jerk), None, "{velocity} {acceleration} {jerk}");
    }
    assert!(Ramp::new(LONGEST_AVERAGE, 1, 1).is_some() && Ramp::new(1 << 20, 1 << 20, 1).is_some());
}

/// 17 minutes at 1 ms with 2 s of acceleration and 0.1 s of jerk over 16 m in micrometres: a unit of s that is rounded
/// down falls short by half a count.
#[test]
fn a_long_slow_ramp_stays_within_a_count_of_its_line_to_the_end() {
    let (distance, lengths) = (1 << 24, [1 << 20, 1 << 11, 1 << 7]);
    let profile = ramp(lengths);
    let mut progress = Progress::new(&profile, 0, distance);
    let (samples, edge) = (profile.samples(), lengths[1] + lengths[2]);
    for k in 1..samples {
        let setpoint = progress.advance(&profile, distance).setpoint;
        if (edge..=lengths[0]).contains(&k) {
            let line =
                f64::from(distance) * (f64::from(k) - f64::from(edge - 2) / 2.0) / f64::from(lengths[0]);
            assert!((f64::from(setpoint) - line).abs() <= 1.0, "{k}: {setpoint} beside {line}");
        }
    }
    assert_eq!(
        progress.advance(&profile, distance),
        Waypoint { setpoint: distance, last: true, ..Waypoint::default() }
    );
}

#[test]
fn the_sine_is_that_of_real_numbers_to_a_hundred_millionth() {
    let one = f64::from(1 << 30);
    for step in 0..=1_000_000_u32 {
        let phase = step.wrapping_mul(4295);
        let real = (f64::from(phase) / 4_294_967_296.0 * TAU).sin();
        assert!((f64::from(sine(phase)) / one - real).abs() < 1.2e-8, "phase {phase}");
    }
    assert_eq!([0, 1 << 31].map(sine), [0, 0]);
    assert!([1 << 30, 3 << 30].map(sine).iter().all(|crest| (1 << 30) - crest.abs() <= 8));
}

#[test]
fn a_sine_swings_about_its_target_and_rests_there_after_whole_turns() {
    let samples = 400;
    let wave = Wave { amplitude: 1000, samples, rate: u64::MAX / 200 + 1, sweep: 0 };
    let all = setpoints(Profile::Wave(wave), 0, 5000);
    assert_eq!(all.len(), 401);
    assert_eq!([all[0], all[50], all[100], all[150], all[400]], [5000, 6000, 5000, 4000, 5000]);
    let down = setpoints(Profile::Wave(Wave { amplitude: -1000, ..wave }), 0, 5000);
    assert_eq!([down[50], down[150]], [4000, 6000]);
}

/// A chirp from f0 to f1 turns per sample over N samples: phase k f0 + (f1 - f0) k (k - 1) / (2 (N - 1)).
#[test]
fn a_chirp_has_the_phase_of_a_frequency_that_grows_evenly() {
    let (samples, turn) = (50_000_u32, 18_446_744_073_709_551_616.0);
    let (from, to) = (0.0001, 0.05);
    let rate = (from * turn) as u64;
    let sweep = ((to - from) / f64::from(samples - 1) * turn) as i64;
    let wave = Wave { amplitude: 20_000, samples, rate, sweep };
    for (k, setpoint) in setpoints(Profile::Wave(wave), 0, 0).iter().enumerate().take(samples as usize) {
        let k = k as f64;
        let phase = k * (rate as f64 / turn) + sweep as f64 / turn * k * (k - 1.0) / 2.0;
        let real = 20_000.0 * (phase.fract() * TAU).sin();
        assert!((f64::from(*setpoint) - real).abs() <= 1.0, "{k}: {setpoint} beside {real}");
    }
}

#[test]
fn noise_goes_through_every_pattern_of_its_register_before_it_repeats() {
    let (taps, period) = (0b11_0000_u32, 63);
    let mut register = 1;
    let mut seen = std::collections::BTreeSet::new();
    for _ in 0..period {
        assert!(seen.insert(register));
        register = shifted(register, taps);
    }
    assert_eq!(register, 1);
}

#[test]
fn noise_holds_each_sign_for_its_time_and_is_as_often_above_as_below_but_once() {
    let noise = Noise { amplitude: 30, samples: 3 * 63 + 1, hold: 3, taps: 0b11_0000 };
    let all = setpoints(Profile::Noise(noise), 0, 100);
    assert_eq!((all[0], all[all.len() - 1]), (100, 100), "it begins and ends at its target");
    let signs: Vec<i32> = all[1..190]
        .chunks(3)
        .map(|hold| {
            assert!(hold.iter().all(|s| *s == hold[0]));
            hold[0] - 100
        })
        .collect();
    assert!(signs.iter().all(|sign| sign.abs() == 30));
    assert_eq!(signs.iter().sum::<i32>().abs(), 30, "63 signs");
    assert!(
        waypoints(Profile::Noise(noise), 0, 100).iter().all(|point| point.velocity == 0),
        "jumps are no motion"
    );
}

proptest! {
    #[test]
    fn a_ramp_is_a_step_averaged_three_times(lengths in lengths(), from in -100_000..100_000, target in -100_000..100_000) {
        let all = setpoints(ramp(lengths), from, target);
        let real = averaged(lengths);
        prop_assert_eq!(all.len(), real.len());
        prop_assert_eq!(all.last(), Some(&target));
        for (setpoint, s) in all.iter().zip(&real) {
            let exact = f64::from(from) + f64::from(target - from) * s;
            prop_assert!((f64::from(*setpoint) - exact).abs() <= 0.501, "{} beside {}", setpoint, exact);
        }
    }

    #[test]
    fn a_ramp_keeps_the_limits_that_its_lengths_stand_for(lengths in lengths(), distance in -1_000_000..1_000_000_i32) {
        let [v, a, j] = lengths.map(f64::from);
        let size = f64::from(distance.abs());
        let s = averaged(lengths);
        let first = differences(&s);
        let second = differences(&first);
        prop_assert!(largest(&first) <= 1.0 / v * (1.0 + 1e-9));
        prop_assert!(largest(&second) <= 1.0 / (v * a) * (1.0 + 1e-6));
        prop_assert!(largest(&differences(&second)) <= 1.0 / (v * a * j) * (1.0 + 1e-3) + 1e-13);
        // What is fed forward is these differences, to half a unit of 2^-12 and what 2^-30 of a count make of it.
        for point in waypoints(ramp(lengths), 0, distance) {
            prop_assert!(f64::from(point.velocity).abs() <= 4096.0 * size / v + 1.0 + size / 1e5);
            prop_assert!(f64::from(point.acceleration).abs() <= 4096.0 * size / (v * a) + 1.0 + size / 1e5);
        }
    }

    #[test]
    fn no_setpoint_leaves_the_extremes_of_its_move(
        kind in 0..3_usize, from in any::<i32>(), target in any::<i32>(), amplitude in any::<i32>(),
        lengths in lengths(), rate in any::<u64>(), sweep in any::<i64>(), taps in any::<u32>(), hold in any::<u32>(),
    ) {
        let samples = 500;
        let profile = [
            ramp(lengths),
            Profile::Wave(Wave { amplitude, samples, rate, sweep }),
            Profile::Noise(Noise { amplitude, samples, hold, taps }),
        ][kind];
        let reach = profile.amplitude();
        let start = if kind == 0 { from } else { target };
        let lowest = start.min(target.saturating_sub_unsigned(reach));
        let highest = start.max(target.saturating_add_unsigned(reach));
        for setpoint in setpoints(profile, from, target) {
            prop_assert!((lowest..=highest).contains(&setpoint), "{} outside {} to {}", setpoint, lowest, highest);
        }
    }

    #[test]
    fn a_sine_of_any_rate_is_within_a_count_of_real_numbers(
        rate in any::<u64>(), amplitude in -1_000_000..1_000_000_i32, target in -1_000_000..1_000_000_i32,
    ) {
        let wave = Wave { amplitude, samples: 2000, rate, sweep: 0 };
        for (k, setpoint) in setpoints(Profile::Wave(wave), 0, target).iter().enumerate().take(2000) {
            let phase = rate.wrapping_mul(k as u64) as f64 / 18_446_744_073_709_551_616.0;
            let real = f64::from(target) + f64::from(amplitude) * (phase * TAU).sin();
            prop_assert!((f64::from(*setpoint) - real).abs() <= 1.0, "{}: {} beside {}", k, setpoint, real);
        }
    }
}
