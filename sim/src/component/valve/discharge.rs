//! Coefficient of discharge over the pressure ratio, for sharp edges (thesis L(17), "Perry's").
//!
//! ```text
//! C_d(r) = 0.8414 - 0.1002 r + 0.8415 r^2 - 3.9 r^3 + 4.6001 r^4 - 1.6827 r^5,   r = P_down/P_up
//! ```
//!
//! A jet of air narrows less behind a sharp edge the lower the pressure it goes to: C_d rises from
//! 0.60, that of a liquid, at r = 1 to 0.84 at r = 0, and goes on rising below the critical ratio.
//!
//! Data: J. A. Perry Jr., "Critical flow through sharp-edged orifices", Trans. ASME 71 (1949)
//! 757-764. The paper and its table were not at hand. The polynomial is what others cite as Perry's:
//! MapleSim's help prints it, with these digits and r downstream over upstream, for the "Use Perry's
//! flow coeff" of its pneumatic `Orifice`
//! (<https://maplesoft.com/support/help/maple/view.aspx?path=componentLibrary%2Fpneumatics%2Frestrictions%2FOrifice>);
//! a public MATLAB simulation of railway brakes (`fxNzleVcq.m`) has it as "Cq Perry". How well it fits
//! the table of 1949 is not confirmed.

use crate::key::{keys, words};

words! {
    /// How the coefficient of discharge depends on the pressure ratio.
    pub enum DischargeKind {
        /// Not at all.
        Constant = "constant",
        /// As Perry measured it.
        Perry = "perry",
    }
}

keys! {
    DISCHARGE_MODEL: DischargeKind = choice("valve.discharge_model", "L(17)", "How the coefficient of discharge depends on the pressure ratio.");
}

/// Of r^0 to r^5.
const PERRY: [f64; 6] = [0.8414, -0.1002, 0.8415, -3.9, 4.6001, -1.6827];

/// C_d at a ratio of the pressure downstream to that upstream; the ratio is limited to 0..1.
#[must_use]
pub fn perry(ratio: f64) -> f64 {
    let r = ratio.clamp(0.0, 1.0);
    PERRY.iter().rev().fold(0.0, |sum, coefficient| sum * r + coefficient)
}

/// dC_d/dr of [`perry`]; 0 outside of 0..1, where C_d is held.
#[must_use]
pub(crate) fn perry_slope(ratio: f64) -> f64 {
    if !(0.0..=1.0).contains(&ratio) {
        return 0.0;
    }
    let [_, a1, a2, a3, a4, a5] = PERRY;
    (((5.0 * a5 * ratio + 4.0 * a4) * ratio + 3.0 * a3) * ratio + 2.0 * a2) * ratio + a1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sharp_edge_passes_0_84_into_vacuum_and_0_60_like_a_liquid() {
        for (ratio, expected) in [(0.0, 0.8414), (0.5, 0.749_096_875), (1.0, 0.6001)] {
            assert!((perry(ratio) - expected).abs() < 1e-15, "{ratio}: {}", perry(ratio));
        }
    }

    #[test]
    fn it_falls_with_the_pressure_ratio_all_the_way() {
        for i in 0..=100 {
            assert!(perry_slope(f64::from(i) / 100.0) < 0.0, "{i}");
        }
    }

    #[test]
    fn the_slope_is_that_of_the_value() {
        for (ratio, expected) in [(0.0, -0.1002), (0.5, -0.409_493_75), (1.0, -0.1303)] {
            assert!((perry_slope(ratio) - expected).abs() < 1e-14, "{ratio}: {}", perry_slope(ratio));
        }
        for ratio in [0.1, 0.3, 0.528, 0.7, 0.95] {
            let central = (perry(ratio + 1e-6) - perry(ratio - 1e-6)) / 2e-6;
            assert!((perry_slope(ratio) - central).abs() < 1e-9, "{ratio}");
        }
    }

    #[test]
    fn it_is_held_outside_of_0_to_1() {
        assert_eq!((perry(-0.1), perry_slope(-0.1)), (perry(0.0), 0.0));
        assert_eq!((perry(1.1), perry_slope(1.1)), (perry(1.0), 0.0));
    }
}
