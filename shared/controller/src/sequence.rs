//! The moves of a test: time, target and profile of each.

use crate::limits::Limits;
use crate::profile::Profile;
use crate::supervisor::Refusal;

/// Most moves of a sequence.
pub const MAX_MOVES: usize = 64;

/// From sample `at_sample` on, `target` is the setpoint.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Move {
    /// First sample at which the move is in force.
    pub at_sample: u32,
    /// Setpoint in encoder counts (closed loop) or command in valve counts (open loop).
    pub target: i32,
    /// The course of the setpoint to it.
    pub profile: Profile,
}

impl Move {
    /// A step to a target.
    #[must_use]
    pub const fn step(at_sample: u32, target: i32) -> Move {
        Move { at_sample, target, profile: Profile::Step }
    }

    /// The lowest and the highest setpoint of the move; that of a ramp begins where the move before ends.
    #[must_use]
    pub fn extremes(&self) -> [i32; 2] {
        let amplitude = self.profile.amplitude();
        [self.target.saturating_sub_unsigned(amplitude), self.target.saturating_add_unsigned(amplitude)]
    }

    /// A move at `time_us` for a sample period of `period_us`: in force from the first sample at or
    /// after that time.
    #[must_use]
    pub fn at_time_us(time_us: u32, period_us: core::num::NonZeroU32, target: i32) -> Move {
        Move::step(time_us.div_ceil(period_us.get()), target)
    }
}

/// Why a sequence was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SequenceError {
    /// It holds [`MAX_MOVES`] moves already.
    Full,
    /// A move lies before its predecessor, or outside the round that repeats. Moves come in order of time.
    OutOfOrder,
}

/// A list of moves in order of time, and the length of the run.
///
/// ```
/// use pneudrive_controller::profile::Ramp;
/// use pneudrive_controller::sequence::SequenceError;
/// use pneudrive_controller::{Move, Profile, Sequence};
///
/// // To 8000 counts at once, and back by an S-curve of at most 8000 counts in 500 samples.
/// let back = Profile::Ramp(Ramp::new(500, 100, 20).expect("lengths in their range"));
/// let mut sequence = Sequence::new(3000);
/// sequence.push(Move::step(0, 8000))?;
/// sequence.push(Move { profile: back, ..Move::step(1000, 0) })?;
/// assert_eq!(back.samples(), 500 + 100 + 20 - 2);
/// assert_eq!(sequence.push(Move::step(999, 50)), Err(SequenceError::OutOfOrder));
/// # Ok::<(), SequenceError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sequence {
    moves: [Move; MAX_MOVES],
    len: usize,
    /// Length of a round, samples; 0: the moves come once.
    round: u32,
    /// Samples of the run: the run is done after sample number `duration_samples`.
    pub duration_samples: u32,
}

impl Default for Sequence {
    // One copy of the loop over all moves: where it is inlined, it is unrolled to 400 bytes each time.
    #[inline(never)]
    fn default() -> Self {
        let moves = [Move::step(0, 0); MAX_MOVES];
        Sequence { moves, len: 0, round: 0, duration_samples: 0 }
    }
}

impl Sequence {
    /// An empty sequence of `duration_samples` samples.
    #[must_use]
    pub fn new(duration_samples: u32) -> Sequence {
        Sequence { duration_samples, ..Sequence::default() }
    }

    /// Makes it a sequence of one move, without a copy of the whole.
    pub fn become_one(&mut self, only: Move, duration_samples: u32) {
        (self.len, self.round) = (1, 0);
        self.duration_samples = duration_samples;
        if let Some(first) = self.moves.first_mut() {
            *first = only;
        }
    }

    /// The moves, in order of time.
    #[must_use]
    pub fn moves(&self) -> &[Move] {
        self.moves.get(..self.len).unwrap_or(&[])
    }

    /// The move at a place.
    pub(crate) fn get(&self, place: usize) -> Option<&Move> {
        if place < self.len { self.moves.get(place) } else { None }
    }

    /// How many moves there are.
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// Repeats the moves every `round` samples; 0: they come once.
    ///
    /// # Errors
    /// When a move lies at the end of the round or after it.
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

    /// Whether a run may begin with these moves. `closed`: they are positions.
    ///
    /// # Errors
    /// When there are no moves, or a setpoint of a closed loop lies beyond a soft limit.
    pub(crate) fn check(&self, limits: &Limits, closed: bool) -> Result<(), Refusal> {
        let moves = self.moves();
        if moves.is_empty() {
            Err(Refusal::NoMoves)
        } else if closed && !moves.iter().flat_map(Move::extremes).all(|end| limits.allows(end)) {
            Err(Refusal::BeyondSoftLimit)
        } else {
            Ok(())
        }
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
