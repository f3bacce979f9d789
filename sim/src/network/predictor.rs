//! The predictor of Newton's method: where its iteration starts.
//!
//! Between two jumps flows change smoothly with time. The parabola through the last three solutions comes close to
//! the next one, which saves an iteration.

use super::Network;
use super::nodes::{Nodes, Surroundings, pair};
use crate::number::{Number, Pair};

/// The farthest extrapolation, over the time span of the three solutions.
const MAX_EXTRAPOLATION: f64 = 8.0;

/// w_n, s and e of the nodes.
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

    /// Leads the last solution to the one that the parabola predicts for now, by Newton's divided differences; false
    /// without three solutions close enough.
    #[inline(always)]
    pub fn predict(&self, nodes: &mut Nodes) -> bool {
        let [last, middle, first] = self.at;
        let dt = self.now - last;
        let span = last - first;
        if dt == 0.0 || last == middle || dt.abs() > MAX_EXTRAPOLATION * span.abs() {
            return false;
        }
        let (per_last, per_first, per_span) = (1.0 / (last - middle), 1.0 / (middle - first), 1.0 / span);
        let (rise, fall) = if middle == first {
            (dt * per_last, 0.0)
        } else {
            let bend = dt * (self.now - middle) * per_span;
            ((dt + bend) * per_last, bend * per_first)
        };
        let (rise, fall) = (pair(rise), pair(fall));
        let [a, b, c] = &self.solutions;
        let at = |i: usize| a[i] + rise * (a[i] - b[i]) - fall * (b[i] - c[i]);
        // A land that is shut stays so.
        let flow = |before: Pair, ahead: Pair| Pair::choose(before.simd_eq(Pair::ZERO), Pair::ZERO, ahead);
        nodes.exner = at(0).larger(pair(0.5) * nodes.exner);
        nodes.supply = flow(nodes.supply, at(1));
        nodes.exhaust = flow(nodes.exhaust, at(2));
        true
    }

    #[inline(always)]
    pub fn note(&mut self, nodes: &Nodes) {
        let Nodes { exner, supply, exhaust, .. } = *nodes;
        if self.now != self.at[0] {
            self.at = [self.now, self.at[0], self.at[1]];
            // Not as a whole, which would take the way over the stack.
            self.solutions[2] = self.solutions[1];
            self.solutions[1] = self.solutions[0];
        }
        self.solutions[0] = [exner, supply, exhaust];
    }
}

impl Network {
    /// The nodes among what surrounds them at the instant `t`.
    #[inline(always)]
    pub(crate) fn solve_at(&mut self, t: f64, around: &Surroundings) -> Nodes {
        self.predictor.now = t;
        self.solve_among(around)
    }
}
