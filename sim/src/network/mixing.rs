//! Mixing of the flows into a node.

use super::Network;
use super::nodes::{BoundaryConditions, Nodes, pair};
use super::restriction::{MaybeApproach, Side};
use crate::number::{Number, Pair};

/// T_n with its slopes over s, e and the flow in the supply tube.
pub(super) struct Mixture {
    pub temperature: Pair,
    pub per_temperature: Pair,
    pub slopes: [Pair; 3],
}

impl Network {
    /// The air in the cylinders' tubes, if their drop depends on it: the node's mixture on the way in, else the
    /// chamber's air.
    #[inline(always)]
    pub(super) fn air_in_tubes(
        &self,
        nodes: &Nodes,
        boundary: &BoundaryConditions,
        supply: &Side,
    ) -> Option<Mixture> {
        if !self.cylinder_tube.feels_temperature() {
            return None;
        }
        // Without a node, the approach to the lands does not change the temperature (6.40).
        let at_rest = |station| Side { station, approach: None, by_flow: pair(0.0) };
        let behind = at_rest(boundary.chambers);
        let charging = match boundary.valve.port {
            Some(_) => self.mixture(nodes, boundary, supply, &behind),
            None => self.mixture(nodes, boundary, &at_rest(supply.station), &behind),
        };
        let of_chambers = Mixture::of(boundary.chambers.temperature);
        let choose = |mixed: Pair, own: Pair| Pair::choose(boundary.charging, mixed, own);
        Some(Mixture {
            temperature: choose(charging.temperature, of_chambers.temperature),
            per_temperature: choose(charging.per_temperature, of_chambers.per_temperature),
            slopes: charging.slopes.map(|slope| choose(slope, pair(0.0))),
        })
    }

    /// The mixture of the flows into the nodes. A node without inflow keeps its temperature. Each approach comes with
    /// the slope of w there: over the flow in the supply tube, and over the flow back from the cylinder.
    #[inline(always)]
    pub(super) fn mixture(
        &self,
        nodes: &Nodes,
        boundary: &BoundaryConditions,
        supply: &Side,
        behind: &Side,
    ) -> Mixture {
        let (zero, one) = (pair(0.0), pair(1.0));
        let from_supply = scaled(self.supply_temperature(), &supply.approach);
        let from_exhaust = pair(self.exhaust.temperature);
        let from_chamber = scaled(boundary.chambers.temperature, &behind.approach);
        let back = Pair::choose(boundary.charging, zero, (-nodes.port_flow()).larger(zero));
        let [s, e] = [nodes.supply.larger(zero), nodes.exhaust.larger(zero)];
        let mass = s + e + back;
        let heat = s * from_supply + e * from_exhaust + back * from_chamber;
        let flows = mass.above(zero);
        let per_mass = Pair::choose(flows, one / mass, zero);
        let temperature = Pair::choose(flows, per_mass * heat, nodes.temperature);
        // Not through T_n itself, which is computed later.
        let per_temperature = Pair::choose(flows, mass, one) / Pair::choose(flows, heat, nodes.temperature);
        // The heat that an additional flow brings where it flows in.
        let warmth = |flows_in: Pair, from: Pair| Pair::choose(flows_in, from - temperature, zero);
        let [s_flows, e_flows] = [s, e].map(|flow| flow.above(zero));
        let by_chamber = warmth(back.above(zero), from_chamber);
        let mut by_flows =
            [warmth(s_flows, from_supply) - by_chamber, warmth(e_flows, from_exhaust) - by_chamber, zero];
        if let Some(approach) = &supply.approach {
            let carried = s * self.supply_temperature();
            by_flows[0] += carried * approach.by_flow;
            by_flows[2] = carried * approach.by_exner * supply.by_flow;
        }
        if let Some(approach) = &behind.approach {
            let carried = back * boundary.chambers.temperature;
            let bend = carried * (approach.by_flow + approach.by_exner * behind.by_flow);
            (by_flows[0], by_flows[1]) = (by_flows[0] - bend, by_flows[1] - bend);
        }
        let [by_supply, by_exhaust, by_total] = by_flows;
        let by_total = if supply.approach.is_some() { per_mass * by_total } else { zero };
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
    /// A temperature that no flow changes.
    #[inline(always)]
    pub fn of(temperature: Pair) -> Mixture {
        Mixture { temperature, per_temperature: pair(1.0) / temperature, slopes: [pair(0.0); 3] }
    }

    /// T_n after changes of s, e and the flow in the supply tube.
    #[inline(always)]
    pub fn after<const AT_REST: bool>(&self, supply: Pair, exhaust: Pair, total: Pair) -> Pair {
        let [by_supply, by_exhaust, by_total] = self.slopes;
        let after = self.temperature + by_supply * supply + by_exhaust * exhaust;
        if AT_REST { after } else { after + by_total * total }
    }
}

/// Appendix VI as one rule: the mean stagnation temperature of the inflows, by mass. None without an inflow.
pub(super) fn mean_of_inflows(inflows: &[(f64, f64)]) -> Option<f64> {
    let (mut mass, mut heat) = (0.0, 0.0);
    for (flow, temperature) in inflows.iter().filter(|(flow, _)| *flow > 0.0) {
        mass += flow;
        heat += flow * temperature;
    }
    (mass > 0.0).then(|| heat / mass)
}
