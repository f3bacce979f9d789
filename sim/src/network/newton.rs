//! Newton's method on (w_n, s, e) of both nodes at once, bordered by the flow in the supply tube.
//!
//! The slopes are complete, those of the node's temperature included, so that the error after a correction
//! goes with its square: about d^2/(2|f|) for a flow f whose last correction is d. The last one is applied
//! and not looked at again.

use super::rest::{Slopes, is_rounding, land_line, square_slope};
use super::restriction::{MaybeApproach, SquareFlow, factor};
use super::{FLOW_ERROR, Network, Node, PortFlow};
use crate::air::Station;
use crate::number::{Number, Pair};
use crate::tubing::FarEnd;
use crate::valve::Conductances;

/// Residual of a port without a bore, per unit of Exner pressure: of the size of the others, kg^2/s^2.
const OPEN_PORT: f64 = 1e-6;

/// kg/s: a flow whose correction is smaller is found.
const SMALLEST: f64 = 1e-12;

/// kg/s: less than this is no flow at all.
const NO_FLOW: f64 = 1e-20;

/// What surrounds the nodes.
struct Surroundings {
    supply_land: Pair,
    exhaust_land: Pair,
    bore: Option<Pair>,
    /// Whether a land is shut, without even a clearance.
    shut: bool,
    supply_temperature: Pair,
    exhaust: Station<Pair>,
    chambers: Station<Pair>,
    /// Where the port's air goes into the cylinder.
    charging: <Pair as Number>::Truth,
}

/// Both nodes: w_n, T_n, s and e.
#[derive(Clone, Copy)]
struct Nodes {
    exner: Pair,
    temperature: Pair,
    supply: Pair,
    exhaust: Pair,
}

/// T_n with its slopes over s, e and the flow in the supply tube.
struct Mixture {
    temperature: Pair,
    slopes: [Pair; 3],
}

/// The balance of each node: residuals of supply land, exhaust land and port, their slopes over (w_n, s, e), and
/// those over the flow in the supply tube.
struct Balance {
    residual: [Pair; 3],
    rows: [[Pair; 3]; 3],
    by_total: [Pair; 3],
    mixture: Mixture,
}

/// Corrections of the nodes' w_n, s and e.
type Correction = [Pair; 3];

fn pair(value: f64) -> Pair {
    Pair::splat(value)
}

impl Surroundings {
    fn new(
        network: &Network,
        valve: &[Conductances; 2],
        chambers: &[Station; 2],
        ports: &[PortFlow; 2],
    ) -> Surroundings {
        let shut = valve.iter().any(|lands| lands.supply == 0.0 || lands.exhaust == 0.0);
        Surroundings {
            supply_land: Pair::of(|i| valve[i].supply),
            exhaust_land: Pair::of(|i| valve[i].exhaust),
            bore: valve[0].port.map(pair),
            shut,
            supply_temperature: pair(network.supply.temperature),
            exhaust: Station {
                exner: pair(network.exhaust.exner),
                temperature: pair(network.exhaust.temperature),
            },
            chambers: Station {
                exner: Pair::of(|i| chambers[i].exner),
                temperature: Pair::of(|i| chambers[i].temperature),
            },
            charging: Pair::of(|i| f64::from(ports[i] == PortFlow::Charging)).above(pair(0.0)),
        }
    }
}

impl Nodes {
    fn of(nodes: &[Node; 2]) -> Nodes {
        Nodes {
            exner: Pair::of(|i| nodes[i].exner),
            temperature: Pair::of(|i| nodes[i].temperature),
            supply: Pair::of(|i| nodes[i].supply_flow),
            exhaust: Pair::of(|i| nodes[i].exhaust_flow),
        }
    }

    fn put_into(&self, nodes: &mut [Node; 2]) {
        for (i, node) in nodes.iter_mut().enumerate() {
            node.exner = self.exner.lane(i);
            node.temperature = self.temperature.lane(i);
            node.supply_flow = self.supply.lane(i);
            node.exhaust_flow = self.exhaust.lane(i);
        }
    }
}

impl Network {
    /// Newton's method from the present nodes; false where it does not converge.
    pub(super) fn newton(
        &mut self,
        valve: &[Conductances; 2],
        chambers: &[Station; 2],
        ports: &[PortFlow; 2],
        slopes: Slopes,
    ) -> bool {
        self.begin_flows(valve);
        let around = Surroundings::new(self, valve, chambers, ports);
        let mut nodes = Nodes::of(&self.nodes);
        let at_rest = self.mach == 0.0;
        let found = match slopes {
            Slopes::Tangent if at_rest => self.iterate::<true>(&around, &mut nodes, Slopes::Tangent),
            _ => self.iterate::<false>(&around, &mut nodes, slopes),
        };
        nodes.put_into(&mut self.nodes);
        found
    }

    /// `AT_REST`: no air has a speed in front of a restriction.
    #[inline(always)]
    fn iterate<const AT_REST: bool>(
        &mut self,
        around: &Surroundings,
        nodes: &mut Nodes,
        slopes: Slopes,
    ) -> bool {
        for _ in 0..slopes.most_iterations() {
            self.work.iterations += 1;
            let total = nodes.supply.reduce_add();
            let at_valve = self.supply_tube.far_end(&self.supply, total);
            let balance = self.balance::<AT_REST>(nodes, around, &at_valve, slopes);
            let corrections = balance.corrections();
            // The change of the total is the sum of its parts, which depend on it.
            let [[_, fixed, _], [_, per_total, _]] = &corrections;
            let change = fixed.reduce_add() / (1.0 - per_total.reduce_add());
            if !change.is_finite() {
                return false;
            }
            if self.apply(nodes, &balance.mixture, &corrections, change, slopes) {
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
            if node.supply_flow.abs() < NO_FLOW && lands.supply > 0.0 {
                let square = self.land(lands.supply, &self.supply, &None, &here).value;
                self.nodes[i].supply_flow = signed_root(square);
            }
            if node.exhaust_flow.abs() < NO_FLOW && lands.exhaust > 0.0 {
                let square = self.land(lands.exhaust, &self.exhaust, &None, &here).value;
                self.nodes[i].exhaust_flow = signed_root(square);
            }
        }
    }

    /// Applies a correction; true where another one would be no more than the allowed error.
    #[inline(always)]
    fn apply(
        &self,
        nodes: &mut Nodes,
        mixture: &Mixture,
        [fixed, per_total]: &[Correction; 2],
        change: f64,
        slopes: Slopes,
    ) -> bool {
        let change = pair(change);
        let [exner, supply, exhaust] = [
            fixed[0] + change * per_total[0],
            fixed[1] + change * per_total[1],
            fixed[2] + change * per_total[2],
        ];
        nodes.temperature = mixture.after(supply, exhaust, change);
        // A pressure that is held back has not arrived, whatever the flows say.
        let half = pair(0.5) * nodes.exner;
        let arrives = half.at_least(exner.abs());
        nodes.exner = (nodes.exner + exner).larger(half).fast_min(pair(2.0) * nodes.exner);
        nodes.supply += supply;
        nodes.exhaust += exhaust;
        let error = pair(if self.sharp { FLOW_ERROR } else { self.flow_error });
        let settles = |flow: Pair, change: Pair| match slopes {
            Slopes::Tangent => {
                (error * flow.abs()).larger(pair(SMALLEST * SMALLEST)).at_least(change * change)
            }
            Slopes::Secant => Pair::of(|i| {
                let change = change.lane(i);
                f64::from(change.abs() < SMALLEST || is_rounding(change))
            })
            .above(pair(0.0)),
        };
        let settled = settles(nodes.supply, supply)
            & settles(nodes.exhaust, exhaust)
            & settles(nodes.supply + nodes.exhaust, supply + exhaust);
        (arrives & settled).all()
    }

    #[inline(always)]
    fn balance<const AT_REST: bool>(
        &self,
        nodes: &Nodes,
        around: &Surroundings,
        at_valve: &FarEnd,
        slopes: Slopes,
    ) -> Balance {
        let (s, e, m) = (nodes.supply, nodes.exhaust, nodes.supply + nodes.exhaust);
        let supply = Station { exner: pair(at_valve.exner), temperature: around.supply_temperature };
        let supply_approach = if AT_REST { None } else { self.supply_approach(&supply, s) };
        let (far, far_by_flow) = self.far_of_cylinders(&around.chambers, -m);
        let far_approach = if AT_REST { None } else { self.approach(&far, -m) };
        let by_back = far_by_flow;
        let mixture = match around.bore {
            Some(_) => {
                let by_total = pair(at_valve.by_flow);
                self.mixture(nodes, around, (&supply_approach, by_total), (&far_approach, by_back))
            }
            // Without a node the exhaust land takes the cylinder's air (6.40).
            None => Mixture { temperature: around.chambers.temperature, slopes: [pair(0.0); 3] },
        };
        let here = Station { exner: nodes.exner, temperature: mixture.temperature };
        let from_supply = self.land(around.supply_land, &supply, &supply_approach, &here);
        let from_exhaust = self.land(around.exhaust_land, &around.exhaust, &None, &here);
        let supply_line =
            self.land_lines(around, around.supply_land, &supply, (s, from_supply.value), slopes);
        let exhaust_line =
            self.land_lines(around, around.exhaust_land, &around.exhaust, (e, from_exhaust.value), slopes);
        // Over T_n, where the air of the node is the one that flows.
        let per_temperature = pair(1.0) / mixture.temperature;
        let cooling = |square: &SquareFlow<Pair>, of_node: Pair| match slopes {
            Slopes::Tangent => Pair::choose(of_node, square.value * per_temperature, pair(0.0)),
            Slopes::Secant => pair(0.0),
        };
        let [by_s, by_e, by_t] = mixture.slopes;
        let by_mixture = |slope: Pair| [slope * by_s, slope * by_e, slope * by_t];
        let of_node = |square: &SquareFlow<Pair>| pair(0.0).above(square.value);
        let [s_s, s_e, s_t] = by_mixture(cooling(&from_supply, of_node(&from_supply)));
        let [e_s, e_e, e_t] = by_mixture(cooling(&from_exhaust, of_node(&from_exhaust)));
        let supply_row = [-from_supply.by_node, supply_line.1 - from_supply.by_flow + s_s, s_e];
        let exhaust_row = [-from_exhaust.by_node, e_s, exhaust_line.1 + e_e];
        let supply_by_total = s_t - from_supply.by_place * pair(at_valve.by_flow);
        let Some(bore) = around.bore else {
            let by_flow = pair(-OPEN_PORT) * by_back;
            return Balance {
                residual: [supply_line.0, exhaust_line.0, pair(OPEN_PORT) * (far.exner - nodes.exner)],
                rows: [supply_row, exhaust_row, [pair(-OPEN_PORT), by_flow, by_flow]],
                by_total: [supply_by_total, e_t, pair(0.0)],
                mixture,
            };
        };
        let temperature = Pair::choose(around.charging, mixture.temperature, far.temperature);
        let back = self.port(bore, &Station { temperature, ..far }, &far_approach, nodes.exner);
        let [p_s, p_e, p_t] = by_mixture(-cooling(&back, around.charging));
        let size = match slopes {
            Slopes::Tangent => pair(2.0) * m.abs(),
            Slopes::Secant => Pair::of(|i| square_slope(slopes, m.lane(i), -back.value.lane(i))),
        };
        let by_flow = size - back.by_flow - back.by_place * by_back;
        Balance {
            residual: [supply_line.0, exhaust_line.0, m * m.abs() + back.value],
            rows: [supply_row, exhaust_row, [back.by_node, by_flow + p_s, by_flow + p_e]],
            by_total: [supply_by_total, e_t, p_t],
            mixture,
        }
    }

    /// The far ends of the cylinder's tubes for flows from the chambers, whose temperature they have, and
    /// the slopes of w there over these flows.
    #[inline(always)]
    fn far_of_cylinders(&self, chambers: &Station<Pair>, flows: Pair) -> (Station<Pair>, Pair) {
        let far_end = |i: usize| {
            let known = Station { exner: chambers.exner.lane(i), temperature: chambers.temperature.lane(i) };
            self.cylinder_tube.far_end(&known, flows.lane(i))
        };
        let (one, two) = (far_end(0), far_end(1));
        let exner = Pair::new([one.exner, two.exner]);
        (Station { exner, ..*chambers }, Pair::new([one.by_flow, two.by_flow]))
    }

    /// Residuals of lands whose pressures give the signed squares `value`, and their slopes over the flow.
    #[inline(always)]
    fn land_lines(
        &self,
        around: &Surroundings,
        conductance: Pair,
        source: &Station<Pair>,
        (flow, value): (Pair, Pair),
        slopes: Slopes,
    ) -> (Pair, Pair) {
        if slopes == Slopes::Tangent && !around.shut {
            return (flow * flow.abs() - value, pair(2.0) * flow.abs());
        }
        let [one, two] = [0, 1].map(|i| {
            let shut = around.supply_land.lane(i) == 0.0 || around.exhaust_land.lane(i) == 0.0;
            let source = Station { exner: source.exner.lane(i), temperature: source.temperature.lane(i) };
            let conductance = conductance.lane(i);
            let creeping = if shut { self.creeping(conductance, &source) } else { 0.0 };
            land_line(conductance, flow.lane(i), value.lane(i), creeping, slopes)
        });
        (Pair::new([one.0, two.0]), Pair::new([one.1, two.1]))
    }

    /// What flows into the nodes, mixed. A node that nothing flows into keeps its temperature. With each
    /// approach comes the slope of w there: over the flow in the supply tube, and over the one back from the
    /// cylinder.
    #[inline(always)]
    fn mixture(
        &self,
        nodes: &Nodes,
        around: &Surroundings,
        (supply, by_total): (&MaybeApproach<Pair>, Pair),
        (behind, by_back): (&MaybeApproach<Pair>, Pair),
    ) -> Mixture {
        let (zero, one) = (pair(0.0), pair(1.0));
        let where_positive = |flow: Pair| Pair::choose(flow.above(zero), one, zero);
        let (s, e) = (nodes.supply, nodes.exhaust);
        let back = -(s + e);
        let (s_in, e_in) = (where_positive(s), where_positive(e));
        let back_in = Pair::choose(around.charging, zero, where_positive(back));
        let from_supply = s_in * around.supply_temperature * factor(supply);
        let from_exhaust = e_in * around.exhaust.temperature;
        let from_chamber = back_in * around.chambers.temperature * factor(behind);
        let mass = s_in * s + e_in * e + back_in * back;
        let heat = from_supply * s + from_exhaust * e + from_chamber * back;
        let mut by_flows = [from_supply - from_chamber, from_exhaust - from_chamber, zero];
        if let Some(supply) = supply {
            let carried = s_in * s * around.supply_temperature;
            by_flows[0] += carried * supply.by_flow;
            by_flows[2] = carried * supply.by_exner * by_total;
        }
        if let Some(behind) = behind {
            let carried = back_in * back * around.chambers.temperature;
            let bend = carried * (behind.by_flow + behind.by_exner * by_back);
            (by_flows[0], by_flows[1]) = (by_flows[0] - bend, by_flows[1] - bend);
        }
        let flows = mass.above(zero);
        let per_mass = Pair::choose(flows, one / mass, zero);
        let temperature = Pair::choose(flows, per_mass * heat, nodes.temperature);
        let [by_supply, by_exhaust, by_total] = by_flows;
        let slopes = [
            per_mass * (by_supply - temperature * (s_in - back_in)),
            per_mass * (by_exhaust - temperature * (e_in - back_in)),
            per_mass * by_total,
        ];
        Mixture { temperature, slopes }
    }
}

impl Mixture {
    /// T_n after changes of s, e and the flow in the supply tube.
    #[inline(always)]
    fn after(&self, supply: Pair, exhaust: Pair, total: Pair) -> Pair {
        let [by_supply, by_exhaust, by_total] = self.slopes;
        self.temperature + by_supply * supply + by_exhaust * exhaust + by_total * total
    }
}

impl Balance {
    /// The correction at a fixed flow in the supply tube, and that per unit of its change. The
    /// determinant vanishes only where no air flows at all.
    #[inline(always)]
    fn corrections(&self) -> [Correction; 2] {
        let [a, b, c] = &self.rows;
        let columns = [cross(b, c), cross(c, a), cross(a, b)];
        let determinant = a[0] * columns[0][0] + a[1] * columns[0][1] + a[2] * columns[0][2];
        let scale = pair(-1.0) / determinant;
        let solved = |right: &[Pair; 3]| {
            let [x, y, z] = [scale * right[0], scale * right[1], scale * right[2]];
            let at = |k: usize| x * columns[0][k] + y * columns[1][k] + z * columns[2][k];
            [at(0), at(1), at(2)]
        };
        [solved(&self.residual), solved(&self.by_total)]
    }
}

#[inline(always)]
fn cross(a: &[Pair; 3], b: &[Pair; 3]) -> [Pair; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
