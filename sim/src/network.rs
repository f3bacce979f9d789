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
//! psi is the flow function of [`crate::gas`] and T the temperature upstream. With upstream Mach
//! numbers (V.9, 6.54; EQUATIONS section 1) the air approaches a restriction at the speed that its
//! own flow has in the port's area A_p, and w and T upstream become their stagnation values:
//!
//! ```text
//! M^2 = min(1, R T m^2 / (n A_p^2 P^2)),   w -> w f,  T -> T f,   f = 1 + (n-1)/2 M^2
//! ```
//!
//! The air in a node stands still, and so does that of the surroundings and of a supply without a
//! tube: their pressure is a stagnation pressure already. The unknowns are the flows: m|m| is smooth through zero, where a
//! pressure difference has an infinite slope. Newton's
//! method on (w_n, s, e) a node, bordered by the flow in the supply tube; it starts from the last
//! solution. Where it does not converge, nested brackets do: the net flow into a node falls with its
//! pressure, so they cannot fail (EQUATIONS section 3).

mod brackets;
mod rest;
mod restriction;

use crate::air::Station;
use crate::flow_law::FlowLaw;
use crate::gas::Gas;
use crate::tubing::{FarEnd, Tube};
use crate::valve::Conductances;
use rest::{Slopes, land_line};
use restriction::Approach;

/// Which way the air in a port goes. Fixed during a step; its reversal is an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PortFlow {
    /// Into the cylinder.
    Charging,
    /// Out of the cylinder.
    Discharging,
}

/// One node and its flows.
#[derive(Clone, Copy, Debug)]
pub struct Node {
    /// w_n.
    pub exner: f64,
    /// T_n, K: of the air that leaves by the lands.
    pub temperature: f64,
    /// Temperature of the air that goes on into the cylinder, K.
    pub carried: f64,
    /// s, kg/s, from the supply.
    pub supply_flow: f64,
    /// e, kg/s, from the exhaust; negative when air leaves.
    pub exhaust_flow: f64,
    /// w in front of the supply land, behind the supply's tube.
    pub supply_exner: f64,
    /// w at the far side of the port.
    pub port_exner: f64,
}

impl Node {
    fn station(&self) -> Station {
        Station { exner: self.exner, temperature: self.temperature }
    }

    const NOT_A_NUMBER: Node = Node {
        exner: f64::NAN,
        temperature: f64::NAN,
        carried: f64::NAN,
        supply_flow: f64::NAN,
        exhaust_flow: f64::NAN,
        supply_exner: f64::NAN,
        port_exner: f64::NAN,
    };

    fn is_finite(&self) -> bool {
        (self.exner + self.temperature + self.supply_flow + self.exhaust_flow).is_finite()
    }

    /// m, kg/s, into the cylinder.
    #[must_use]
    pub fn port_flow(&self) -> f64 {
        self.supply_flow + self.exhaust_flow
    }
}

/// The laws of flow of lands and ports.
#[derive(Clone, Copy, Debug)]
pub struct Laws {
    /// Between supply or exhaust and a node.
    pub land: FlowLaw,
    /// Between a node and its tube.
    pub port: FlowLaw,
}

/// What the network joins, and the last solution, from which the next one starts.
#[derive(Clone, Debug)]
pub struct Network {
    gas: Gas,
    supply: Station,
    exhaust: Station,
    supply_tube: Tube,
    cylinder_tube: Tube,
    laws: Laws,
    /// Whether the supply is a reservoir right at the valve, whose air is at rest.
    reservoir: bool,
    /// R / (n A_p^2): makes T m^2 / P^2 a squared Mach number; 0 where approach counts for nothing.
    mach: f64,
    nodes: [Node; 2],
    /// Whether `nodes` is a solution.
    started: bool,
    /// Whether the next solution may be far from `nodes`, so that a search is worth its time.
    far: bool,
    /// Solutions that were not found since the last one that was.
    failures: u32,
    /// Work done so far.
    pub work: NetworkWork,
}

/// Counters of the work of the network.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NetworkWork {
    /// Solutions asked for.
    pub solutions: u64,
    /// Newton iterations over all of them.
    pub iterations: u64,
    /// Solutions by nested brackets, where Newton did not converge.
    pub bracketed: u64,
}

/// Flows are solved to this change in the last correction, kg/s. The error after it is far smaller,
/// the convergence being quadratic but for the node temperature.
const FLOW_TOLERANCE: f64 = 1e-12;

/// After so many failures, with a step ten times shorter each time, the solution that was followed has
/// come to its end: with upstream Mach numbers a land that is wider than its port has none below M = 1
/// for large coefficients of discharge. Another one is searched for, and the flows jump to it.
const MOST_FAILURES: u32 = 5;

/// Residuals and slopes of the three restrictions of a node.
struct Linearised {
    /// Residuals of supply land, exhaust land and port.
    residual: [f64; 3],
    /// Slopes over each flow: 2|s|, 2|e| and 2|m| with approach, the port's with its tube.
    stiffness: [f64; 3],
    /// Slope of each residual over w_n; the port's is negative.
    by_node: [f64; 3],
    /// Slope of the supply land's residual over the flow in the supply tube.
    by_total: f64,
}

/// A correction of one node: at a fixed flow in the supply tube, and per unit of its change.
#[derive(Clone, Copy)]
struct Correction {
    exner: f64,
    supply: f64,
    exhaust: f64,
}

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
        let node = Node {
            exner: 0.5 * (supply.exner + exhaust.exner),
            temperature: supply.temperature,
            carried: supply.temperature,
            supply_flow: 0.0,
            exhaust_flow: 0.0,
            supply_exner: supply.exner,
            port_exner: supply.exner,
        };
        Network {
            gas,
            supply,
            exhaust,
            supply_tube,
            cylinder_tube,
            laws,
            reservoir: false,
            mach: port_area.map_or(0.0, |area| gas.gas_constant / (gas.heat_capacity_ratio * area * area)),
            nodes: [node; 2],
            started: false,
            far: true,
            failures: 0,
            work: NetworkWork::default(),
        }
    }

    /// The same with the supply's air at rest in front of the lands: no tube brings it there.
    #[must_use]
    pub fn from_reservoir(self) -> Network {
        Network { reservoir: true, ..self }
    }

    /// The next solution may be far from the last one: the spool has jumped, or a mode changed.
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

    /// The exhaust.
    #[must_use]
    pub fn exhaust(&self) -> &Station {
        &self.exhaust
    }

    /// The flows for the open areas, chambers and port directions of this instant.
    pub(crate) fn solve(
        &mut self,
        valve: &[Conductances; 2],
        chambers: &[Station; 2],
        ports: &[PortFlow; 2],
    ) -> [Node; 2] {
        self.work.solutions += 1;
        let usable = |value: f64| value.is_finite() && value > 0.0;
        let in_order = |chamber: &Station| usable(chamber.exner) && usable(chamber.temperature);
        if !(chambers.iter().all(in_order) && valve.iter().all(|lands| lands.supply.is_finite())) {
            return [Node::NOT_A_NUMBER; 2];
        }
        // A trial step too large may lead to where there is no solution, or leave no numbers: it is
        // told so, and the last solution is not spoilt by it.
        let last = self.nodes;
        if !(self.started && self.by_newton(valve, chambers, ports)) {
            self.failures += 1;
            if !self.far && self.failures < MOST_FAILURES {
                self.nodes = last;
                return [Node::NOT_A_NUMBER; 2];
            }
            self.work.bracketed += 1;
            self.by_brackets(valve, chambers, ports);
            // Sharpens what the brackets found; they are the answer where it fails again.
            let found = self.nodes;
            if !self.by_newton(valve, chambers, ports) {
                self.nodes = found;
            }
        }
        let mut solved = self.nodes;
        let total = solved[0].supply_flow + solved[1].supply_flow;
        let supply_exner = self.supply_tube.far_end(&self.supply, total).exner;
        for ((node, lands), chamber) in solved.iter_mut().zip(valve).zip(chambers) {
            node.carried = self.carried(node, lands.port);
            node.supply_exner = supply_exner;
            node.port_exner = self.far_of_cylinder(chamber, node.port_flow());
        }
        if solved.iter().all(Node::is_finite) {
            self.started = true;
            self.far = false;
            self.failures = 0;
        } else {
            self.nodes = last;
        }
        solved
    }

    /// Newton's method from the present nodes; false where it does not converge.
    fn newton(
        &mut self,
        valve: &[Conductances; 2],
        chambers: &[Station; 2],
        ports: &[PortFlow; 2],
        slopes: Slopes,
    ) -> bool {
        self.begin_flows(valve);
        for _ in 0..slopes.most_iterations() {
            self.work.iterations += 1;
            let total = self.nodes[0].supply_flow + self.nodes[1].supply_flow;
            let at_valve = self.supply_tube.far_end(&self.supply, total);
            let mut fixed = [Correction { exner: 0.0, supply: 0.0, exhaust: 0.0 }; 2];
            let mut per_total = fixed;
            for i in 0..2 {
                self.nodes[i].temperature = match valve[i].port {
                    Some(_) => self.mixed_temperature(i, &chambers[i], ports[i]),
                    // Without a node the exhaust land takes the cylinder's air (6.40).
                    None => chambers[i].temperature,
                };
                let lines = self.linearise(i, &valve[i], &chambers[i], ports[i], at_valve, slopes);
                let r = lines.residual;
                fixed[i] = lines.correct([-r[0], -r[1], -r[2]]);
                per_total[i] = lines.correct([-lines.by_total, 0.0, 0.0]);
            }
            // The change of the total is the sum of its parts, which depend on it.
            let change =
                (fixed[0].supply + fixed[1].supply) / (1.0 - per_total[0].supply - per_total[1].supply);
            let largest = self.apply(&fixed, &per_total, change);
            if !largest.is_finite() {
                return false;
            }
            if largest < FLOW_TOLERANCE || self.is_rounding(slopes, largest) {
                return true;
            }
        }
        false
    }

    /// A land that was shut and has opened begins with what its pressures drive through it: from no flow
    /// at all a square has no slope to follow.
    fn begin_flows(&mut self, valve: &[Conductances; 2]) {
        let signed_root = |square: f64| square.abs().sqrt().copysign(square);
        for (i, lands) in valve.iter().enumerate() {
            let (node, here) = (self.nodes[i], self.nodes[i].station());
            if node.supply_flow == 0.0 && lands.supply > 0.0 {
                let square = self.land(lands.supply, &self.supply, Approach::NONE, &here).value;
                self.nodes[i].supply_flow = signed_root(square);
            }
            if node.exhaust_flow == 0.0 && lands.exhaust > 0.0 {
                let square = self.land(lands.exhaust, &self.exhaust, Approach::NONE, &here).value;
                self.nodes[i].exhaust_flow = signed_root(square);
            }
        }
    }

    /// Applies a correction and tells its largest change of a flow.
    fn apply(&mut self, fixed: &[Correction; 2], per_total: &[Correction; 2], change: f64) -> f64 {
        let mut largest = 0.0_f64;
        for i in 0..2 {
            let node = &mut self.nodes[i];
            let supply = fixed[i].supply + change * per_total[i].supply;
            let exhaust = fixed[i].exhaust + change * per_total[i].exhaust;
            let exner = node.exner + fixed[i].exner + change * per_total[i].exner;
            if !(supply + exhaust + exner).is_finite() {
                return f64::NAN;
            }
            node.exner = exner.clamp(0.5 * node.exner, 2.0 * node.exner);
            node.supply_flow += supply;
            node.exhaust_flow += exhaust;
            largest = largest.max(supply.abs().max(exhaust.abs()));
        }
        largest
    }

    fn linearise(
        &self,
        i: usize,
        valve: &Conductances,
        chamber: &Station,
        port: PortFlow,
        at_valve: FarEnd,
        slopes: Slopes,
    ) -> Linearised {
        let node = &self.nodes[i];
        let here = node.station();
        let supply = Station { exner: at_valve.exner, temperature: self.supply.temperature };
        let (s_flow, e_flow) = (node.supply_flow, node.exhaust_flow);
        let s = self.land(valve.supply, &supply, self.supply_approach(&supply, s_flow), &here);
        let e = self.land(valve.exhaust, &self.exhaust, Approach::NONE, &here);
        let p = self.port_line(valve.port, node, chamber, port, slopes);
        let shut = valve.supply == 0.0 || valve.exhaust == 0.0;
        let least = |conductance, source| if shut { self.creeping(conductance, source) } else { 0.0 };
        let s_line = land_line(valve.supply, s_flow, s.value, least(valve.supply, &supply), slopes);
        let e_line = land_line(valve.exhaust, e_flow, e.value, least(valve.exhaust, &self.exhaust), slopes);
        Linearised {
            residual: [s_line.0, e_line.0, p.residual],
            stiffness: [s_line.1 - s.by_flow, e_line.1 - e.by_flow, p.by_flow],
            by_node: [-s.by_second, -e.by_second, p.by_node],
            by_total: -s.by_first * at_valve.by_flow,
        }
    }

    /// A node mixes what flows into it; without one the air comes from the land that feeds the port.
    fn carried(&self, node: &Node, bore: Option<f64>) -> f64 {
        let from_lands =
            [(node.supply_flow, self.supply.temperature), (node.exhaust_flow, self.exhaust.temperature)];
        match bore {
            Some(_) => node.temperature,
            None => mean_of_inflows(&from_lands).unwrap_or(node.temperature),
        }
    }

    /// T_n of node `i`. A node that nothing flows into keeps its temperature.
    fn mixed_temperature(&self, i: usize, chamber: &Station, port: PortFlow) -> f64 {
        let node = &self.nodes[i];
        let [supply, exhaust, far] = self.approaches(i, chamber, port);
        let from_cylinder = if port == PortFlow::Discharging { -node.port_flow() } else { 0.0 };
        let inflows = [
            (node.supply_flow, self.supply.temperature * supply.factor),
            (node.exhaust_flow, self.exhaust.temperature * exhaust.factor),
            (from_cylinder, chamber.temperature * far.factor),
        ];
        mean_of_inflows(&inflows).unwrap_or(node.temperature)
    }
}

/// Appendix VI as one rule: the mean stagnation temperature of what flows in, by mass. None if
/// nothing does.
fn mean_of_inflows(inflows: &[(f64, f64)]) -> Option<f64> {
    let (mut mass, mut heat) = (0.0, 0.0);
    for (flow, temperature) in inflows.iter().filter(|(flow, _)| *flow > 0.0) {
        mass += flow;
        heat += flow * temperature;
    }
    (mass > 0.0).then(|| heat / mass)
}

impl Linearised {
    /// Solves the three lines for a right side, by elimination written out. The determinant vanishes
    /// only where no air flows at all.
    fn correct(&self, right: [f64; 3]) -> Correction {
        let [a, b, c] = self.stiffness;
        let [s, e, p] = self.by_node;
        let n = -p;
        let [rs, re, rp] = right;
        let across = c * re - b * rp;
        let determinant = c * b * s + a * c * e + a * b * n;
        Correction {
            exner: (b * c * rs + a * across) / determinant,
            supply: (rs * (c * e + b * n) - s * across) / determinant,
            exhaust: (s * c * re + a * (e * rp + n * re) - rs * e * c) / determinant,
        }
    }
}

#[cfg(test)]
mod appendix_tests;
#[cfg(test)]
mod tests;
