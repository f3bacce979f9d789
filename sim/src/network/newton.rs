//! Newton's method on (w_n, s, e) of both nodes at once, bordered by the flow in the supply tube.
//!
//! The slopes are complete, those of the node's temperature included, so that the error after a correction
//! goes with its square: about d^2/(2|f|) for a flow f whose last correction is d. The last one is applied
//! and not looked at again.

use super::nodes::{Nodes, Surroundings, pair};
use super::rest::{Slope, is_rounding, land_line, square_slope};
use super::restriction::{MaybeApproach, Place, SquareFlow};
use super::{FLOW_ERROR, Network};
use crate::component::air::Station;
use crate::component::tubing::FarEnd;
use crate::number::{Number, Pair};

/// Residual of a port without a bore, per unit of Exner pressure: of the size of the others, kg^2/s^2.
const OPEN_PORT: f64 = 1e-6;

/// kg/s: a flow whose correction is smaller is found.
const SMALLEST: f64 = 1e-12;

/// A node's w whose correction is more than this part of it is not found.
const ARRIVED: f64 = 0.01;

/// kg/s: less than this is no flow at all.
const NO_FLOW: f64 = 1e-20;

/// T_n with its slopes over s, e and the flow in the supply tube.
struct Mixture {
    temperature: Pair,
    per_temperature: Pair,
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

impl Network {
    /// Newton's method from `nodes`; None where it does not converge.
    pub(super) fn newton(&mut self, around: &Surroundings, nodes: Nodes, slopes: Slope) -> Option<Nodes> {
        let nodes = self.begun(around, nodes);
        let plain = self.following.is_none()
            && !self.supply_tube.feels_temperature()
            && !self.cylinder_tube.feels_temperature();
        match slopes {
            Slope::Tangent if self.mach == 0.0 && plain => self.iterate::<true, true>(around, nodes, slopes),
            Slope::Tangent if self.mach == 0.0 => self.iterate::<true, false>(around, nodes, slopes),
            _ if plain => self.iterate::<false, true>(around, nodes, slopes),
            _ => self.iterate::<false, false>(around, nodes, slopes),
        }
    }

    /// `AT_REST`: no air has a speed in front of a restriction. `PLAIN`: no tube's drop depends on the temperature of
    /// its air, and nothing of a lagged one follows at once.
    #[inline(never)]
    fn iterate<const AT_REST: bool, const PLAIN: bool>(
        &mut self,
        around: &Surroundings,
        mut nodes: Nodes,
        slopes: Slope,
    ) -> Option<Nodes> {
        for _ in 0..slopes.max_iterations() {
            self.work.iterations += 1;
            let total = nodes.supply.reduce_add();
            let at_valve =
                if PLAIN { self.supply_tube.far_end(&self.supply, total) } else { self.supply_end(total) };
            let balance = self.balance::<AT_REST, PLAIN>(&nodes, around, &at_valve, slopes);
            let corrections = balance.corrections::<AT_REST>();
            // The change of the total is the sum of its parts, which depend on it.
            let [[_, fixed, _], [_, per_total, _]] = &corrections;
            let change = fixed.reduce_add() / (1.0 - per_total.reduce_add());
            if !change.is_finite() {
                return None;
            }
            if self.apply::<AT_REST>(&mut nodes, &balance.mixture, &corrections, change, slopes) {
                return Some(nodes);
            }
        }
        None
    }

    /// The nodes to begin with.
    #[inline(always)]
    fn begun(&self, around: &Surroundings, nodes: Nodes) -> Nodes {
        let least = pair(NO_FLOW);
        let rests = least.above(nodes.supply.abs()) | least.above(nodes.exhaust.abs());
        if rests.any() { self.begun_from_rest(around, nodes) } else { nodes }
    }

    /// A land that was shut and has opened begins with what its pressures drive through it: from no flow
    /// at all a square has no slope to follow.
    #[inline(never)]
    fn begun_from_rest(&self, around: &Surroundings, nodes: Nodes) -> Nodes {
        let supply = Station { exner: pair(self.supply.exner), temperature: self.supply_temperature() };
        let begin = |flow: Pair, conductance: Pair, source: &Station<Pair>| {
            let square =
                self.land(conductance, &Place::of(source), &None, &Place::of(&nodes.stations())).value;
            let driven = Pair::of(|i| square.lane(i).abs().sqrt().copysign(square.lane(i)));
            let opens = pair(NO_FLOW).above(flow.abs()) & conductance.above(pair(0.0));
            Pair::choose(opens, driven, flow)
        };
        Nodes {
            supply: begin(nodes.supply, around.valve.supply, &supply),
            exhaust: begin(nodes.exhaust, around.valve.exhaust, &self.exhausts()),
            ..nodes
        }
    }

    /// Applies a correction; true where another one would be no more than the allowed error.
    #[inline(always)]
    fn apply<const AT_REST: bool>(
        &self,
        nodes: &mut Nodes,
        mixture: &Mixture,
        [fixed, per_total]: &[Correction; 2],
        change: f64,
        slopes: Slope,
    ) -> bool {
        let change = pair(change);
        let [exner, supply, exhaust] = [
            fixed[0] + change * per_total[0],
            fixed[1] + change * per_total[1],
            fixed[2] + change * per_total[2],
        ];
        nodes.temperature = mixture.after::<AT_REST>(supply, exhaust, change);
        // A pressure that still moves has not arrived, whatever the flows say: between shut lands they say nothing.
        let arrives = (pair(ARRIVED) * nodes.exner).at_least(exner.abs());
        let half = pair(0.5) * nodes.exner;
        nodes.exner = (nodes.exner + exner).larger(half).smaller(pair(2.0) * nodes.exner);
        nodes.supply += supply;
        nodes.exhaust += exhaust;
        let error = pair(if self.tight { FLOW_ERROR } else { self.flow_error });
        let settles = |flow: Pair, change: Pair| match slopes {
            Slope::Tangent => {
                (error * flow.abs()).larger(pair(SMALLEST * SMALLEST)).at_least(change * change)
            }
            Slope::Secant => Pair::of(|i| {
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
    fn balance<const AT_REST: bool, const PLAIN: bool>(
        &self,
        nodes: &Nodes,
        around: &Surroundings,
        at_valve: &FarEnd,
        slopes: Slope,
    ) -> Balance {
        let (s, e, m) = (nodes.supply, nodes.exhaust, nodes.port_flow());
        let exhaust = self.exhausts();
        let supply = Station { exner: pair(at_valve.exner), temperature: self.supply_temperature() };
        let supply_approach = if AT_REST { None } else { self.supply_approach(&supply, s) };
        let from_supply_tube = (&supply_approach, pair(at_valve.by_flow));
        let in_tubes = if PLAIN { None } else { self.air_in_tubes(nodes, around, from_supply_tube) };
        let known = match &in_tubes {
            Some(air) => Station { temperature: air.temperature, ..around.chambers },
            None => around.chambers,
        };
        let far_end = self.cylinder_tube.far_end(&known, -m);
        let by_warmth = in_tubes.map(|air| {
            let by_temperature = far_end.by_temperature(-m, air.temperature);
            air.slopes.map(|slope| by_temperature * slope)
        });
        let far = Station { exner: far_end.exner, ..around.chambers };
        let far_approach = if AT_REST { None } else { self.port_approach(&far, -m) };
        let by_back = far_end.by_flow;
        let mixture = match around.valve.port {
            Some(_) => self.mixture(nodes, around, from_supply_tube, (&far_approach, by_back)),
            // Without a node the exhaust land takes the cylinder's air (6.40).
            None => Mixture::of(around.chambers.temperature),
        };
        let here = Place { exner: nodes.exner, per_temperature: mixture.per_temperature };
        let from_supply = self.land(around.valve.supply, &Place::of(&supply), &supply_approach, &here);
        let from_exhaust = self.land(around.valve.exhaust, &Place::of(&exhaust), &None, &here);
        let supply_line =
            self.land_lines(around, around.valve.supply, &supply, (s, from_supply.value), slopes);
        let exhaust_line =
            self.land_lines(around, around.valve.exhaust, &exhaust, (e, from_exhaust.value), slopes);
        // Over T_n, where the air of the node is the one that flows.
        let per_temperature = mixture.per_temperature;
        let cooling = |square: &SquareFlow<Pair>, of_node: Pair| match slopes {
            Slope::Tangent => Pair::choose(of_node, square.value * per_temperature, pair(0.0)),
            Slope::Secant => pair(0.0),
        };
        let [by_s, by_e, by_t] = mixture.slopes;
        let by_mixture = |slope: Pair| [slope * by_s, slope * by_e, slope * by_t];
        let of_node = |square: &SquareFlow<Pair>| pair(0.0).above(square.value);
        let [s_s, s_e, s_t] = by_mixture(cooling(&from_supply, of_node(&from_supply)));
        let [e_s, e_e, e_t] = by_mixture(cooling(&from_exhaust, of_node(&from_exhaust)));
        let supply_row = [-from_supply.by_node, supply_line.1 - from_supply.by_flow + s_s, s_e];
        let exhaust_row = [-from_exhaust.by_node, e_s, exhaust_line.1 + e_e];
        let pushed = -from_supply.by_place * pair(at_valve.by_flow);
        let supply_by_total = if AT_REST { pushed } else { s_t + pushed };
        let Some(bore) = around.valve.port else {
            let by_flow = pair(-OPEN_PORT) * by_back;
            let [w_s, w_e, w_t] =
                by_warmth.map_or([pair(0.0); 3], |by_warmth| by_warmth.map(|slope| pair(OPEN_PORT) * slope));
            return Balance {
                residual: [supply_line.0, exhaust_line.0, pair(OPEN_PORT) * (far.exner - nodes.exner)],
                rows: [supply_row, exhaust_row, [pair(-OPEN_PORT), by_flow + w_s, by_flow + w_e]],
                by_total: [supply_by_total, e_t, w_t],
                mixture,
            };
        };
        let of_chambers = pair(1.0) / around.chambers.temperature;
        let per_temperature = Pair::choose(around.charging, per_temperature, of_chambers);
        let behind = Place { exner: far.exner, per_temperature };
        let back = self.port(bore, &behind, &far_approach, nodes.exner);
        let [p_s, p_e, p_t] = by_mixture(-cooling(&back, around.charging));
        let size = match slopes {
            Slope::Tangent => pair(2.0) * m.abs(),
            Slope::Secant => Pair::of(|i| square_slope(slopes, m.lane(i), -back.value.lane(i))),
        };
        let by_flow = size - back.by_flow - back.by_place * by_back;
        let mut port_row = [back.by_node, by_flow + p_s, by_flow + p_e];
        let mut port_by_total = p_t;
        if let Some([w_s, w_e, w_t]) = by_warmth {
            port_row[1] += back.by_place * w_s;
            port_row[2] += back.by_place * w_e;
            port_by_total += back.by_place * w_t;
        }
        Balance {
            residual: [supply_line.0, exhaust_line.0, m * m.abs() + back.value],
            rows: [supply_row, exhaust_row, port_row],
            by_total: [supply_by_total, e_t, port_by_total],
            mixture,
        }
    }

    /// The air in the cylinders' tubes, if their drop depends on it: what the node mixes when it charges, else the
    /// chamber's.
    #[inline(always)]
    fn air_in_tubes(
        &self,
        nodes: &Nodes,
        around: &Surroundings,
        supply: (&MaybeApproach<Pair>, Pair),
    ) -> Option<Mixture> {
        if !self.cylinder_tube.feels_temperature() {
            return None;
        }
        // Without a node the approach to the lands leaves the temperature alone (6.40).
        let supply = if around.valve.port.is_some() { supply } else { (&None, pair(0.0)) };
        let charging = self.mixture(nodes, around, supply, (&None, pair(0.0)));
        let of_chambers = Mixture::of(around.chambers.temperature);
        let choose = |mixed: Pair, own: Pair| Pair::choose(around.charging, mixed, own);
        Some(Mixture {
            temperature: choose(charging.temperature, of_chambers.temperature),
            per_temperature: choose(charging.per_temperature, of_chambers.per_temperature),
            slopes: charging.slopes.map(|slope| choose(slope, pair(0.0))),
        })
    }

    /// Residuals of lands whose pressures give the signed squares `value`, and their slopes over the flow.
    #[inline(always)]
    fn land_lines(
        &self,
        around: &Surroundings,
        conductance: Pair,
        source: &Station<Pair>,
        (flow, value): (Pair, Pair),
        slopes: Slope,
    ) -> (Pair, Pair) {
        if slopes == Slope::Tangent && !around.has_shut_land {
            return (flow * flow.abs() - value, pair(2.0) * flow.abs());
        }
        self.line_by_line(around, conductance, source, (flow, value), slopes)
    }

    /// The same one by one: at rest, or beside a land that is shut.
    #[inline(never)]
    fn line_by_line(
        &self,
        around: &Surroundings,
        conductance: Pair,
        source: &Station<Pair>,
        (flow, value): (Pair, Pair),
        slopes: Slope,
    ) -> (Pair, Pair) {
        let line = |i: usize| {
            let shut = around.valve.supply.lane(i) == 0.0 || around.valve.exhaust.lane(i) == 0.0;
            let source = Station { exner: source.exner.lane(i), temperature: source.temperature.lane(i) };
            let conductance = conductance.lane(i);
            let creeping = if shut { self.creeping(conductance, &source) } else { 0.0 };
            land_line(conductance, flow.lane(i), value.lane(i), creeping, slopes)
        };
        let (one, two) = (line(0), line(1));
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
        let zero = pair(0.0);
        let out = nodes.supply + nodes.exhaust;
        let s = nodes.supply.larger(zero);
        let e = nodes.exhaust.larger(zero);
        let back = Pair::choose(around.charging, zero, (-out).larger(zero));
        let from_supply = scaled(self.supply_temperature(), supply);
        let from_exhaust = pair(self.exhaust.temperature);
        let from_chamber = scaled(around.chambers.temperature, behind);
        let mass = s + e + back;
        let heat = s * from_supply + e * from_exhaust + back * from_chamber;
        let flows = mass.above(zero);
        let per_mass = Pair::choose(flows, pair(1.0) / mass, zero);
        let temperature = Pair::choose(flows, per_mass * heat, nodes.temperature);
        // Not by way of T_n itself, which is there later.
        let per_temperature =
            Pair::choose(flows, mass, pair(1.0)) / Pair::choose(flows, heat, nodes.temperature);
        // What a flow more brings of warmth, where it flows in.
        let warmth = |flow: Pair, from: Pair| Pair::choose(flow.above(zero), from - temperature, zero);
        let by_chamber = warmth(back, from_chamber);
        let mut by_flows = [warmth(s, from_supply) - by_chamber, warmth(e, from_exhaust) - by_chamber, zero];
        if let Some(supply) = supply {
            let carried = s * self.supply_temperature();
            by_flows[0] += carried * supply.by_flow;
            by_flows[2] = carried * supply.by_exner * by_total;
        }
        if let Some(behind) = behind {
            let carried = back * around.chambers.temperature;
            let bend = carried * (behind.by_flow + behind.by_exner * by_back);
            (by_flows[0], by_flows[1]) = (by_flows[0] - bend, by_flows[1] - bend);
        }
        let [by_supply, by_exhaust, by_total] = by_flows;
        let by_total = if supply.is_some() { per_mass * by_total } else { zero };
        Mixture {
            temperature,
            per_temperature,
            slopes: [per_mass * by_supply, per_mass * by_exhaust, by_total],
        }
    }
}

/// A temperature raised by an approach.
#[inline(always)]
fn scaled(temperature: Pair, approach: &MaybeApproach<Pair>) -> Pair {
    approach.as_ref().map_or(temperature, |approach| temperature * approach.factor)
}

impl Mixture {
    /// Of a temperature that no flow changes.
    #[inline(always)]
    fn of(temperature: Pair) -> Mixture {
        Mixture { temperature, per_temperature: pair(1.0) / temperature, slopes: [pair(0.0); 3] }
    }

    /// T_n after changes of s, e and the flow in the supply tube.
    #[inline(always)]
    fn after<const AT_REST: bool>(&self, supply: Pair, exhaust: Pair, total: Pair) -> Pair {
        let [by_supply, by_exhaust, by_total] = self.slopes;
        let after = self.temperature + by_supply * supply + by_exhaust * exhaust;
        if AT_REST { after } else { after + by_total * total }
    }
}

impl Balance {
    /// The correction at a fixed flow in the supply tube, and that per unit of its change. The
    /// determinant vanishes only where no air flows at all.
    #[inline(always)]
    fn corrections<const AT_REST: bool>(&self) -> [Correction; 2] {
        let [a, b, c] = &self.rows;
        let columns = [cross(b, c), cross(c, a), cross(a, b)];
        let determinant = a[0] * columns[0][0] + a[1] * columns[0][1] + a[2] * columns[0][2];
        let scale = pair(-1.0) / determinant;
        let solved = |right: &[Pair; 3]| {
            let at =
                |k: usize| right[0] * columns[0][k] + right[1] * columns[1][k] + right[2] * columns[2][k];
            // The determinant's inverse comes last.
            [scale * at(0), scale * at(1), scale * at(2)]
        };
        if AT_REST {
            // The supply land alone feels the flow in the supply tube.
            let at = |k: usize| scale * (self.by_total[0] * columns[0][k]);
            return [solved(&self.residual), [at(0), at(1), at(2)]];
        }
        [solved(&self.residual), solved(&self.by_total)]
    }
}

#[inline(always)]
fn cross(a: &[Pair; 3], b: &[Pair; 3]) -> [Pair; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
