//! The air inside the valve. No sensor of a drive shows it, but the graphs of thesis 7.2.1 (c) do.

use super::{Assembly, StateVector};
use crate::network::Nodes;

/// The air inside the valve at one instant. Pressures are absolute and static.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValveState {
    /// In front of the supply's lands, behind the supply tube, Pa.
    pub supply_pressure: f64,
    /// At the ports, on the valve's side of the cylinder tubes: P_1v and P_2v, Pa.
    pub port_pressures: [f64; 2],
    /// In the flow nodes, P_n of 6.47, Pa.
    pub node_pressures: [f64; 2],
    /// In the flow nodes, T_n of 6.53, K.
    pub node_temperatures: [f64; 2],
    /// From the supply into the nodes, kg/s.
    pub supply_flows: [f64; 2],
    /// From the exhaust into the nodes, kg/s; negative when air leaves.
    pub exhaust_flows: [f64; 2],
}

impl Assembly {
    /// The air inside the valve at a state.
    ///
    /// Looking leaves no trace, as in [`Assembly::port_flows`].
    pub fn valve_state(&mut self, t: f64, x: &StateVector) -> ValveState {
        let left = (self.parts.network.clone(), self.solved);
        let nodes = self.nodes_for_a_row(t, x);
        let at_ports = self.at_ports(x);
        let ends = self.ends_at_valve(x, &at_ports);
        let network = &self.parts.network;
        let pressure = |exner| self.parts.gas.pressure(exner);
        let ports = network.exner_behind_ports(&nodes, &ends, &self.ports.directions);
        let Nodes { exner, temperature, supply, exhaust, .. } = nodes;
        let state = ValveState {
            supply_pressure: pressure(network.exner_at_lands(&nodes)),
            port_pressures: ports.to_array().map(pressure),
            node_pressures: exner.to_array().map(pressure),
            node_temperatures: temperature.to_array(),
            supply_flows: supply.to_array(),
            exhaust_flows: exhaust.to_array(),
        };
        (self.parts.network, self.solved) = left;
        state
    }
}
