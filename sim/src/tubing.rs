//! The tubes from the supply to the valve and from the valve to the cylinder.
//!
//! Empirical model (6.61, reading R1 of EQUATIONS section 4; C(28), C(30)):
//!
//! ```text
//! P_out = P_in q^(mdot / mdot_ref),   q = 1 - K_dr
//! ```
//!
//! with a signed exponent, so that it holds for both directions. In Exner pressures the exponent is
//! scaled by (n-1)/n. The pressure at the far end depends on the flow and the flow on that
//! pressure: the network solves both at once, so that the thesis's oscillation of P1v, which came
//! from using the flow of the call before (7.2.1), cannot arise.

use crate::gas::Gas;

/// A tube between a known pressure and a valve port.
#[derive(Clone, Copy, Debug)]
pub struct Tube {
    /// d ln w / d mdot of a flow away from the known end, s/kg; 0 for no tube.
    decay: f64,
}

/// Exner pressure at the far end of a tube, and its slope over the flow.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FarEnd {
    pub exner: f64,
    pub by_flow: f64,
}

impl Tube {
    /// No tube: the same pressure at both ends.
    #[must_use]
    pub fn none() -> Tube {
        Tube { decay: 0.0 }
    }

    /// The regression line of the thesis: the pressure falls by the fraction `drop_slope` (below 1)
    /// at `reference_flow_kg_s`.
    #[must_use]
    pub fn empirical(gas: &Gas, drop_slope: f64, reference_flow_kg_s: f64) -> Tube {
        Tube { decay: gas.exner_exponent() * libm::log(1.0 - drop_slope) / reference_flow_kg_s }
    }

    /// The far end, for a flow (kg/s) from the known end at `exner` to the far end.
    pub(crate) fn far_end(&self, exner: f64, flow: f64) -> FarEnd {
        if self.decay == 0.0 {
            return FarEnd { exner, by_flow: 0.0 };
        }
        let exner = exner * libm::exp(self.decay * flow);
        FarEnd { exner, by_flow: self.decay * exner }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn at_the_reference_flow_the_pressure_falls_by_the_slope_and_rises_for_reverse_flow() {
        let gas = Gas::new(1.4, 286.76);
        let tube = Tube::empirical(&gas, 0.4, 0.00465);
        let pressure = |flow| gas.pressure(tube.far_end(gas.exner(589e3), flow).exner) / 589e3;
        assert!((pressure(0.00465) - 0.6).abs() < 1e-12);
        assert!((pressure(-0.00465) - 1.0 / 0.6).abs() < 1e-12);
        assert!((pressure(0.0093) - 0.36).abs() < 1e-12, "positive for every flow");
        assert!((pressure(0.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn no_tube_has_no_drop() {
        assert_eq!(Tube::none().far_end(40.0, 0.01).exner, 40.0);
    }
}
