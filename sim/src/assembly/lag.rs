//! Tubes whose pressure ratio follows the flow with a first-order lag (thesis 7.2.1; EQUATIONS section
//! 4):
//!
//! ```text
//! ratio' = (settled ratio at the present flow - ratio) / lag
//! ```
//!
//! To the network they are no tubes, and the pressures behind them are states.

use super::{StateVector, slot};
use crate::air::Station;
use crate::gas::Gas;
use crate::number::{Number, Pair};
use crate::tubing::Tube;

/// The lag, and what the ratios will come to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lag {
    /// s.
    pub time: f64,
    pub supply: Station,
    pub supply_tube: Tube,
    pub cylinder_tube: Tube,
}

impl Lag {
    /// The pressure ratio that a flow will come to.
    fn settled_ratio(&self, gas: &Gas, tube: &Tube, known: &Station, flow: f64) -> f64 {
        gas.pressure(tube.far_end(known, flow).exner) / gas.pressure(known.exner)
    }

    /// Rates of the three ratios, for the flow from the supply (kg/s) and those into the chambers.
    pub fn derivative(
        &self,
        gas: &Gas,
        x: &StateVector,
        chambers: &Station<Pair>,
        total: f64,
        flows: Pair,
    ) -> [f64; 3] {
        let settled =
            |i: usize| self.settled_ratio(gas, &self.cylinder_tube, &chambers.lane(i), -flows.lane(i));
        let settled =
            [self.settled_ratio(gas, &self.supply_tube, &self.supply, total), settled(0), settled(1)];
        std::array::from_fn(|i| (settled[i] - x[slot::RATIO[i]]) / self.time)
    }
}
