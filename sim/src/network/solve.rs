//! Solving the network: Newton's method from the last solution, continuation from rest and brackets where it fails.

use super::mixing::mean_of_inflows;
use super::nodes::{BoundaryConditions, Nodes};
use super::{Network, Node, PortFlow};
use crate::component::air::GasState;
use crate::component::valve::{Conductances, Valve};
use crate::number::Pair;

/// After this many failures, with a step ten times shorter each time, the branch of the solution has ended. With
/// upstream Mach numbers and large coefficients of discharge, a land wider than its port has no solution below M = 1.
/// Another solution is searched for, and the flows jump to it.
const MAX_FAILURES: u32 = 3;

/// Passes over the temperature of the air that flows back through the supply tube. It depends on the flows, and they
/// depend on it a little.
const MAX_RETURNING_PASSES: u32 = 20;

/// A relative change of that temperature below this counts as none; the flow changes by half of it.
const SAME_TEMPERATURE: f64 = 1e-9;

/// Failures are forgotten after this many solutions in a row, those of ten steps. Two steps would not do: steps
/// become ever shorter before the place where a solution ends.
const CALM: u32 = 60;

impl Network {
    /// The flows through a valve with its spool at a place (m) into two chambers.
    pub fn flows(
        &mut self,
        valve: &Valve,
        spool: f64,
        chambers: &[GasState; 2],
        ports: &[PortFlow; 2],
    ) -> [Node; 2] {
        if let Some(laws) = valve.laws_at(spool) {
            self.set_land_laws(laws);
        }
        let conductances = valve.conductances(&self.gas, spool);
        self.solve(&conductances, chambers, ports)
    }

    /// The flows for the open areas, chambers and port directions of this instant.
    pub(crate) fn solve(
        &mut self,
        valve: &Conductances<Pair>,
        chambers: &[GasState; 2],
        ports: &[PortFlow; 2],
    ) -> [Node; 2] {
        self.solve_among(&BoundaryConditions::new(*valve, GasState::both(chambers), ports)).each()
    }

    /// The nodes among what surrounds them.
    #[inline(always)]
    pub(super) fn solve_among(&mut self, boundary: &BoundaryConditions) -> Nodes {
        if self.supply_tube.feels_temperature() {
            self.solve_returning(boundary)
        } else {
            self.solve_once(boundary)
        }
    }

    /// The same where air flows back through the supply tube and its temperature matters: it has the temperature of
    /// the nodes.
    #[inline(never)]
    pub(super) fn solve_returning(&mut self, boundary: &BoundaryConditions) -> Nodes {
        let mut nodes = self.solve_once(boundary);
        for _ in 0..MAX_RETURNING_PASSES {
            let returning = self.returning_temperature(&nodes);
            if (returning - self.returning).abs() <= SAME_TEMPERATURE * self.returning {
                break;
            }
            self.returning = returning;
            nodes = self.solve_once(boundary);
        }
        nodes
    }

    /// Stagnation temperature of the air that the nodes give back to the supply tube, K.
    pub(crate) fn returning_temperature(&self, nodes: &Nodes) -> f64 {
        if nodes.supply.reduce_add() >= 0.0 {
            return self.returning;
        }
        let each = nodes.each().map(|node| (-node.supply_flow, node.temperature));
        mean_of_inflows(&each).unwrap_or(self.returning)
    }

    /// The nodes for a given temperature of the air that flows back through the supply tube.
    #[inline(always)]
    pub(super) fn solve_once(&mut self, boundary: &BoundaryConditions) -> Nodes {
        self.work.solutions += 1;
        if !boundary.are_in_order() {
            return Nodes::NOT_NUMBERS;
        }
        // With air at rest in front of each restriction there is one solution, from any start.
        let has_start = self.started || self.mach == 0.0;
        if !(has_start && self.by_newton(boundary)) {
            (self.failures, self.found) = (self.failures + 1, 0);
            // With speeds of approach, a trial step that is too large may lead to a place without a solution. It is
            // told so, and the last solution stays intact. Air at rest has a solution everywhere. If it could not be
            // followed, as where chambers are at the pressure of the supply and slopes are infinite, that says
            // nothing about the step.
            let lost = self.mach > 0.0 && !self.far && self.failures < MAX_FAILURES;
            if lost || !self.by_search(boundary) {
                return Nodes::NOT_NUMBERS;
            }
            self.nodes.carried = self.nodes.temperature;
        }
        (self.started, self.far) = (true, false);
        self.found += 1;
        if self.found >= CALM {
            self.failures = 0;
        }
        if boundary.valve.port.is_none() {
            self.nodes.carried = self.carried();
        }
        self.nodes
    }

    /// The solution that grows out of air at rest. Where it cannot be followed: nested brackets, refined by Newton's
    /// method. Returns false if they find nothing.
    #[inline(never)]
    pub(super) fn by_search(&mut self, boundary: &BoundaryConditions) -> bool {
        let last = self.nodes;
        if self.continue_from_rest(boundary) {
            return true;
        }
        let rests = self.by_brackets(boundary);
        // Where Newton's method fails again, the result of the brackets stands.
        let found = self.by_newton(boundary) || (rests && self.nodes.are_finite());
        if !found {
            self.nodes = last;
        }
        found
    }

    /// The air in ports without a node before them: it comes from the land that feeds each.
    pub(super) fn carried(&self) -> Pair {
        Pair::new(self.nodes.each().map(|node| self.carried_by(&node)))
    }

    /// The same at one of them, K.
    pub(super) fn carried_by(&self, node: &Node) -> f64 {
        let from_lands =
            [(node.supply_flow, self.supply.temperature), (node.exhaust_flow, self.exhaust.temperature)];
        mean_of_inflows(&from_lands).unwrap_or(node.temperature)
    }
}
