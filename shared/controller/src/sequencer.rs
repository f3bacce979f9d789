//! Moves: which setpoint is in force at sample k, and whether the axis has come there.
//!
//! A move whose time is <= k * period is in force at sample k (DESIGN section 4). The times are
//! turned into sample numbers once, when the sequence is made, so that a sample compares integers.
//!
//! With [`MotionConfig::on_arrival`] a move also waits for the end of the one before (thesis 6.3.2: the
//! position dead band and the forced exit are checked at the second interrupt, and the new position is
//! in effect at the next sample). A move ends
//!
//! - `dwell` after it has arrived: at the first sample inside the tolerance (fast stop, `monitoring` = 0),
//!   or after `monitoring` samples on end inside it (exact stop);
//! - or at the forced exit, arrived or not.
//!
//! At such an exit the thesis has the new position only, and no spool command: the valve of a closed loop stays as it is for
//! a period.
//!
//! A sequence may repeat: its moves come again and again, a round after the other, until the run is over.
//!
//! Before the first move a closed loop holds the count of sample k = 0, and an open loop is at null.

/// The most moves one sequence holds.
pub const MAX_MOVES: usize = 64;

/// From sample `at_sample` on, `target` is the setpoint.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Move {
    /// First sample at which the move is in force.
    pub at_sample: u32,
    /// Setpoint in encoder counts (closed loop) or command in valve counts (open loop).
    pub target: i32,
}

impl Move {
    /// A move at `time_us` for a sample period of `period_us`: in force from the first sample at or
    /// after that time.
    #[must_use]
    pub fn at_time_us(time_us: u32, period_us: core::num::NonZeroU32, target: i32) -> Move {
        Move { at_sample: time_us.div_ceil(period_us.get()), target }
    }
}

/// Why a sequence was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SequenceError {
    /// It holds [`MAX_MOVES`] moves already.
    Full,
    /// A move lies before its predecessor, or not within the round that repeats; moves come in order of time.
    OutOfOrder,
}

/// A list of moves in order of time, and the length of the run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sequence {
    moves: [Move; MAX_MOVES],
    len: usize,
    /// Length of a round, samples; 0: the moves come once.
    round: u32,
    /// Samples of the run: the run is done after sample number `duration_samples`.
    pub duration_samples: u32,
    /// What is held before the first move, instead of the count of sample k = 0: older firmware held 0, and its
    /// records are replayed so. Unit: counts.
    pub held_first: Option<i32>,
}

impl Default for Sequence {
    fn default() -> Self {
        let moves = [Move::default(); MAX_MOVES];
        Sequence { moves, len: 0, round: 0, duration_samples: 0, held_first: None }
    }
}

impl Sequence {
    /// An empty sequence of `duration_samples` samples.
    #[must_use]
    pub fn new(duration_samples: u32) -> Sequence {
        Sequence { duration_samples, ..Sequence::default() }
    }

    /// The moves, in order of time.
    #[must_use]
    pub fn moves(&self) -> &[Move] {
        self.moves.get(..self.len).unwrap_or(&[])
    }

    /// The moves come again every `round` samples; 0: they come once.
    ///
    /// # Errors
    /// When a move lies at the end of the round or behind it.
    pub fn repeat_every(&mut self, round: u32) -> Result<(), SequenceError> {
        if self.moves().last().is_some_and(|last| !is_within(last, round)) {
            return Err(SequenceError::OutOfOrder);
        }
        self.round = round;
        Ok(())
    }

    /// Length of a round, samples; 0: the moves come once.
    #[must_use]
    pub fn round(&self) -> u32 {
        self.round
    }

    /// Appends a move.
    ///
    /// # Errors
    /// When the sequence is full, or the move lies before the last one or not within the round.
    pub fn push(&mut self, next: Move) -> Result<(), SequenceError> {
        let too_early = self.moves().last().is_some_and(|last| next.at_sample < last.at_sample);
        if too_early || !is_within(&next, self.round) {
            return Err(SequenceError::OutOfOrder);
        }
        let slot = self.moves.get_mut(self.len).ok_or(SequenceError::Full)?;
        *slot = next;
        self.len += 1;
        Ok(())
    }
}

/// Whether a move lies within a round of this length.
fn is_within(next: &Move, round: u32) -> bool {
    round == 0 || next.at_sample < round
}

/// When a move counts as complete, and what follows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MotionConfig {
    /// Whether a move waits for the end of the one before.
    pub on_arrival: bool,
    /// An error of this much is inside, counts.
    pub tolerance: u32,
    /// Samples on end inside the tolerance that an exact stop takes; 0: a fast stop.
    pub monitoring: u32,
    /// From the arrival to the end of the move, samples.
    pub dwell: u32,
    /// A move ends after so many samples, arrived or not.
    pub forced_exit: u32,
    /// A command is given at an exit, too: older firmware did so, and its records are replayed so.
    pub commands_at_exit: bool,
}

/// How the move in force stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Arrival {
    /// There is no move in force.
    #[default]
    Idle,
    /// On its way.
    Moving,
    /// Arrived.
    Arrived,
    /// The forced exit, the next move or the end of the run came first.
    NotReached,
}

/// Where a run stands in its sequence.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sequencer {
    taken: u32,
    /// The run is over behind this sample, which can still be counted.
    last: u32,
    next_move: usize,
    /// Sample at which the round of the next move begins.
    round_at: u32,
    /// The next move is due at this sample; `u32::MAX`, which no run reaches: there is none.
    next_at: u32,
    next_target: i32,
    setpoint: i32,
    arrival: Arrival,
    /// Moves that ended without arriving.
    not_reached: u32,
    /// What `taken` was when the move in force began, when it was last outside, and when it arrived: what
    /// has passed since is a difference, and nothing need be counted.
    begun_at: u32,
    outside_at: u32,
    arrived_at: u32,
    ended: bool,
    /// What `taken` was at the last exit.
    exit_at: u32,
    /// Whether the first sample is to be held until the first move.
    holds_first: bool,
}

impl Sequencer {
    /// At the beginning of a run. `closed`: moves are positions, and the first one is held until they come.
    pub(crate) fn new(sequence: &Sequence, closed: bool) -> Sequencer {
        let last = sequence.duration_samples.min(u32::MAX - 1);
        let mut sequencer = Sequencer { last, ..Sequencer::default() };
        sequencer.look_ahead(sequence);
        if closed && sequencer.next_at > 0 {
            sequencer.holds_first = true;
            sequencer.next_at = 0;
        }
        sequencer
    }

    /// Takes sample k, at which the axis is at `position`. Whether it ends a move that rests.
    pub(crate) fn advance(&mut self, config: &MotionConfig, sequence: &Sequence, position: i32) -> bool {
        let rested = self.is_due(config) && self.move_on(config, sequence, position);
        self.taken = self.taken.wrapping_add(1); // A run is over before.
        rested
    }

    /// Whether the time of the next move has come, and it need not wait for the end of the one before.
    fn is_due(&self, config: &MotionConfig) -> bool {
        self.taken >= self.next_at && (!config.on_arrival || self.arrival == Arrival::Idle || self.ended)
    }

    /// Begins the moves that are due, of which the last one holds. Whether one before it rests.
    #[cold]
    #[inline(never)]
    fn move_on(&mut self, config: &MotionConfig, sequence: &Sequence, position: i32) -> bool {
        let mut rested = false;
        if self.holds_first {
            self.holds_first = false;
            self.setpoint = sequence.held_first.unwrap_or(position);
            self.look_ahead(sequence);
        }
        while self.is_due(config) {
            rested |= self.close();
            self.begin();
            self.look_ahead(sequence);
        }
        rested
    }

    /// Finds the next move, in this round or the one after it.
    fn look_ahead(&mut self, sequence: &Sequence) {
        if self.next_move >= sequence.len && sequence.round > 0 {
            self.next_move = 0;
            self.round_at = self.round_at.saturating_add(sequence.round);
        }
        self.next_at = u32::MAX;
        if let Some(next) = sequence.moves().get(self.next_move) {
            self.next_at = self.round_at.saturating_add(next.at_sample);
            self.next_target = next.target;
        }
    }

    fn begin(&mut self) {
        self.setpoint = self.next_target;
        self.next_move += 1;
        self.arrival = Arrival::Moving;
        self.begun_at = self.taken;
        self.outside_at = self.taken;
        self.ended = false;
    }

    /// Judges the move in force by the error at this sample.
    pub(crate) fn judge(&mut self, config: &MotionConfig, error: i32) {
        if error.unsigned_abs() > config.tolerance {
            self.outside_at = self.taken;
        }
        if self.arrival == Arrival::Moving && self.taken - self.outside_at > config.monitoring {
            self.arrival = Arrival::Arrived;
            self.arrived_at = self.taken;
        }
        if config.on_arrival && !self.ended && self.is_through(config) {
            self.ended = true;
            self.exit_at = self.taken;
            self.close();
        }
    }

    /// Whether the sample of a run that was judged last is an exit, at which no command is given.
    pub(crate) fn is_at_exit(&self, config: &MotionConfig) -> bool {
        self.exit_at == self.taken && !config.commands_at_exit
    }

    /// Whether the move in force has rested for its dwell, or has taken too long.
    fn is_through(&self, config: &MotionConfig) -> bool {
        let rested = self.arrival == Arrival::Arrived && self.taken - self.arrived_at >= config.dwell;
        rested || self.taken - self.begun_at >= config.forced_exit
    }

    /// What is not arrived by now has not been reached. Whether the move has arrived and is still inside
    /// its tolerance.
    pub(crate) fn close(&mut self) -> bool {
        if self.arrival == Arrival::Moving {
            self.arrival = Arrival::NotReached;
            self.not_reached = self.not_reached.saturating_add(1);
        }
        self.arrival == Arrival::Arrived && self.taken > self.outside_at
    }

    /// How the move in force stands.
    #[must_use]
    pub fn arrival(&self) -> Arrival {
        self.arrival
    }

    /// Moves of this run that ended without arriving.
    #[must_use]
    pub fn not_reached(&self) -> u32 {
        self.not_reached
    }

    /// Moves of this run that have begun; `sequence` is the one that it runs.
    #[must_use]
    pub fn begun(&self, sequence: &Sequence) -> u32 {
        let rounds = self.round_at.checked_div(sequence.round).unwrap_or(0);
        rounds.saturating_mul(sequence.len as u32).saturating_add(self.next_move as u32)
    }

    /// The setpoint last in force.
    pub(crate) fn setpoint(&self) -> i32 {
        self.setpoint
    }

    /// Samples taken: k of the next one.
    pub(crate) fn taken(&self) -> u32 {
        self.taken
    }

    /// Whether the last sample of the run has been taken, or the last move has ended that others wait
    /// for.
    pub(crate) fn is_over(&self, config: &MotionConfig, sequence: &Sequence) -> bool {
        let through = config.on_arrival && self.ended && self.next_move >= sequence.moves().len();
        through || self.taken > self.last
    }
}

#[cfg(test)]
mod tests {
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
        commands_at_exit: false,
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
            sequence.push(Move { at_sample, target }).expect("in order");
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
        assert_eq!(
            (sequencer.begun(&sequence), sequencer.not_reached()),
            (4, 3),
            "the last one is on its way"
        );
    }

    #[test]
    fn before_the_first_move_the_axis_stays_where_it_is_unless_something_else_is_said() {
        let mut late = sequence(&[(2, 7)], 9);
        assert_eq!(setpoints(&TIMED, &late, &[0, 9, 9]).0, [STANDS, STANDS, 7]);
        late.held_first = Some(0);
        assert_eq!(setpoints(&FAST, &late, &[0, 9, 9]).0, [0, 0, 7]);
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
        assert_eq!(round.push(Move { at_sample: 6, target: 0 }), Err(SequenceError::OutOfOrder));
        assert_eq!(round.repeat_every(0), Ok(()));
        assert_eq!(round.push(Move { at_sample: 6, target: 0 }), Ok(()));
    }

    #[test]
    fn moves_out_of_order_and_one_too_many_are_refused() {
        let mut full = Sequence::new(0);
        for at_sample in 0..MAX_MOVES as u32 {
            full.push(Move { at_sample, target: 0 }).expect("room for this many");
        }
        assert_eq!(full.push(Move { at_sample: 99, target: 0 }), Err(SequenceError::Full));
        assert_eq!(
            sequence(&[(5, 0)], 0).push(Move { at_sample: 4, target: 0 }),
            Err(SequenceError::OutOfOrder)
        );
        assert_eq!(full.moves().len(), MAX_MOVES);
    }
}
