//! The surroundings: the valve exhausts into them, and they push on the rod.

use crate::component::air::GasState;
use crate::component::gas::Gas;
use crate::key::keys;
use crate::values::Rig;

keys! {
    PRESSURE_PA: f64 = number("exhaust.pressure_pa", 101_300.0, 1e4, 4e6, "C(7)", "Absolute pressure of the surroundings, into which the valve exhausts.");
    TEMPERATURE_K: f64 = number("exhaust.temperature_k", 294.0, 150.0, 600.0, "C(8)", "Temperature of the surroundings.");
}

/// The air of the surroundings: ambient pressure and temperature.
#[must_use]
pub fn station(rig: &Rig, gas: &Gas) -> GasState {
    GasState { exner: gas.exner(rig.get(&keys::PRESSURE_PA)), temperature: rig.get(&keys::TEMPERATURE_K) }
}
