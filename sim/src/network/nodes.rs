//! Both nodes at once, and what surrounds them.

use super::{Network, Node, PortFlow};
use crate::air::Station;
use crate::number::{Number, Pair};
use crate::valve::Conductances;

/// The same number for both.
#[inline(always)]
pub(super) fn pair(value: f64) -> Pair {
    Pair::splat(value)
}

/// What surrounds the nodes.
pub(super) struct Surroundings {
    pub supply_land: Pair,
    pub exhaust_land: Pair,
    pub bore: Option<Pair>,
    /// Whether a land is shut, without even a clearance.
    pub shut: bool,
    pub supply_temperature: Pair,
    pub exhaust: Station<Pair>,
    pub chambers: Station<Pair>,
    /// Where the port's air goes into the cylinder.
    pub charging: <Pair as Number>::Truth,
}

/// Both nodes: w_n, T_n, s and e.
#[derive(Clone, Copy)]
pub(super) struct Nodes {
    pub exner: Pair,
    pub temperature: Pair,
    pub supply: Pair,
    pub exhaust: Pair,
}

impl Surroundings {
    pub fn new(
        network: &Network,
        valve: &[Conductances; 2],
        chambers: &[Station; 2],
        ports: &[PortFlow; 2],
    ) -> Surroundings {
        let shut = valve.iter().any(|lands| lands.supply == 0.0 || lands.exhaust == 0.0);
        Surroundings {
            supply_land: Pair::of(|i| valve[i].supply),
            exhaust_land: Pair::of(|i| valve[i].exhaust),
            bore: valve[0].port.map(pair),
            shut,
            supply_temperature: pair(network.supply.temperature),
            exhaust: Station {
                exner: pair(network.exhaust.exner),
                temperature: pair(network.exhaust.temperature),
            },
            chambers: Station {
                exner: Pair::of(|i| chambers[i].exner),
                temperature: Pair::of(|i| chambers[i].temperature),
            },
            charging: Pair::of(|i| f64::from(ports[i] == PortFlow::Charging)).above(pair(0.0)),
        }
    }
}

impl Nodes {
    pub fn of(nodes: &[Node; 2]) -> Nodes {
        Nodes {
            exner: Pair::of(|i| nodes[i].exner),
            temperature: Pair::of(|i| nodes[i].temperature),
            supply: Pair::of(|i| nodes[i].supply_flow),
            exhaust: Pair::of(|i| nodes[i].exhaust_flow),
        }
    }

    /// Where their air is.
    pub fn stations(&self) -> Station<Pair> {
        Station { exner: self.exner, temperature: self.temperature }
    }

    pub fn put_into(&self, nodes: &mut [Node; 2]) {
        for (i, node) in nodes.iter_mut().enumerate() {
            node.exner = self.exner.lane(i);
            node.temperature = self.temperature.lane(i);
            node.carried = node.temperature;
            node.supply_flow = self.supply.lane(i);
            node.exhaust_flow = self.exhaust.lane(i);
        }
    }
}
