//! One node and its flows.

use crate::component::air::GasState;

/// One node and its flows.
#[derive(Clone, Copy, Debug)]
pub struct Node {
    /// w_n.
    pub exner: f64,
    /// T_n, K: of the air that leaves by the lands.
    pub temperature: f64,
    /// Temperature of the air that goes on into the cylinder, K.
    pub carried: f64,
    /// s, kg/s, from the supply.
    pub supply_flow: f64,
    /// e, kg/s, from the exhaust; negative when air leaves.
    pub exhaust_flow: f64,
}

impl Node {
    pub(super) fn station(&self) -> GasState {
        GasState { exner: self.exner, temperature: self.temperature }
    }

    pub(super) const NOT_A_NUMBER: Node = Node {
        exner: f64::NAN,
        temperature: f64::NAN,
        carried: f64::NAN,
        supply_flow: f64::NAN,
        exhaust_flow: f64::NAN,
    };

    pub(super) fn is_finite(&self) -> bool {
        (self.exner + self.temperature + self.supply_flow + self.exhaust_flow).is_finite()
    }

    /// m, kg/s, into the cylinder.
    #[must_use]
    pub fn port_flow(&self) -> f64 {
        self.supply_flow + self.exhaust_flow
    }
}
