//! Rest: when a load at the end of its trajectory rests, and the force that holds it, on dry friction and on bristles alike.
//!
//! ```text
//! held       Fh' = 16/(mm s) Fc e  beyond 20 um          Fh within s Fc of M w + f + d; within 0.4 of that to begin with
//! at rest    g = f (Fh - 50/s M/A v - F)                 neither K v nor what the flow observer missed; f/8 while nothing moves
//! ```
//!
//! Friction that holds a load at rest is never less than that of one that slides. So a force within the running friction moves
//! no load that stands: it only bends what holds it. With its valve left to the force alone the air is a spring that takes energy
//! away, and the second term takes more. So a load at rest does not swing, whatever friction is, and whatever error is left.
//!
//! A load that has not come to rest 100 ms after the end of its trajectory sets off again: it swings about another place than its target.
//! One that turns more than twice after the end of its trajectory is on friction that gives way like a spring, or on a model that is
//! wrong. Each further turn lets it rest twice as far from its target, at first within 40 um, at last within 0.64 mm. What was
//! learned so is kept until the next start, or beyond it (`kept`). A load that has come to stand 0.2 mm off its target is moved once more, four times at
//! most, and pushed with the stiction; one that moves farther off than 0.9 mm, or without bristles by 60 um, sets off again.

use super::motion::Motion;
use super::number::{product, samples, within};
use crate::fixed::quotient;
use crate::parameters::{Parameters, id};

/// Turns that are not due to bristles: beyond the target, and back.
const FIRST_TURNS: u32 = 2;
/// What the looseness goes up to.
const LOOSEST: u32 = 4;
/// How often a load that stands off its target is moved once more.
const TRIES: u32 = 4;

/// Thresholds and rates.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Constants {
    /// 6, 10, 30 and 100 ms, samples.
    still: u32,
    asleep: u32,
    settled: u32,
    pub(super) overdue: u32,
    /// 3 and 5 mm/s, Q16.
    turning: i32,
    pub(super) slow: i32,
    /// 20, 40 and 60 um, 0.2 and 0.9 mm, counts.
    close: u32,
    pub(super) near: u32,
    slipped: u32,
    off: u32,
    pub(super) away: u32,
    /// 50/s, Q16 a sample.
    damper: i32,
    /// Force a sample (Q24) for a count of error, Q8.
    pull: i32,
    /// A rate that is not worth a move of the valve, Q24 a sample.
    pub(super) least: i32,
}

/// What is known of how it comes to rest, and for how long it has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rest {
    /// Where the load came to rest, counts, and for how many samples it has rested.
    stood: i32,
    rested: u32,
    /// Turns after the end of a trajectory to this target, and the sign of the last.
    turns: u32,
    turned: i32,
    /// How far from a target it rests: the distance doubles with each.
    pub looseness: u32,
    tries: u32,
}

impl Constants {
    /// `speed` is a m/s in counts a sample, Q16.
    pub(super) fn of(parameters: &Parameters, period_us: u32, count_pm: u64, speed: i32) -> Constants {
        let counts = |um: u64| quotient(um * 1_000_000, count_pm) as u32;
        let period = u64::from(period_us);
        let friction = [id::CASCADE_COULOMB_EXTEND, id::CASCADE_COULOMB_RETRACT];
        let [extend, retract] = friction.map(|id| u64::from(parameters.scalar(id).unsigned_abs()));
        let coulomb = (extend + retract) / 2;
        let most = |value: u64| value.min(1 << 30) as i32;
        Constants {
            still: samples(6000, period_us).max(4),
            asleep: samples(10_000, period_us),
            settled: samples(30_000, period_us),
            overdue: samples(100_000, period_us),
            turning: product(speed, 197, 16),
            slow: product(speed, 328, 16),
            close: counts(20),
            near: counts(40).max(1),
            slipped: counts(60).max(2),
            off: counts(200).max(2),
            away: counts(900),
            damper: most(quotient(3277 * period, 1000)),
            // 16/(mm s) Fc T x in Q32, x: a count in pm.
            pull: most(quotient(quotient(coulomb * count_pm, 1_000_000) * 4096 * period, 1_000_000_000)),
            least: most(quotient(604 * period, 1000)),
        }
    }

    /// D v: an acceleration, counts a sample squared, Q16.
    pub(super) fn slowed(&self, speed: i32) -> i32 {
        product(speed, self.damper, 16)
    }

    /// What the force that holds a load changes by in a sample, for an error.
    pub(super) fn pulled(&self, error: i32) -> i32 {
        if error.unsigned_abs() > self.close { product(self.pull, within(error, 1 << 15), 8) } else { 0 }
    }
}

impl Rest {
    /// A new target.
    pub(super) fn aim(&mut self) {
        (self.turns, self.tries) = (0, 0);
    }

    /// A trajectory begins with this motion.
    pub(super) fn set_off(&mut self, motion: &Motion) {
        self.turned = motion.v.signum();
    }

    /// The load comes to rest at a count.
    pub(super) fn begin(&mut self, count: i32) {
        (self.stood, self.rested) = (count, 0);
    }

    /// A sample after the end of a trajectory: whether the load stands, or is slow where it shall be. `over` is since when.
    pub(super) fn has_come(&mut self, constants: &Constants, motion: &Motion, over: u32, error: u32) -> bool {
        let (speed, sign) = (motion.v.saturating_abs(), motion.v.signum());
        if speed > constants.turning && sign != self.turned {
            (self.turns, self.turned) = (self.turns.saturating_add(1), sign);
            if self.turns > FIRST_TURNS {
                self.looseness = (self.looseness + 1).min(LOOSEST);
            }
        }
        let slow = (constants.slow / 4).saturating_mul(4 + self.looseness as i32);
        let wait = if self.is_loose() { 0 } else { constants.still };
        motion.still >= constants.still
            || over > wait && speed < slow && error < constants.near.saturating_mul(1 << self.looseness)
    }

    /// A sample at rest: whether the load has to set off again.
    pub(super) fn is_lost(
        &mut self,
        constants: &Constants,
        motion: &mut Motion,
        count: i32,
        error: u32,
    ) -> bool {
        self.rested = self.rested.saturating_add(1);
        motion.stuck = motion.still > constants.asleep;
        let settled = self.rested > constants.settled;
        let moved = motion.still == 0 && !self.is_loose() && count.abs_diff(self.stood) > constants.slipped;
        if !motion.stuck && error > constants.away || settled && moved {
            motion.stuck = false;
            return true;
        }
        let again = settled && motion.stuck && error > constants.off && self.tries < TRIES;
        self.tries += u32::from(again);
        again
    }

    /// Whether it is moved once more to a target.
    pub(super) fn tries_again(&self) -> bool {
        self.tries > 0
    }

    /// Whether the friction keeps its sign at the end of a trajectory.
    pub(super) fn is_loose(&self) -> bool {
        self.looseness > 0
    }
}
