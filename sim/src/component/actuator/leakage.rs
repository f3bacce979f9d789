//! Leakage past the piston, from chamber 1 to chamber 2 (thesis 6.1.2).
//!
//! ```text
//! mdot_L = K_L (P_1 - P_2)                                          laminar     (6.26, 6.27)
//! mdot_L = +- sigma F P_o / sqrt(R T_o)                             adiabatic   (6.28 to 6.30)
//! sigma  = sqrt((1 - r^2) / R_ch),   r = P_low/P_high <= 1,   R_ch = L_nh s/h
//! F      = pi D h                                                   bore D, clearance h
//! ```
//!
//! o is the source, the chamber of the higher pressure. The adiabatic law is Egli's, for narrow channels. It does not
//! choke, but sigma ends at sqrt(1/R_ch). The thesis estimates s = 10 mm, h = 10 um and L_nh = 0.02, so R_ch = 20.
//! Its C(57) = 0.1 mm contradicts that and would leak like an open valve, and F is not stated (EQUATIONS section 5).
//!
//! At P_1 = P_2 the adiabatic law is continuous but has an infinite slope. We keep it; the integrator's error control
//! handles it and may take small steps there.
//!
//! The leakage enters both mass balances and carries the temperature T_L = T_o of its source:
//!
//! ```text
//! chamber 1: flow -mdot_L at T_L,   chamber 2: flow +mdot_L at T_L       (6.15 to 6.18 as corrected)
//! ```

use std::f64::consts::PI;

use crate::component::air::ChamberAir;
use crate::component::gas::Gas;
use crate::key::{keys, words};
use crate::number::{Number, Pair};
use crate::values::Rig;

words! {
    /// Leakage past the piston.
    pub enum LeakageKind {
        /// None.
        None = "none",
        /// In proportion to the pressure difference.
        Laminar = "laminar",
        /// Through the gap around the piston.
        Adiabatic = "adiabatic",
    }
}

keys! {
    LEAKAGE: LeakageKind = choice("actuator.leakage", "L(18)", "Leakage past the piston.");
    LEAKAGE_COEFFICIENT: f64 = number("actuator.leakage_coefficient", 0.0, 0.0, 1e-6, "C(55)", "Laminar leakage, kg/(s Pa).").vague();
    PASSAGE_RESISTANCE: f64 = number("actuator.passage_resistance", 20.0, 1e-3, 1e6, "C(56)", "Egli's resistance of the leakage passage.");
    PASSAGE_CLEARANCE_M: f64 = number("actuator.passage_clearance_m", 1e-5, 1e-9, 1e-2, "C(57)", "Clearance of the leakage passage; the thesis's table has 1e-4, a slip.").vague();
}

impl Leakage {
    /// The leakage of a rig, past a piston of this bore (m).
    pub(super) fn of(rig: &Rig, bore: f64) -> Leakage {
        match rig.get(&keys::LEAKAGE) {
            LeakageKind::None => Leakage::None,
            LeakageKind::Laminar => Leakage::Laminar { coefficient: rig.get(&keys::LEAKAGE_COEFFICIENT) },
            LeakageKind::Adiabatic => Leakage::Adiabatic {
                resistance: rig.get(&keys::PASSAGE_RESISTANCE),
                clearance: rig.get(&keys::PASSAGE_CLEARANCE_M),
                bore,
            },
        }
    }
}

/// How the piston leaks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Leakage {
    /// Not at all.
    None,
    /// In proportion to the pressure difference.
    Laminar {
        /// K_L, kg/(s Pa) (C(55)).
        coefficient: f64,
    },
    /// Through the gap around the piston, after Egli.
    Adiabatic {
        /// R_ch (C(56)), above 0.
        resistance: f64,
        /// h, m (C(57)).
        clearance: f64,
        /// D, m (C(15)).
        bore: f64,
    },
}

impl Leakage {
    /// mdot_L, kg/s, from chamber 1 to chamber 2 at these pressures (Pa), both at one temperature (K): the form for a
    /// record, which has no temperatures.
    #[must_use]
    pub fn at_pressures(&self, gas: &Gas, pressures: [f64; 2], temperature: f64) -> f64 {
        let [mass, exner] = [0, 1]
            .map(|state| Pair::of(|i| ChamberAir::state_of(gas, pressures[i], temperature, 1.0)[state]));
        let (pressure, temperature) = (Pair::new(pressures), Pair::splat(temperature));
        self.flow(gas, &ChamberAir { mass, exner, pressure, temperature })
    }

    /// mdot_L, kg/s, from chamber 1 to chamber 2; negative the other way.
    #[inline]
    pub(crate) fn flow(&self, gas: &Gas, air: &ChamberAir<Pair>) -> f64 {
        match *self {
            Leakage::None => 0.0,
            Leakage::Laminar { coefficient } => coefficient * (air.pressure.lane(0) - air.pressure.lane(1)),
            Leakage::Adiabatic { resistance, clearance, bore } => {
                let from = source(air);
                let (high, low) = (air.lane(from), air.lane(1 - from));
                // P_o sqrt(1 - r^2), without the loss of digits at r = 1.
                let drop = ((high.pressure - low.pressure) * (high.pressure + low.pressure)).sqrt();
                let gap = PI * bore * clearance;
                let flow = gap * drop / (resistance * gas.gas_constant * high.temperature).sqrt();
                if from == 0 { flow } else { -flow }
            }
        }
    }
}

/// The index of the chamber that air leaks from, whose temperature is T_L. At equal pressures nothing
/// leaks and it is chamber 1's.
#[inline(always)]
pub(crate) fn source(air: &ChamberAir<Pair>) -> usize {
    usize::from(air.pressure.lane(1) > air.pressure.lane(0))
}

#[cfg(test)]
mod tests {
    use super::*;

    const THESIS: Leakage = Leakage::Adiabatic { resistance: 20.0, clearance: 1e-5, bore: 0.05 };

    fn gas() -> Gas {
        Gas::new(1.4, 286.76)
    }

    /// Both chambers at a pressure and a temperature each.
    fn air(chambers: [(f64, f64); 2]) -> ChamberAir<Pair> {
        let states =
            chambers.map(|(pressure, temperature)| ChamberAir::state_of(&gas(), pressure, temperature, 1e-4));
        let both = |of: fn(&[f64; 2]) -> f64| Pair::of(|i| of(&states[i]));
        ChamberAir {
            mass: both(|state| state[0]),
            exner: both(|state| state[1]),
            pressure: Pair::of(|i| chambers[i].0),
            temperature: Pair::of(|i| chambers[i].1),
        }
    }

    fn flow(leakage: Leakage, p_1: f64, t_1: f64, p_2: f64, t_2: f64) -> f64 {
        leakage.flow(&gas(), &air([(p_1, t_1), (p_2, t_2)]))
    }

    #[test]
    fn laminar_leakage_is_linear_in_the_pressure_difference_and_odd() {
        let leakage = Leakage::Laminar { coefficient: 2e-9 };
        assert!((flow(leakage, 4e5, 294.0, 3e5, 294.0) - 2e-4).abs() < 1e-18);
        assert!((flow(leakage, 6e5, 310.0, 3e5, 280.0) - 6e-4).abs() < 1e-18);
        assert_eq!(flow(leakage, 3e5, 280.0, 6e5, 310.0), -flow(leakage, 6e5, 310.0, 3e5, 280.0));
    }

    /// By hand: F = pi 0.05 1e-5 = 1.570796e-6 m2; r = 0.6, sigma = sqrt(0.64/20) = 0.178885;
    /// sqrt(R T) = sqrt(286.76 294) = 290.3574; F sigma 5e5 / 290.3574 = 4.83874e-4 kg/s.
    #[test]
    fn the_gap_of_the_thesis_leaks_half_a_gram_a_second() {
        let got = flow(THESIS, 5e5, 294.0, 3e5, 350.0);
        assert!((got - 4.838_74e-4).abs() < 1e-9, "{got}");
    }

    #[test]
    fn adiabatic_leakage_takes_pressure_and_temperature_of_its_source() {
        let [cold, hot] = [294.0, 300.0];
        let (forth, back) = (flow(THESIS, 5e5, cold, 3e5, hot), flow(THESIS, 3e5, cold, 5e5, hot));
        assert!((back / forth + (cold / hot).sqrt()).abs() < 1e-14);
        assert_eq!(source(&air([(5e5, cold), (3e5, hot)])), 0);
        assert_eq!(source(&air([(3e5, cold), (5e5, hot)])), 1);
    }

    #[test]
    fn at_one_temperature_the_pressures_tell_the_leakage() {
        for leakage in [Leakage::None, Leakage::Laminar { coefficient: 2e-9 }, THESIS] {
            let by_pressures = leakage.at_pressures(&gas(), [5e5, 3e5], 294.0);
            assert_eq!(by_pressures, flow(leakage, 5e5, 294.0, 3e5, 294.0));
        }
    }

    #[test]
    fn exchanging_chambers_of_the_same_temperature_reverses_it() {
        for (p_1, p_2) in [(5e5, 3e5), (5e5, 1e5), (300_001.0, 3e5)] {
            assert_eq!(flow(THESIS, p_1, 294.0, p_2, 294.0), -flow(THESIS, p_2, 294.0, p_1, 294.0));
        }
    }

    #[test]
    fn nothing_leaks_at_equal_pressures_and_little_near_them() {
        assert_eq!(flow(THESIS, 4e5, 294.0, 4e5, 310.0), 0.0);
        for difference in [1e-9, -1e-9, 1e-3, -1e-3] {
            let got = flow(THESIS, 4e5 + difference, 294.0, 4e5, 294.0);
            assert!(got.abs() < 1e-7 && got * difference >= 0.0, "{difference}: {got}");
        }
        assert_eq!(flow(Leakage::None, 5e5, 294.0, 3e5, 294.0), 0.0);
    }

    #[test]
    fn the_dimensionless_flow_ends_at_the_root_of_1_over_the_resistance() {
        let full = PI * 0.05 * 1e-5 * 5e5 / (286.76_f64 * 294.0).sqrt();
        let sigma = |low: f64| flow(THESIS, 5e5, 294.0, low, 294.0) / full;
        assert!((sigma(0.0) - (1.0_f64 / 20.0).sqrt()).abs() < 1e-15);
        assert!(sigma(1e5) < sigma(1e3) && sigma(1e3) < sigma(0.0));
    }
}
