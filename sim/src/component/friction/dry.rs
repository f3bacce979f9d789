//! Dry friction with stiction, as events rather than a velocity threshold (thesis 6.2.1, C(46..49)).
//!
//! ```text
//! stuck:  v = 0 while -Fs_retract <= F <= Fs_extend     F: all forces but dry friction
//! slip+:  friction Fc_extend against v > 0
//! slip-:  friction Fc_retract against v < 0
//! ```
//!
//! A slip ends at the located zero of the velocity. The body then breaks away again if F is beyond the static force;
//! otherwise it sticks. This is the limit of the thesis's model as the velocity threshold C(24) goes to zero (EQUATIONS
//! section 6, section 11 rule 2). A body without dry friction never sticks. Load and spool share this model.

use super::{Body, FrictionModel, States, keys as load};
use crate::key::keys;
use crate::values::Rig;

keys! {
    VELOCITY_THRESHOLD_M_S: f64 = number("load.velocity_threshold_m_s", 1e-5, 0.0, 1.0, "C(24)", "Velocity below which the thesis's model sticks; here sticking is an event at exactly zero.").default_only();
}

impl FrictionModel for DryFriction {
    fn of(rig: &Rig) -> DryFriction {
        DryFriction {
            static_extend: rig.get(&load::STATIC_EXTEND_N),
            coulomb_extend: rig.get(&load::COULOMB_EXTEND_N),
            static_retract: rig.get(&load::STATIC_RETRACT_N),
            coulomb_retract: rig.get(&load::COULOMB_RETRACT_N),
        }
    }

    fn at_rest(&self, applied: f64) -> (Contact, States) {
        (DryFriction::at_rest(self, applied), States::default())
    }

    fn force(&self, body: &Body) -> f64 {
        DryFriction::force(self, body.contact, body.applied)
    }

    /// A slip has the same friction all the time.
    fn force_rate(&self, _body: &Body, _acceleration: f64, _applied_rate: f64) -> f64 {
        0.0
    }

    fn guard(&self, body: &Body) -> f64 {
        DryFriction::guard(self, body.contact, body.applied, body.velocity)
    }

    fn after(&self, contact: Contact, applied: f64) -> Contact {
        DryFriction::after(self, contact, applied)
    }
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

/// The motion of a body with dry friction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contact {
    /// At rest, held.
    Stuck,
    /// Moving, or about to move, in the positive direction.
    Extending,
    /// Moving, or about to move, in the negative direction.
    Retracting,
    /// Never held: without friction, or on bristles.
    Free,
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

    /// Whether it has no friction at all.
    #[must_use]
    pub fn is_none(&self) -> bool {
        *self == DryFriction::symmetric(0.0, 0.0)
    }

    /// The static and the Coulomb force against a velocity.
    #[must_use]
    pub fn against(&self, velocity: f64) -> [f64; 2] {
        if velocity < 0.0 {
            [self.static_retract, self.coulomb_retract]
        } else {
            [self.static_extend, self.coulomb_extend]
        }
    }

    /// The contact of a body at rest under the force `applied`.
    #[must_use]
    pub fn at_rest(&self, applied: f64) -> Contact {
        if self.is_none() {
            Contact::Free
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
            Contact::Free => 0.0,
        }
    }

    /// Not negative as long as the contact holds.
    #[must_use]
    pub fn guard(&self, contact: Contact, applied: f64, velocity: f64) -> f64 {
        match contact {
            Contact::Stuck => (self.static_extend - applied).min(applied + self.static_retract),
            Contact::Extending => velocity,
            Contact::Retracting => -velocity,
            Contact::Free => 1.0,
        }
    }

    /// The contact after the guard has become negative.
    #[must_use]
    pub fn after(&self, contact: Contact, applied: f64) -> Contact {
        match contact {
            Contact::Stuck if applied > 0.0 => Contact::Extending,
            Contact::Stuck => Contact::Retracting,
            Contact::Extending | Contact::Retracting => self.at_rest(applied),
            Contact::Free => Contact::Free,
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
        assert_eq!(none.at_rest(0.0), Contact::Free);
        assert!(none.guard(Contact::Free, 5.0, -1.0) > 0.0);
    }
}
