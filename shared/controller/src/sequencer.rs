//! Timed moves: which setpoint is in force at sample k.
//!
//! A move whose time is <= k * period is in force at sample k (DESIGN section 4). The times are
//! turned into sample numbers once, when the sequence is made, so that a sample compares integers.

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
    /// A move lies before its predecessor; moves come in order of time.
    OutOfOrder,
}

/// A list of moves in order of time, and the length of the run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sequence {
    moves: [Move; MAX_MOVES],
    len: usize,
    /// Samples of the run: the run is done after sample number `duration_samples`.
    pub duration_samples: u32,
}

impl Default for Sequence {
    fn default() -> Self {
        Sequence { moves: [Move::default(); MAX_MOVES], len: 0, duration_samples: 0 }
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

    /// Appends a move.
    ///
    /// # Errors
    /// When the sequence is full, or the move lies before the last one.
    pub fn push(&mut self, next: Move) -> Result<(), SequenceError> {
        if self.moves().last().is_some_and(|last| next.at_sample < last.at_sample) {
            return Err(SequenceError::OutOfOrder);
        }
        let slot = self.moves.get_mut(self.len).ok_or(SequenceError::Full)?;
        *slot = next;
        self.len += 1;
        Ok(())
    }
}

/// Where a run stands in its sequence.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sequencer {
    taken: u32,
    next_move: usize,
    setpoint: i32,
}

impl Sequencer {
    /// Takes sample k and tells the setpoint in force at it: 0 before the first move.
    pub(crate) fn advance(&mut self, sequence: &Sequence) -> i32 {
        while let Some(due) = sequence.moves().get(self.next_move).filter(|m| m.at_sample <= self.taken) {
            self.setpoint = due.target;
            self.next_move += 1;
        }
        self.taken = self.taken.saturating_add(1);
        self.setpoint
    }

    /// The setpoint last in force.
    pub(crate) fn setpoint(&self) -> i32 {
        self.setpoint
    }

    /// k of the last sample taken.
    pub(crate) fn index(&self) -> u32 {
        self.taken.saturating_sub(1)
    }

    /// Whether the last sample of the run has been taken.
    pub(crate) fn is_over(&self, sequence: &Sequence) -> bool {
        self.taken > sequence.duration_samples
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::num::NonZeroU32;

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
        let mut sequencer = Sequencer::default();
        let setpoints: [i32; 6] = core::array::from_fn(|_| sequencer.advance(&sequence));
        assert_eq!(setpoints, [10, 10, 30, 30, 40, 40]);
        assert_eq!(sequencer.setpoint(), 40);
    }

    #[test]
    fn before_the_first_move_the_setpoint_is_zero() {
        let mut sequencer = Sequencer::default();
        assert_eq!(sequencer.advance(&sequence(&[(1, 7)], 9)), 0);
    }

    #[test]
    fn a_run_of_n_samples_ends_with_sample_n() {
        let sequence = sequence(&[(0, 1)], 3);
        let mut sequencer = Sequencer::default();
        let over: [bool; 4] = core::array::from_fn(|_| {
            sequencer.advance(&sequence);
            sequencer.is_over(&sequence)
        });
        assert_eq!(over, [false, false, false, true]);
        assert_eq!(sequencer.index(), 3);
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
