//! A pressure regulator: the inlet of a receiver, which opens as the pressure behind it falls below the set pressure.
//!
//! ```text
//! mdot_f =  y mdot_o(P),  y = min((P_s - P)/D, 1)                 P <= P_s    y = 0: shut, 1: wide open
//! mdot_f = -z C_r rho_0 P sqrt(T_0/T) phi(P_e/P),  z = min((P - P_s)/D, 1)    P > P_s: it relieves, T_f = T
//! ```
//!
//! mdot_o is the flow of the inlet wide open by its C and b (ISO 6358; [`super::receiver`]), P the pressure behind it, P_s the set
//! pressure at no flow, P_e that of the surroundings. C_r = 0 does not relieve. The relief has the b of the inlet, which has no effect
//! while P is above P_e/b. In a steady flow that is choked the outlet pressure falls in proportion, P = P_s - D mdot/mdot_o: that is the
//! forward flow characteristic of ISO 6953-1 and -2, as a straight line. D is read from a data sheet as the fall at a flow, times the
//! flow wide open over that flow.
//!
//! Next to P_s the pressure closes in on it with the time constant
//!
//! ```text
//! tau = V D / (n R T_l mdot_o)
//! ```
//!
//! The opening follows the pressure at once, as ISO 6953-3 presumes where it measures the flow by charging and emptying a tank; data sheets
//! give no time of their own. Left out are hysteresis, the effect of the line's pressure on P_s, what a relief needs before it opens, and a
//! permanent bleed.
//!
//! While the line has less than P, air flows back through what is open, and any fall below P_s opens it further: its check valve, or
//! one beside it, keeps the pressure (`supply.check_valve`).
//!
//! The flow is continuous where the inlet or the relief begins to open and where it is wide open; its slope jumps there. No event is
//! made of that: P comes to P_s from one side only unless air flows back, and steps that cross are repeated until their error is within
//! the tolerance (`sim/tests/regulator.rs`).

use crate::component::air::ChamberAir;
use crate::component::exhaust;
use crate::component::gas::Gas;
use crate::component::supply::{self, SupplyKind, keys::MODEL};
use crate::component::valve::iso6358::Opening;
use crate::key::{Typed, keys};
use crate::values::{Findings, Rig};

keys! {
    PRIMARY_PRESSURE_PA: f64 = number("supply.primary_pressure_pa", 9e5, 2e4, 5e6, "", "Absolute pressure of the line in front of the regulator.").chosen_by(&MODEL, &["regulator"]).spread();
    DROOP_PA: f64 = number("supply.droop_pa", 1e5, 100.0, 2e6, "", "Fall of the outlet pressure below supply.pressure_pa at which the regulator is wide open: by its sheet (ISO 6953), the fall at a flow times the flow wide open over that flow. 1 bar is a round number.").chosen_by(&MODEL, &["regulator"]).spread();
    RELIEF_CONDUCTANCE: f64 = number("supply.relief_conductance_m3_per_s_pa", 1e-9, 0.0, 1e-6, "", "Sonic conductance of the relief into the surroundings (ISO 6358), wide open supply.droop_pa above supply.pressure_pa; 0: it does not relieve. The default is a round number.").chosen_by(&MODEL, &["regulator"]).spread();
}

/// The least tau, s: steps are no longer than a few of it wherever the regulator is open in part.
const LEAST_TAU_S: f64 = 1e-5;

/// What a regulator adds to its inlet, SI.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Regulator {
    /// P_s, Pa.
    pub set: f64,
    /// D, Pa.
    droop: f64,
    relief: Opening,
    /// P_e, Pa.
    outside: f64,
}

impl Regulator {
    /// The regulator of a rig, whose inlet has this b.
    pub fn of(rig: &Rig, critical_ratio: f64) -> Option<Regulator> {
        (rig.get(&MODEL) == SupplyKind::Regulator).then(|| Regulator {
            set: rig.get(&supply::keys::PRESSURE_PA),
            droop: rig.get(&keys::DROOP_PA),
            relief: Opening::new(rig.get(&keys::RELIEF_CONDUCTANCE), critical_ratio),
            outside: rig.get(&exhaust::keys::PRESSURE_PA),
        })
    }

    /// mdot_f and T_f beside the air behind it, for those of its inlet wide open. Out of line, so that drives without one do not pay for it.
    #[cold]
    #[inline(never)]
    pub fn passes(&self, air: &ChamberAir, (wide_open, temperature): (f64, f64)) -> (f64, f64) {
        let missing = (self.set - air.pressure) / self.droop;
        if missing < 0.0 {
            let outside = self.outside.min(air.pressure);
            let relief = self.relief.flow((air.pressure, air.temperature), outside);
            return (missing.max(-1.0) * relief, air.temperature);
        }
        (missing.min(1.0) * wide_open, temperature)
    }
}

/// The key of the pressure of the line in front of a receiver or a regulator, or of an ideal supply.
pub(crate) fn line_pressure(rig: &Rig) -> &'static Typed<f64> {
    match rig.get(&MODEL) {
        SupplyKind::Regulator => &keys::PRIMARY_PRESSURE_PA,
        SupplyKind::Ideal | SupplyKind::Receiver => &supply::keys::PRESSURE_PA,
    }
}

/// The constraints on a regulator with this C (m^3/(s Pa)) in front of a volume (m^3).
pub(super) fn check(rig: &Rig, conductance: f64, volume: f64, findings: &mut Findings) {
    let why = "a regulator only lowers the pressure of its line";
    findings.below(rig, &supply::keys::PRESSURE_PA, &keys::PRIMARY_PRESSURE_PA, why);
    let droop = rig.get(&keys::DROOP_PA);
    let tau = least_tau(rig, conductance, volume);
    if tau < LEAST_TAU_S {
        // Rounded, it is still enough.
        let enough = 1.05 * droop * LEAST_TAU_S / tau;
        let message = format!(
            "the pressure behind it follows within {tau:.1e} s, less than {LEAST_TAU_S:e} s: give at least {enough:.1e}, or a larger supply.receiver_volume_m3"
        );
        findings.note(&keys::DROOP_PA, message);
    }
}

/// tau of the inlet or of the relief, whichever is less, s.
fn least_tau(rig: &Rig, conductance: f64, volume: f64) -> f64 {
    let (gas, temperature) = (Gas::of(rig), rig.get(&supply::keys::TEMPERATURE_K));
    let choked = |conductance: f64, pressure: f64| {
        Opening::new(conductance, 0.0).choked * pressure / temperature.sqrt()
    };
    let inlet = choked(conductance, rig.get(&keys::PRIMARY_PRESSURE_PA));
    let relief = choked(rig.get(&keys::RELIEF_CONDUCTANCE), rig.get(&supply::keys::PRESSURE_PA));
    volume * rig.get(&keys::DROOP_PA)
        / (gas.heat_capacity_ratio * gas.gas_constant * temperature * inlet.max(relief))
}

#[cfg(test)]
mod tests;
