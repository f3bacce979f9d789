use std::f64::consts::TAU;

use super::*;
use crate::evaluation::noise::tests::normal;

const PERIOD_S: f64 = 0.0013;
const COUNT_MM: f64 = 0.01205;

/// What positions (mm) over time (s) and pressures (kPa) show.
fn shown(time: &[f64], position: &[f64], pressures: [&[f64]; 2]) -> LimitCycle {
    LimitCycle::of(time, position, pressures, None, COUNT_MM, still_band(position, COUNT_MM))
}

/// What the counts of a motion (mm over s) show.
fn seen(motion: impl Fn(f64) -> f64, seconds: f64) -> LimitCycle {
    seen_with_noise(motion, seconds, || 0.0)
}

/// The same with noise of so many counts.
fn seen_with_noise(motion: impl Fn(f64) -> f64, seconds: f64, mut noise: impl FnMut() -> f64) -> LimitCycle {
    let time: Vec<f64> = (0..=(seconds / PERIOD_S) as usize).map(|k| k as f64 * PERIOD_S).collect();
    let position: Vec<f64> =
        time.iter().map(|&t| (motion(t) / COUNT_MM + noise()).floor() * COUNT_MM).collect();
    let pressures = vec![400.0; time.len()];
    shown(&time, &position, [&pressures, &pressures])
}

/// A step of 60 mm that a time constant of 30 ms carries to its end.
fn step(t: f64) -> f64 {
    100.0 - 60.0 * (-t / 0.03).exp()
}

/// A sine of an amplitude (mm) and frequency (Hz), a share of a cycle late.
fn sine(amplitude_mm: f64, hz: f64, late: f64) -> impl Fn(f64) -> f64 {
    move |t| amplitude_mm * (TAU * (hz * t - late)).sin()
}

/// Start phases, shares of a cycle.
fn phases() -> impl Iterator<Item = f64> {
    (0..8).map(|eighth| f64::from(eighth) / 8.0)
}

/// Requires a limit cycle of this swing (mm) and frequency (Hz), both to a part of it; the swing to two counts, too.
fn is_sustained(found: LimitCycle, swing_mm: f64, hz: f64, within: f64, what: &str) {
    let LimitCycle::Sustained(cycle) = found else { panic!("{what}: {found:?}") };
    let off = (cycle.swing_mm - swing_mm).abs();
    assert!(off < 2.0 * COUNT_MM + within * swing_mm, "{what}: {cycle:?}");
    assert!((cycle.frequency_hz / hz - 1.0).abs() < within, "{what}: {cycle:?}");
    let [least, most] = cycle.range_mm;
    assert!(least <= cycle.swing_mm && cycle.swing_mm <= most, "{what}: {cycle:?}");
}

#[test]
fn a_swing_of_77_mm_at_4_hz_is_seen_in_a_move_of_1_7_s_whatever_its_phase() {
    for late in phases() {
        let swing = sine(77.0, 4.0, late);
        let found = seen(|t| step(t) + swing(t), 1.7);
        is_sustained(found, 154.0, 4.0, 0.02, &format!("{late} late"));
    }
}

#[test]
fn a_swing_that_goes_on_is_seen_at_any_size_and_period_from_five_cycles_on() {
    for amplitude_mm in [0.05, 0.3, 2.0, 15.0, 77.0] {
        for cycles in [5.0, 6.4, 9.0, 17.3, 60.0] {
            for seconds in [1.1, 1.7, 6.0] {
                for late in phases() {
                    let hz = cycles / seconds;
                    if hz > 60.0 {
                        continue;
                    }
                    let swing = sine(amplitude_mm, hz, late);
                    let what = format!("{amplitude_mm} mm, {hz} Hz, {seconds} s, {late}");
                    is_sustained(seen(|t| step(t) + swing(t), seconds), 2.0 * amplitude_mm, hz, 0.03, &what);
                }
            }
        }
    }
}

/// From three cycles to four it depends on the phase whether three whole ones can be seen.
#[test]
fn a_swing_of_few_cycles_is_one_or_is_not_decidable() {
    for cycles in [0.5, 0.7, 1.0, 1.5, 2.0, 2.6, 3.3, 4.2] {
        for amplitude_mm in [0.1, 2.0, 77.0] {
            for late in phases() {
                let hz = cycles / 1.7;
                let swing = sine(amplitude_mm, hz, late);
                let found = seen(|t| step(t) + swing(t), 1.7);
                let what = format!("{cycles} cycles, {amplitude_mm} mm, {late}: {found:?}");
                match found {
                    LimitCycle::None { below_mm, for_s } => {
                        let went_mm = (swing(1.7) - swing(1.7 - for_s)).abs();
                        assert!(
                            cycles < 1.1 && went_mm < below_mm + COUNT_MM,
                            "it stands at its turning point, {what}"
                        );
                    }
                    LimitCycle::Sustained(_) => {
                        assert!(cycles > 3.0, "{what}");
                        is_sustained(found, 2.0 * amplitude_mm, hz, 0.06, &what);
                    }
                    LimitCycle::Undecided(_) => {}
                }
            }
        }
    }
}

#[test]
fn a_ringing_that_dies_out_is_no_limit_cycle() {
    for left_of_a_cycle in [0.2, 0.5, 0.7, 0.8, 0.9, 0.95] {
        for hz in [3.0, 8.0, 20.0] {
            for seconds in [0.7, 1.7, 6.0] {
                for late in phases() {
                    let swing = sine(60.0, hz, late);
                    let ringing = |t: f64| 100.0 + f64::powf(left_of_a_cycle, hz * t) * swing(t);
                    let found = seen(ringing, seconds);
                    let what = format!("{left_of_a_cycle} a cycle, {hz} Hz, {seconds} s, {late}: {found:?}");
                    assert!(!matches!(found, LimitCycle::Sustained(_)), "{what}");
                    let left_mm = 60.0 * f64::powf(left_of_a_cycle, hz * 0.6 * seconds);
                    if left_mm < COUNT_MM && 0.15 * seconds > REST_S {
                        assert!(matches!(found, LimitCycle::None { .. }), "{what}");
                    }
                    if left_mm > 1.0 {
                        assert!(matches!(found, LimitCycle::Undecided(_)), "{what}");
                    }
                }
            }
        }
    }
}

/// Dry friction takes as much of every swing until the drive sticks.
#[test]
fn a_ringing_that_friction_stops_ends_at_rest() {
    let ringing = |t: f64| 100.0 + (20.0 - 25.0 * t).max(0.0) * (TAU * 6.0 * t).cos();
    assert!(matches!(seen(ringing, 3.0), LimitCycle::None { .. }));
    assert!(
        matches!(seen(ringing, 0.75), LimitCycle::Undecided(Doubt::DyingOut { .. })),
        "{:?}",
        seen(ringing, 0.75)
    );
}

#[test]
fn a_transient_before_and_a_late_beginning_do_not_hide_a_limit_cycle() {
    for late in phases() {
        let (transient, swing) = (sine(60.0, 5.0, late), sine(0.4, 5.0, late));
        let settling = |t: f64| 100.0 + transient(t) * (-t / 0.25).exp() + swing(t);
        is_sustained(seen(settling, 4.0), 0.8, 5.0, 0.1, &format!("after a transient, {late}"));
        let begins = |t: f64| 100.0 + if t < 1.2 { 0.0 } else { swing(t) };
        is_sustained(seen(begins, 2.2), 0.8, 5.0, 0.05, &format!("begins late, {late}"));
        let too_late = seen(begins, 1.5);
        assert!(matches!(too_late, LimitCycle::Undecided(_)), "{late}: {too_late:?}");
        // Grown to its size: from a hundredth of it, by 40 % a cycle.
        let grows = |t: f64| {
            100.0 + (0.01 * (5.0 * t * 1.4_f64.ln()).exp()).min(1.0) * 10.0 * sine(1.0, 5.0, late)(t)
        };
        is_sustained(seen(grows, 5.5), 20.0, 5.0, 0.05, &format!("has grown, {late}"));
        let growing = seen(grows, 2.5);
        assert!(matches!(growing, LimitCycle::Undecided(Doubt::Growing { .. })), "{late}: {growing:?}");
    }
}

#[test]
fn a_swing_that_stops_is_none_once_it_has_rested_for_a_cycle() {
    let swing = sine(5.0, 4.0, 0.0);
    let stops = |t: f64| 100.0 + if t < 1.0 { swing(t) } else { 0.0 };
    assert_eq!(seen(stops, 1.2), LimitCycle::Undecided(Doubt::JustStopped));
    assert!(matches!(seen(stops, 2.0), LimitCycle::None { .. }), "{:?}", seen(stops, 2.0));
    // A drive that sticks for long between two jumps rests only if it does so for longer.
    let hunts = |t: f64| 100.0 + if (t / 0.6).floor() % 2.0 == 0.0 { 0.5 } else { -0.5 };
    is_sustained(seen(hunts, 6.3), 1.0, 1.0 / 1.2, 0.02, "it hunts");
    assert!(matches!(seen(hunts, 2.35), LimitCycle::Undecided(_)), "{:?}", seen(hunts, 2.35));
}

#[test]
fn a_drift_does_not_change_the_swing() {
    for drift_mm_s in [-3.0, 0.2, 1.0, 3.0] {
        for late in phases() {
            let swing = sine(0.5, 6.0, late);
            let found = seen(|t| step(t) + swing(t) + drift_mm_s * t, 2.0);
            is_sustained(found, 1.0, 6.0, 0.05, &format!("{drift_mm_s} mm/s, {late}"));
        }
    }
}

#[test]
fn a_drive_that_creeps_or_still_moves_shows_neither_rest_nor_a_limit_cycle() {
    for motion in
        [|t: f64| 40.0 + 60.0 * t, |t: f64| 100.0 + 0.5 * t, |t: f64| 100.0 - 60.0 * (-t / 0.4).exp()]
    {
        let found = seen(motion, 1.0);
        assert_eq!(found, LimitCycle::Undecided(Doubt::Moving));
    }
}

#[test]
fn a_resting_drive_has_none_on_the_edge_of_a_count_and_with_noise() {
    for (counts, seconds) in [(0.0, 0.25), (0.0, 20.0), (0.3, 2.0), (1.0, 2.0), (1.0, 60.0), (3.0, 5.0)] {
        for seed in 0..8 {
            let mut draw = normal(seed);
            let found = seen_with_noise(step, seconds + 0.3, || counts * draw());
            let LimitCycle::None { below_mm, .. } = found else {
                panic!("{counts} counts, {seconds} s: {found:?}")
            };
            assert!(below_mm <= COUNT_MM * (2.6 + 10.5 * counts), "{counts} counts: {below_mm}");
        }
    }
    let edge = |t: f64| 100.0 + COUNT_MM * ((t * 500.0).floor() % 2.0);
    assert!(matches!(seen(edge, 1.0), LimitCycle::None { .. }));
}

#[test]
fn noise_of_a_count_does_not_hide_a_limit_cycle_that_stands_above_it() {
    for (amplitude_mm, hz) in [(0.25, 5.0), (1.0, 2.5), (1.0, 50.0), (77.0, 4.0)] {
        for seed in 0..8 {
            let (mut draw, swing) = (normal(seed), sine(amplitude_mm, hz, f64::from(seed as u32) / 8.0));
            let found = seen_with_noise(|t| step(t) + swing(t), 3.0, &mut draw);
            let LimitCycle::Sustained(cycle) = found else { panic!("{amplitude_mm} mm, {hz} Hz: {found:?}") };
            // Its turning points are the largest and smallest of some noisy readings.
            let over_mm = cycle.swing_mm - 2.0 * amplitude_mm;
            assert!(
                (-2.0 * COUNT_MM..8.0 * COUNT_MM).contains(&over_mm),
                "{amplitude_mm} mm, {hz} Hz: {cycle:?}"
            );
            assert!((cycle.frequency_hz / hz - 1.0).abs() < 0.02, "{amplitude_mm} mm, {hz} Hz: {cycle:?}");
        }
    }
}

/// Below the steps of the encoder nothing can be seen; two counts of them are an edge, and four a swing.
#[test]
fn a_swing_of_less_than_two_counts_is_a_drive_at_rest() {
    for (counts, sustained) in [(0.9, false), (1.4, false), (4.0, true), (6.0, true)] {
        for late in phases() {
            let swing = sine(counts * COUNT_MM / 2.0, 6.0, late);
            let found = seen(|t| step(t) + swing(t), 3.0);
            assert_eq!(
                matches!(found, LimitCycle::Sustained(_)),
                sustained,
                "{counts} counts, {late}: {found:?}"
            );
            assert_eq!(
                matches!(found, LimitCycle::None { .. }),
                !sustained,
                "{counts} counts, {late}: {found:?}"
            );
        }
    }
}

#[test]
fn a_hold_must_last_to_show_that_the_drive_rests() {
    assert!(matches!(seen(|_| 100.0, 0.3), LimitCycle::None { .. }));
    assert_eq!(seen(|_| 100.0, 0.15), LimitCycle::Undecided(Doubt::TooShort));
    assert_eq!(seen(|t| 100.0 * (t / 0.2).min(1.0), 0.35), LimitCycle::Undecided(Doubt::JustStopped));
    assert!(matches!(seen(|_| 100.0, 0.0), LimitCycle::Undecided(_)), "one sample");
    assert!(matches!(shown(&[], &[], [&[], &[]]), LimitCycle::Undecided(_)));
}

/// A drive that sticks and jumps, once a second, stands still for longer than it moves.
#[test]
fn a_drive_that_stands_while_its_pressures_go_on_changing_is_not_known_to_rest() {
    let time: Vec<f64> = (0..1000).map(|k| f64::from(k) * PERIOD_S).collect();
    let seen = |pressure: &dyn Fn(f64) -> f64| {
        let pressure: Vec<f64> = time.iter().map(|&t| pressure(t)).collect();
        shown(&time, &vec![100.0; time.len()], [&vec![400.0; time.len()], &pressure])
    };
    for ramp_kpa_s in [-40.0, 8.0, 100.0] {
        let found = seen(&|t| 300.0 + ramp_kpa_s * t);
        let LimitCycle::Undecided(Doubt::Sticking { kpa_s, still_s }) = found else { panic!("{found:?}") };
        assert!((kpa_s / ramp_kpa_s.abs() - 1.0).abs() < 0.01, "{kpa_s}");
        assert_eq!(still_s, 10.0, "nothing is foreseen for longer");
    }
    let charged = seen(&|t| 300.0 + 100.0 * (-t / 0.3).exp());
    assert!(matches!(charged, LimitCycle::None { .. }), "{charged:?}");
    for hz in [20.0, 50.0, 75.0] {
        let dithered = seen(&|t| 300.0 + 5.0 * (TAU * hz * t).sin());
        assert!(matches!(dithered, LimitCycle::None { .. }), "{dithered:?}");
    }
}

/// Pressures that creep to their end for seconds: the wait ends where less than 2 kPa is to come.
#[test]
fn what_is_still_to_come_of_a_pressure_tells_how_much_longer_to_watch() {
    let seen = |seconds: f64, kpa: f64, decays_s: f64| {
        let time: Vec<f64> = (0..(seconds / PERIOD_S) as usize).map(|k| k as f64 * PERIOD_S).collect();
        let pressure: Vec<f64> = time.iter().map(|t| 300.0 + kpa * (-t / decays_s).exp()).collect();
        shown(&time, &vec![100.0; time.len()], [&pressure, &pressure])
    };
    for (kpa, decays_s) in [(30.0_f64, 1.0), (-30.0, 2.0), (10.0, 3.0)] {
        let until_s = decays_s * (kpa.abs() / 2.0_f64).ln();
        let found = seen(2.0, kpa, decays_s);
        let LimitCycle::Undecided(Doubt::Sticking { still_s, .. }) = found else { panic!("{found:?}") };
        assert!((still_s - (until_s - 2.0)).abs() < 0.1, "{kpa} kPa, {decays_s} s: {still_s}");
        let later = seen(until_s + 0.1, kpa, decays_s);
        assert!(matches!(later, LimitCycle::None { .. }), "{later:?}");
    }
}

/// A pressure that turns back is on its way to somewhere that nobody knows.
#[test]
fn a_pressure_that_changes_its_direction_is_not_taken_for_one_that_dies_out() {
    let time: Vec<f64> = (0..1000).map(|k| f64::from(k) * PERIOD_S).collect();
    let turns: Vec<f64> = time.iter().map(|t| 300.0 - 40.0 * (-t / 0.2).exp() - 4.0 * t).collect();
    let found = shown(&time, &vec![100.0; time.len()], [&turns, &vec![400.0; time.len()]]);
    assert!(matches!(found, LimitCycle::Undecided(Doubt::Sticking { .. })), "{found:?}");
}

/// A load that friction barely holds is moved by what a load that it holds firmly does not feel.
#[test]
fn what_is_to_come_is_held_against_the_friction_that_is_left() {
    let time: Vec<f64> = (0..1000).map(|k| f64::from(k) * PERIOD_S).collect();
    let (still, steady) = (vec![100.0; time.len()], vec![400.0; time.len()]);
    let rising: Vec<f64> = time.iter().map(|t| 300.0 - 30.0 * (-t / 0.4).exp()).collect();
    let seen = |used: f64| {
        let grip = FrictionUse { used: vec![used; time.len()], per_kpa: [0.05; 2] };
        LimitCycle::of(&time, &still, [&rising, &steady], Some(&grip), COUNT_MM, 0.03)
    };
    for used in [0.0, -0.5, 0.8] {
        assert!(matches!(seen(used), LimitCycle::None { .. }), "{used}: {:?}", seen(used));
    }
    for used in [0.95, -0.95, 1.0] {
        let found = seen(used);
        assert!(matches!(found, LimitCycle::Undecided(Doubt::Sticking { .. })), "{used}: {found:?}");
    }
}

/// A drive without pressure sensors may stick as any other; its swing is seen all the same.
#[test]
fn a_drive_that_stands_is_not_known_to_rest_unless_both_pressures_are_measured() {
    let time: Vec<f64> = (0..1000).map(|k| f64::from(k) * PERIOD_S).collect();
    let (known, unknown) = (vec![400.0; time.len()], vec![f64::NAN; time.len()]);
    let still = vec![100.0; time.len()];
    let seen = |position: &[f64], pressures: [&[f64]; 2]| shown(&time, position, pressures);
    let [known, unknown] = [&known[..], &unknown[..]];
    for pressures in [[unknown, unknown], [known, unknown], [unknown, known]] {
        assert_eq!(seen(&still, pressures), LimitCycle::Undecided(Doubt::PressuresUnknown));
    }
    assert!(Doubt::PressuresUnknown.to_string().contains("without its pressures"));
    assert!(matches!(seen(&still, [known, known]), LimitCycle::None { .. }));
    let counted = |mm: f64| (mm / COUNT_MM).floor() * COUNT_MM;
    let swing: Vec<f64> = time.iter().map(|&t| counted(100.0 + sine(5.0, 6.0, 0.0)(t))).collect();
    assert!(matches!(seen(&swing, [unknown, unknown]), LimitCycle::Sustained(_)));
}

#[test]
fn of_two_moves_the_worse_is_the_undecided_one_then_the_larger_swing() {
    let none = LimitCycle::None { below_mm: 0.03, for_s: 0.5 };
    let [small, large] = [1.0, 4.0].map(|mm| seen(|t| step(t) + sine(mm, 6.0, 0.0)(t), 3.0));
    let undecided = LimitCycle::Undecided(Doubt::Moving);
    assert_eq!(none.or_worse(small), small);
    assert_eq!(large.or_worse(small), large);
    assert_eq!(large.or_worse(undecided), undecided);
    assert_eq!(undecided.or_worse(none), undecided);
    assert_eq!((none.swing_mm(), undecided.swing_mm()), (Some(0.0), None));
}
