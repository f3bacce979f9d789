//! The sequencer: the setpoint in force at sample k, and whether the axis has reached it.
//!
//! A move is in force at sample k if its time is <= k * period (DESIGN section 4). The times become sample numbers
//! once, when the sequence is made, so a sample compares integers.
//!
//! With [`MotionConfig::on_arrival`] a move also waits for the end of the one before. In the thesis (6.3.2), the
//! second interrupt checks the position dead band and the forced exit, and the new position is in effect at the next
//! sample. A move ends
//!
//! - `dwell` after it has arrived: at the first sample inside the tolerance (fast stop, `monitoring` = 0), or after
//!   `monitoring` consecutive samples inside it (exact stop);
//! - or at the forced exit, arrived or not.
//!
//! At such an exit the thesis has a new position but no spool command: the valve of a closed loop keeps its command
//! for one period.
//!
//! A sequence may repeat: its moves come again, round after round, until the run is over.
//!
//! Before the first move a closed loop holds the count of sample k = 0, and an open loop is at null.
//!
//! A move may have a [`Profile`], the course of its setpoint. Its next setpoint can be computed ahead, between two
//! samples ([`crate::State::prepare`]); a sample that finds none computes it. A move with an unfinished profile has
//! not arrived. The next move, or the end of the run, cuts a profile short.

use crate::profile::{Point, Profile, Progress, Waypoint};
pub use crate::sequence::{MAX_MOVES, Move, Sequence, SequenceError};

/// When a move counts as complete, and what follows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MotionConfig {
    /// Whether a move waits for the end of the one before.
    pub on_arrival: bool,
    /// Errors up to this count as arrived, counts.
    pub tolerance: u32,
    /// Consecutive samples inside the tolerance that an exact stop takes; 0: a fast stop.
    pub monitoring: u32,
    /// From the arrival to the end of the move, samples.
    pub dwell: u32,
    /// A move ends after this many samples, arrived or not.
    pub forced_exit: u32,
    /// What is fed forward of a profile.
    pub feed_forward: FeedForward,
}

/// The contribution of the setpoint's motion to the sum of the law, in the units of its feedback gains (see
/// [`crate::law`]).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FeedForward {
    /// On counts a sample: the gain of a velocity window times the window.
    pub velocity: u32,
    /// On counts per sample squared: the gain times both windows.
    pub acceleration: u32,
}

impl FeedForward {
    /// The sum at a sample of a profile. Factors of 31 + 22 and 31 + 28 bits: exact in 64, then rounded down from 2^-12.
    fn sum(self, waypoint: &Waypoint) -> i64 {
        let velocity = i64::from(self.velocity) * i64::from(waypoint.velocity);
        let acceleration = i64::from(self.acceleration) * i64::from(waypoint.acceleration);
        (velocity + acceleration) >> 12
    }
}

/// The state of the move in force.
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

/// The next sample of a profile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct NextSample {
    setpoint: i32,
    feed_forward: i64,
    point: Point,
    last: bool,
}

/// The progress of a run in its sequence.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sequencer {
    taken: u32,
    /// The run is over after this sample, which can still be counted.
    last: u32,
    next_move: usize,
    /// Place of the move whose profile began last.
    in_force: usize,
    /// Sample at which the round of the next move begins.
    round_at: u32,
    /// The next move is due at this sample; `u32::MAX`, which no run reaches: there is none.
    next_at: u32,
    next_target: i32,
    next_is_profile: bool,
    setpoint: i32,
    /// The law's feed-forward for the motion of the setpoint.
    feed_forward: i64,
    /// Whether the profile of the move in force is under way.
    follows: bool,
    /// Whether `ahead` belongs to the next sample.
    prepared: bool,
    ahead: NextSample,
    progress: Progress,
    arrival: Arrival,
    /// Moves that ended without arriving.
    not_reached: u32,
    /// The values of `taken` when the move in force began, when the axis was last outside, and when it arrived. Times
    /// are differences of these, so nothing else is counted.
    begun_at: u32,
    outside_at: u32,
    arrived_at: u32,
    ended: bool,
    /// The value of `taken` at the last exit.
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
        let begins_with_ramp =
            sequence.moves().first().is_some_and(|first| matches!(first.profile, Profile::Ramp(_)));
        if closed && (sequencer.next_at > 0 || begins_with_ramp) {
            sequencer.holds_first = true;
            sequencer.next_at = 0;
        }
        sequencer
    }

    /// Takes sample k, with the axis at `position`. Returns whether it ends a move at rest.
    pub(crate) fn advance(&mut self, config: &MotionConfig, sequence: &Sequence, position: i32) -> bool {
        let mut rested = false;
        if self.is_due(config) {
            rested = self.move_on(config, sequence, position);
        } else if self.follows {
            self.follow(config, sequence);
        }
        self.taken = self.taken.wrapping_add(1); // A run is over before.
        rested
    }

    /// Goes on along the profile of the move in force.
    #[inline(always)]
    fn follow(&mut self, config: &MotionConfig, sequence: &Sequence) {
        if !self.prepared {
            self.work_out(config, sequence);
        }
        self.prepared = false;
        self.setpoint = self.ahead.setpoint;
        self.feed_forward = self.ahead.feed_forward;
        self.follows = !self.ahead.last;
        // Up to the last sample of a profile an axis has not arrived, however close it is.
        self.outside_at = self.taken.wrapping_add(u32::from(self.follows));
    }

    /// Computes the next setpoint of a profile ahead of its sample.
    #[inline(always)]
    pub(crate) fn prepare(&mut self, config: &MotionConfig, sequence: &Sequence) {
        if self.follows && !self.prepared {
            self.work_out(config, sequence);
        }
    }

    #[cold]
    #[inline(never)]
    fn work_out(&mut self, config: &MotionConfig, sequence: &Sequence) {
        let Some(Move { target, profile, .. }) = sequence.get(self.in_force) else { return };
        let waypoint = self.progress.advance(profile, *target);
        let feed_forward = config.feed_forward.sum(&waypoint);
        let Waypoint { setpoint, point, last, .. } = waypoint;
        self.ahead = NextSample { setpoint, feed_forward, point, last };
        self.prepared = true;
    }

    /// Keeps the setpoint where it is from here on.
    pub(crate) fn stand(&mut self) {
        self.follows = false;
        self.feed_forward = 0;
    }

    /// Whether the next move is due and need not wait for the end of the one before.
    fn is_due(&self, config: &MotionConfig) -> bool {
        self.taken >= self.next_at && (!config.on_arrival || self.arrival == Arrival::Idle || self.ended)
    }

    /// Begins the moves that are due; the last of them holds. Returns whether the one before is at rest.
    #[cold]
    #[inline(never)]
    fn move_on(&mut self, config: &MotionConfig, sequence: &Sequence, position: i32) -> bool {
        if self.holds_first {
            self.holds_first = false;
            self.setpoint = position;
            self.look_ahead(sequence);
            if !self.is_due(config) {
                return false;
            }
        }
        let mut rested = false;
        loop {
            rested |= self.close();
            self.begin(sequence);
            self.look_ahead(sequence);
            if !self.is_due(config) {
                return rested;
            }
        }
    }

    /// Finds the next move, in this round or the one after it.
    fn look_ahead(&mut self, sequence: &Sequence) {
        if self.next_move >= sequence.len() && sequence.round() > 0 {
            self.next_move = 0;
            self.round_at = self.round_at.saturating_add(sequence.round());
        }
        self.next_at = u32::MAX;
        if let Some(next) = sequence.get(self.next_move) {
            self.next_at = self.round_at.saturating_add(next.at_sample);
            self.next_target = next.target;
            self.next_is_profile = !matches!(next.profile, Profile::Step);
        }
    }

    fn begin(&mut self, sequence: &Sequence) {
        let before = core::mem::replace(&mut self.setpoint, self.next_target);
        self.follows = self.next_is_profile;
        self.feed_forward = 0;
        self.arrival = Arrival::Moving;
        self.begun_at = self.taken;
        self.outside_at = self.taken;
        self.ended = false;
        if self.follows {
            self.begin_profile(sequence, before);
        }
        self.next_move += 1;
    }

    /// Begins a step to `target` with the next sample. Returns whether the move before it is at rest.
    pub(crate) fn redirect(&mut self, target: i32) -> bool {
        let rested = self.close();
        self.stand();
        self.setpoint = target;
        self.arrival = Arrival::Moving;
        self.begun_at = self.taken;
        self.outside_at = self.taken;
        self.ended = false;
        rested
    }

    #[cold]
    #[inline(never)]
    fn begin_profile(&mut self, sequence: &Sequence, before: i32) {
        let Some(Move { profile, .. }) = sequence.get(self.next_move) else { return };
        self.in_force = self.next_move;
        self.progress = Progress::new(profile, before, self.next_target);
        self.setpoint = self.progress.first();
        self.ahead.point = Point::at(self.setpoint);
        self.prepared = false;
        self.outside_at = self.taken.wrapping_add(1);
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
    pub(crate) fn is_at_exit(&self) -> bool {
        self.exit_at == self.taken
    }

    /// Whether the move in force has dwelt for long enough, or has taken too long.
    fn is_through(&self, config: &MotionConfig) -> bool {
        let rested = self.arrival == Arrival::Arrived && self.taken - self.arrived_at >= config.dwell;
        rested || self.taken - self.begun_at >= config.forced_exit
    }

    /// Ends the move in force; one that has not arrived by now is not reached. Returns whether the move has arrived
    /// and is still inside its tolerance.
    pub(crate) fn close(&mut self) -> bool {
        if self.arrival == Arrival::Moving {
            self.arrival = Arrival::NotReached;
            self.not_reached = self.not_reached.saturating_add(1);
        }
        self.arrival == Arrival::Arrived && self.taken > self.outside_at
    }

    /// The state of the move in force.
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
        let rounds = self.round_at.checked_div(sequence.round()).unwrap_or(0);
        rounds.saturating_mul(sequence.len() as u32).saturating_add(self.next_move as u32)
    }

    /// The setpoint last in force.
    pub(crate) fn setpoint(&self) -> i32 {
        self.setpoint
    }

    /// The law's feed-forward for the motion of that setpoint, in the units of its sum.
    pub(crate) fn feed_forward(&self) -> i64 {
        self.feed_forward
    }

    /// Where a profile is at the sample taken last, while one is under way.
    pub(crate) fn point(&self) -> Option<Point> {
        self.follows.then_some(self.ahead.point)
    }

    /// Samples taken: k of the next one.
    pub(crate) fn taken(&self) -> u32 {
        self.taken
    }

    /// Whether the last sample of the run has been taken, or the last move that others wait for has ended.
    pub(crate) fn is_over(&self, config: &MotionConfig, sequence: &Sequence) -> bool {
        let through = config.on_arrival && self.ended && self.next_move >= sequence.len();
        through || self.taken > self.last
    }
}

#[cfg(test)]
mod tests;
