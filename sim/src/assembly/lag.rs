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
    /// Rates of the three ratios, for the flow from the supply (kg/s), the chambers and the flows into them.
    #[inline(always)]
    pub fn derivative(
        &self,
        gas: &Gas,
        x: &StateVector,
        total: f64,
        chambers: &Station<Pair>,
        flows: Pair,
    ) -> [f64; 3] {
        let supply = settled_ratio(gas, &self.supply_tube, &self.supply, total);
        let cylinders = settled_ratio(gas, &self.cylinder_tube, chambers, -flows);
        let settled = [supply, cylinders.lane(0), cylinders.lane(1)];
        std::array::from_fn(|i| (settled[i] - x[slot::RATIO[i]]) / self.time)
    }
}

/// The pressure ratio that a flow will come to.
#[inline(always)]
fn settled_ratio<N: Number>(gas: &Gas, tube: &Tube, known: &Station<N>, flow: N) -> N {
    gas.pressure_of(tube.far_end(known, flow).exner / known.exner)
}
