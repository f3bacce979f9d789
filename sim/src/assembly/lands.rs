//! The open lands of the valve.
//!
//! Within the last micrometres before its edge a land's area bends sharply, and at the edge it has a kink. So a spool
//! that passes an edge is an event.

use crate::component::operator::{Limit, Met, Quantity};
use crate::component::valve::Valve;

/// m: edges as near as this to each other are passed at once.
const TOGETHER: f64 = 1e-15;

/// Land 1 and land 2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Lands {
    pub open: [bool; 2],
}

impl Lands {
    /// By the position of the spool, m. At its edge a land counts as shut.
    pub fn at(valve: &Valve, spool: f64) -> Lands {
        Lands { open: valve.openings(spool).map(|opening| opening > 0.0) }
    }

    /// Not negative as long as the spool has passed no edge.
    pub fn guards(&self, valve: &Valve, spool: f64) -> [f64; 2] {
        let openings = valve.openings(spool);
        let room = |i: usize| if self.open[i] { openings[i] } else { -openings[i] };
        [room(0), room(1)]
    }

    /// The edges as limits of the spool's position.
    pub fn limits(&self, valve: &Valve) -> [Limit; 2] {
        let edges = valve.edges();
        let limit =
            |i: usize, upper| Limit { of: Quantity::Position, level: edges[i], upper, met: Met::Edge(i) };
        // A spool that rises opens land 1 and shuts land 2.
        [limit(0, !self.open[0]), limit(1, self.open[1])]
    }

    /// The edge of a land is passed.
    pub fn pass(&mut self, land: usize, valve: &Valve, spool: f64) {
        let other = 1 - land;
        self.open[land] = !self.open[land];
        // One land opens as the other shuts.
        if valve.openings(spool)[other].abs() < TOGETHER {
            self.open[other] = !self.open[land];
        }
    }
}
