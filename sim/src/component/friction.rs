//! Dry friction with stiction, as events rather than a velocity threshold (thesis 6.2.1, C(46..49)).
//!
//! ```text
//! stuck:  v = 0 while -Fs_retract <= F <= Fs_extend     F: all forces but dry friction
//! slip+:  friction Fc_extend against v > 0
//! slip-:  friction Fc_retract against v < 0
//! ```
//!
//! A slip ends at the located zero of the velocity; the body then breaks away anew if F is beyond the
//! static force, else it sticks. This is the limit of the thesis's model for a velocity threshold
//! C(24) that goes to zero (EQUATIONS section 6, section 11 rule 2). A body without any dry friction
//! never sticks. Load and spool share this file.

use crate::key::{keys, words};
use crate::values::{Findings, Rig};

words! {
    /// Kind of dry friction.
    pub enum Model {
        /// Stiction and Coulomb friction.
        Coulomb = "coulomb",
    } not built "lugre"
}

keys! {
    FRICTION: Model = choice("load.friction", "", "Kind of dry friction.");
    STATIC_EXTEND_N: f64 = number("load.static_extend_n", 70.0, 0.0, 1e5, "C(46)", "Stiction, extending.").spread();
    COULOMB_EXTEND_N: f64 = number("load.coulomb_extend_n", 40.0, 0.0, 1e5, "C(47)", "Coulomb friction, extending.").spread();
    STATIC_RETRACT_N: f64 = number("load.static_retract_n", 40.0, 0.0, 1e5, "C(48)", "Stiction, retracting.").spread();
    COULOMB_RETRACT_N: f64 = number("load.coulomb_retract_n", 11.0, 0.0, 1e5, "C(49)", "Coulomb friction, retracting.").spread();
    VELOCITY_THRESHOLD_M_S: f64 = number("load.velocity_threshold_m_s", 1e-5, 0.0, 1.0, "C(24)", "Velocity below which the thesis's model sticks; here sticking is an event at exactly zero, and this is not used.");
}

impl DryFriction {
    /// The friction of a rig's load.
    #[must_use]
    pub fn of_load(rig: &Rig) -> DryFriction {
        DryFriction {
            static_extend: rig.get(&keys::STATIC_EXTEND_N),
            coulomb_extend: rig.get(&keys::COULOMB_EXTEND_N),
            static_retract: rig.get(&keys::STATIC_RETRACT_N),
            coulomb_retract: rig.get(&keys::COULOMB_RETRACT_N),
        }
    }
}

/// What the load's friction must hold.
pub(crate) fn check(rig: &Rig, findings: &mut Findings) {
    let why = "a body that slips must not be held more than one that sticks";
    findings.not_above(rig, &keys::COULOMB_EXTEND_N, &keys::STATIC_EXTEND_N, why);
    findings.not_above(rig, &keys::COULOMB_RETRACT_N, &keys::STATIC_RETRACT_N, why);
}

/// Static and Coulomb forces by direction, N.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DryFriction {
    /// Force that an extending body breaks away at.
    pub static_extend: f64,
    /// Force against an extending body.
    pub coulomb_extend: f64,
    /// Force that a retracting body breaks away at.
    pub static_retract: f64,
    /// Force against a retracting body.
    pub coulomb_retract: f64,
}

/// What a body with dry friction is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contact {
    /// At rest, held.
    Stuck,
    /// Moving, or about to move, in the positive direction.
    Extending,
    /// Moving, or about to move, in the negative direction.
    Retracting,
    /// There is no dry friction.
    Frictionless,
}

impl DryFriction {
    /// The same friction in both directions.
    #[must_use]
    pub fn symmetric(static_force: f64, coulomb_force: f64) -> DryFriction {
        DryFriction {
            static_extend: static_force,
            coulomb_extend: coulomb_force,
            static_retract: static_force,
            coulomb_retract: coulomb_force,
        }
    }

    fn is_none(&self) -> bool {
        *self == DryFriction::symmetric(0.0, 0.0)
    }

    /// The contact of a body at rest under the force `applied`.
    #[must_use]
    pub fn at_rest(&self, applied: f64) -> Contact {
        if self.is_none() {
            Contact::Frictionless
        } else if applied > self.static_extend {
            Contact::Extending
        } else if applied < -self.static_retract {
            Contact::Retracting
        } else {
            Contact::Stuck
        }
    }

    /// The friction force, positive against the positive direction.
    #[must_use]
    pub fn force(&self, contact: Contact, applied: f64) -> f64 {
        match contact {
            Contact::Stuck => applied,
            Contact::Extending => self.coulomb_extend,
            Contact::Retracting => -self.coulomb_retract,
            Contact::Frictionless => 0.0,
        }
    }

    /// Not negative as long as the contact holds.
    #[must_use]
    pub fn guard(&self, contact: Contact, applied: f64, velocity: f64) -> f64 {
        match contact {
            Contact::Stuck => (self.static_extend - applied).min(applied + self.static_retract),
            Contact::Extending => velocity,
            Contact::Retracting => -velocity,
            Contact::Frictionless => 1.0,
        }
    }

    /// The contact after the guard has become negative.
    #[must_use]
    pub fn after(&self, contact: Contact, applied: f64) -> Contact {
        match contact {
            Contact::Stuck if applied > 0.0 => Contact::Extending,
            Contact::Stuck => Contact::Retracting,
            Contact::Extending | Contact::Retracting => self.at_rest(applied),
            Contact::Frictionless => Contact::Frictionless,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOAD: DryFriction = DryFriction {
        static_extend: 70.0,
        coulomb_extend: 40.0,
        static_retract: 40.0,
        coulomb_retract: 11.0,
    };

    #[test]
    fn a_body_at_rest_is_held_inside_the_stiction_band_of_each_direction() {
        for (applied, contact) in [
            (70.0, Contact::Stuck),
            (70.1, Contact::Extending),
            (-40.0, Contact::Stuck),
            (-40.1, Contact::Retracting),
        ] {
            assert_eq!(LOAD.at_rest(applied), contact);
        }
    }

    #[test]
    fn friction_opposes_motion_and_balances_a_held_body() {
        assert_eq!(LOAD.force(Contact::Stuck, 33.0), 33.0);
        assert_eq!(LOAD.force(Contact::Extending, 33.0), 40.0);
        assert_eq!(LOAD.force(Contact::Retracting, 33.0), -11.0);
    }

    #[test]
    fn a_slip_that_stops_under_a_large_force_goes_on_the_other_way() {
        assert_eq!(LOAD.after(Contact::Extending, -41.0), Contact::Retracting);
        assert_eq!(LOAD.after(Contact::Extending, -39.0), Contact::Stuck);
        assert_eq!(LOAD.after(Contact::Stuck, 70.0), Contact::Extending);
        assert_eq!(LOAD.after(Contact::Stuck, -40.0), Contact::Retracting);
    }

    #[test]
    fn a_body_without_dry_friction_never_sticks() {
        let none = DryFriction::symmetric(0.0, 0.0);
        assert_eq!(none.at_rest(0.0), Contact::Frictionless);
        assert!(none.guard(Contact::Frictionless, 5.0, -1.0) > 0.0);
    }
}
