//! The flow network: the supply tube, two flow nodes with their lands and ports, and two cylinder tubes.
//!
//! Each node (6.47 to 6.53, Appendix VI) joins a land to the supply, a land to the exhaust and the bore of its port.
//! The flows s and e go into the node, m goes out of it:
//!
//! ```text
//! s|s| = K_s/T psi(w_sv, w_n)      w_sv = tube(w_s, s_1 + s_2)
//! e|e| = K_e/T psi(w_e,  w_n)      m    = s + e
//! m|m| = K_p/T psi(w_n,  w_v)      w_v  = tube(w_c, -m)
//! T_n  = sum over inflows (mdot T) / sum of inflows
//! ```
//!
//! psi is the flow function of [`crate::component::gas`], and T is the temperature upstream. With upstream Mach
//! numbers (V.9, 6.54; EQUATIONS section 1) the air approaches a restriction at a speed: its own flow through the
//! port's area A_p gives that speed. w and T upstream then become their stagnation values:
//!
//! ```text
//! M^2 = min(1, R T m^2 / (n A_p^2 P^2)),   w -> w f,  T -> T f,   f = 1 + (n-1)/2 M^2
//! ```
//!
//! Air in a node is at rest, so the pressure there is a stagnation pressure already. The same holds for a vessel right at
//! the valve: the surroundings, and a supply or chambers without a tube. Air that charges a tube has the temperature T_n
//! of its node. Air that leaves a chamber has the temperature of the chamber (6.58, VIII.14; EQUATIONS section 12).
//!
//! The unknowns are the flows rather than the pressures: m|m| is smooth through zero, where the flow over the
//! pressure difference has an infinite slope. Newton's method solves for (w_n, s, e) of each node, bordered by the
//! flow in the supply tube. It starts from the last solution, and at first from air at rest. If it does not converge,
//! nested brackets take over. They cannot fail as long as the iteration over the speeds of approach converges,
//! because the net flow into a node falls with its pressure (EQUATIONS section 3).

mod balance;
mod brackets;
mod continuation;
mod following;
mod mixing;
mod newton;
mod node;
mod nodes;
mod of_rig;
mod predictor;
mod rest;
mod restriction;
mod settling;
mod solve;
mod usual;

use crate::component::air::GasState;
use crate::component::gas::Gas;
use crate::component::tubing::{FarEnd, Tube};
use crate::component::valve::flow_law::FlowLaw;
use crate::number::{Number, Pair};
use following::Following;
pub use node::Node;
pub(crate) use nodes::{BoundaryConditions, Nodes};
use predictor::Predictor;
use restriction::Approach;

/// The direction of the air in a port. It is fixed during a step; its reversal is an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PortFlow {
    /// Into the cylinder.
    Charging,
    /// Out of the cylinder.
    Discharging,
}

/// The ends of the network that are vessels right at the valve, without a tube.
#[derive(Clone, Copy, Debug, Default)]
pub struct Vessels {
    /// The supply.
    pub supply: bool,
    /// Both chambers.
    pub chambers: bool,
}

/// The flow laws of lands and ports.
#[derive(Clone, Copy, Debug)]
pub struct Laws {
    /// Between the supply and a node.
    pub supply: FlowLaw,
    /// Between a node and the exhaust.
    pub exhaust: FlowLaw,
    /// Between a node and its tube.
    pub port: FlowLaw,
}

impl Laws {
    /// The same law everywhere.
    #[must_use]
    pub fn alike(law: FlowLaw) -> Laws {
        Laws { supply: law, exhaust: law, port: law }
    }

    /// Whether all of them are orifices with a constant coefficient of discharge.
    fn are_orifices(&self) -> bool {
        [self.supply, self.exhaust, self.port] == [FlowLaw::Orifice; 3]
    }
}

/// The network and its last solution, from which the next one starts.
#[derive(Clone, Debug)]
pub struct Network {
    gas: Gas,
    supply: GasState,
    /// 1/T of the supply, 1/K.
    per_supply_temperature: f64,
    exhaust: GasState,
    supply_tube: Tube,
    cylinder_tube: Tube,
    /// Whether each chamber's tube is on the other port.
    crossed: bool,
    laws: Laws,
    /// Whether air can flow through the lands and ports, and all are orifices.
    passes_air: bool,
    /// The ends that are vessels right at the valve, with air at rest.
    vessels: Vessels,
    /// The part of a lagged supply tube's drop that follows the flow at once.
    following: Option<Following>,
    /// Stagnation temperature of the air that flows back through the supply tube, K.
    returning: f64,
    /// R / (n A_p^2). It turns T m^2 / P^2 into a squared Mach number; 0 without speeds of approach.
    mach: f64,
    /// The square of C(54), the factor on every upstream Mach number.
    turbulence_squared: f64,
    /// Approaches at the lands to the supply and at the ports that do not follow the flows.
    given: Option<[Approach<Pair>; 2]>,
    nodes: Nodes,
    /// Whether `nodes` is a solution.
    started: bool,
    /// Whether the next solution may be far from `nodes`: then a longer search pays.
    far: bool,
    predictor: Predictor,
    /// Allowed error of a flow, kg/s: in the present step, and in steps up to `short_step` (s).
    flow_error: f64,
    short_error: f64,
    short_step: f64,
    /// Whether flows are solved to rounding error instead.
    tight: bool,
    /// Solutions that were not found, and later ones found in a row, until there are enough of these.
    failures: u32,
    found: u32,
    /// Work counters.
    pub work: NetworkWork,
}

/// Work counters of the network.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NetworkWork {
    /// Requested solutions.
    pub solutions: u64,
    /// Newton iterations of all solutions.
    pub iterations: u64,
    /// Solutions by nested brackets, where Newton's method did not converge.
    pub bracketed: u64,
    /// Passes of the brackets over the speeds of approach.
    pub passes: u64,
}

/// Default of the allowed error of a flow, kg/s.
const FLOW_ERROR: f64 = 1e-15;

impl Network {
    /// A network at rest between a supply and an exhaust. With a `port_area` (m^2) air approaches the restrictions at
    /// a speed; without one it is at rest in front of each.
    #[must_use]
    pub fn new(
        gas: Gas,
        supply: GasState,
        exhaust: GasState,
        supply_tube: Tube,
        cylinder_tube: Tube,
        laws: Laws,
        port_area: Option<f64>,
    ) -> Network {
        let passes_air = gas.is_diatomic() && laws.are_orifices();
        let node = Node {
            exner: 0.5 * (supply.exner + exhaust.exner),
            temperature: supply.temperature,
            carried: supply.temperature,
            supply_flow: 0.0,
            exhaust_flow: 0.0,
        };
        Network {
            gas,
            supply,
            per_supply_temperature: 1.0 / supply.temperature,
            exhaust,
            supply_tube,
            cylinder_tube,
            crossed: false,
            laws,
            passes_air,
            vessels: Vessels::default(),
            following: None,
            returning: supply.temperature,
            mach: port_area.map_or(0.0, |area| gas.gas_constant / (gas.heat_capacity_ratio * area * area)),
            turbulence_squared: 1.0,
            given: None,
            nodes: Nodes::alike(node),
            started: false,
            far: true,
            predictor: Predictor::UNKNOWN,
            flow_error: FLOW_ERROR,
            short_error: FLOW_ERROR,
            short_step: f64::INFINITY,
            tight: false,
            failures: 0,
            found: 0,
            work: NetworkWork::default(),
        }
    }

    /// The network with vessels right at the valve at these ends.
    #[must_use]
    pub fn beside(self, vessels: Vessels) -> Network {
        let mach = if vessels.supply && vessels.chambers { 0.0 } else { self.mach };
        Network { vessels, mach, ..self }
    }

    /// The network with C(54), a factor from 0 to 1 on every upstream Mach number (6.54).
    #[must_use]
    pub(crate) fn with_turbulence(self, coefficient: f64) -> Network {
        Network { turbulence_squared: coefficient * coefficient, ..self }
    }

    /// The network with this allowed error of a flow, kg/s.
    #[must_use]
    pub(crate) fn with_flow_error(self, flow_error: f64) -> Network {
        Network { flow_error, short_error: flow_error, ..self }
    }

    /// The network with this allowed error in steps of `short_step` seconds. Longer steps get a proportionally
    /// smaller error, since the error in mass counts.
    #[must_use]
    pub(crate) fn by_steps_of(self, short_step: f64) -> Network {
        Network { short_step, ..self }
    }

    /// Prepares for a trial step of `h` seconds.
    pub fn begin_step(&mut self, h: f64) {
        self.flow_error = self.short_error * (self.short_step / h).min(1.0);
    }

    /// Switches solving to rounding error on or off. Returns whether that is a change.
    pub fn tighten(&mut self, tight: bool) -> bool {
        std::mem::replace(&mut self.tight, tight) != tight
    }

    /// Sets the flow laws of the lands after the spool has moved.
    pub(crate) fn set_land_laws(&mut self, [supply, exhaust]: [FlowLaw; 2]) {
        (self.laws.supply, self.laws.exhaust) = (supply, exhaust);
    }

    /// Joins the tube of each chamber to the other port, or to its own.
    pub(crate) fn cross_tubes(&mut self, crossed: bool) {
        if std::mem::replace(&mut self.crossed, crossed) != crossed {
            self.cylinder_tube = self.cylinder_tube.exchanged();
        }
    }

    /// The flows jump, so the last solutions do not predict the next one.
    pub fn jump(&mut self) {
        self.predictor = Predictor::UNKNOWN;
        self.expect_jump();
    }

    /// A mode has changed, so the next solution may be far from the last one.
    pub fn expect_jump(&mut self) {
        self.far = true;
    }

    /// Why flows jump, and the remedy, if Newton's method has lost them of late.
    pub(crate) fn jumps(&self) -> Option<&'static str> {
        (self.mach > 0.0 && self.failures > 0).then_some(
            "the flow through the ports jumps, as the air gains more pressure from its speed behind wide lands than tubes and ports take: write valve.upstream_mach = false",
        )
    }

    /// The supply, in front of its tube.
    #[must_use]
    pub fn supply(&self) -> &GasState {
        &self.supply
    }

    /// Sets the air of the supply.
    pub(crate) fn set_supply(&mut self, supply: GasState) {
        (self.supply, self.per_supply_temperature) = (supply, 1.0 / supply.temperature);
    }

    /// The same in front of both nodes, K.
    fn supply_temperature(&self) -> Pair {
        Pair::splat(self.supply.temperature)
    }

    /// The exhaust behind both.
    fn exhausts(&self) -> GasState<Pair> {
        GasState {
            exner: Pair::splat(self.exhaust.exner),
            temperature: Pair::splat(self.exhaust.temperature),
        }
    }

    /// The exhaust.
    #[must_use]
    pub fn exhaust(&self) -> &GasState {
        &self.exhaust
    }

    /// w in front of the supply's lands, behind its tube.
    pub(crate) fn exner_at_lands(&self, nodes: &Nodes) -> f64 {
        self.supply_end(nodes.supply.reduce_add()).exner
    }

    /// w at the far side of the ports, for these chambers and these directions of the air.
    pub(crate) fn exner_behind_ports(
        &self,
        nodes: &Nodes,
        chambers: &GasState<Pair>,
        ports: &[PortFlow; 2],
    ) -> Pair {
        let charging = PortFlow::charging(ports);
        let temperature = Pair::choose(charging, nodes.carried, chambers.temperature);
        self.cylinder_tube.far_end(&GasState { temperature, ..*chambers }, -nodes.port_flow()).exner
    }

    /// w at the valve's end of the supply tube, for a flow (kg/s) from the supply.
    #[inline(always)]
    fn supply_end(&self, total: f64) -> FarEnd {
        let temperature = if total < 0.0 { self.returning } else { self.supply.temperature };
        match &self.following {
            None => self.supply_tube.far_end(&GasState { temperature, ..self.supply }, total),
            Some(following) => following.far_end(self.supply.exner, temperature, total),
        }
    }

    /// Lets a part of the drop in a lagged supply tube follow the flow at once. `part` is its exponent of the tube's
    /// factor; the rest has come to the known pressure.
    pub(crate) fn let_supply_follow(&mut self, source: GasState, tube: Tube, part: f64) {
        self.following = (part > 0.0).then_some(Following { source, tube, part });
    }
}

#[cfg(test)]
mod air_in_tubes_tests;
#[cfg(test)]
mod appendix_tests;
#[cfg(test)]
mod tests;
