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
//! (`tubing/pipe.rs`), and a sharp restriction in place of a tube (`tubing/connector.rs`). Beside a valve without tubes
//! one-way flow controls stand at the ports of the cylinder (`tubing/flow_control.rs`).
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
mod flow_control;
mod pipe;

use crate::component::air::GasState;
use crate::component::gas::Gas;
use crate::component::supply;
use crate::component::valve::{self, Valve, speed_counts};
use crate::key::{keys, words};
use crate::number::Number;
use crate::values::Rig;
use connector::Connector;
pub use flow_control::FlowControlKind;
use flow_control::FlowControls;
use pipe::Pipe;

words! {
    /// Pressure drop between supply, valve and cylinder.
    pub enum TubingKind {
        /// By a slope over the flow that was measured.
        Empirical = "empirical",
        /// As a pipe with friction.
        Analytical = "analytical",
        /// None.
        None = "none",
    } not built "dynamic"
}

keys! {
    MODEL: TubingKind = choice("tubing.model", "L(11)", "Pressure drop between supply, valve and cylinder.");
    DROP_SLOPE: f64 = number("tubing.drop_slope", 0.4, 0.0, 0.99, "C(28)", "Part of the pressure that is lost at the reference flow.").of(&["empirical"]).spread();
    REFERENCE_FLOW_KG_S: f64 = number("tubing.reference_flow_kg_s", 0.00465, 1e-5, 100.0, "C(30)", "Flow at which drop_slope holds.").of(&["empirical"]);
    DIAMETER_MM: f64 = number("tubing.diameter_mm", 4.0, 0.1, 500.0, "C(13)", "Bore of the tubes; with the multiple flow node that of the restriction at the cylinder.");
    LENGTH_M: f64 = number("tubing.length_m", 1.0, 0.0, 1000.0, "", "Length of each tube.").of(&["analytical", "dynamic"]);
    FRICTION_FACTOR: f64 = number("tubing.friction_factor", 0.005, 1e-5, 1.0, "", "Fanning friction factor.").of(&["analytical", "dynamic"]);
    FLOW_CONTROL: FlowControlKind = choice("tubing.flow_control", "", "One-way flow controls at the ports of the cylinder: the way that they throttle; the other is free.");
    FLOW_CONTROL_1_CONDUCTANCE: f64 = number("tubing.flow_control_1_conductance_m3_per_s_pa", 5e-9, 1e-12, 1e-6, "", "Sonic conductance of the throttle of chamber 1 (ISO 6358); a round number, as the needle may stand anywhere.").chosen_by(&FLOW_CONTROL, &["meter-out", "meter-in"]).spread();
    FLOW_CONTROL_2_CONDUCTANCE: f64 = number("tubing.flow_control_2_conductance_m3_per_s_pa", 5e-9, 1e-12, 1e-6, "", "The same of chamber 2.").chosen_by(&FLOW_CONTROL, &["meter-out", "meter-in"]).spread();
    FLOW_CONTROL_CRITICAL_RATIO: f64 = number("tubing.flow_control_critical_ratio", 0.3, 0.0, 0.9, "", "Critical pressure ratio of both throttles (ISO 6358).").chosen_by(&FLOW_CONTROL, &["meter-out", "meter-in"]);
    LAG_S: f64 = number("tubing.lag_s", 0.0, 0.0, 1.0, "", "First-order lag of the pressure ratio, behind an ideal supply; 0: solved together with the valve.");
}

/// The tubes of a rig: the one from the supply, and those to the cylinder. With the multiple flow node a restriction at
/// the cylinder stands for the tube (6.55 to 6.60), and the supply has none.
#[must_use]
pub fn tubes(rig: &Rig, gas: &Gas) -> (Tube, Tube) {
    let bore = rig.get(&keys::DIAMETER_MM) * 1e-3;
    let model = rig.get(&valve::keys::MODEL);
    if model.facts().replaces_tubes {
        let bore = model.connector_bore(rig).unwrap_or(bore);
        return (Tube::none(), Tube::connector(gas, rig.get(&valve::keys::DISCHARGE_SUPPLY), bore));
    }
    let tube = match rig.get(&keys::MODEL) {
        TubingKind::None => {
            let controls = FlowControls::of(rig, gas).map_or(Drop::None, Drop::FlowControls);
            return (Tube::none(), Tube(controls));
        }
        TubingKind::Analytical => {
            Tube::analytical(gas, rig.get(&keys::LENGTH_M), bore, rig.get(&keys::FRICTION_FACTOR))
        }
        TubingKind::Empirical => {
            Tube::empirical(gas, rig.get(&keys::DROP_SLOPE), rig.get(&keys::REFERENCE_FLOW_KG_S))
        }
    };
    (tube, tube)
}

/// Whether flow controls stand at the ports of the cylinder: only beside a valve without tubes.
#[must_use]
pub fn has_flow_controls(rig: &Rig) -> bool {
    rig.get(&keys::FLOW_CONTROL) != FlowControlKind::None
        && rig.get(&keys::MODEL) == TubingKind::None
        && !rig.get(&valve::keys::MODEL).facts().replaces_tubes
}

/// The pressure that the speed in a port recovers behind an infinitely wide land, over the pressure that the tube from
/// the supply loses, both as slopes over the flow, where only the lands' clearance is fed. 0 without speeds of approach.
pub(crate) fn speed_recovery(rig: &Rig, gas: &Gas, valve: &Valve) -> f64 {
    let (tube, supply) = (tubes(rig, gas).0, supply::station(rig, gas));
    if !speed_counts(rig) || tube.is_none() {
        return 0.0;
    }
    let pressure = gas.pressure(supply.exner);
    let choked = gas.flow_constant() / supply.temperature * gas.flow_function(supply.exner, 0.0).value;
    let leak = (valve.discharge_supply * valve.edge_area(-1.0)).max(1e-3 * valve.port_area());
    let flow = leak * choked.sqrt();
    let far = tube.far_end(&supply, flow);
    let lost = -far.by_flow / (gas.exner_exponent() * far.exner);
    let density_of_flow = gas.gas_constant * supply.temperature / (valve.port_area() * pressure).powi(2);
    rig.get(&valve::keys::TURBULENCE).powi(2) * density_of_flow * flow / lost
}

/// Whether the speed in the ports gives more pressure back behind a wide land than the tube from the
/// supply loses on the way: then the flow has no steady value near the supply's pressure.
///
/// A land of area A gives back 1 - (A_p / (C_d A))^2 of the dynamic pressure R T m^2 / (2 A_p^2 P). Told
/// by the slopes over the flow where the lands' clearance alone is fed. A supply without a tube is at
/// rest.
pub(crate) fn speed_outweighs_supply_tube(rig: &Rig) -> bool {
    let valve = Valve::of(rig);
    let width = valve.discharge_supply * valve.edge_area(valve.travel - valve.lap) / valve.port_area();
    width > 1.0 && (1.0 - 1.0 / (width * width)) * speed_recovery(rig, &Gas::of(rig), &valve) > 1.0
}

/// A tube between a known pressure and a valve port.
#[derive(Clone, Copy, Debug)]
pub struct Tube(Drop);

#[derive(Clone, Copy, Debug)]
enum Drop {
    None,
    /// `decay` is d ln w / d mdot of a flow away from the known end, s/kg.
    Empirical {
        decay: f64,
    },
    Analytical(Pipe),
    Connector(Connector),
    FlowControls(FlowControls),
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
        Tube(Drop::None)
    }

    /// Whether both ends have the same pressure, whatever flows.
    #[must_use]
    pub fn is_none(&self) -> bool {
        matches!(self.0, Drop::None)
    }

    /// Whether the air at its far end is at rest: there is no tube that brings it.
    #[must_use]
    pub(crate) fn ends_at_rest(&self) -> bool {
        matches!(self.0, Drop::None | Drop::FlowControls(_))
    }

    /// That of node `i`, where those of both nodes differ.
    pub(crate) fn of_node(&self, i: usize) -> Tube {
        match &self.0 {
            Drop::FlowControls(controls) => Tube(Drop::FlowControls(controls.of_place(i))),
            _ => *self,
        }
    }

    /// Those of the nodes the other way round.
    pub(crate) fn exchanged(&self) -> Tube {
        match &self.0 {
            Drop::FlowControls(controls) => Tube(Drop::FlowControls(controls.exchanged())),
            _ => *self,
        }
    }

    /// The decay d ln w/d mdot of a flow away from the known end, s/kg, if it is the same for all flows.
    #[inline(always)]
    pub(crate) fn decay(&self) -> Option<f64> {
        match self.0 {
            Drop::None => Some(0.0),
            Drop::Empirical { decay } => Some(decay),
            Drop::Analytical(_) | Drop::Connector(_) | Drop::FlowControls(_) => None,
        }
    }

    /// Whether the drop depends on the temperature of the air in the tube.
    pub(crate) fn feels_temperature(&self) -> bool {
        matches!(self.0, Drop::Analytical(_) | Drop::Connector(_) | Drop::FlowControls(_))
    }

    /// The regression line of the thesis: the pressure falls by the fraction `drop_slope` (below 1)
    /// at `reference_flow_kg_s`.
    #[must_use]
    pub fn empirical(gas: &Gas, drop_slope: f64, reference_flow_kg_s: f64) -> Tube {
        if drop_slope == 0.0 {
            return Tube::none();
        }
        Tube(Drop::Empirical {
            decay: gas.exner_exponent() * libm::log(1.0 - drop_slope) / reference_flow_kg_s,
        })
    }

    /// A pipe with friction and no heat through its wall (Appendix VIII). The factor is Fanning's, a
    /// quarter of Darcy's. Without friction it is no tube.
    #[must_use]
    pub fn analytical(gas: &Gas, length_m: f64, diameter_m: f64, fanning_friction_factor: f64) -> Tube {
        let span = 4.0 * fanning_friction_factor * length_m / diameter_m;
        if span < pipe::MIN_SPAN {
            return Tube::none();
        }
        Tube(Drop::Analytical(Pipe::new(*gas, span, diameter_m)))
    }

    /// A sharp restriction in place of a tube (6.55 to 6.60): bore and coefficient of discharge.
    #[must_use]
    pub fn connector(gas: &Gas, discharge: f64, diameter_m: f64) -> Tube {
        Tube(Drop::Connector(Connector::new(*gas, discharge, diameter_m)))
    }

    /// The Exner pressure at the far end, for a flow (kg/s) from the known end to it; `known` as in `far_end`.
    #[must_use]
    pub fn far_exner(&self, known: &GasState, flow: f64) -> f64 {
        self.far_end(known, flow).exner
    }

    /// The far end, for a flow (kg/s) from the known end to the far end. `known` has the pressure at the known
    /// end and the stagnation temperature of the air in the tube: that of the place the air comes from.
    #[inline(always)]
    pub(crate) fn far_end<N: Number>(&self, known: &GasState<N>, flow: N) -> FarEnd<N> {
        // The usual one first.
        if let Drop::Empirical { decay } = &self.0 {
            let decay = N::from(*decay);
            let exner = known.exner * (decay * flow).exponential();
            return FarEnd { exner, by_flow: decay * exner };
        }
        match &self.0 {
            Drop::None | Drop::Empirical { .. } => FarEnd { exner: known.exner, by_flow: N::from(0.0) },
            Drop::Analytical(pipe) => one_by_one(known, flow, |_, known, flow| pipe.ratio(known, flow)),
            Drop::Connector(connector) => {
                one_by_one(known, flow, |_, known, flow| connector.ratio(known, flow))
            }
            Drop::FlowControls(controls) => {
                one_by_one(known, flow, |i, known, flow| controls.ratio(i, known, flow))
            }
        }
    }
}

/// The far ends of tubes whose equations have to be asked how large things are.
#[inline]
fn one_by_one<N: Number>(
    known: &GasState<N>,
    flow: N,
    ratio: impl Fn(usize, &GasState, f64) -> Ratio,
) -> FarEnd<N> {
    let mut slopes = [0.0; 2];
    let exner = N::of(|i| {
        let (known, flow) =
            (GasState { exner: known.exner.lane(i), temperature: known.temperature.lane(i) }, flow.lane(i));
        let far = ratio(i, &known, flow).far_end(known.exner, flow);
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
