//! The supply: an ideal reservoir.

use crate::component::air::GasState;
use crate::component::gas::Gas;
use crate::key::keys;
use crate::values::Rig;

keys! {
    PRESSURE_PA: f64 = number("supply.pressure_pa", 589_000.0, 2e4, 5e6, "C(5)", "Absolute supply pressure.").spread();
    TEMPERATURE_K: f64 = number("supply.temperature_k", 294.0, 150.0, 600.0, "C(6)", "Supply temperature.");
}

/// The air of the supply: its pressure and temperature.
#[must_use]
pub fn station(rig: &Rig, gas: &Gas) -> GasState {
    GasState { exner: gas.exner(rig.get(&keys::PRESSURE_PA)), temperature: rig.get(&keys::TEMPERATURE_K) }
}
