//! Air in one place: its pressure as Exner pressure w, its temperature, its mass.
//!
//! ```text
//! m' = sum of mdot                                       mass
//! w'/w = (n-1) (R sum of mdot T_in / (P V) - V'/V)       energy: thesis 6.15, 6.17 in w
//! T = P V / (m R)
//! ```

use crate::gas::Gas;

/// A place with an Exner pressure and a temperature, or two of them.
#[derive(Clone, Copy, Debug)]
pub struct Station<N = f64> {
    /// w.
    pub exner: N,
    /// K.
    pub temperature: N,
}

/// A chamber's volume and how fast it grows.
#[derive(Clone, Copy, Debug)]
pub struct Volume {
    /// m^3.
    pub volume: f64,
    /// m^3/s.
    pub rate: f64,
}

/// The air in a chamber.
#[derive(Clone, Copy, Debug)]
pub struct Air {
    /// m, kg.
    pub mass: f64,
    /// w.
    pub exner: f64,
    /// P, Pa.
    pub pressure: f64,
    /// T, K.
    pub temperature: f64,
}

impl Air {
    /// Air of a mass and an Exner pressure in a volume.
    #[must_use]
    pub fn of_state(gas: &Gas, mass: f64, exner: f64, volume: f64) -> Air {
        let pressure = gas.pressure(exner);
        Air { mass, exner, pressure, temperature: pressure * volume / (mass * gas.gas_constant) }
    }

    /// The mass (kg) and Exner pressure of air at `pressure` Pa and `temperature` K in a volume.
    #[must_use]
    pub fn state_of(gas: &Gas, pressure: f64, temperature: f64, volume: f64) -> [f64; 2] {
        [pressure * volume / (gas.gas_constant * temperature), gas.exner(pressure)]
    }

    /// As a place in the network of flows.
    #[must_use]
    pub fn station(&self) -> Station {
        Station { exner: self.exner, temperature: self.temperature }
    }

    /// m' and w' for flows in kg/s into the chamber, each with the temperature (K) that it carries.
    #[must_use]
    pub fn derivative<const N: usize>(&self, gas: &Gas, volume: Volume, flows: [(f64, f64); N]) -> [f64; 2] {
        let carried: f64 = flows.iter().map(|(flow, temperature)| flow * temperature).sum();
        let filling = gas.gas_constant * carried / (self.pressure * volume.volume);
        let growth = volume.rate / volume.volume;
        let mass = flows.iter().map(|(flow, _)| flow).sum();
        [mass, self.exner * (gas.heat_capacity_ratio - 1.0) * (filling - growth)]
    }
}
