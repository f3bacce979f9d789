//! Which way the solution has been going: where Newton's method begins.
//!
//! Between two jumps flows change smoothly with time. The parabola through the last three solutions nearly
//! meets the next one, and an iteration is saved.

use super::{Network, Node, PortFlow};
use crate::air::Station;
use crate::valve::Conductances;

/// How far ahead a parabola is trusted, over the time that it was taken from.
const FARTHEST: f64 = 8.0;

/// w_n, s and e of both nodes.
type Unknowns = [f64; 6];

/// The last three solutions, the latest first, at different instants.
#[derive(Clone, Copy, Debug)]
pub(super) struct Course {
    at: [f64; 3],
    solutions: [Unknowns; 3],
    /// The instant of the solution that is asked for.
    now: f64,
}

impl Course {
    /// Nothing is known yet.
    pub const UNKNOWN: Course = Course { at: [0.0; 3], solutions: [[0.0; 6]; 3], now: 0.0 };

    /// Where the solution will be now, by Newton's divided differences; None where that is not known.
    pub fn ahead(&self, nodes: &[Node; 2]) -> Option<[Node; 2]> {
        let [last, middle, first] = self.at;
        let dt = self.now - last;
        let span = (last - first).abs();
        if dt == 0.0 || last == middle || dt.abs() > FARTHEST * span {
            return None;
        }
        let bends = if middle == first { 0.0 } else { 1.0 };
        let [a, b, c] = &self.solutions;
        let mut found = *a;
        for i in 0..found.len() {
            let slope = (a[i] - b[i]) / (last - middle);
            let before = (b[i] - c[i]) / (middle - first);
            let bend = if bends == 0.0 { 0.0 } else { (slope - before) / (last - first) };
            found[i] += dt * (slope + (self.now - middle) * bend);
        }
        Some([node_with(&nodes[0], &found[..3]), node_with(&nodes[1], &found[3..])])
    }

    fn note(&mut self, nodes: &[Node; 2]) {
        let [one, two] = nodes.map(|node| [node.exner, node.supply_flow, node.exhaust_flow]);
        let solution = [one[0], one[1], one[2], two[0], two[1], two[2]];
        if self.now != self.at[0] {
            self.at = [self.now, self.at[0], self.at[1]];
            self.solutions = [solution, self.solutions[0], self.solutions[1]];
        } else {
            self.solutions[0] = solution;
        }
    }
}

/// A land that is shut stays so.
fn node_with(node: &Node, unknowns: &[f64]) -> Node {
    let flow = |before: f64, ahead: f64| if before == 0.0 { 0.0 } else { ahead };
    Node {
        exner: unknowns[0].max(0.5 * node.exner),
        supply_flow: flow(node.supply_flow, unknowns[1]),
        exhaust_flow: flow(node.exhaust_flow, unknowns[2]),
        ..*node
    }
}

impl Network {
    /// The flows for the open areas, chambers and port directions at the instant `t`.
    pub(crate) fn solve_at(
        &mut self,
        t: f64,
        valve: &[Conductances; 2],
        chambers: &[Station; 2],
        ports: &[PortFlow; 2],
    ) -> [Node; 2] {
        self.course.now = t;
        let failures = self.failures;
        let solved = self.solve(valve, chambers, ports);
        if self.failures <= failures {
            self.course.note(&solved);
        }
        solved
    }
}
