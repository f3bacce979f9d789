extern crate std;
use super::*;
use core::num::NonZeroU32;
use std::vec::Vec;

const TIMED: MotionConfig = MotionConfig {
    on_arrival: false,
    tolerance: 2,
    monitoring: 0,
    dwell: 0,
    forced_exit: 100,
    feed_forward: FeedForward { velocity: 0, acceleration: 0 },
};
const FAST: MotionConfig = MotionConfig { on_arrival: true, ..TIMED };

/// Where the axis is.
const STANDS: i32 = 5;

/// The setpoints while an axis has these errors.
fn setpoints(config: &MotionConfig, sequence: &Sequence, errors: &[i32]) -> (Vec<i32>, Sequencer) {
    let mut sequencer = Sequencer::new(sequence, true);
    let seen = errors.iter().map(|&error| {
        sequencer.advance(config, sequence, STANDS);
        sequencer.judge(config, error);
        sequencer.setpoint()
    });
    (seen.collect(), sequencer)
}

fn sequence(moves: &[(u32, i32)], duration_samples: u32) -> Sequence {
    let mut sequence = Sequence::new(duration_samples);
    for &(at_sample, target) in moves {
        sequence.push(Move::step(at_sample, target)).expect("in order");
    }
    sequence
}

#[test]
fn a_move_is_in_force_at_the_first_sample_not_before_its_time() {
    let period = NonZeroU32::new(1300).expect("not zero");
    // 231 * 1300 us = 0.3003 s is the first sample at or after 0.3 s.
    assert_eq!(Move::at_time_us(300_000, period, 1).at_sample, 231);
    assert_eq!(Move::at_time_us(1_300, period, 1).at_sample, 1);
    assert_eq!(Move::at_time_us(1_301, period, 1).at_sample, 2);
    assert_eq!(Move::at_time_us(0, period, 1).at_sample, 0);
}

#[test]
fn the_last_of_the_due_moves_holds() {
    let sequence = sequence(&[(0, 10), (2, 20), (2, 30), (4, 40)], 100);
    let (setpoints, sequencer) = setpoints(&TIMED, &sequence, &[9; 6]);
    assert_eq!(setpoints, [10, 10, 30, 30, 40, 40]);
    assert_eq!((sequencer.begun(&sequence), sequencer.not_reached()), (4, 3), "the last one is on its way");
}

#[test]
fn before_the_first_move_the_axis_stays_where_it_is() {
    let late = sequence(&[(2, 7)], 9);
    for config in [&TIMED, &FAST] {
        assert_eq!(setpoints(config, &late, &[0, 9, 9]).0, [STANDS, STANDS, 7]);
    }
}

#[test]
fn a_run_of_n_samples_ends_with_sample_n() {
    let sequence = sequence(&[(0, 1)], 3);
    let mut sequencer = Sequencer::new(&sequence, true);
    let over: [bool; 4] = core::array::from_fn(|_| {
        sequencer.advance(&TIMED, &sequence, STANDS);
        sequencer.is_over(&TIMED, &sequence)
    });
    assert_eq!(over, [false, false, false, true]);
    assert_eq!(sequencer.taken(), 4);
}

#[test]
fn a_fast_stop_goes_on_at_the_sample_after_the_first_one_inside() {
    let sequence = sequence(&[(0, 10), (0, 20), (0, 30)], 100);
    let (setpoints, sequencer) = setpoints(&FAST, &sequence, &[10, 3, -2, 9, 2, 9]);
    assert_eq!(setpoints, [10, 10, 10, 20, 20, 30]);
    assert_eq!((sequencer.arrival(), sequencer.not_reached()), (Arrival::Moving, 0));
}

#[test]
fn an_exact_stop_must_stay_inside_for_the_monitoring_time() {
    let exact = MotionConfig { monitoring: 2, ..FAST };
    let sequence = sequence(&[(0, 10), (0, 20)], 100);
    let (setpoints, _) = setpoints(&exact, &sequence, &[0, 0, 9, 0, 0, 0, 9]);
    assert_eq!(setpoints, [10, 10, 10, 10, 10, 10, 20], "two samples inside are not enough");
}

#[test]
fn a_dwell_comes_between_the_arrival_and_the_next_move() {
    let dwell = MotionConfig { dwell: 3, ..FAST };
    let (setpoints, _) = setpoints(&dwell, &sequence(&[(0, 10), (0, 20)], 100), &[9, 0, 5, 5, 5, 5]);
    assert_eq!(setpoints, [10, 10, 10, 10, 10, 20], "arrived is arrived, also when it is pushed away");
}

#[test]
fn a_forced_exit_ends_a_move_that_does_not_arrive_and_says_so() {
    let forced = MotionConfig { forced_exit: 3, ..FAST };
    let sequence = sequence(&[(0, 10), (0, 20)], 100);
    let (seen, sequencer) = setpoints(&forced, &sequence, &[9, 9, 9, 9]);
    assert_eq!(seen, [10, 10, 10, 20]);
    assert_eq!(sequencer.not_reached(), 1);
    let (_, sequencer) = setpoints(&forced, &sequence, &[9, 9, 9, 9, 9, 9]);
    assert_eq!((sequencer.arrival(), sequencer.not_reached()), (Arrival::NotReached, 2));
    assert!(sequencer.is_over(&forced, &sequence), "the last move has ended");
}

#[test]
fn a_move_that_waits_for_the_one_before_also_waits_for_its_time() {
    let (setpoints, _) = setpoints(&FAST, &sequence(&[(0, 10), (4, 20)], 100), &[0; 6]);
    assert_eq!(setpoints, [10, 10, 10, 10, 20, 20]);
}

#[test]
fn a_timed_run_lasts_to_its_end_whatever_has_arrived() {
    let sequence = sequence(&[(0, 10)], 100);
    let (_, mut sequencer) = setpoints(&TIMED, &sequence, &[0; 5]);
    assert_eq!(sequencer.arrival(), Arrival::Arrived);
    assert!(!sequencer.is_over(&TIMED, &sequence));
    sequencer.close();
    assert_eq!((sequencer.arrival(), sequencer.not_reached()), (Arrival::Arrived, 0));
}

#[test]
fn moves_that_repeat_come_again_each_round_until_the_run_is_over() {
    let mut sequence = sequence(&[(1, 10), (3, 20)], 10);
    sequence.repeat_every(4).expect("behind the last move");
    let (setpoints, sequencer) = setpoints(&TIMED, &sequence, &[9; 11]);
    assert_eq!(setpoints, [STANDS, 10, 10, 20, 20, 10, 10, 20, 20, 10, 10]);
    assert_eq!((sequencer.begun(&sequence), sequencer.not_reached()), (5, 4));
    assert!(sequencer.is_over(&TIMED, &sequence));
}

#[test]
fn a_round_of_moves_that_wait_begins_once_the_last_one_has_ended_and_its_time_has_come() {
    let mut sequence = sequence(&[(0, 10), (0, 20)], 100);
    sequence.repeat_every(1).expect("behind the last move");
    let (setpoints, sequencer) = setpoints(&FAST, &sequence, &[9, 0, 9, 9, 0, 0, 0, 9]);
    assert_eq!(setpoints, [10, 10, 20, 20, 20, 10, 20, 10], "the round is late and goes on at once");
    assert!(!sequencer.is_over(&FAST, &sequence));
    sequence.repeat_every(7).expect("behind the last move");
    let (setpoints, _) = super::tests::setpoints(&FAST, &sequence, &[0; 9]);
    assert_eq!(setpoints, [10, 20, 20, 20, 20, 20, 20, 10, 20], "the round waits for its time");
}

#[test]
fn rounds_go_on_to_the_last_sample_that_can_be_counted() {
    let mut sequence = sequence(&[(0, 10), (2, 20)], u32::MAX - 1);
    sequence.repeat_every(4).expect("behind the last move");
    let mut sequencer = Sequencer::new(&sequence, true);
    sequencer.taken = u32::MAX - 7;
    sequencer.round_at = u32::MAX - 7;
    sequencer.look_ahead(&sequence);
    let mut seen = Vec::new();
    while !sequencer.is_over(&TIMED, &sequence) {
        sequencer.advance(&TIMED, &sequence, STANDS);
        seen.push(sequencer.setpoint());
    }
    assert_eq!(seen, [10, 10, 20, 20, 10, 10, 20]);
}

/// The rounds at the end of the count began again and again within one sample, and the run had no end.
#[test]
fn a_run_of_as_many_samples_as_there_are_numbers_ends_with_the_last_one_that_can_be_counted() {
    for moves in [&[(0, 10)][..], &[(0, 10), (1, 20)]] {
        let mut sequence = sequence(moves, u32::MAX);
        sequence.repeat_every(2).expect("behind the last move");
        let mut sequencer = Sequencer::new(&sequence, true);
        sequencer.taken = u32::MAX - 5;
        sequencer.round_at = u32::MAX - 5;
        sequencer.next_move = 0;
        sequencer.look_ahead(&sequence);
        let mut samples = 0;
        while !sequencer.is_over(&TIMED, &sequence) {
            sequencer.advance(&TIMED, &sequence, STANDS);
            samples += 1;
            assert!(samples <= 5, "samples MAX - 5 to MAX - 1");
        }
        assert_eq!(samples, 5);
    }
}

#[test]
fn a_move_behind_the_end_of_its_round_is_refused() {
    let mut round = sequence(&[(5, 0)], 9);
    assert_eq!(round.repeat_every(5), Err(SequenceError::OutOfOrder));
    assert_eq!(round.repeat_every(6), Ok(()));
    assert_eq!(round.push(Move::step(6, 0)), Err(SequenceError::OutOfOrder));
    assert_eq!(round.repeat_every(0), Ok(()));
    assert_eq!(round.push(Move::step(6, 0)), Ok(()));
}

#[test]
fn moves_out_of_order_and_one_too_many_are_refused() {
    let mut full = Sequence::new(0);
    for at_sample in 0..MAX_MOVES as u32 {
        full.push(Move::step(at_sample, 0)).expect("room for this many");
    }
    assert_eq!(full.push(Move::step(99, 0)), Err(SequenceError::Full));
    assert_eq!(sequence(&[(5, 0)], 0).push(Move::step(4, 0)), Err(SequenceError::OutOfOrder));
    assert_eq!(full.moves().len(), MAX_MOVES);
}

#[test]
fn a_sequence_tells_after_how_many_samples_its_moves_come_again() {
    let mut sequence = sequence(&[(0, 5), (6, 7)], 100);
    assert_eq!(sequence.round(), 0, "once");
    assert_eq!(sequence.repeat_every(6), Err(SequenceError::OutOfOrder), "the second move is not within it");
    sequence.repeat_every(7).expect("both are");
    assert_eq!(sequence.round(), 7);
}

#[test]
fn a_setpoint_from_outside_is_the_step_that_a_sequence_with_it_would_have() {
    for config in [TIMED, FAST] {
        let whole = sequence(&[(0, 10), (3, 20), (5, 30)], 100);
        let errors = [9, 1, 0, 9, 1, 9, 9, 0];
        let (expected, as_moves) = setpoints(&TIMED, &whole, &errors);
        let outside = sequence(&[(0, 10)], 100);
        let mut sequencer = Sequencer::new(&outside, true);
        for (k, (&error, &setpoint)) in errors.iter().zip(&expected).enumerate() {
            // At sample 3 the axis rests inside its tolerance, at sample 5 as well.
            if k == 3 || k == 5 {
                assert!(sequencer.redirect(setpoint), "sample {k}");
            }
            sequencer.advance(&config, &outside, STANDS);
            sequencer.judge(&config, error);
            assert_eq!(sequencer.setpoint(), setpoint, "sample {k}");
        }
        assert_eq!(
            (sequencer.arrival(), sequencer.not_reached()),
            (as_moves.arrival(), as_moves.not_reached())
        );
    }
}

#[test]
fn a_setpoint_from_outside_ends_a_profile_and_a_move_on_its_way_is_not_reached() {
    let mut ramp = Sequence::new(100);
    let profile = Profile::Ramp(crate::profile::Ramp::new(20, 1, 1).expect("short"));
    ramp.push(Move { at_sample: 0, target: 1000, profile }).expect("the first");
    let feeds = MotionConfig { feed_forward: FeedForward { velocity: 4096, acceleration: 0 }, ..TIMED };
    let mut sequencer = Sequencer::new(&ramp, true);
    for _ in 0..5 {
        sequencer.advance(&feeds, &ramp, STANDS);
        sequencer.judge(&feeds, 500);
    }
    assert_ne!(sequencer.feed_forward(), 0, "it is on its way");
    assert!(!sequencer.redirect(42));
    for _ in 0..5 {
        sequencer.advance(&feeds, &ramp, STANDS);
        assert_eq!((sequencer.setpoint(), sequencer.feed_forward()), (42, 0));
        sequencer.judge(&feeds, 0);
    }
    assert_eq!((sequencer.arrival(), sequencer.not_reached()), (Arrival::Arrived, 1));
}
