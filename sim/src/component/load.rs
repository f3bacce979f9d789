//! The load: a mass with friction between two stops (thesis 6.2).
//!
//! ```text
//! M y'' = F_a + F_const - k y + F_s - M g sin(incline) - K_C y' + L_e - F_r     (6.31)
//! ```
//!
//! Positive means extension. F_const acts along +y (EQUATIONS section 6); F_s is the force of a return spring in the cylinder
//! ([`crate::component::actuator::spring`]). It is linear like k, so a [`Load`] has both springs in one. L_e is the force of the end stops
//! ([`crate::component::stop`]), F_r the friction except its viscous part ([`crate::component::friction`]). The applied
//! force is everything except F_r; it decides whether a stuck load breaks away.

pub mod returning;

use crate::component::actuator;
use crate::component::actuator::spring::ReturnSpring;
use crate::component::friction::{Body, Contact, Friction, FrictionModel, States};
use crate::component::stop::{Side, Stops};
use crate::key::{keys, words};
use crate::values::Rig;

words! {
    /// Kind of load.
    pub enum LoadKind {
        /// A mass.
        Mass = "mass",
    }
}

keys! {
    MODEL: LoadKind = choice("load.model", "L(21)", "Kind of load.");
    MASS_KG: f64 = number("load.mass_kg", 1.6, 1e-3, 1e5, "C(17)", "Moving mass.").spread();
    VISCOUS_N_S_PER_M: f64 = number("load.viscous_n_s_per_m", 30.0, 0.0, 1e6, "C(18)", "Viscous friction.").spread().vague();
    CONSTANT_FORCE_N: f64 = number("load.constant_force_n", 0.0, -1e6, 1e6, "C(19)", "Constant force in the direction of extension.");
    SPRING_N_PER_M: f64 = number("load.spring_n_per_m", 0.0, 0.0, 1e6, "", "Spring to the retracted end.");
    INCLINE_DEG: f64 = number("load.incline_deg", 0.0, -90.0, 90.0, "", "Angle at which extension goes uphill.");
}

impl Load {
    /// The load of a rig.
    #[must_use]
    pub fn of(rig: &Rig) -> Load {
        let mass = rig.get(&keys::MASS_KG);
        let inside = ReturnSpring::of(rig);
        Load {
            mass,
            viscous: rig.get(&keys::VISCOUS_N_S_PER_M),
            constant_force: rig.get(&keys::CONSTANT_FORCE_N) + inside.force_at_0,
            spring: rig.get(&keys::SPRING_N_PER_M) + inside.stiffness,
            uphill: libm::sin(rig.get(&keys::INCLINE_DEG).to_radians()),
            friction: Friction::of(rig),
            stops: Stops::of_load(rig, rig.get(&actuator::keys::STROKE_M), mass),
        }
    }
}

/// Standard gravity, m/s^2 (CGPM 1901).
pub const GRAVITY: f64 = 9.806_65;

/// The parameters of a load, SI.
#[derive(Clone, Copy, Debug)]
pub struct Load {
    /// M, kg (C(17)).
    pub mass: f64,
    /// K_C, N s/m (C(18)).
    pub viscous: f64,
    /// F_const (C(19)) and the return spring's force at y = 0, N, along +y.
    pub constant_force: f64,
    /// k of both springs, N/m.
    pub spring: f64,
    /// Sine of the incline: of the angle at which extension goes uphill.
    pub uphill: f64,
    /// Friction, but for its viscous part.
    pub friction: Friction,
    /// The ends of the stroke.
    pub stops: Stops,
}

/// How a load moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// y, m.
    pub position: f64,
    /// y', m/s.
    pub velocity: f64,
    /// y'', m/s^2.
    pub acceleration: f64,
}

impl Load {
    /// The part of its weight that acts against extension, N.
    #[must_use]
    pub fn weight(&self) -> f64 {
        self.mass * GRAVITY * self.uphill
    }

    /// The forces that depend on neither velocity nor contact, N: constant force, springs, weight.
    #[must_use]
    pub fn standing_force(&self, position: f64) -> f64 {
        self.constant_force - self.spring * position - self.weight()
    }

    /// All forces but F_r, N.
    #[must_use]
    pub fn applied_force(&self, actuator: f64, side: Side, position: f64, velocity: f64) -> f64 {
        actuator + self.standing_force(position) - self.viscous * velocity
            + self.stops.force(side, position, velocity)
    }

    /// The load as its friction has it, under an applied force (N) at a velocity (m/s).
    #[must_use]
    #[inline(always)]
    pub fn body(&self, applied: f64, velocity: f64, (contact, states): (Contact, States)) -> Body {
        Body { mass: self.mass, viscous: self.viscous, applied, velocity, contact, states }
    }

    /// y'', m/s^2; exactly 0 while stuck.
    #[must_use]
    #[inline(always)]
    pub fn acceleration(&self, body: &Body) -> f64 {
        match body.contact {
            Contact::Stuck => 0.0,
            _ => (body.applied - self.friction.force(body)) / self.mass,
        }
    }

    /// y''', m/s^3, for the rate of the actuator's force in N/s; exactly 0 while stuck.
    #[must_use]
    pub fn jerk(&self, actuator_rate: f64, side: Side, motion: Motion, body: &Body) -> f64 {
        if body.contact == Contact::Stuck {
            return 0.0;
        }
        let Motion { position, velocity, acceleration } = motion;
        let stops = self.stops.force_rate(side, position, velocity, acceleration);
        let applied_rate = actuator_rate - self.spring * velocity - self.viscous * acceleration + stops;
        (applied_rate - self.friction.force_rate(body, acceleration, applied_rate)) / self.mass
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::friction::DryFriction;

    fn load() -> Load {
        Load {
            mass: 2.0,
            viscous: 30.0,
            constant_force: 5.0,
            spring: 100.0,
            uphill: 0.5,
            friction: Friction::Coulomb(DryFriction::symmetric(20.0, 10.0)),
            stops: Stops::new(0.0, 0.3, 1e6, 1e-3, 0.5, 2.0),
        }
    }

    /// The load that does this under an applied force, at a velocity.
    fn body(contact: Contact, applied: f64, velocity: f64) -> Body {
        load().body(applied, velocity, (contact, States::default()))
    }

    #[test]
    fn forces_add_up_with_the_signs_of_6_31() {
        let applied = load().applied_force(50.0, Side::Free, 0.1, 0.5);
        assert!((applied - (50.0 + 5.0 - 10.0 - 2.0 * GRAVITY * 0.5 - 15.0)).abs() < 1e-12);
    }

    #[test]
    fn the_jerk_is_the_slope_of_the_acceleration() {
        let (load, motion) = (load(), Motion { position: 0.3005, velocity: 0.2, acceleration: 4.0 });
        let at = |t: f64| {
            let position = motion.position + motion.velocity * t + 0.5 * motion.acceleration * t * t;
            let velocity = motion.velocity + motion.acceleration * t;
            let applied = load.applied_force(50.0 + 900.0 * t, Side::High, position, velocity);
            load.acceleration(&body(Contact::Extending, applied, velocity))
        };
        let slope = (at(1e-7) - at(-1e-7)) / 2e-7;
        let jerk = |contact| load.jerk(900.0, Side::High, motion, &body(contact, 0.0, motion.velocity));
        let stuck = jerk(Contact::Stuck);
        let jerk = jerk(Contact::Extending);
        assert!((jerk / slope - 1.0).abs() < 1e-6, "{jerk} {slope}");
        assert_eq!(stuck, 0.0);
    }

    #[test]
    fn a_stuck_load_does_not_accelerate_and_a_slipping_one_loses_the_coulomb_force() {
        assert_eq!(load().acceleration(&body(Contact::Stuck, 15.0, 0.0)), 0.0);
        assert_eq!(load().acceleration(&body(Contact::Extending, 15.0, 0.0)), 2.5);
        assert_eq!(load().acceleration(&body(Contact::Retracting, -15.0, 0.0)), -2.5);
    }
}
