//! The supply: an ideal reservoir, a receiver behind a line ([`receiver`]), or one behind a regulator ([`regulator`]).

pub mod receiver;
pub mod regulator;

use crate::component::air::GasState;
use crate::component::gas::Gas;
use crate::key::{keys, words};
use crate::values::Rig;

words! {
    /// Where the air in front of the valve comes from.
    pub enum SupplyKind {
        /// A reservoir of constant pressure and temperature.
        Ideal = "ideal",
        /// A volume of air, which a line feeds.
        Receiver = "receiver",
        /// The same, which a regulator feeds.
        Regulator = "regulator",
    }
}

keys! {
    MODEL: SupplyKind = choice("supply.model", "", "Where the valve's air comes from: a reservoir of constant pressure, a receiver of a volume, which the valve empties and a line fills, or the volume behind a pressure regulator.");
    PRESSURE_PA: f64 = number("supply.pressure_pa", 589_000.0, 2e4, 5e6, "C(5)", "Absolute supply pressure; with a receiver that of the line in front of it, with a regulator what it is set to at no flow.").spread();
    TEMPERATURE_K: f64 = number("supply.temperature_k", 294.0, 150.0, 600.0, "C(6)", "Supply temperature; with a receiver that of the line, and of the receiver at the start.");
}

/// The air of the supply, or of the line in front of its receiver: its pressure and temperature.
#[must_use]
pub fn station(rig: &Rig, gas: &Gas) -> GasState {
    GasState { exner: gas.exner(rig.get(&keys::PRESSURE_PA)), temperature: rig.get(&keys::TEMPERATURE_K) }
}
