use super::*;
use crate::transient::{CHANNELS, COMMAND, Cut, POSITION, SETPOINT};

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
    assert!(matches!(step.limit_cycle, LimitCycle::None { .. }), "{:?}", step.limit_cycle);
    // The estimator's window of 5 ms sees the mean speed of the first 5 ms.
    near(Some(step.top_speed_mm_s), 600.0 * (1.0 - 0.05f64.exp().recip()) / 0.05, 3.0);
}

#[test]
fn an_oscillation_that_goes_on_is_a_limit_cycle_with_its_overshoot() {
    let swing = |t: f64| 100.0 + 2.0 * (std::f64::consts::TAU * 7.0 * t).sin() - 60.0 * (-t / 0.02).exp();
    let [step] = &evaluated(&transient(|_| 100.0, swing, 3000))[..] else { panic!("one move") };
    let LimitCycle::Sustained(cycle) = step.limit_cycle else { panic!("it swings: {:?}", step.limit_cycle) };
    near(Some(cycle.swing_mm), 4.0, 0.02);
    near(Some(cycle.frequency_hz), 7.0, 0.05);
    near(step.overshoot_mm, 2.0, 0.02);
    assert_eq!(step.settling_s, None, "it never stays within the tolerance");
}

#[test]
fn a_drive_that_stands_on_the_edge_of_a_count_has_no_limit_cycle() {
    let edge = |t: f64| 100.0 + 0.01 * ((t * 500.0).floor() % 3.0 - 1.0);
    let [step] = &evaluated(&transient(|_| 100.0, edge, 1000))[..] else { panic!("one move") };
    assert!(matches!(step.limit_cycle, LimitCycle::None { .. }), "{:?}", step.limit_cycle);
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

/// Once `--from` made a move of what was left of one: with a later beginning, a shorter distance and a faster rise.
#[test]
fn a_part_keeps_the_numbers_and_figures_of_its_moves_and_of_the_one_it_begins_in_only_those_of_its_end() {
    let setpoint = |t: f64| [40.0, 100.0, 60.0][(t / 1.0) as usize];
    let lag = |t: f64| {
        let after = |at: f64| if t < at { 0.0 } else { 1.0 - (-(t - at) / 0.05).exp() };
        40.0 + 60.0 * after(1.0) - 40.0 * after(2.0)
    };
    let whole = transient(setpoint, lag, 3000);
    let all = evaluated(&whole);
    let part = whole.between(1.02, 2.5);
    let [cut, last] = &evaluated(&part)[..] else { panic!("two moves") };
    assert_eq!((cut.number, cut.is_cut, cut.rise_s, cut.settling_s), (2, true, None, None));
    assert_eq!((cut.end_mm, cut.limit_cycle.swing_mm()), (all[1].end_mm, all[1].limit_cycle.swing_mm()));
    assert_eq!((last.number, last.is_cut, last.start_s, last.rise_s), (3, false, 2.0, all[2].rise_s));
    assert!(part.cut.at_end, "its last move goes on until 3 s");
    assert_eq!(part.between(1.5, 2.5).cut, whole.between(1.5, 2.5).cut, "a part of a part is a part");
    assert_eq!(whole.between(0.0, 9.0).cut, Cut::default());
    let at_a_beginning = whole.between(1.0, 1.9995);
    assert_eq!(at_a_beginning.cut, Cut { moves_before: 1, at_start: false, at_end: false });
    assert_eq!(evaluated(&at_a_beginning), all[1..2]);
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

#[test]
fn the_rise_is_told_between_samples() {
    // 1 mm/ms from 0.1 ms on: 6 mm and 54 mm are passed between two samples each.
    let ramp = transient(|_| 100.0, |t| 40.0 + (1e3 * t - 0.1).clamp(0.0, 60.0), 1000);
    near(evaluated(&ramp)[0].rise_s, 0.048, 2e-5);
}

#[test]
fn a_hold_has_no_rise_and_no_overshoot_and_a_short_step_no_rise() {
    for from in [100.0, 100.006, 99.98] {
        let hold = transient(|_| 100.0, |t| if t > 0.5 { 100.4 } else { from }, 1000);
        let [hold] = &evaluated(&hold)[..] else { panic!("one move") };
        assert_eq!((hold.rise_s, hold.overshoot_mm), (None, None), "from {from}");
    }
    let short = transient(|_| 100.0, |t| if t > 0.2 { 100.02 } else { 99.93 }, 1000);
    let [short] = &evaluated(&short)[..] else { panic!("one move") };
    assert_eq!(short.rise_s, None, "a tenth of 7 counts is none");
    near(short.overshoot_mm, 0.02, 0.01);
}

#[test]
fn a_drive_that_passes_its_setpoint_as_the_record_ends_has_not_settled_and_shows_no_error() {
    let passing = transient(|_| 100.0, |t| 40.0 + 60.0 * t, 1001);
    let [step] = &evaluated(&passing)[..] else { panic!("one move") };
    assert_eq!((step.overshoot_mm, step.settling_s, step.steady_error_mm), (None, None, None));
    near(step.mean_error_mm, 7.5, 0.1);
    near(Some(step.range_mm), 15.0, 0.1);
    near(step.rise_s, 0.8, 2e-3);
}

/// Settled is what stays there for the last quarter of its move.
#[test]
fn a_drive_that_is_there_only_at_the_end_is_not_known_to_have_settled() {
    let arrives = |at: f64| transient(|_| 100.0, move |t| if t < at { 40.0 } else { 100.0 }, 1000);
    near(evaluated(&arrives(0.7))[0].settling_s, 0.7, 1.5 * PERIOD);
    assert_eq!(evaluated(&arrives(0.8))[0].settling_s, None);
}

#[test]
fn the_steady_error_of_a_limit_cycle_is_that_of_its_whole_cycles() {
    // 3.6 cycles in the last quarter: their mean there is off by where it is cut.
    let swing = |t: f64| 99.5 + 2.0 * (std::f64::consts::TAU * 4.8 * t).sin() - 59.5 * (-t / 0.02).exp();
    let [step] = &evaluated(&transient(|_| 100.0, swing, 3000))[..] else { panic!("one move") };
    near(step.steady_error_mm, 0.505, 0.02);
}

#[test]
fn the_table_and_its_doubts_tell_rest_limit_cycle_and_neither() {
    let swing = |t: f64| 2.0 * (std::f64::consts::TAU * 7.0 * t).sin();
    let setpoint = |t: f64| 40.0 + 60.0 * (t / 2.0).floor();
    let position = |t: f64| match t {
        t if t < 2.0 => 40.0,
        t if t < 4.0 => 100.0 + swing(t),
        t => 160.0 + 3.0 * (t - 4.0),
    };
    let moves = evaluated(&transient(setpoint, position, 6000));
    let cells: Vec<String> =
        table(std::slice::from_ref(&moves), 0.05).rows.iter().map(|row| row[9].clone()).collect();
    assert_eq!(cells, ["none", "3.991 (3.990 to 4.000)", "not decidable"]);
    assert_eq!(
        remarks(std::slice::from_ref(&moves)),
        [
            "Move 3: it cannot be decided whether it ends in a limit cycle; it still moves at the end.",
            "No limit cycle means that the drive is at rest within 0.025 mm for at least the last 2.00 s."
        ]
    );
}

/// A step to 100 mm that ends `error` mm short of it.
fn short_by(error: f64) -> Vec<Move> {
    evaluated(&transient(|_| 100.0, |t| (100.0 - error) * (1.0 - (-t / 0.05).exp()), 2000))
}

#[test]
fn figures_over_several_runs_have_their_least_and_most_where_the_digits_show_it() {
    let runs = [short_by(0.0), short_by(0.0), short_by(1.0)];
    let table = table(&runs, 0.05);
    let [own, least, most] = &table.rows[..] else { panic!("a move with its ends: {:?}", table.rows) };
    assert_eq!((own[0].as_str(), least[0].as_str(), most[0].as_str()), ("1", "  least", "  most"));
    assert_eq!([&least[3], &most[3]], ["", ""], "the setpoint is the same in all");
    let [error, smallest, largest] = [own, least, most].map(|row| row[8].parse::<f64>().expect("mm"));
    assert!(error == smallest && (largest - error - 1.0).abs() < 1e-9, "{error} {smallest} {largest}");
    assert!(most[7].ends_with("(- in 1 of 3)"), "one run does not settle: {most:?}");
    let alone = super::table(&runs[..1], 0.05);
    assert_eq!(alone.rows, table.rows[..1]);
    let json = &to_json(&runs)[0];
    assert_eq!(json["settled_s"]["runs_without"], 1);
    assert!((json["steady_error_mm"]["most"].as_f64().expect("mm") - largest).abs() < 1e-3, "{json}");
}

#[test]
fn runs_that_do_not_all_end_alike_are_counted() {
    let swing = |t: f64| 100.0 + 2.0 * (std::f64::consts::TAU * 7.0 * t).sin() - 60.0 * (-t / 0.02).exp();
    let swinging = evaluated(&transient(|_| 100.0, swing, 3000));
    let runs = [short_by(0.0), swinging, short_by(1.0)];
    let text = remarks(&runs).join("\n");
    let counts = "of 3 nearly identical runs, 2 come to rest, 1 end in a limit cycle";
    assert!(text.contains(counts), "{text}");
    let cycle = &table(&runs, 0.05).rows;
    assert_eq!((cycle[0][9].as_str(), cycle[1][9].as_str()), ("none", "none"));
    assert!(cycle[2][9].starts_with("4.0") || cycle[2][9].starts_with("3.9"), "{cycle:?}");
    assert!(!remarks(&runs[..1]).join("\n").contains("runs"), "a run alone is not divided");
}

/// A drive that is half a millimetre behind a setpoint that goes 100 mm in a second, and then comes to it.
#[test]
fn a_profile_is_one_move_with_its_largest_and_its_mean_error() {
    let setpoint = |t: f64| 100.0 * (t - 0.2).clamp(0.0, 1.0);
    let position = |t: f64| if t < 1.2 { (setpoint(t) - 0.5).max(0.0) } else { 100.0 };
    let moves = evaluated(&transient(setpoint, position, 2000));
    assert_eq!(moves.len(), 2, "what was before, and the profile");
    assert_eq!((moves[0].tracking, moves[1].to_mm), (None, Some(100.0)));
    let tracking = moves[1].tracking.expect("of a profile");
    near(Some(tracking.most_mm), 0.5, 0.02);
    near(Some(tracking.rms_mm), 0.5, 0.02);
    let remarks = remarks(std::slice::from_ref(&moves));
    assert!(remarks[0].starts_with("Move 2 follows its profile: the error is 0.5"), "{remarks:?}");
    assert!(to_json(std::slice::from_ref(&moves))[1]["tracking_most_mm"]["value"].is_number());
}

#[test]
fn steps_that_follow_each_other_closely_are_moves_of_their_own() {
    let staircase = |t: f64| 10.0 * (t / 0.04).floor().min(4.0);
    let moves = evaluated(&transient(staircase, |_| 0.0, 1000));
    assert_eq!(moves.len(), 5, "four steps are no profile");
    assert!(moves.iter().all(|one| one.tracking.is_none()));
}

/// A drive that follows a sine about its setpoint half a millimetre off, and stands there afterwards.
#[test]
fn a_profile_that_leaves_its_way_has_no_rise_and_no_overshoot() {
    let setpoint = |t: f64| {
        let swing = (std::f64::consts::TAU * (t - 0.2)).sin();
        50.0 + if (0.2..1.2).contains(&t) { 20.0 * swing } else { 0.0 }
    };
    let moves = evaluated(&transient(setpoint, |t| setpoint(t) + 0.5, 2000));
    let last = moves.last().expect("a move");
    near(Some(last.tracking.expect("of a profile").most_mm), 0.5, 0.02);
    assert_eq!((last.rise_s, last.overshoot_mm, last.settling_s), (None, None, None));
}
