//! Solves the network by nested brackets: the flow of the supply tube outside, each node inside it, its port innermost.
//!
//! The brackets cannot fail, but they are slow. They are used where Newton's method fails, also on the way from air
//! at rest. Only the speeds of approach may not converge: each pass takes them as given and finds them again. Between given
//! speeds there is one solution, so that Newton's method may find it first.

use super::mixing::mean_of_inflows;
use super::rest::Slope;
use super::restriction::{Approach, EndState, MaybeApproach, factor};
use super::{BoundaryConditions, GasState, Network, Node, Nodes, PortFlow};
use crate::component::tubing::Tube;
use crate::component::valve::Conductances;
use crate::component::valve::flow_law::FlowLaw;
use crate::number::Pair;
use pneudrive_solver::bracketed_root;

/// Passes over the speeds of approach. As a rule, each pass halves the change.
const MAX_PASSES: u32 = 400;

/// A change of a factor below this counts as none. The limit grows tenfold after every further [`PASSES_PER_DECADE`]
/// passes: near a double root the iteration slows down more and more, and is near enough in the end.
const UNCHANGED: f64 = 1e-12;
const PASSES_PER_DECADE: u32 = 50;

/// A pass is slow if it leaves more than this part of the previous change.
const SLOW: f64 = 0.7;

/// Limit of the over-relaxation of a slow factor in one pass.
const MAX_STEP_OF_FACTOR: f64 = 1e-3;

/// Passes over the temperature of the air that charges a port without a bore. As a rule, one land gives this air
/// after the first pass.
const TEMPERATURE_PASSES: u32 = 4;

/// How often the end of a bracket is halved: no tube passes less of what a choked land does.
const MAX_HALVINGS: u32 = 60;

/// The surroundings of one node, for given speeds of approach.
struct NodeSide<'a> {
    valve: Conductances,
    chamber: GasState,
    port: PortFlow,
    /// At supply land, exhaust land and port.
    approaches: &'a [MaybeApproach; 3],
    /// Of its lands to the supply and to the exhaust.
    laws: [FlowLaw; 2],
    tube: Tube,
}

impl Network {
    /// Solves with nested brackets for given speeds of approach. The flows give new speeds, and so on, beginning at
    /// rest. Of several solutions this finds the one that grows out of air at rest.
    ///
    /// Just beyond the end of a solution a speed can creep past the place for ten thousand passes. So a slow factor
    /// is over-relaxed more and more, until it turns.
    ///
    /// Returns false if the speeds cycle (Brent, BIT 20, 1980) or do not converge. This happens behind tubes that let
    /// next to nothing pass: there air comes at the speed of sound or not at all, and each is the consequence of the
    /// other.
    pub(super) fn by_brackets(&mut self, boundary: &BoundaryConditions) -> bool {
        let mut places = [[OverRelaxation::AT_REST; 3]; 2];
        let mut landmark = places;
        for pass in 0..MAX_PASSES {
            self.work.passes += 1;
            let approaches = places.map(|node| node.map(|place| place.approach));
            self.nodes = self.at_speeds(boundary, &approaches);
            let mut largest = 0.0_f64;
            for (i, node) in places.iter_mut().enumerate() {
                for (place, found) in node.iter_mut().zip(self.approaches(i, boundary)) {
                    largest = largest.max(place.follow(found));
                }
            }
            if largest < UNCHANGED * 10_f64.powi((pass / PASSES_PER_DECADE) as i32) {
                return true;
            }
            let mut both = places.as_flattened().iter().zip(landmark.as_flattened());
            if both.all(|(here, there)| here.is_where(there)) {
                break;
            }
            if pass.is_power_of_two() {
                landmark = places;
            }
        }
        false
    }

    /// The nodes for given speeds of approach: by Newton's method to rounding error, else by brackets.
    fn at_speeds(&mut self, boundary: &BoundaryConditions, approaches: &[[MaybeApproach; 3]; 2]) -> Nodes {
        let (tight, mut nodes) = (std::mem::replace(&mut self.tight, true), self.nodes);
        // In the usual pattern the speeds follow the flows.
        let passes_air = std::mem::replace(&mut self.passes_air, false);
        self.given = Some([0, 2].map(|place| given(approaches.map(|node| node[place]))));
        let found = self.newton(boundary, &mut nodes, Slope::Tangent);
        (self.given, self.tight, self.passes_air) = (None, tight, passes_air);
        if found {
            return nodes;
        }
        self.work.bracketed += 1;
        Nodes::of(&self.balanced(boundary, approaches))
    }

    /// The factors of approach at supply land, exhaust land and port of node `i`, for its present flows.
    pub(super) fn approaches(&self, i: usize, boundary: &BoundaryConditions) -> [MaybeApproach; 3] {
        let node = &self.nodes.each()[i];
        let supply = GasState { exner: self.exner_at_lands(&self.nodes), ..self.supply };
        let chamber = boundary.chambers.lane(i);
        let far = self.port_station(
            &self.cylinder_tube.of_node(i),
            node.temperature,
            (&chamber, boundary.port(i)),
            node.port_flow(),
        );
        [self.supply_approach(&supply, node.supply_flow), None, self.port_approach(&far, -node.port_flow())]
    }

    /// The nodes at the flow in the supply tube that both together take.
    fn balanced(&self, boundary: &BoundaryConditions, approaches: &[[MaybeApproach; 3]; 2]) -> [Node; 2] {
        let sides = [0, 1].map(|i| NodeSide {
            valve: boundary.valve.lane(i),
            chamber: boundary.chambers.lane(i),
            port: boundary.port(i),
            approaches: &approaches[i],
            laws: [self.laws.supply.of_node(i), self.laws.exhaust.of_node(i)],
            tube: self.cylinder_tube.of_node(i),
        });
        let highest = self.supply.exner.max(sides[0].chamber.exner).max(sides[1].chamber.exner);
        let coldest =
            sides.iter().map(|side| side.chamber.temperature).fold(self.supply.temperature, f64::min);
        let choked =
            |side: &NodeSide| self.more_than_choked(&side.laws[0], side.valve.supply / coldest, highest);
        let most: f64 = sides.iter().map(choked).sum();
        let lowest = self.exhaust.exner.min(sides[0].chamber.exner).min(sides[1].chamber.exner);
        let ends = ends_of(most, [lowest, highest], |total| self.supply_end(total).exner);
        let nodes_at = |total: f64| {
            let at_valve = self.supply_end(total).exner;
            sides.each_ref().map(|side| self.node_by_brackets(side, at_valve))
        };
        let excess = |total: f64| {
            let [one, two] = nodes_at(total);
            one.supply_flow + two.supply_flow - total
        };
        nodes_at(bracketed_root(excess, ends.map(|total| (total, excess(total))), 1e-16))
    }

    /// The node at a given pressure behind the supply tube, where its net flow is zero.
    fn node_by_brackets(&self, side: &NodeSide, at_valve: f64) -> Node {
        let Some(bore) = side.valve.port else { return self.open_node_by_brackets(side, at_valve) };
        let net = |exner: f64| {
            let node = self.node_at(exner, side, at_valve, |node| self.port_flow_at(node, side, bore));
            node.port_flow() - self.port_flow_at(&node, side, bore)
        };
        let supply = at_valve * factor(&side.approaches[0]);
        let chamber = side.chamber.exner * factor(&side.approaches[2]);
        let lowest = at_valve.min(self.exhaust.exner).min(side.chamber.exner);
        let highest = supply.max(self.exhaust.exner * factor(&side.approaches[1])).max(chamber);
        let bracket = [(lowest, net(lowest)), (highest, net(highest))];
        let exner = bracketed_root(net, bracket, 1e-13);
        self.node_at(exner, side, at_valve, |node| self.port_flow_at(node, side, bore))
    }

    /// The same without a bore: the flow gives the node's pressure through the tube.
    fn open_node_by_brackets(&self, side: &NodeSide, at_valve: f64) -> Node {
        let node_for = |m: f64| {
            // Air that charges the cylinder has the temperature of the air that the lands let in at that pressure.
            let node_with = |charging: f64| {
                let far = self.port_station(&side.tube, charging, (&side.chamber, side.port), m);
                self.node_at(far.exner, side, at_valve, |_| m)
            };
            let mut node = node_with(self.supply.temperature);
            if self.cylinder_tube.feels_temperature() {
                for _ in 0..TEMPERATURE_PASSES {
                    node = node_with(self.carried_by(&node));
                }
            }
            node
        };
        let excess = |m: f64| node_for(m).port_flow() - m;
        let highest = at_valve.max(self.exhaust.exner).max(side.chamber.exner);
        let coldest = self.supply.temperature.min(side.chamber.temperature);
        let most = self.more_than_choked(
            &side.laws[0],
            (side.valve.supply + side.valve.exhaust) / coldest,
            2.0 * highest,
        );
        let lowest = at_valve.min(self.exhaust.exner).min(side.chamber.exner);
        let behind = |m: f64| {
            self.port_station(&side.tube, self.supply.temperature, (&side.chamber, side.port), m).exner
        };
        let ends = ends_of(most, [lowest, highest], behind);
        node_for(bracketed_root(excess, ends.map(|m| (m, excess(m))), 1e-17))
    }

    /// The land flows at a node pressure. Inflows do not depend on the node's temperature, which follows from them.
    fn node_at(
        &self,
        exner: f64,
        side: &NodeSide,
        at_valve: f64,
        through_port: impl Fn(&Node) -> f64,
    ) -> Node {
        let supply = GasState { exner: at_valve, temperature: self.supply.temperature };
        let mut node = Node {
            exner,
            temperature: supply.temperature,
            carried: supply.temperature,
            supply_flow: 0.0,
            exhaust_flow: 0.0,
        };
        let [from_supply, from_exhaust, from_port] = side.approaches;
        let signed_root = |square: f64| square.abs().sqrt().copysign(square);
        for _ in 0..2 {
            let here = EndState::of(&GasState { exner, temperature: node.temperature });
            let supply_flow =
                self.land(&side.laws[0], side.valve.supply, &EndState::of(&supply), from_supply, &here).value;
            let exhaust_flow = self
                .land(&side.laws[1], side.valve.exhaust, &EndState::of(&self.exhaust), from_exhaust, &here)
                .value;
            node.supply_flow = signed_root(supply_flow);
            node.exhaust_flow = signed_root(exhaust_flow);
            let inflows = [
                (node.supply_flow, supply.temperature * factor(from_supply)),
                (node.exhaust_flow, self.exhaust.temperature * factor(from_exhaust)),
                (-through_port(&node), side.chamber.temperature * factor(from_port)),
            ];
            node.temperature = match side.valve.port {
                Some(_) => mean_of_inflows(&inflows).unwrap_or(node.temperature),
                None => side.chamber.temperature,
            };
        }
        node
    }

    /// The flow through port and tube in series from a node into a chamber.
    fn port_flow_at(&self, node: &Node, side: &NodeSide, bore: f64) -> f64 {
        let here = node.station();
        let excess = |m: f64| {
            let far = self.port_station(&side.tube, here.temperature, (&side.chamber, side.port), m);
            m * m.abs() + self.port(bore, &EndState::of(&far), &side.approaches[2], here.exner).value
        };
        let highest = node.exner.max(side.chamber.exner);
        let coldest = node.temperature.min(side.chamber.temperature);
        let most = self.more_than_choked(&self.laws.port, bore / coldest, highest);
        let lowest = node.exner.min(side.chamber.exner);
        let behind =
            |m: f64| self.port_station(&side.tube, here.temperature, (&side.chamber, side.port), m).exner;
        let ends = ends_of(most, [lowest, highest], behind);
        bracketed_root(excess, ends.map(|m| (m, excess(m))), 1e-17)
    }
}

/// The ends of a bracket of flows: `most` either way, or less where the tube at the end of which w is `exner_at` passes
/// less. Beyond twice the highest or half of the lowest w around it no air flows on, whatever its speed of approach.
fn ends_of(most: f64, [lowest, highest]: [f64; 2], exner_at: impl Fn(f64) -> f64) -> [f64; 2] {
    let around = 0.5 * lowest..=2.0 * highest;
    [-most, most].map(|mut end| {
        for _ in 0..MAX_HALVINGS {
            if around.contains(&exner_at(0.5 * end)) {
                break;
            }
            end *= 0.5;
        }
        end
    })
}

/// The approaches of both nodes at one place, whatever the flows: factors without slopes.
fn given(approaches: [MaybeApproach; 2]) -> Approach<Pair> {
    let none = Pair::splat(0.0);
    Approach {
        factor: Pair::new(approaches.map(|approach| factor(&approach))),
        by_exner: none,
        by_flow: none,
    }
}

/// The over-relaxed iteration of one speed of approach.
#[derive(Clone, Copy)]
struct OverRelaxation {
    approach: MaybeApproach,
    /// The last change of the factor that a pass asked for, and the over-relaxation that was used.
    last: f64,
    reach: f64,
}

impl OverRelaxation {
    const AT_REST: OverRelaxation = OverRelaxation { approach: None, last: 0.0, reach: 1.0 };

    /// Whether it equals another one and continues in the same way.
    fn is_where(&self, there: &OverRelaxation) -> bool {
        let apart = factor(&self.approach) - factor(&there.approach);
        apart.abs() < UNCHANGED && self.reach == there.reach
    }

    /// Moves towards the result of a pass. Returns the distance before the move.
    fn follow(&mut self, found: MaybeApproach) -> f64 {
        let rise = factor(&found) - factor(&self.approach);
        self.reach = if rise * self.last < 0.0 {
            (0.5 * self.reach).max(1.0)
        } else if self.last != 0.0 && rise.abs() > SLOW * self.last.abs() {
            2.0 * self.reach
        } else {
            (0.5 * self.reach).max(1.0)
        };
        let farthest = MAX_STEP_OF_FACTOR.max(rise.abs());
        let step = (self.reach * rise).clamp(-farthest, farthest);
        self.last = rise;
        self.approach = found.map(|found| Approach { factor: factor(&self.approach) + step, ..found });
        rise.abs()
    }
}
