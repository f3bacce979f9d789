//! What a drive keeps of what it has learned, from one arming to the next (thesis 8.4: drift; 9.3: a drive that tunes itself).
//!
//! ```text
//! begin      the unknowns t = k, their variances as afresh          k: kept, parts of what the rig file says
//! arming     k' = t - (t - file)/8                                  t: as the run ended, of the pace within 1/8 of k
//!            looseness: one less with each 8th arming
//! changed    M moved by a factor of 1.5, s of 2, d by 4 stictions, from k to t, or
//!            M, d or pace at a bound at the end of 3 runs in a row: k' = file
//! ```
//!
//! A run knows as little of its own beginning as one that begins afresh: what is kept moves the beginning, not how fast it is left
//! again. The eighth that each arming takes back is what nothing has borne out: what no run excites is half gone after five armings.
//! What each run finds again is kept at 7/8 of its deviation, since the run ends with all of it. The lag of a valve drifts slowly, and
//! one drive in a hundred is wrong about it: so its pace is followed in steps, and is no evidence of a change.
//!
//! A drive whose load differs from run to run has nothing to keep. It says so (`changed`) until 8 armings in a row were alike, and
//! begins afresh after each change. So does a drive that has tripped, unless somebody has stopped it or its host was silent: what was kept
//! may be why.
//!
//! | quantity | format | range |
//! |---|---|---|
//! | M, s, pace | Q16 | 0.25 to 2.5, 0.3 to 2, 0.5 to 3 |
//! | d, B | Q24 of the stiction, of B | -8 to 8, -1 to 4 |
//! | looseness | | 0 to 4 |

use crate::fault::Fault;
use crate::parameters::{Parameters, id};

/// 1 of M, s and pace.
const ONE: i32 = 1 << 16;
/// An arming takes this part of the deviation from the rig file back.
const PULL: i32 = 8;
/// Armings in a row after which a drive has not changed.
const STEADY: i32 = 8;
/// Runs in a row that may end at a bound.
const AT_BOUND: i32 = 3;
/// Most armings that are counted. One more than them counts as so many that the pull of each 8th one goes on.
const MOST: i32 = 65_535;
/// What a run may move the pace by.
const STEP: i32 = ONE / 8;
/// 4 stictions.
const FAR: u32 = 4 << 24;

/// What a run learns of its drive: parts of what the rig file says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Learned {
    /// M, Q16.
    pub mass: i32,
    /// s, Q16.
    pub friction: i32,
    /// d, Q24 of the stiction.
    pub force: i32,
    /// What B is larger by, Q24 of B.
    pub viscous: i32,
    /// The lag of the valve, Q16.
    pub pace: i32,
    /// How often the distance at which the load may rest was doubled.
    pub looseness: i32,
}

/// Why a drive began afresh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Changed {
    /// It did not, of late.
    No = 0,
    /// What it learned stayed at a bound.
    AtBound = 1,
    /// What a run learned is far from what it began with.
    Jumped = 2,
    /// A run tripped.
    Tripped = 3,
}

/// What is kept, and of how many runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kept {
    /// What a run begins with.
    pub learned: Learned,
    /// Armings since it began afresh, 65,535 at most.
    pub armings: i32,
    /// Runs in a row that ended at a bound.
    pub at_bound: i32,
    /// Whether and why it began afresh.
    pub changed: Changed,
}

impl Default for Learned {
    /// What the rig file says.
    fn default() -> Learned {
        Learned { mass: ONE, friction: ONE, force: 0, viscous: 0, pace: ONE, looseness: 0 }
    }
}

impl Default for Kept {
    fn default() -> Kept {
        Kept { learned: Learned::default(), armings: 0, at_bound: 0, changed: Changed::No }
    }
}

/// What an arming leaves of a value.
fn pulled(value: i32, file: i32) -> i32 {
    value.saturating_sub(value.saturating_sub(file) / PULL)
}

/// Whether two parts differ by more than this factor, a quotient.
fn are_apart(one: i32, other: i32, [over, under]: [i64; 2]) -> bool {
    let (one, other) = (i64::from(one), i64::from(other));
    one * under > other * over || other * under > one * over
}

impl Learned {
    /// Within the bounds of what a run may learn, whatever it was.
    #[must_use]
    pub fn bounded(self) -> Learned {
        Learned {
            mass: self.mass.clamp(ONE / 4, 5 * ONE / 2),
            friction: self.friction.clamp(19_661, 2 * ONE),
            force: self.force.clamp(-8 << 24, 8 << 24),
            viscous: self.viscous.clamp(-1 << 24, 4 << 24),
            pace: self.pace.clamp(ONE / 2, 3 * ONE),
            looseness: self.looseness.clamp(0, 4),
        }
    }

    /// What is left of it after an arming of this number.
    fn after_arming(self, number: i32) -> Learned {
        let file = Learned::default();
        let loosens = number % PULL == 0;
        Learned {
            mass: pulled(self.mass, file.mass),
            friction: pulled(self.friction, file.friction),
            force: pulled(self.force, file.force),
            viscous: pulled(self.viscous, file.viscous),
            pace: pulled(self.pace, file.pace),
            looseness: self.looseness.saturating_sub(i32::from(loosens)),
        }
        .bounded()
    }

    /// Whether a drive that was this one is another one now. Pace and B are no evidence: B is guessed, and short moves hardly show it.
    fn is_far_from(self, other: Learned) -> bool {
        are_apart(self.mass, other.mass, [3, 2])
            || are_apart(self.friction, other.friction, [2, 1])
            || self.force.abs_diff(other.force) > FAR
    }
}

impl Kept {
    /// What parameters keep, within its bounds.
    #[must_use]
    pub fn of(parameters: &Parameters) -> Kept {
        let get = |id| parameters.scalar(id);
        let learned = Learned {
            mass: get(id::KEPT_MASS),
            friction: get(id::KEPT_FRICTION),
            force: get(id::KEPT_FORCE),
            viscous: get(id::KEPT_VISCOUS),
            pace: get(id::KEPT_PACE),
            looseness: get(id::KEPT_LOOSENESS),
        };
        Kept {
            learned: learned.bounded(),
            armings: get(id::KEPT_ARMINGS).clamp(0, MOST),
            at_bound: get(id::KEPT_AT_BOUND).clamp(0, AT_BOUND),
            changed: match get(id::KEPT_CHANGED) {
                1 => Changed::AtBound,
                2 => Changed::Jumped,
                3 => Changed::Tripped,
                _ => Changed::No,
            },
        }
    }

    /// The parameters that keep it, each within its range.
    #[must_use]
    pub fn values(&self) -> [(u16, i32); 9] {
        let Learned { mass, friction, force, viscous, pace, looseness } = self.learned.bounded();
        [
            (id::KEPT_MASS, mass),
            (id::KEPT_FRICTION, friction),
            (id::KEPT_FORCE, force),
            (id::KEPT_VISCOUS, viscous),
            (id::KEPT_PACE, pace),
            (id::KEPT_LOOSENESS, looseness),
            (id::KEPT_ARMINGS, self.armings.clamp(0, MOST)),
            (id::KEPT_AT_BOUND, self.at_bound.clamp(0, AT_BOUND)),
            (id::KEPT_CHANGED, self.changed as i32),
        ]
    }

    /// At the arming behind a run that has begun with it: what the run ended with, whether that is at a bound, and the fault that
    /// the drive is in.
    pub(crate) fn after(&self, run: Learned, is_at_bound: bool, fault: Option<Fault>) -> Kept {
        match fault {
            // None of these tells of the run.
            None
            | Some(Fault::Stop | Fault::HostSilent | Fault::CommandWhileDisarmed | Fault::WatchdogTried) => {}
            Some(Fault::ModelAtBound) => return Kept::afresh(Changed::AtBound),
            Some(_) => return Kept::afresh(Changed::Tripped),
        }
        let at_bound = if is_at_bound { self.at_bound.saturating_add(1) } else { 0 };
        if at_bound >= AT_BOUND {
            return Kept::afresh(Changed::AtBound);
        }
        // What the rig file says of a drive that has not run is no evidence of a change.
        if self.armings > 0 && run.is_far_from(self.learned) {
            return Kept::afresh(Changed::Jumped);
        }
        let armings = if self.armings < MOST { self.armings.saturating_add(1) } else { MOST + 1 - PULL };
        let changed = if armings < STEADY { self.changed } else { Changed::No };
        let pace =
            run.pace.min(self.learned.pace.saturating_add(STEP)).max(self.learned.pace.saturating_sub(STEP));
        let learned = Learned { pace, ..run }.after_arming(armings);
        Kept { learned, armings, at_bound, changed }
    }

    /// Whether it differs so much from what is stored that it is worth a write of the flash: M or pace by a 16th, s by an 8th, d by a
    /// stiction, B by half of it, or the looseness. While the drive has changed of late, only that it begins afresh is.
    #[must_use]
    pub fn is_worth_storing(&self, stored: &Learned) -> bool {
        let (is, was) = (&self.learned, stored);
        let moved = is.mass.abs_diff(was.mass) > ONE.unsigned_abs() / 16
            || is.pace.abs_diff(was.pace) > ONE.unsigned_abs() / 16
            || is.friction.abs_diff(was.friction) > ONE.unsigned_abs() / 8
            || is.force.abs_diff(was.force) > 1 << 24
            || is.viscous.abs_diff(was.viscous) > 1 << 23
            || is.looseness != was.looseness;
        moved && (self.changed == Changed::No || self.is_afresh())
    }

    /// Whether a run begins with what the rig file says.
    #[must_use]
    pub fn is_afresh(&self) -> bool {
        self.learned == Learned::default()
    }

    fn afresh(changed: Changed) -> Kept {
        Kept { changed, ..Kept::default() }
    }
}

#[cfg(test)]
mod tests;
