//! What the law knows at a sample, to be looked at. Nothing of it is used by the law itself.

use super::begin::Begun;
use super::{Cascade, Phase, motion};

/// What the load does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// At rest.
    Rest = 0,
    /// On a trajectory of its own, or at its end until it stands.
    Trajectory = 1,
    /// On that of a profile.
    Profile = 2,
}

/// What the law knows, in its units: counts, samples, the force of the supply on area 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Known {
    /// What the load does.
    pub stage: Stage,
    /// Place and speed of the reference, Q16; at rest the middle of the target, and 0.
    pub reference: (i64, i32),
    /// Estimated place and speed, Q16.
    pub motion: (i64, i32),
    /// F, by the pressures, and the force that the law wants, Q24.
    pub force: i32,
    /// At rest the one that holds the load.
    pub wanted: i32,
    /// d of the motion observer, Q24.
    pub against: i32,
    /// M w + f + d, as it is learned, Q24.
    pub standing: i32,
    /// M and s, parts of those of the rig file, Q16.
    pub mass: i32,
    /// Of the friction.
    pub friction: i32,
    /// The lag of the valve over that of the rig file, Q16.
    pub pace: i32,
    /// How far from its target it rests: the distance doubles with each.
    pub looseness: u32,
}

impl Cascade {
    /// Whether the load rests and stands: it has not moved a count in 10 ms.
    #[must_use]
    pub fn stands(&self) -> bool {
        matches!(self.phase, Phase::Rest { .. }) && self.motion.stuck
    }

    /// What it knows at the last sample; None before the first one.
    #[must_use]
    pub fn known(&self) -> Option<Known> {
        let (stage, reference) = match self.phase {
            Phase::Rest { .. } => (Stage::Rest, (motion::middle(self.target), 0)),
            Phase::Trajectory => (Stage::Trajectory, (self.reference.x, self.reference.v)),
            Phase::Profile => (Stage::Profile, (self.reference.x, self.reference.v)),
        };
        let [force, wanted] = self.forces;
        (self.begun != Begun::No).then_some(Known {
            stage,
            reference,
            motion: (self.motion.x, self.motion.v),
            force,
            wanted,
            against: self.motion.d,
            standing: self.load.standing,
            mass: self.load.mass,
            friction: self.load.friction,
            pace: self.lag.pace,
            looseness: self.rest.looseness,
        })
    }
}
