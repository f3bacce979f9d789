//! Tubes whose pressure ratio follows the flow with a first-order lag (thesis 7.2.1; EQUATIONS section
//! 4):
//!
//! ```text
//! ratio' = (settled ratio at the present flow - ratio) / lag
//! ```
//!
//! The network does not contain them; the pressures behind them are states.
//!
//! One part of the supply tube cannot lag. Behind a land wider than its port, the speed of the air recovers pressure at
//! once (6.54). So for a given pressure in front of it the flow near rest has no unique value, and it would jump to and
//! fro with any lag, however short. Therefore enough of the drop follows the flow at once to outweigh the recovery:
//!
//! ```text
//! P_sv = P_s ratio^(1-a) settled^a,   a = 1.5 G (1 - (A_p/(C_d A))^2),   0 where C_d A <= A_p
//! ```
//!
//! G is the pressure that the speed of the leakage recovers behind an infinitely wide land, over the pressure that
//! the tube loses, both as slopes over the flow. Larger flows are limited by their port more than their speed helps
//! them. As the lag goes to zero, P_sv goes to the value for a tube without lag.

use super::{StateVector, slot};
use crate::component::air::GasState;
use crate::component::gas::Gas;
use crate::component::supply;
use crate::component::tubing::{Tube, speed_recovery, tubes};
use crate::component::valve::Valve;
use crate::keys;
use crate::number::{Number, Pair};
use crate::values::Rig;

/// The lag, and the settled ratios.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lag {
    /// s.
    pub time: f64,
    pub supply: GasState,
    pub supply_tube: Tube,
    pub cylinder_tube: Tube,
    /// G; 0 without upstream Mach numbers.
    pub recovery: f64,
}

/// How much more of the drop follows at once than must.
const MARGIN: f64 = 1.5;

impl Lag {
    /// The lag of a rig's tubes, if they have one.
    pub fn of(rig: &Rig, gas: &Gas) -> Option<Lag> {
        let time = rig.get(&keys::tubing::LAG_S);
        let (supply_tube, cylinder_tube) = tubes(rig, gas);
        (time > 0.0).then(|| {
            let recovery = speed_recovery(rig, gas, &Valve::of(rig));
            Lag { time, supply: supply::station(rig, gas), supply_tube, cylinder_tube, recovery }
        })
    }

    /// a, for the largest C_d A of a supply land over A_p.
    pub fn at_once(&self, width: f64) -> f64 {
        (MARGIN * self.recovery * (1.0 - 1.0 / (width * width))).clamp(0.0, 1.0)
    }

    /// Rates of the three ratios. The flow from the supply (kg/s) comes with the temperature (K) of the air that flows
    /// back to it. The flows into the chambers come with their pressures and the temperatures of the air in the tubes.
    #[inline(always)]
    pub fn derivative(
        &self,
        gas: &Gas,
        x: &StateVector,
        (total, returning): (f64, f64),
        (chambers, flows): (&GasState<Pair>, Pair),
    ) -> [f64; 3] {
        let temperature = if total < 0.0 { returning } else { self.supply.temperature };
        let supply = settled_ratio(gas, &self.supply_tube, &GasState { temperature, ..self.supply }, total);
        let cylinders = settled_ratio(gas, &self.cylinder_tube, chambers, -flows);
        let settled = [supply, cylinders.lane(0), cylinders.lane(1)];
        std::array::from_fn(|i| (settled[i] - x[slot::RATIO[i]]) / self.time)
    }
}

/// The settled pressure ratio for a flow.
#[inline(always)]
fn settled_ratio<N: Number>(gas: &Gas, tube: &Tube, known: &GasState<N>, flow: N) -> N {
    gas.pressure_of(tube.far_end(known, flow).exner / known.exner)
}
