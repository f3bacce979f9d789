//! The predictor: where Newton's method starts.
//!
//! Between two jumps the flows change smoothly with time. They change even more smoothly when each is divided by the root
//! of its land's conductance, because a flow through a narrow land follows that conductance, and the spool moves faster
//! than the pressures. A parabola through the last three solutions comes close to the next one and saves an iteration.

use super::Network;
use super::nodes::{BoundaryConditions, Nodes, pair};
use crate::number::{Number, Pair};

/// Limit of the extrapolation, as a multiple of the time span of the three solutions.
const MAX_EXTRAPOLATION: f64 = 8.0;

/// w_n of the nodes, and s and e divided by the roots of their conductances.
type Unknowns = [Pair; 3];

/// The last three solutions, the latest first, at different instants.
#[derive(Clone, Copy, Debug)]
pub(super) struct Predictor {
    at: [f64; 3],
    solutions: [Unknowns; 3],
    /// The instant of the requested solution.
    now: f64,
}

impl Predictor {
    /// Before the first solution.
    pub const UNKNOWN: Predictor = Predictor { at: [0.0; 3], solutions: [[Pair::ZERO; 3]; 3], now: 0.0 };

    /// The solution that the parabola predicts for now, by Newton's divided differences. Without three solutions
    /// close enough, the last one.
    #[inline(always)]
    pub fn predict(&self, nodes: &Nodes, boundary: &BoundaryConditions) -> Nodes {
        let [last, middle, first] = self.at;
        let (dt, span) = (self.now - last, last - first);
        if dt == 0.0 || last == middle || dt.abs() > MAX_EXTRAPOLATION * span.abs() {
            return *nodes;
        }
        let (rise, fall) = self.weights(dt);
        let [supply, exhaust] = roots(boundary);
        let [a, b, c] = &self.solutions;
        let at = |i: usize| a[i] + pair(rise) * (a[i] - b[i]) - pair(fall) * (b[i] - c[i]);
        // A land that is shut stays shut.
        let flow = |before: Pair, ahead: Pair| Pair::choose(before.simd_eq(Pair::ZERO), Pair::ZERO, ahead);
        Nodes {
            exner: at(0).larger(pair(0.5) * nodes.exner),
            supply: flow(nodes.supply, supply * at(1)),
            exhaust: flow(nodes.exhaust, exhaust * at(2)),
            ..*nodes
        }
    }

    /// The weights, `dt` after the last solution, of the last difference of the solutions and of the one before.
    #[inline(always)]
    fn weights(&self, dt: f64) -> (f64, f64) {
        let [last, middle, first] = self.at;
        let (late, early) = (last - middle, middle - first);
        if early == 0.0 {
            return (dt / late, 0.0);
        }
        let (span, ahead) = (last - first, self.now - middle);
        let scale = dt / (late * early * span);
        (scale * early * (span + ahead), scale * late * ahead)
    }

    #[inline(always)]
    pub fn note(&mut self, nodes: &Nodes, boundary: &BoundaryConditions) {
        let Nodes { exner, supply, exhaust, .. } = *nodes;
        if self.now != self.at[0] {
            self.at = [self.now, self.at[0], self.at[1]];
            // One by one: as a whole they would go through the stack.
            self.solutions[2] = self.solutions[1];
            self.solutions[1] = self.solutions[0];
        }
        let roots = roots(boundary);
        self.solutions[0] = [exner, supply / roots[0], exhaust / roots[1]];
    }
}

/// The roots of the conductances of the lands; above zero where a land is shut.
#[inline(always)]
fn roots(boundary: &BoundaryConditions) -> [Pair; 2] {
    [boundary.valve.supply, boundary.valve.exhaust].map(|land| land.larger(pair(f64::MIN_POSITIVE)).root())
}

impl Network {
    /// The nodes in their surroundings at the instant `t`.
    #[inline(always)]
    pub(crate) fn solve_at(&mut self, t: f64, boundary: &BoundaryConditions) -> Nodes {
        self.predictor.now = t;
        self.solve_among(boundary)
    }
}
