//! Continuation: follows the solution that grows out of air at rest.
//!
//! With air at rest in front of each restriction the flows have one solution. With speeds of approach they may have
//! several. So the speeds are switched on in steps,
//!
//! ```text
//! f = 1 + (n-1)/2 a M^2,   a = 0, 1/8, 2/8 ... 1
//! ```
//!
//! and the solution is followed from step to step. A step that finds nothing, or jumps, is taken in two halves, and these in
//! halves of their own: near the end of its branch the solution turns away ever faster. A jump in the smallest step means
//! that the branch has ended and another solution was found. Then the continuation has failed.

use super::Network;
use super::nodes::{BoundaryConditions, Nodes, pair};
use super::predictor::Predictor;
use crate::number::Number;

/// The number of steps in which the squared speeds are switched on.
const PARTS: u32 = 8;

/// How often a step is halved at most.
const MAX_HALVINGS: u32 = 6;

/// A step of the solution changes the flows of each node by at most this part of them
const LEAP: f64 = 0.25;
/// plus this part of the flows of both.
const LEAK: f64 = 0.01;

impl Network {
    /// Follows the solution from rest. Returns false if the branch ends, or without speeds of approach.
    pub(super) fn continue_from_rest(&mut self, boundary: &BoundaryConditions) -> bool {
        if self.mach == 0.0 {
            return false;
        }
        let (whole, predictor) = (self.mach, self.predictor);
        let speeds = |part: u32| whole * f64::from(part) / f64::from(PARTS);
        let found = self.is_found_at(0.0, boundary)
            && (0..PARTS).all(|part| self.follow([speeds(part), speeds(part + 1)], boundary, MAX_HALVINGS));
        (self.mach, self.predictor) = (whole, predictor);
        if found {
            self.predictor.note(&self.nodes, boundary);
        }
        found
    }

    /// Follows the solution from one speed to another, in at most 2^`halvings` steps.
    fn follow(&mut self, [from, to]: [f64; 2], boundary: &BoundaryConditions, halvings: u32) -> bool {
        let before = self.nodes;
        if self.is_found_at(to, boundary) && is_near(&before, &self.nodes) {
            return true;
        }
        self.nodes = before;
        let middle = 0.5 * (from + to);
        halvings > 0
            && self.follow([from, middle], boundary, halvings - 1)
            && self.follow([middle, to], boundary, halvings - 1)
    }

    /// Whether Newton's method finds a solution at these speeds, from the last one.
    fn is_found_at(&mut self, mach: f64, boundary: &BoundaryConditions) -> bool {
        (self.mach, self.predictor) = (mach, Predictor::UNKNOWN);
        self.by_newton(boundary)
    }
}

/// Whether the flows of each node have hardly changed. A leak that is small beside the flows of the other node does
/// not count.
fn is_near(before: &Nodes, now: &Nodes) -> bool {
    let changes = (now.supply - before.supply).abs() + (now.exhaust - before.exhaust).abs();
    let sizes = now.supply.abs() + now.exhaust.abs();
    let allowed = pair(LEAP) * sizes + pair(LEAK * sizes.reduce_add());
    allowed.at_least(changes).all()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tubing::Tube;
    use crate::component::valve::{Valve, thesis_valve};
    use crate::network::PortFlow;
    use crate::network::tests::{chambers, network_with};

    const PORTS: [[PortFlow; 2]; 4] = [
        [PortFlow::Charging, PortFlow::Charging],
        [PortFlow::Charging, PortFlow::Discharging],
        [PortFlow::Discharging, PortFlow::Charging],
        [PortFlow::Discharging, PortFlow::Discharging],
    ];

    /// Whether the directions of the ports match their flows. Otherwise a node may have no inflow, and any temperature.
    fn fits(network: &Network, boundary: &BoundaryConditions) -> bool {
        let each = network.nodes.each();
        (0..2).all(|i| (each[i].port_flow() >= 0.0) == (boundary.port(i) == PortFlow::Charging))
    }

    /// Narrow and wide lands, tubes that let next to nothing pass and tubes that let everything pass. Where the
    /// solution can be followed, it equals the one of the brackets. Elsewhere the brackets are used.
    #[test]
    fn what_air_at_rest_comes_to_is_what_the_brackets_find() {
        let (mut followed, mut all) = (0, 0);
        for (drop, discharge) in [(0.0, 1.5), (0.1, 0.3), (0.4, 0.8), (0.4, 1.0), (0.9, 1.0), (0.99, 0.8)] {
            let (gas, network) = network_with(true, true);
            let tube = Tube::empirical(&gas, drop, 0.00465);
            let network = Network { supply_tube: tube, cylinder_tube: tube, ..network };
            let valve = Valve { discharge_supply: discharge, discharge_exhaust: discharge, ..thesis_valve() };
            for spool in [-0.9e-3, -1e-6, 0.0, 0.1e-3, 0.3e-3] {
                for (p1, p2) in [(110e3, 580e3), (325e3, 400e3), (588e3, 102e3), (20e3, 300e3)] {
                    for ports in PORTS {
                        let chambers = crate::component::air::GasState::both(&chambers(&gas, p1, p2));
                        let boundary =
                            BoundaryConditions::new(valve.conductances(&gas, spool), chambers, &ports);
                        let (mut one, mut other) = (network.clone(), network.clone());
                        let found = one.continue_from_rest(&boundary);
                        if !(other.by_brackets(&boundary) && fits(&other, &boundary)) {
                            continue;
                        }
                        (followed, all) = (followed + u32::from(found), all + 1);
                        for (one, other) in one.nodes.each().iter().zip(&other.nodes.each()).filter(|_| found)
                        {
                            let apart = (one.supply_flow - other.supply_flow).abs()
                                + (one.exhaust_flow - other.exhaust_flow).abs();
                            assert!(apart < 1e-8, "{drop} {discharge} {spool} {p1} {p2}: {one:?} {other:?}");
                        }
                    }
                }
            }
        }
        assert!(all > 100 && followed > all / 2 && followed < all, "{followed} of {all}");
    }
}
