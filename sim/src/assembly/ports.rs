//! The direction of the flow in each port.
//!
//! A reversal is an event. The sign of a flow at rest is rounding and would change at every step. So a port that
//! reverses twice within [`MOMENT`] rests: it keeps its direction until a flow of [`RESTING_FLOW`] goes against it.
//! The direction affects only the temperature, and so little air carries negligible energy.

use crate::network::{Nodes, PortFlow};
use crate::number::Number;

/// s.
const MOMENT: f64 = 1e-6;

/// kg/s: three times the largest error of a flow in a run.
const RESTING_FLOW: f64 = 1e-9;

/// The directions in both ports, valve's side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ports {
    pub directions: [PortFlow; 2],
    turned_at: [f64; 2],
    resting: [bool; 2],
}

impl Ports {
    pub fn new() -> Ports {
        Ports { directions: [PortFlow::Charging; 2], turned_at: [f64::NEG_INFINITY; 2], resting: [false; 2] }
    }

    /// Sets the directions of the flows; returns whether one is new.
    pub fn follow(&mut self, nodes: &Nodes) -> bool {
        let directions = nodes.port_flow().to_array().map(|flow| match flow >= 0.0 {
            true => PortFlow::Charging,
            false => PortFlow::Discharging,
        });
        std::mem::replace(&mut self.directions, directions) != directions
    }

    /// Negative where a flow goes against its port's direction.
    pub fn guards(&self, nodes: &Nodes) -> [f64; 2] {
        std::array::from_fn(|i| {
            let along = match self.directions[i] {
                PortFlow::Charging => nodes.port_flow().lane(i),
                PortFlow::Discharging => -nodes.port_flow().lane(i),
            };
            if self.resting[i] { along + RESTING_FLOW } else { along }
        })
    }

    /// The flow in a port reverses at `t`.
    pub fn turn(&mut self, port: usize, t: f64) {
        self.directions[port] = match self.directions[port] {
            PortFlow::Charging => PortFlow::Discharging,
            PortFlow::Discharging => PortFlow::Charging,
        };
        self.resting[port] = t - self.turned_at[port] < MOMENT;
        self.turned_at[port] = t;
    }
}
