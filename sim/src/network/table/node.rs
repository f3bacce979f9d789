//! One flow node by itself, as the table is filled and measured with it.
//!
//! What the other node takes from the supply tube is given: the node has a supply behind that much flow, and the
//! tube for its own flow in front of it. Both lanes of the network are given the same node and half of that tube, so
//! that its own solution, the one that every run without a table takes, fills the table.

use crate::air::Station;
use crate::flow_law::FlowLaw;
use crate::gas::Gas;
use crate::network::{Laws, Network, PortFlow};
use crate::root::bracketed_root;
use crate::tubing::Tube;
use crate::valve::{Conductances, Valve};

/// kg/s: what a flow in the table may be off by for its solution's sake.
const FLOW_ERROR: f64 = 1e-10;

/// The surroundings of one node.
#[derive(Clone, Debug)]
pub(super) struct LoneNode {
    pub gas: Gas,
    pub valve: Valve,
    pub laws: Laws,
    pub supply: Station,
    pub exhaust: Station,
    pub supply_tube: Tube,
    pub cylinder_tube: Tube,
    network: Network,
}

/// Flows of one node, kg/s.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flows {
    /// m, into the cylinder.
    pub port: f64,
    /// s, from the supply.
    pub supply: f64,
}

/// Where the port does not flow, and how it begins to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Blocked {
    /// w of the chamber.
    pub exner: f64,
    /// alpha: how far the flow goes in proportion to the pressure before it goes with its root.
    pub softness: f64,
}

impl Blocked {
    /// w of the chamber at a flow coordinate u.
    pub fn exner_at(&self, u: f64) -> f64 {
        self.exner - u * (self.softness + u.abs())
    }

    /// u of a chamber.
    pub fn coordinate(&self, exner: f64) -> f64 {
        let (drop, a) = (self.exner - exner, self.softness);
        2.0 * drop / (a + (a * a + 4.0 * drop.abs()).sqrt())
    }
}

impl LoneNode {
    /// None where a tube is of a kind that two nodes cannot halve.
    pub fn of(network: &Network, valve: &Valve) -> Option<LoneNode> {
        let Network { gas, supply, exhaust, supply_tube, cylinder_tube, laws, .. } = *network;
        let half = supply_tube.halved()?;
        cylinder_tube.halved()?;
        let network =
            Network::new(gas, supply, exhaust, half, cylinder_tube, laws, None).to_within(FLOW_ERROR);
        Some(LoneNode { gas, valve: *valve, laws, supply, exhaust, supply_tube, cylinder_tube, network })
    }

    /// What surrounds node 1 with the spool at a place, m.
    pub fn lands(&self, spool: f64) -> Conductances {
        self.valve.conductances(&self.gas, spool).lane(0)
    }

    /// What surrounds the other node meanwhile: its lands are opened by the same edges.
    pub fn mirrored(&self, lands: &Conductances) -> Conductances {
        let (supply, exhaust) = (self.valve.discharge_supply, self.valve.discharge_exhaust);
        let of_both = match self.laws.land {
            FlowLaw::Orifice => (supply / exhaust) * (supply / exhaust),
            _ => 1.0,
        };
        Conductances { supply: lands.exhaust * of_both, exhaust: lands.supply / of_both, port: lands.port }
    }

    /// The supply behind its tube, when the other node takes so much, kg/s.
    fn supply_behind(&self, other: f64) -> Station {
        Station { exner: self.supply_tube.far_end(&self.supply, other).exner, ..self.supply }
    }

    /// The flows, as the network has them; None where it finds none.
    pub fn flows(
        &mut self,
        lands: Conductances,
        chamber: &Station,
        other: f64,
        port: PortFlow,
    ) -> Option<Flows> {
        self.network.set_supply(self.supply_behind(other).exner);
        self.network.expect_jump();
        let [node, _] = self.network.solve(&Conductances::alike(&lands), &[*chamber; 2], &[port; 2]);
        let flows = Flows { port: node.port_flow(), supply: node.supply_flow };
        (flows.port + flows.supply).is_finite().then_some(flows)
    }

    /// Of a port that is blocked: what comes from the supply leaves to the exhaust.
    ///
    /// Near it the chamber's pressure goes with the flow as Delta w = -(a m + b m|m|): a is the slope of the lands
    /// and that of the tube, b the bore's and that of the lands, and alpha = a / sqrt(b).
    pub fn blocked(&self, lands: &Conductances, other: f64) -> Blocked {
        let source = self.supply_behind(other);
        let per_temperature = 1.0 / self.supply.temperature;
        let (from, to) = (lands.supply * per_temperature, lands.exhaust * per_temperature);
        let land = self.laws.land;
        let leaves = |exner: f64| land.flow_function(&self.gas, exner, self.exhaust.exner);
        let excess = |exner: f64| {
            let square = to * leaves(exner).value;
            let far = self.supply_tube.far_end(&source, square.max(0.0).sqrt()).exner;
            let inward = far >= exner;
            let (up, down) = if inward { (far, exner) } else { (exner, far) };
            let drives = land.flow_function(&self.gas, up, down).value;
            from * if inward { drives } else { -drives } - square
        };
        let (low, high) = (self.exhaust.exner, source.exner);
        let exner = bracketed_root(excess, [(low, excess(low)), (high, excess(high))], 0.0);
        let out = leaves(exner);
        let flow = (to * out.value).sqrt();
        let far = self.supply_tube.far_end(&source, flow);
        let enters = land.flow_function(&self.gas, far.exner, exner);
        let supply_slope =
            from * enters.by_downstream / (2.0 * flow - from * enters.by_upstream * far.by_flow);
        let slope = to * out.by_upstream / (2.0 * flow) - supply_slope;
        let a = 1.0 / slope + self.decay() * exner;
        let port = lands.port.unwrap_or(f64::INFINITY);
        let sharpness = self.laws.port.flow_function(&self.gas, exner, exner).by_upstream;
        let b = (1.0 / port + 1.0 / (lands.supply + lands.exhaust)) / (per_temperature * sharpness);
        Blocked { exner, softness: a / b.sqrt() }
    }

    /// -d ln w / dm of the cylinder's tube, s/kg.
    pub fn decay(&self) -> f64 {
        let whole = Station { exner: 1.0, temperature: self.supply.temperature };
        -self.cylinder_tube.far_end(&whole, 0.0).by_flow
    }
}
