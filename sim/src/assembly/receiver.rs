//! The air of the receiver in a state, which the network draws from.

use super::{Assembly, StateVector, slot};
use crate::component::air::ChamberAir;
use crate::component::supply::receiver::ReceiverState;
use crate::network::Nodes;

impl Assembly {
    /// The air in the receiver, if there is one.
    pub(super) fn air_of_receiver(&self, x: &StateVector) -> Option<ChamberAir> {
        let receiver = self.parts.receiver.as_ref()?;
        Some(receiver.air(&self.parts.gas, slot::RECEIVER.map(|i| x[i])))
    }

    /// Network and tubes draw its air.
    #[inline(never)]
    pub(super) fn draw_from_receiver(&mut self, x: &StateVector) {
        if let Some(air) = self.air_of_receiver(x) {
            self.draw_from(air.station());
        }
    }

    /// What can be seen of it.
    pub fn receiver_state(&self, x: &StateVector) -> Option<ReceiverState> {
        self.parts.receiver.as_ref().zip(self.air_of_receiver(x)).map(|(receiver, air)| receiver.seen(&air))
    }

    /// The rates of mass and Exner pressure: a node that gives air back gives its own.
    #[inline(never)]
    pub(super) fn fill_receiver(&self, x: &StateVector, nodes: &Nodes, slope: &mut StateVector) {
        let Some((receiver, air)) = self.parts.receiver.as_ref().zip(self.air_of_receiver(x)) else { return };
        let drawn = nodes.each().map(|node| {
            let flows_back = node.supply_flow < 0.0;
            (node.supply_flow, if flows_back { node.temperature } else { air.temperature })
        });
        let rates = receiver.derivative(&self.parts.gas, &air, drawn);
        for (place, rate) in slot::RECEIVER.into_iter().zip(rates) {
            slope[place] = rate;
        }
    }
}
