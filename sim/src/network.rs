//! The network of flows: supply tube, two flow nodes with their lands and ports, two cylinder tubes.
//!
//! Each node (6.47 to 6.53, Appendix VI) joins a land to the supply, a land to the exhaust and the
//! bore of its port; with s, e and m the flows into, into and out of it:
//!
//! ```text
//! s|s| = K_s/T psi(w_sv, w_n)      w_sv = tube(w_s, s_1 + s_2)
//! e|e| = K_e/T psi(w_e,  w_n)      m    = s + e
//! m|m| = K_p/T psi(w_n,  w_v)      w_v  = tube(w_c, -m)
//! T_n  = sum over inflows (mdot T) / sum of inflows
//! ```
//!
//! psi is the flow function of [`crate::component::gas`] and T the temperature upstream. With upstream Mach
//! numbers (V.9, 6.54; EQUATIONS section 1) the air approaches a restriction at the speed that its
//! own flow has in the port's area A_p, and w and T upstream become their stagnation values:
//!
//! ```text
//! M^2 = min(1, R T m^2 / (n A_p^2 P^2)),   w -> w f,  T -> T f,   f = 1 + (n-1)/2 M^2
//! ```
//!
//! The air in a node stands still, and so does that of a vessel right at the valve: the surroundings, and supply
//! and chambers that no tube joins to it. Their pressure is a stagnation pressure already. Air that charges a
//! tube has the temperature T_n of the node it comes from, air that leaves a chamber that of the chamber (6.58,
//! VIII.14; EQUATIONS section 12).
//!
//! The unknowns are the flows: m|m| is smooth through zero, where a
//! pressure difference has an infinite slope. Newton's
//! method on (w_n, s, e) a node, bordered by the flow in the supply tube; it starts from the last
//! solution, the first one from air at rest. Where it does not converge, nested brackets do: the net flow into a node
//! falls with its pressure, so they cannot fail (EQUATIONS section 3) as long as the speeds of
//! approach come to rest.

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

use crate::component::air::Station;
use crate::component::gas::Gas;
use crate::component::tubing::{FarEnd, Tube};
use crate::component::valve::flow_law::FlowLaw;
use crate::number::{Number, Pair};
use following::Following;
pub use node::Node;
pub(crate) use nodes::{Nodes, Surroundings};
use predictor::Predictor;

/// Which way the air in a port goes. Fixed during a step; its reversal is an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PortFlow {
    /// Into the cylinder.
    Charging,
    /// Out of the cylinder.
    Discharging,
}

/// Which ends of the network are vessels right at the valve: no tube brings their air to it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Vessels {
    /// The supply.
    pub supply: bool,
    /// Both chambers.
    pub chambers: bool,
}

/// The laws of flow of lands and ports.
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

    /// Whether everything is an orifice with a constant coefficient of discharge.
    fn are_orifices(&self) -> bool {
        [self.supply, self.exhaust, self.port] == [FlowLaw::Orifice; 3]
    }
}

/// What the network joins, and the last solution, from which the next one starts.
#[derive(Clone, Debug)]
pub struct Network {
    gas: Gas,
    supply: Station,
    /// 1/T of the supply, 1/K.
    per_supply_temperature: f64,
    exhaust: Station,
    supply_tube: Tube,
    cylinder_tube: Tube,
    laws: Laws,
    /// Whether lands and ports are orifices that air flows through.
    passes_air: bool,
    /// Which ends are vessels right at the valve, whose air is at rest.
    vessels: Vessels,
    /// What of a lagged supply tube follows the flow at once.
    following: Option<Following>,
    /// Stagnation temperature of the air that goes back through the supply tube, K.
    returning: f64,
    /// R / (n A_p^2): makes T m^2 / P^2 a squared Mach number; 0 where approach counts for nothing.
    mach: f64,
    /// The square of C(54), which every upstream Mach number is multiplied by.
    turbulence_squared: f64,
    nodes: Nodes,
    /// Whether `nodes` is a solution.
    started: bool,
    /// Whether the next solution may be far from `nodes`, so that a search is worth its time.
    far: bool,
    predictor: Predictor,
    /// Allowed error of a flow, kg/s, in the present step and in one no longer than `short_step` (s).
    flow_error: f64,
    short_error: f64,
    short_step: f64,
    /// Whether flows are solved to rounding instead.
    tight: bool,
    /// Solutions that were not found, and those found since, until there are enough of these in a row.
    failures: u32,
    found: u32,
    /// Work done so far.
    pub work: NetworkWork,
}

/// Counters of the work of the network.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NetworkWork {
    /// Requested solutions.
    pub solutions: u64,
    /// Newton iterations over all of them.
    pub iterations: u64,
    /// Solutions by nested brackets, where Newton did not converge.
    pub bracketed: u64,
    /// Passes of these over the speeds of approach.
    pub passes: u64,
}

/// Default of the allowed error of a flow, kg/s.
const FLOW_ERROR: f64 = 1e-15;

impl Network {
    /// A network at rest between a supply and an exhaust. `port_area` (m^2) makes flows approach
    /// their restrictions at a speed; without one, air is at rest in front of each.
    #[must_use]
    pub fn new(
        gas: Gas,
        supply: Station,
        exhaust: Station,
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
            laws,
            passes_air,
            vessels: Vessels::default(),
            following: None,
            returning: supply.temperature,
            mach: port_area.map_or(0.0, |area| gas.gas_constant / (gas.heat_capacity_ratio * area * area)),
            turbulence_squared: 1.0,
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

    /// The same with the air at rest in front of the valve at these ends: no tube brings it there.
    #[must_use]
    pub fn beside(self, vessels: Vessels) -> Network {
        let mach = if vessels.supply && vessels.chambers { 0.0 } else { self.mach };
        Network { vessels, mach, ..self }
    }

    /// The same with every upstream Mach number multiplied by C(54), from 0 to 1 (6.54).
    #[must_use]
    pub fn with_turbulence(self, coefficient: f64) -> Network {
        Network { turbulence_squared: coefficient * coefficient, ..self }
    }

    /// The same with flows to this error, kg/s.
    #[must_use]
    pub fn to_within(self, flow_error: f64) -> Network {
        Network { flow_error, short_error: flow_error, ..self }
    }

    /// The same with that error in steps of `short_step` seconds, and as much less in longer ones: it is mass that
    /// counts.
    #[must_use]
    pub fn by_steps_of(self, short_step: f64) -> Network {
        Network { short_step, ..self }
    }

    /// A step of `h` seconds is about to be tried.
    pub fn begin_step(&mut self, h: f64) {
        self.flow_error = self.short_error * (self.short_step / h).min(1.0);
    }

    /// Switches on or off that flows are solved to rounding; returns whether that is a change.
    pub fn tighten(&mut self, tight: bool) -> bool {
        std::mem::replace(&mut self.tight, tight) != tight
    }

    /// Sets the laws of the lands to the supply and to the exhaust, where the spool has moved.
    pub(crate) fn set_land_laws(&mut self, [supply, exhaust]: [FlowLaw; 2]) {
        (self.laws.supply, self.laws.exhaust) = (supply, exhaust);
    }

    /// The flows jump: what they were says nothing of the next ones.
    pub fn jump(&mut self) {
        self.predictor = Predictor::UNKNOWN;
        self.expect_jump();
    }

    /// The next solution may be far from the last one: a mode changed.
    pub fn expect_jump(&mut self) {
        self.far = true;
    }

    /// The supply, in front of its tube.
    #[must_use]
    pub fn supply(&self) -> &Station {
        &self.supply
    }

    /// Sets the Exner pressure of the supply.
    pub fn set_supply(&mut self, exner: f64) {
        self.supply.exner = exner;
    }

    /// The same in front of both nodes, K.
    fn supply_temperature(&self) -> Pair {
        Pair::splat(self.supply.temperature)
    }

    /// The exhaust behind both.
    fn exhausts(&self) -> Station<Pair> {
        Station { exner: Pair::splat(self.exhaust.exner), temperature: Pair::splat(self.exhaust.temperature) }
    }

    /// The exhaust.
    #[must_use]
    pub fn exhaust(&self) -> &Station {
        &self.exhaust
    }

    /// w in front of the supply's lands, behind its tube.
    pub(crate) fn exner_at_lands(&self, nodes: &Nodes) -> f64 {
        self.supply_end(nodes.supply.reduce_add()).exner
    }

    /// w at the far side of the ports, for the chambers that they are joined to and the directions of the air in
    /// them.
    pub(crate) fn exner_behind_ports(
        &self,
        nodes: &Nodes,
        chambers: &Station<Pair>,
        ports: &[PortFlow; 2],
    ) -> Pair {
        let charging = PortFlow::charging(ports);
        let temperature = Pair::choose(charging, nodes.carried, chambers.temperature);
        self.cylinder_tube.far_end(&Station { temperature, ..*chambers }, -nodes.port_flow()).exner
    }

    /// The valve's end of the supply tube, for a flow (kg/s) from the supply.
    #[inline(always)]
    fn supply_end(&self, total: f64) -> FarEnd {
        let temperature = if total < 0.0 { self.returning } else { self.supply.temperature };
        match &self.following {
            None => self.supply_tube.far_end(&Station { temperature, ..self.supply }, total),
            Some(following) => following.far_end(self.supply.exner, temperature, total),
        }
    }

    /// Has a part of the drop in the lagged supply tube follow the flow at once: the exponent `part` of what the
    /// tube makes of the supply, where the rest has come to the known pressure.
    pub(crate) fn let_supply_follow(&mut self, source: Station, tube: Tube, part: f64) {
        self.following = (part > 0.0).then_some(Following { source, tube, part });
    }
}

#[cfg(test)]
mod air_in_tubes_tests;
#[cfg(test)]
mod appendix_tests;
#[cfg(test)]
mod tests;
