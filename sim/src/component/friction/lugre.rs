//! Friction on bristles under a film of lubricant: the revised LuGre model (Tran and Yanada, Dynamic Friction
//! Behaviors of Pneumatic Cylinders, Intelligent Control and Automation 4(2), 2013, doi 10.4236/ica.2013.42022).
//!
//! ```text
//! F_r = s_0 z + s_1 z' + K_C (v + T v')                     bristles; the fluid, with what its inertia adds
//! z'  = v - s_0 |v| z / g                                   deflection of the bristles, m
//! g   = F_c + (F_s - F_c) (1 - f) exp(-(|v|/v_s)^n)         what they hold; F_s and F_c of the direction of v
//! f'  = (f_s - f)/t,   t = t_g while f < f_s, else t_d      thickness of the film over its largest
//! f_s = (min(|v|, v_b)/v_b)^(2/3)
//! ```
//!
//! The source has the thickness h = f (1 - F_c/F_s). K_C v is the load's viscous friction, one of the applied forces F.
//! With M v' = F - (F_r - K_C v) put in, F_r - K_C v = (M (s_0 z + s_1 z') + K_C T F)/(M + K_C T).
//!
//! Bristles hold a body at rest, so nothing sticks. At constant speed the friction becomes g(f_s) + K_C v. Bristles
//! give no energy while s_1 < K_C F_c/(F_s - F_c) (Barabanov and Ortega, IEEE Trans. Automatic Control 45(4), 2000).

use super::{Body, Contact, DryFriction, FrictionModel, States, keys as load};
use crate::key::keys;
use crate::values::{Findings, Rig};

keys! {
    BRISTLE_STIFFNESS_N_PER_M: f64 = number("load.bristle_stiffness_n_per_m", 1e5, 1e3, 1e8, "", "Stiffness of the bristles, s_0: that of a load before it slides.").chosen_by(&load::FRICTION, &["lugre"]).spread().vague();
    BRISTLE_DAMPING_N_S_PER_M: f64 = number("load.bristle_damping_n_s_per_m", 10.0, 0.0, 1e5, "", "Damping of the bristles, s_1.").chosen_by(&load::FRICTION, &["lugre"]).spread().vague();
    STRIBECK_VELOCITY_M_S: f64 = number("load.stribeck_velocity_m_s", 0.02, 1e-4, 10.0, "", "Velocity at which friction has dropped towards Coulomb friction, v_s.").chosen_by(&load::FRICTION, &["lugre"]).spread().vague();
    STRIBECK_EXPONENT: f64 = number("load.stribeck_exponent", 1.0, 0.25, 4.0, "", "How sharply it drops there, n.").chosen_by(&load::FRICTION, &["lugre"]);
    FILM_VELOCITY_M_S: f64 = number("load.film_velocity_m_s", 0.05, 1e-4, 10.0, "", "Velocity from which on the film is as thick as it gets, v_b.").chosen_by(&load::FRICTION, &["lugre"]).spread().vague();
    FILM_GROWTH_S: f64 = number("load.film_growth_s", 0.05, 1e-4, 100.0, "", "Time constant of a film that grows, t_g.").chosen_by(&load::FRICTION, &["lugre"]).spread().vague();
    FILM_DECAY_S: f64 = number("load.film_decay_s", 0.2, 1e-4, 100.0, "", "Time constant of a film that gets thinner, t_d.").chosen_by(&load::FRICTION, &["lugre"]).spread().vague();
    FLUID_LAG_S: f64 = number("load.fluid_lag_s", 0.0, 0.0, 1.0, "", "T: viscous friction is that of the velocity and T times the acceleration.").chosen_by(&load::FRICTION, &["lugre"]).spread().vague();
}

/// Bristles and film, SI; the forces are those of C(46) to C(49).
#[derive(Clone, Copy, Debug)]
pub struct LuGre {
    forces: DryFriction,
    bristles: [f64; 2],
    stribeck: [f64; 2],
    film: [f64; 3],
    fluid_lag: f64,
}

/// m/s: below it the film goes with the velocity itself, as the slope of f_s has no bound at rest.
const SLOW: f64 = 1e-6;

impl FrictionModel for LuGre {
    const SCALE: &'static [f64] = &[1e-3, 1.0];

    const NAMES: &'static [&'static str] = &["bristle_deflection_m", "film_thickness"];

    fn of(rig: &Rig) -> LuGre {
        let both = |one, other| [one, other].map(|key| rig.get(key));
        LuGre {
            forces: FrictionModel::of(rig),
            bristles: both(&keys::BRISTLE_STIFFNESS_N_PER_M, &keys::BRISTLE_DAMPING_N_S_PER_M),
            stribeck: both(&keys::STRIBECK_VELOCITY_M_S, &keys::STRIBECK_EXPONENT),
            film: [&keys::FILM_VELOCITY_M_S, &keys::FILM_GROWTH_S, &keys::FILM_DECAY_S]
                .map(|key| rig.get(key)),
            fluid_lag: rig.get(&keys::FLUID_LAG_S),
        }
    }

    fn check(rig: &Rig, findings: &mut Findings) {
        let forces: DryFriction = FrictionModel::of(rig);
        for key in [&load::COULOMB_EXTEND_N, &load::COULOMB_RETRACT_N] {
            if rig.get(key) == 0.0 && !forces.is_none() {
                findings.note(key, "must be above 0 with load.friction = \"lugre\", or all four forces 0");
            }
        }
    }

    fn at_rest(&self, applied: f64) -> (Contact, States) {
        let held = applied.clamp(-self.forces.static_retract, self.forces.static_extend);
        (Contact::Free, [held / self.bristles[0], 0.0])
    }

    fn creep(&self) -> f64 {
        self.stribeck[0]
    }

    fn derivative(&self, body: &Body) -> States {
        let ([stiffness, _], [velocity, exponent], [z, film]) = (self.bristles, self.stribeck, body.states);
        let (v, [most, least]) = (body.velocity.abs(), self.forces.against(body.velocity));
        let fall = libm::exp(-libm::pow(v / velocity, exponent));
        let hold = least + (most - least) * (1.0 - film) * fall;
        let slip = if hold > 0.0 { stiffness * v * z / hold } else { body.velocity };
        let [largest_from, growth, decay] = self.film;
        let part = v.min(largest_from) / largest_from;
        let settled = part / libm::cbrt(part.max(SLOW / largest_from));
        [body.velocity - slip, (settled - film) / if film < settled { growth } else { decay }]
    }

    fn force(&self, body: &Body) -> f64 {
        let ([stiffness, damping], [z_rate, _]) = (self.bristles, self.derivative(body));
        let (bristles, inertia) =
            (stiffness * body.states[0] + damping * z_rate, body.viscous * self.fluid_lag);
        (body.mass * bristles + inertia * body.applied) / (body.mass + inertia)
    }
}

#[cfg(test)]
mod tests;
