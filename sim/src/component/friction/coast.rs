//! A body that only its friction slows down: the shortest trial of a model, for which many have a closed form.

use super::{Body, Contact, FrictionModel, STATES, States};
use pneudrive_solver::{Derivative, Event, IntegrationError, Integrator, Method, System};

/// Distance, velocity, and the states of the model.
const N: usize = 2 + STATES;

/// Allowed error of a step, of 1 m, 1 m/s and the scales of the model.
const TOLERANCE: f64 = 1e-11;

/// Where a body has come to rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// Time until then, s.
    pub time: f64,
    /// Distance travelled until then, m.
    pub distance: f64,
}

/// A body that extends, or has come to rest.
struct Coasting<'a, F> {
    friction: &'a F,
    mass: f64,
    contact: Contact,
    stop: Option<Stop>,
}

impl<F: FrictionModel> System<N, 1, 0> for Coasting<'_, F> {
    fn derivative(&mut self, _t: f64, x: &[f64; N]) -> [f64; N] {
        let mut derivative = [0.0; N];
        if self.stop.is_none() {
            let states: States = std::array::from_fn(|i| x[2 + i]);
            let &mut Coasting { mass, contact, .. } = self;
            let body = Body { mass, viscous: 0.0, applied: 0.0, velocity: x[1], contact, states };
            derivative[..2].copy_from_slice(&[x[1], -self.friction.force(&body) / mass]);
            derivative[2..].copy_from_slice(&self.friction.derivative(&body));
        }
        derivative
    }

    fn guards(&mut self, _t: f64, x: &[f64; N]) -> [f64; 1] {
        [if self.stop.is_none() { x[1] } else { 1.0 }]
    }

    fn handle_event(&mut self, _event: Event, time: f64, x: &mut [f64; N]) -> Derivative {
        self.stop = Some(Stop { time, distance: x[0] });
        Derivative::Discontinuous
    }
}

/// Where a body (mass in kg) that extends at a velocity (m/s) first stands still; None if it does not within the
/// given seconds.
///
/// ```
/// use pneudrive_sim::component::friction::{DryFriction, coast};
///
/// // Coulomb friction of 40 N takes 2 kg from 1 m/s to rest in 50 ms, on 25 mm.
/// let stop = coast(&DryFriction::symmetric(70.0, 40.0), 2.0, 1.0, 1.0)?.expect("it stops");
/// assert!((stop.time - 0.050).abs() < 1e-9 && (stop.distance - 0.025).abs() < 1e-9);
/// # Ok::<(), pneudrive_sim::IntegrationError>(())
/// ```
///
/// # Errors
/// When the integration fails.
pub fn coast<F: FrictionModel>(
    friction: &F,
    mass: f64,
    velocity: f64,
    longest_s: f64,
) -> Result<Option<Stop>, IntegrationError> {
    let (at_rest, states) = friction.at_rest(0.0);
    let contact = if at_rest == Contact::Stuck { Contact::Extending } else { at_rest };
    let mut body = Coasting { friction, mass, contact, stop: None };
    let (mut scale, mut x) = ([1.0; N], [0.0; N]);
    scale[2..2 + F::SCALE.len()].copy_from_slice(F::SCALE);
    x[1] = velocity;
    x[2..].copy_from_slice(&states);
    let mut integrator = Integrator::new(Method::DormandPrince, TOLERANCE, scale, x);
    integrator.integrate_to(&mut body, longest_s, longest_s)?;
    Ok(body.stop)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::friction::{DryFriction, Friction};
    use crate::values::Rig;

    #[test]
    fn a_body_without_friction_does_not_stop() {
        let none = DryFriction::symmetric(0.0, 0.0);
        assert_eq!(coast(&none, 1.0, 1.0, 10.0), Ok(None));
    }

    /// Bristles give way by micrometres, and the film lasts for milliseconds: apart from that it is Coulomb friction.
    #[test]
    fn a_fast_body_on_bristles_stops_where_coulomb_friction_stops_it() {
        let lugre = Rig::read_with("test", "", &["load.friction=lugre"]).expect("valid");
        let stop = coast(&Friction::of(&lugre), 2.0, 2.0, 1.0).expect("a solution").expect("it stops");
        let coulomb = coast(&DryFriction::symmetric(70.0, 40.0), 2.0, 2.0, 1.0).expect("a solution");
        let coulomb = coulomb.expect("it stops");
        assert!((stop.time / coulomb.time - 1.0).abs() < 0.05, "{stop:?}, {coulomb:?}");
        assert!((stop.distance / coulomb.distance - 1.0).abs() < 0.02, "{stop:?}, {coulomb:?}");
    }
}
