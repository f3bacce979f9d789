//! A receiver: a volume of air in front of the valve, which the valve empties and a line fills through an opening.
//!
//! ```text
//! m'   = mdot_f - s_1 - s_2                                    s: from the receiver into the nodes of the valve
//! w'/w = (n-1) R (mdot_f T_f - sum of s T_s)/(P V) + ((n-1)^2/n) Q/(P V)      [`crate::component::air`]
//! Q    = h A (T_e - T),   A = 5/2 pi D^2,   V = pi/2 D^3       a closed cylinder twice as long as wide
//!
//! mdot_f =  C rho_0 P_l sqrt(T_0/T_l) phi(P/P_l)               P < P_l, T_f = T_l           ISO 6358-1, m = 0.5
//! mdot_f = -C rho_0 P   sqrt(T_0/T)   phi(P_l/P)               P > P_l, T_f = T; 0 with a check valve
//! ```
//!
//! Air has the temperature of where it comes from: T_s is that of the receiver, or of a node that gives air back. P_l and T_l are
//! constant, T_e is the temperature of the surroundings, which the walls keep, and h = 0 makes them adiabatic. So mass and
//! energy of receiver and chambers change by what line, exhaust, walls and piston exchange with them, and by nothing else; but
//! with `valve.upstream_mach` the air that approaches a land is warmer than that (6.54), and the mass alone is in balance.
//!
//! Near P = P_l the ellipse of ISO 6358 has an infinite slope, so phi goes to 0 in proportion there
//! ([`crate::component::valve::iso6358`]).
//!
//! A receiver has plain ports when it is bought. The check valve in front of it, which keeps its pressure while the line loses its own,
//! is a part of its own, opens at once, and its loss is in C and b.

use std::f64::consts::PI;

use crate::component::air::{ChamberAir, Volume};
use crate::component::exhaust;
use crate::component::gas::Gas;
use crate::component::supply::regulator::{self, Regulator};
use crate::component::supply::{self, SupplyKind, keys::MODEL};
use crate::component::valve::iso6358::Opening;
use crate::key::keys;
use crate::values::{Findings, Rig};

keys! {
    RECEIVER_VOLUME_M3: f64 = number("supply.receiver_volume_m3", 2e-3, 1e-4, 100.0, "", "Volume of the receiver, or behind the regulator (filter bowl, line), with the tube to the valve; 2 l is a round number.").chosen_by(&MODEL, &["receiver", "regulator"]);
    FEED_CONDUCTANCE: f64 = number("supply.feed_conductance_m3_per_s_pa", 8e-9, 1e-12, 1e-6, "", "Sonic conductance between line and receiver (ISO 6358), with all that is there, a regulator wide open. The default is that of a smooth tube of 4 mm bore and 3 m, for a line of 6 mm.").chosen_by(&MODEL, &["receiver", "regulator"]).spread();
    FEED_CRITICAL_RATIO: f64 = number("supply.feed_critical_ratio", 0.25, 0.0, 0.9, "", "Critical pressure ratio between line and receiver (ISO 6358); long tubes have 0.2 to 0.3.").chosen_by(&MODEL, &["receiver", "regulator"]);
    CHECK_VALVE: bool = switch("supply.check_valve", false, "", "Whether a check valve keeps the air of the receiver from flowing back into the line. A receiver is bought without one.").chosen_by(&MODEL, &["receiver", "regulator"]);
    RECEIVER_HEAT_TRANSFER: f64 = number("supply.receiver_heat_transfer_w_per_m2_k", 0.0, 0.0, 1e5, "", "Heat transfer of the receiver's walls, which have the temperature of the surroundings; 0: adiabatic.").chosen_by(&MODEL, &["receiver", "regulator"]);
}

/// A receiver and what feeds it, SI.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Receiver {
    /// V, m^3.
    volume: f64,
    feed: Feed,
    regulator: Option<Regulator>,
    /// h A, W/K.
    heat_per_kelvin: f64,
    /// T_e, K.
    wall_temperature: f64,
}

/// The air of a receiver at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReceiverState {
    /// Absolute, Pa.
    pub pressure: f64,
    /// K.
    pub temperature: f64,
    /// mdot_f from the line, kg/s; negative when air flows back, or out of a regulator.
    pub feed_flow: f64,
}

impl Receiver {
    /// The receiver of a rig.
    pub fn of(rig: &Rig) -> Option<Receiver> {
        if rig.get(&MODEL) == SupplyKind::Ideal {
            return None;
        }
        let volume = rig.get(&keys::RECEIVER_VOLUME_M3);
        Some(Receiver {
            volume,
            feed: Feed::of(rig),
            regulator: Regulator::of(rig, rig.get(&keys::FEED_CRITICAL_RATIO)),
            heat_per_kelvin: rig.get(&keys::RECEIVER_HEAT_TRANSFER) * wall_area(volume),
            wall_temperature: rig.get(&exhaust::keys::TEMPERATURE_K),
        })
    }

    /// Mass (kg) and Exner pressure at a pressure (Pa) and a temperature (K).
    pub fn state_of(&self, gas: &Gas, pressure: f64, temperature: f64) -> [f64; 2] {
        ChamberAir::state_of(gas, pressure, temperature, self.volume)
    }

    /// Another pressure of the line, Pa.
    pub fn set_line(&mut self, pressure: f64) {
        self.feed.line_pressure = pressure;
    }

    /// Another pressure that a regulator is set to, Pa; false without one.
    pub fn set_regulator(&mut self, pressure: f64) -> bool {
        self.regulator.as_mut().map(|regulator| regulator.set = pressure).is_some()
    }

    /// Air of a mass (kg) and an Exner pressure.
    #[inline]
    pub fn air(&self, gas: &Gas, [mass, exner]: [f64; 2]) -> ChamberAir {
        ChamberAir::of_state(gas, mass, exner, self.volume)
    }

    /// m' and w' for flows (kg/s) into the nodes, each with the temperature (K) that it carries.
    pub fn derivative(&self, gas: &Gas, air: &ChamberAir, [one, two]: [(f64, f64); 2]) -> [f64; 2] {
        let volume = Volume { volume: self.volume, rate: 0.0 };
        let flows = [self.inflow(air), (-one.0, one.1), (-two.0, two.1)];
        let [mass, exner] = air.derivative(gas, volume, flows);
        let heat = self.heat_per_kelvin * (self.wall_temperature - air.temperature);
        [mass, exner + air.exner_rate_of_heat(gas, self.volume, heat)]
    }

    /// mdot_f and T_f.
    #[inline(always)]
    fn inflow(&self, air: &ChamberAir) -> (f64, f64) {
        let wide_open = self.feed.flow(air);
        match &self.regulator {
            None => wide_open,
            Some(regulator) => regulator.passes(air, wide_open),
        }
    }

    /// T', K/s, of air for the rates of its mass and its pressure: T = P V/(m R).
    pub fn temperature_rate(&self, air: &ChamberAir, mass_rate: f64, pressure_rate: f64) -> f64 {
        air.temperature * (pressure_rate / air.pressure - mass_rate / air.mass)
    }

    /// What can be seen of its air.
    pub fn seen(&self, air: &ChamberAir) -> ReceiverState {
        let (feed_flow, _) = self.inflow(air);
        ReceiverState { pressure: air.pressure, temperature: air.temperature, feed_flow }
    }
}

/// The constraints on what feeds it.
pub(crate) fn check(rig: &Rig, findings: &mut Findings) {
    if rig.get(&MODEL) == SupplyKind::Regulator {
        let of = |key| rig.get(key);
        regulator::check(rig, of(&keys::FEED_CONDUCTANCE), of(&keys::RECEIVER_VOLUME_M3), findings);
    }
}

/// A of a volume in m^3, m^2.
fn wall_area(volume: f64) -> f64 {
    let diameter = (2.0 * volume / PI).cbrt();
    2.5 * PI * diameter * diameter
}

/// The line and the opening behind it.
#[derive(Clone, Copy, Debug)]
struct Feed {
    /// P_l, Pa.
    line_pressure: f64,
    /// T_l, K.
    line_temperature: f64,
    opening: Opening,
    check_valve: bool,
}

impl Feed {
    fn of(rig: &Rig) -> Feed {
        Feed::new(
            [regulator::line_pressure(rig), &supply::keys::TEMPERATURE_K].map(|key| rig.get(key)),
            rig.get(&keys::FEED_CONDUCTANCE),
            rig.get(&keys::FEED_CRITICAL_RATIO),
            rig.get(&keys::CHECK_VALVE),
        )
    }

    /// From a line of a pressure (Pa) and a temperature (K) through C (m^3/(s Pa)) and b.
    fn new(
        [pressure, temperature]: [f64; 2],
        conductance: f64,
        critical_ratio: f64,
        check_valve: bool,
    ) -> Feed {
        Feed {
            line_pressure: pressure,
            line_temperature: temperature,
            opening: Opening::new(conductance, critical_ratio),
            check_valve,
        }
    }

    /// mdot_f and T_f beside the air of the receiver.
    fn flow(&self, air: &ChamberAir) -> (f64, f64) {
        let (line, own) = (self.line_pressure, air.pressure);
        if own <= line {
            (self.opening.flow((line, self.line_temperature), own), self.line_temperature)
        } else if self.check_valve {
            (0.0, air.temperature)
        } else {
            (-self.opening.flow((own, air.temperature), line), air.temperature)
        }
    }
}

#[cfg(test)]
pub(super) mod tests;
