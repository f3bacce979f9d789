//! The load: a mass with friction between two stops (thesis 6.2).
//!
//! ```text
//! M y'' = F_a + F_const - k y - M g sin(incline) - K_C y' + L_e - F_r     (6.31)
//! ```
//!
//! Positive means extension. F_const acts along +y (EQUATIONS section 6); L_e is the force of the
//! end stops ([`crate::stop`]), F_r the dry friction ([`crate::friction`]). The
//! applied force is all but F_r: what a stuck load is tested with.

use crate::friction::{Contact, DryFriction};
use crate::stop::{Side, Stops};

/// Standard gravity, m/s^2 (CGPM 1901).
const GRAVITY: f64 = 9.806_65;

/// The parameters of a load, SI.
#[derive(Clone, Copy, Debug)]
pub struct Load {
    /// M, kg (C(17)).
    pub mass: f64,
    /// K_C, N s/m (C(18)).
    pub viscous: f64,
    /// F_const, N, along +y (C(19)).
    pub constant_force: f64,
    /// k, N/m, from y = 0.
    pub spring: f64,
    /// Angle at which extension goes uphill, rad.
    pub incline: f64,
    /// Stiction and Coulomb friction by direction.
    pub friction: DryFriction,
    /// The ends of the stroke.
    pub stops: Stops,
}

impl Load {
    /// The forces that depend on neither velocity nor contact, N: constant force, spring, weight.
    #[must_use]
    pub fn standing_force(&self, position: f64) -> f64 {
        self.constant_force - self.spring * position - self.mass * GRAVITY * libm::sin(self.incline)
    }

    /// All forces but dry friction, N.
    #[must_use]
    pub fn applied_force(&self, actuator: f64, side: Side, position: f64, velocity: f64) -> f64 {
        actuator + self.standing_force(position) - self.viscous * velocity
            + self.stops.force(side, position, velocity)
    }

    /// y'', m/s^2; exactly 0 while stuck.
    #[must_use]
    pub fn acceleration(&self, applied: f64, contact: Contact) -> f64 {
        match contact {
            Contact::Stuck => 0.0,
            _ => (applied - self.friction.force(contact, applied)) / self.mass,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn load() -> Load {
        Load {
            mass: 2.0,
            viscous: 30.0,
            constant_force: 5.0,
            spring: 100.0,
            incline: std::f64::consts::FRAC_PI_6,
            friction: DryFriction::symmetric(20.0, 10.0),
            stops: Stops::new(0.0, 0.3, 1e6, 1e-3, 0.5, 2.0),
        }
    }

    #[test]
    fn forces_add_up_with_the_signs_of_6_31() {
        let applied = load().applied_force(50.0, Side::Free, 0.1, 0.5);
        assert!((applied - (50.0 + 5.0 - 10.0 - 2.0 * GRAVITY * 0.5 - 15.0)).abs() < 1e-12);
    }

    #[test]
    fn a_stuck_load_does_not_accelerate_and_a_slipping_one_loses_the_coulomb_force() {
        assert_eq!(load().acceleration(15.0, Contact::Stuck), 0.0);
        assert_eq!(load().acceleration(15.0, Contact::Extending), 2.5);
        assert_eq!(load().acceleration(-15.0, Contact::Retracting), -2.5);
    }
}
