//! Air in one place: its pressure as Exner pressure w, its temperature, its mass.
//!
//! ```text
//! m' = sum of mdot                                       mass
//! w'/w = (n-1) (R sum of mdot T_in / (P V) - V'/V)       energy: thesis 6.15, 6.17 in w
//!        + ((n-1)^2 / n) Q / (P V)                       heat Q from the walls
//! T = P V / (m R)
//! ```
//!
//! The second line is U' = n/(n-1) R sum of mdot T_in - P V' + Q with U = P V / (n-1).

use crate::component::gas::Gas;
use crate::number::{Number, Pair};

/// A place with an Exner pressure and a temperature, or two of them.
#[derive(Clone, Copy, Debug)]
pub struct GasState<N = f64> {
    /// w.
    pub exner: N,
    /// K.
    pub temperature: N,
}

impl GasState<Pair> {
    /// Two places as one.
    pub(crate) fn both([one, two]: &[GasState; 2]) -> GasState<Pair> {
        GasState {
            exner: Pair::new([one.exner, two.exner]),
            temperature: Pair::new([one.temperature, two.temperature]),
        }
    }

    /// Place `i` of them.
    pub(crate) fn lane(&self, i: usize) -> GasState {
        GasState { exner: self.exner.lane(i), temperature: self.temperature.lane(i) }
    }
}

/// A chamber's volume and its rate of change, or those of both chambers.
#[derive(Clone, Copy, Debug)]
pub struct Volume<N = f64> {
    /// m^3.
    pub volume: N,
    /// m^3/s.
    pub rate: N,
}

/// The air in a chamber, or in both.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChamberAir<N = f64> {
    /// m, kg.
    pub mass: N,
    /// w.
    pub exner: N,
    /// P, Pa.
    pub pressure: N,
    /// T, K.
    pub temperature: N,
}

impl ChamberAir {
    /// The mass (kg) and Exner pressure of air at `pressure` Pa and `temperature` K in a volume.
    #[must_use]
    pub(crate) fn state_of(gas: &Gas, pressure: f64, temperature: f64, volume: f64) -> [f64; 2] {
        [pressure * volume / (gas.gas_constant * temperature), gas.exner(pressure)]
    }
}

impl<N: Number> ChamberAir<N> {
    /// Air of a mass and an Exner pressure in a volume.
    #[inline(always)]
    pub(crate) fn of_state(gas: &Gas, mass: N, exner: N, volume: N) -> ChamberAir<N> {
        let pressure = gas.pressure_of(exner);
        ChamberAir {
            mass,
            exner,
            pressure,
            temperature: pressure * volume / (mass * N::from(gas.gas_constant)),
        }
    }

    /// As a place in the network of flows.
    #[inline(always)]
    pub(crate) fn station(&self) -> GasState<N> {
        GasState { exner: self.exner, temperature: self.temperature }
    }

    /// m' and w' for flows in kg/s into the chamber, each with the temperature (K) that it carries.
    #[inline(always)]
    pub(crate) fn derivative(&self, gas: &Gas, volume: Volume<N>, flows: [(N, N); 3]) -> [N; 2] {
        let [(one, t1), (two, t2), (three, t3)] = flows;
        let carried = one * t1 + two * t2 + three * t3;
        let filling = carried * (N::from(gas.gas_constant) / (self.pressure * volume.volume));
        let growth = volume.rate / volume.volume;
        let per_growth = self.exner * N::from(gas.heat_capacity_ratio - 1.0);
        [one + two + three, per_growth * (filling - growth)]
    }

    /// The contribution of heat from the walls (W) to w' in a volume (m^3).
    #[inline(always)]
    pub(crate) fn exner_rate_of_heat(&self, gas: &Gas, volume: N, heat: N) -> N {
        let per_heat = N::from((gas.heat_capacity_ratio - 1.0) * gas.exner_exponent());
        self.exner * per_heat * heat / (self.pressure * volume)
    }
}

impl ChamberAir<Pair> {
    /// The air of chamber `i`.
    #[inline(always)]
    pub(crate) fn lane(&self, i: usize) -> ChamberAir {
        ChamberAir {
            mass: self.mass.lane(i),
            exner: self.exner.lane(i),
            pressure: self.pressure.lane(i),
            temperature: self.temperature.lane(i),
        }
    }
}
