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
mod tests;
