//! The tubes from the supply to the valve and from the valve to the cylinder.
//!
//! Empirical model (6.61, reading R1 of EQUATIONS section 4; C(28), C(30)):
//!
//! ```text
//! P_out = P_in q^(mdot / mdot_ref),   q = 1 - K_dr
//! ```
//!
//! with a signed exponent, so that it holds for both directions. In Exner pressures the exponent is
//! scaled by (n-1)/n. Two others follow from the dimensions: adiabatic flow with friction
//! (`tubing/pipe.rs`), and a sharp restriction in place of a tube (`tubing/connector.rs`).
//!
//! The pressure at the far end depends on the flow and the flow on that pressure: the network solves
//! both at once, so that the thesis's oscillation of P1v, which came from using the flow of the call
//! before (7.2.1), cannot arise.
//!
//! Choking. A tube known at its upstream end passes no more than a choking flow m*, behind which the
//! far pressure may be anything below P*; just before it the pressure falls with an infinite slope. A
//! function of the flow instead falls no steeper than `STEEPEST` = s allows: from the flow m_s, where
//! its slope is just that, it goes on along its tangent, and below half of w_s along a hyperbola:
//!
//! ```text
//! d ln w / d ln m = -s at m_s,   x = s (m/m_s - 1)
//! w = w_s (1 - x) for x <= 1/2,  w_s / (4 x) beyond
//! ```
//!
//! Value and slope are continuous, w stays positive, and it falls for every flow. m_s is below m* by
//! far less than 1/s of it, and air at a far end above 0.09 P* flows at most 0.5/s above m_s.

mod connector;
mod pipe;

use crate::component::air::Station;
use crate::component::gas::Gas;
use crate::number::Number;
use connector::Connector;
use pipe::Pipe;

/// A tube between a known pressure and a valve port.
#[derive(Clone, Copy, Debug)]
pub struct Tube(Model);

#[derive(Clone, Copy, Debug)]
enum Model {
    None,
    /// `decay` is d ln w / d mdot of a flow away from the known end, s/kg.
    Empirical {
        decay: f64,
    },
    Analytical(Pipe),
    Connector(Connector),
}

/// Exner pressure at the far end of a tube, and its slope over the flow.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FarEnd<N = f64> {
    pub exner: N,
    pub by_flow: N,
}

impl<N: Number> FarEnd<N> {
    /// The slope over the temperature of the air in a tube that feels it: flow and temperature enter as m^2 T.
    #[inline(always)]
    pub fn by_temperature(&self, flow: N, temperature: N) -> N {
        N::from(0.5) * self.by_flow * flow / temperature
    }
}

/// Exner pressure at the far end over that at the known end.
#[derive(Clone, Copy, Debug)]
struct Ratio {
    value: f64,
    /// d ln value / d ln mdot.
    elasticity: f64,
}

/// s: -d ln w / d ln m of the steepest fall. Choked flows come out right to 0.5/s (tested).
///
/// Steeper falls cost the network its Newton solutions. Of 20 000 of a sweep of spool and chambers on
/// tubes of 1 cm with a bore of 2 mm, which choke, 85 went to the brackets at 100 and 2630 at 300; of
/// tubes of 1 m, whose bore is 2 or 4 mm, the first alone.
const STEEPEST: f64 = 100.0;

impl Tube {
    /// No tube: the same pressure at both ends.
    #[must_use]
    pub fn none() -> Tube {
        Tube(Model::None)
    }

    /// Whether both ends have the same pressure, whatever flows.
    pub(crate) fn is_none(&self) -> bool {
        matches!(self.0, Model::None)
    }

    /// Whether the drop depends on the temperature of the air in the tube.
    pub(crate) fn feels_temperature(&self) -> bool {
        matches!(self.0, Model::Analytical(_) | Model::Connector(_))
    }

    /// The regression line of the thesis: the pressure falls by the fraction `drop_slope` (below 1)
    /// at `reference_flow_kg_s`.
    #[must_use]
    pub fn empirical(gas: &Gas, drop_slope: f64, reference_flow_kg_s: f64) -> Tube {
        if drop_slope == 0.0 {
            return Tube::none();
        }
        Tube(Model::Empirical {
            decay: gas.exner_exponent() * libm::log(1.0 - drop_slope) / reference_flow_kg_s,
        })
    }

    /// A pipe with friction and no heat through its wall (Appendix VIII). The factor is Fanning's, a
    /// quarter of Darcy's. Without friction it is no tube.
    #[must_use]
    pub fn analytical(gas: &Gas, length_m: f64, diameter_m: f64, fanning_friction_factor: f64) -> Tube {
        let span = 4.0 * fanning_friction_factor * length_m / diameter_m;
        if span < pipe::LEAST_SPAN {
            return Tube::none();
        }
        Tube(Model::Analytical(Pipe::new(*gas, span, diameter_m)))
    }

    /// A sharp restriction in place of a tube (6.55 to 6.60): bore and coefficient of discharge.
    #[must_use]
    pub fn connector(gas: &Gas, discharge: f64, diameter_m: f64) -> Tube {
        Tube(Model::Connector(Connector::new(*gas, discharge, diameter_m)))
    }

    /// The far end, for a flow (kg/s) from the known end to the far end. `known` has the pressure at the known
    /// end and the stagnation temperature of the air in the tube: that of the place the air comes from.
    #[inline(always)]
    pub(crate) fn far_end<N: Number>(&self, known: &Station<N>, flow: N) -> FarEnd<N> {
        match &self.0 {
            Model::None => FarEnd { exner: known.exner, by_flow: N::from(0.0) },
            Model::Empirical { decay } => {
                let decay = N::from(*decay);
                let exner = known.exner * (decay * flow).exponential();
                FarEnd { exner, by_flow: decay * exner }
            }
            Model::Analytical(pipe) => one_by_one(known, flow, |known, flow| pipe.ratio(known, flow)),
            Model::Connector(connector) => {
                one_by_one(known, flow, |known, flow| connector.ratio(known, flow))
            }
        }
    }
}

/// The far ends of tubes whose equations have to be asked how large things are.
#[inline]
fn one_by_one<N: Number>(known: &Station<N>, flow: N, ratio: impl Fn(&Station, f64) -> Ratio) -> FarEnd<N> {
    let mut slopes = [0.0; 2];
    let exner = N::of(|i| {
        let (known, flow) =
            (Station { exner: known.exner.lane(i), temperature: known.temperature.lane(i) }, flow.lane(i));
        let far = ratio(&known, flow).far_end(known.exner, flow);
        slopes[i] = far.by_flow;
        far.exner
    });
    FarEnd { exner, by_flow: N::of(|i| slopes[i]) }
}

impl Ratio {
    /// The fall behind the steepest place: `value` is the ratio there, `excess` m/m_s - 1.
    fn beyond_choking(value: f64, excess: f64) -> Ratio {
        let fall = STEEPEST * excess;
        if fall <= 0.5 {
            let left = 1.0 - fall;
            return Ratio { value: value * left, elasticity: -STEEPEST * (1.0 + excess) / left };
        }
        Ratio { value: 0.25 * value / fall, elasticity: -(1.0 + excess) / excess }
    }

    fn far_end(self, known_exner: f64, flow: f64) -> FarEnd {
        let exner = known_exner * self.value;
        // The drop goes with m|m|: flat at no flow.
        let by_flow = if flow == 0.0 { 0.0 } else { exner * self.elasticity / flow };
        FarEnd { exner, by_flow }
    }
}

#[cfg(test)]
mod tests;
