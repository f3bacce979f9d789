use super::*;
use crate::transient::CHANNELS;

const PERIOD: f64 = 0.001;

/// A transient of these setpoints and positions, mm, a sample each millisecond; counts of 0.01 mm.
fn transient(setpoint: impl Fn(f64) -> f64, position: impl Fn(f64) -> f64, samples: usize) -> Transient {
    let time: Vec<f64> = (0..samples).map(|k| k as f64 * PERIOD).collect();
    let counts: Vec<i32> = time.iter().map(|&t| (position(t) / 0.01).floor() as i32).collect();
    let mut channels: [Vec<f64>; CHANNELS.len()] = std::array::from_fn(|_| vec![0.0; samples]);
    channels[SETPOINT] = time.iter().map(|&t| setpoint(t)).collect();
    channels[POSITION] = counts.iter().map(|&count| f64::from(count) * 0.01).collect();
    Transient { time, channels, counts, mm_per_count: 0.01, windows: [5, 3], ..Transient::default() }
}

fn evaluated(transient: &Transient) -> Vec<Move> {
    moves(transient, &Motion::of(transient), None, 0.05)
}

fn near(value: Option<f64>, expected: f64, within: f64) {
    let value = value.expect("measured");
    assert!((value - expected).abs() <= within, "{value} is not {expected}");
}

/// A first-order lag: 10 % to 90 % take ln 9 time constants, to 0.05 of 60 mm ln 1200.
#[test]
fn the_rise_and_settling_times_of_a_lag_are_those_of_its_closed_form() {
    let lag = transient(|_| 100.0, |t| 40.0 + 60.0 * (1.0 - (-t / 0.1).exp()), 2000);
    let [step] = &evaluated(&lag)[..] else { panic!("one move") };
    assert_eq!((step.start_s, step.from_mm, step.to_mm), (0.0, 40.0, Some(100.0)));
    near(step.rise_s, 0.1 * 9f64.ln(), 2.0 * PERIOD);
    near(step.settling_s, 0.1 * 1200f64.ln(), 0.1 * 0.25);
    near(step.overshoot_mm, 0.0, 0.0);
    near(step.steady_error_mm, 0.01, 0.011);
    assert_eq!(step.limit_cycle, None);
    // The estimator's window of 5 ms sees the mean speed of the first 5 ms.
    near(Some(step.top_speed_mm_s), 600.0 * (1.0 - 0.05f64.exp().recip()) / 0.05, 3.0);
}

#[test]
fn an_oscillation_that_goes_on_is_a_limit_cycle_with_its_overshoot() {
    let swing = |t: f64| 100.0 + 2.0 * (std::f64::consts::TAU * 7.0 * t).sin() - 60.0 * (-t / 0.02).exp();
    let [step] = &evaluated(&transient(|_| 100.0, swing, 3000))[..] else { panic!("one move") };
    let cycle = step.limit_cycle.expect("it swings");
    near(Some(cycle.amplitude_mm), 2.0, 0.01);
    near(Some(cycle.frequency_hz), 7.0, 0.05);
    near(step.overshoot_mm, 2.0, 0.02);
    assert_eq!(step.settling_s, None, "it never stays within the tolerance");
}

#[test]
fn a_drive_that_stands_on_the_edge_of_a_count_has_no_limit_cycle() {
    let edge = |t: f64| 100.0 + 0.01 * ((t * 500.0).floor() % 3.0 - 1.0);
    let [step] = &evaluated(&transient(|_| 100.0, edge, 1000))[..] else { panic!("one move") };
    assert_eq!(step.limit_cycle, None);
    assert_eq!(step.settling_s, Some(0.0));
}

#[test]
fn a_move_ends_where_the_next_one_begins_and_overshoot_has_the_direction_of_the_move() {
    let there_and_back = |t: f64| if t < 1.0 { 100.0 } else { 40.0 };
    let position = |t: f64| match t {
        t if t < 0.1 => 40.0,
        t if t < 1.1 => 100.0,
        t if t < 1.2 => 39.0,
        _ => 40.0,
    };
    let moves = evaluated(&transient(there_and_back, position, 2000));
    assert_eq!(moves.len(), 2);
    near(moves[0].overshoot_mm, 0.0, 0.0);
    near(moves[1].overshoot_mm, 1.0, 1e-9);
    near(moves[1].settling_s, 0.2, 1.5 * PERIOD);
    assert_eq!((moves[1].start_s, moves[1].from_mm, moves[1].to_mm), (1.0, 100.0, Some(40.0)));
}

#[test]
fn the_moves_of_an_open_loop_are_its_commands_and_have_no_setpoint() {
    let mut open = transient(|_| f64::NAN, |t| 40.0 + 100.0 * t, 1000);
    open.channels[COMMAND] = open.time.iter().map(|&t| if t < 0.5 { 0.0 } else { 512.0 }).collect();
    let moves = evaluated(&open);
    assert_eq!(moves.len(), 2);
    assert_eq!((moves[1].to_mm, moves[1].rise_s, moves[1].steady_error_mm), (None, None, None));
    near(Some(moves[1].top_speed_mm_s), 100.0, 2.1);
}

#[test]
fn samples_from_before_the_start_belong_to_no_move() {
    let mut early = transient(|_| 100.0, |_| 100.0, 100);
    early.time.iter_mut().for_each(|time| *time -= 0.05);
    assert_eq!(evaluated(&early)[0].start_s.abs(), 0.0);
    early.time.iter_mut().for_each(|time| *time -= 9.0);
    assert!(evaluated(&early).is_empty());
}
