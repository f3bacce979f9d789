//! The network of a rig.

use super::{Laws, Network, Vessels};
use crate::component::air::GasState;
use crate::component::gas::Gas;
use crate::component::tubing::{Tube, tubes};
use crate::component::valve::{Valve, speed_counts};
use crate::component::{exhaust, supply};
use crate::keys;
use crate::values::Rig;

impl Network {
    /// The network of a rig. Lagged tubes are states of the assembly, not part of it.
    pub fn of(rig: &Rig, gas: Gas) -> Network {
        let lagged = rig.get(&keys::tubing::LAG_S) > 0.0;
        let (supply_tube, cylinder_tube) =
            if lagged { (Tube::none(), Tube::none()) } else { tubes(rig, &gas) };
        let port_area = speed_counts(rig).then(|| Valve::of(rig).port_area());
        let network = Network::new(
            gas,
            supply::station(rig, &gas),
            exhaust::station(rig, &gas),
            supply_tube,
            cylinder_tube,
            laws(rig),
            port_area,
        );
        network.beside(vessels(rig, &gas)).with_turbulence(rig.get(&keys::valve::TURBULENCE))
    }

    /// The valve's lands and ports between gauges right at them: another pressure (Pa) at the supply port, no tubes.
    /// With a `port_area` (m^2) air approaches at its own speed.
    pub fn without_tubes(rig: &Rig, gas: Gas, supply_pa: f64, port_area: Option<f64>) -> Network {
        let supply = GasState { exner: gas.exner(supply_pa), ..supply::station(rig, &gas) };
        let exhaust = exhaust::station(rig, &gas);
        Network::new(gas, supply, exhaust, Tube::none(), Tube::none(), laws(rig), port_area)
            .with_turbulence(rig.get(&keys::valve::TURBULENCE))
    }
}

/// The flow laws of the lands. A port is an orifice like those of the supply's lands.
fn laws(rig: &Rig) -> Laws {
    let [supply, exhaust] = rig.get(&keys::valve::MODEL).laws(rig);
    Laws { supply, exhaust, port: supply }
}

/// The ends that no tube joins to the valve. A lagged tube counts as none.
fn vessels(rig: &Rig, gas: &Gas) -> Vessels {
    let (supply, cylinder) = tubes(rig, gas);
    Vessels { supply: supply.is_none(), chambers: cylinder.ends_at_rest() }
}
