//! One-way flow controls at the ports of the cylinder: a throttle beside a check valve. By them people set the speeds of a cylinder.
//!
//! ```text
//! throttled:  mdot = C rho_0 P_u sqrt(T_0/T_u) g,   g = 1 for r <= b,  sqrt(1 - ((r - b)/(1 - b))^2) above     ISO 6358-1, m = 0.5
//! free:       P_d = P_u                                                                                        r = P_d/P_u
//! ```
//!
//! "meter-out" throttles the air that leaves a chamber, "meter-in" the air that charges it. Data sheets print C and b of the
//! controlled flow over the turns of the needle. The check valve opens at once and loses nothing, and it shuts tight. With
//! f = mdot/(C rho_0 P sqrt(T_0/T)) of the pressure P at the known end, the chamber:
//!
//! ```text
//! known upstream,   q = sqrt(1 - f^2):      r = b + (1 - b) q                       d ln r/d ln f = -(1 - b) f^2/(q r)
//! known downstream, u = 1/r:   (1 - 2b) u^2 + 2b u = 1 + (1 - b)^2 f^2              d ln u/d ln f = (1 - b)^2 f^2/(u ((1 - 2b) u + b))
//!   choked, f >= 1/b:          u = f                                                d ln u/d ln f = 1
//! ```
//!
//! In Exner pressures both exponents are scaled by (n-1)/n =: k. Known upstream, r falls with an infinite slope at choking; the
//! steepest fall s ([`super`]) is at the q of `((1 - b) (s + k)) q^2 + s b q = k (1 - b)`.

use super::{Ratio, STEEPEST, keys};
use crate::component::air::GasState;
use crate::component::gas::Gas;
use crate::component::valve::iso6358::{REFERENCE_DENSITY, REFERENCE_TEMPERATURE};
use crate::key::words;
use crate::values::Rig;

words! {
    /// One-way flow controls at the ports of the cylinder.
    pub enum FlowControlKind {
        /// There are none.
        None = "none",
        /// They throttle the air that leaves the chambers.
        MeterOut = "meter-out",
        /// They throttle the air that charges the chambers.
        MeterIn = "meter-in",
    }
}

/// The flow controls of both chambers.
#[derive(Clone, Copy, Debug)]
pub(super) struct FlowControls {
    gas: Gas,
    /// Whether the air that leaves is throttled.
    out: bool,
    /// C rho_0 sqrt(T_0) of chambers 1 and 2, kg sqrt(K)/(s Pa).
    choked: [f64; 2],
    /// b.
    critical_ratio: f64,
    /// f, and w behind over w in front, where the pressure behind falls as steeply as it may.
    steepest: (f64, f64),
}

impl FlowControls {
    /// Those of a rig.
    pub(super) fn of(rig: &Rig, gas: &Gas) -> Option<FlowControls> {
        let out = match rig.get(&keys::FLOW_CONTROL) {
            FlowControlKind::None => return None,
            kind => kind == FlowControlKind::MeterOut,
        };
        let conductances =
            [&keys::FLOW_CONTROL_1_CONDUCTANCE, &keys::FLOW_CONTROL_2_CONDUCTANCE].map(|key| rig.get(key));
        Some(FlowControls::new(*gas, out, conductances, rig.get(&keys::FLOW_CONTROL_CRITICAL_RATIO)))
    }

    /// By sonic conductances in m^3/(s Pa) and a critical ratio of at least 0 and below 1.
    pub(super) fn new(gas: Gas, out: bool, conductances: [f64; 2], critical_ratio: f64) -> FlowControls {
        let (b, k) = (critical_ratio, gas.exner_exponent());
        let (square, half) = ((1.0 - b) * (STEEPEST + k), 0.5 * STEEPEST * b);
        let q = k * (1.0 - b) / (half + (half * half + square * k * (1.0 - b)).sqrt());
        FlowControls {
            gas,
            out,
            choked: conductances.map(|c| c * REFERENCE_DENSITY * REFERENCE_TEMPERATURE.sqrt()),
            critical_ratio,
            steepest: ((1.0 - q * q).sqrt(), gas.exner_ratio(b + (1.0 - b) * q)),
        }
    }

    /// The same with both as that at place `i`.
    pub(super) fn of_place(&self, i: usize) -> FlowControls {
        FlowControls { choked: [self.choked[i]; 2], ..*self }
    }

    /// The same with the places exchanged.
    pub(super) fn exchanged(&self) -> FlowControls {
        FlowControls { choked: [self.choked[1], self.choked[0]], ..*self }
    }

    /// At place `i`, for a flow (kg/s) out of the chamber.
    pub(super) fn ratio(&self, i: usize, known: &GasState, flow: f64) -> Ratio {
        if flow == 0.0 || (flow > 0.0) != self.out {
            return Ratio { value: 1.0, elasticity: 0.0 };
        }
        let f = flow.abs() * known.temperature.sqrt() / (self.choked[i] * self.gas.pressure(known.exner));
        if flow > 0.0 { self.known_upstream(f) } else { self.known_downstream(f) }
    }

    fn known_upstream(&self, f: f64) -> Ratio {
        let (steepest, value) = self.steepest;
        if f >= steepest {
            return Ratio::beyond_choking(value, f / steepest - 1.0);
        }
        let (b, q) = (self.critical_ratio, (1.0 - f * f).sqrt());
        let r = b + (1.0 - b) * q;
        let elasticity = -self.gas.exner_exponent() * (1.0 - b) * f * f / (q * r);
        Ratio { value: self.gas.exner_ratio(r), elasticity }
    }

    fn known_downstream(&self, f: f64) -> Ratio {
        let (b, k) = (self.critical_ratio, self.gas.exner_exponent());
        if f * b >= 1.0 {
            return Ratio { value: self.gas.exner_ratio(f), elasticity: k };
        }
        let square = (1.0 - b) * f * (1.0 - b) * f;
        let root = (b * b + (1.0 - 2.0 * b) * (1.0 + square)).sqrt();
        let u = (1.0 + square) / (b + root);
        Ratio { value: self.gas.exner_ratio(u), elasticity: k * square / (u * root) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::valve::iso6358::Iso6358;

    const CHAMBER: f64 = 4e5;
    const TEMPERATURE: f64 = 310.0;

    fn gas() -> Gas {
        Gas::new(1.4, 286.76)
    }

    fn controls(out: bool, critical_ratio: f64) -> FlowControls {
        FlowControls::new(gas(), out, [2e-9, 5e-9], critical_ratio)
    }

    /// Pressure behind a control of place `i` for a flow out of the chamber, Pa.
    fn behind(controls: &FlowControls, i: usize, flow: f64) -> f64 {
        let known = GasState { exner: gas().exner(CHAMBER), temperature: TEMPERATURE };
        gas().pressure(controls.ratio(i, &known, flow).far_end(known.exner, flow).exner)
    }

    #[test]
    fn a_throttle_passes_what_iso_6358_says_between_the_pressures_at_its_ends() {
        for b in [0.0, 0.2, 0.5, 0.7] {
            for (i, c) in [2e-9, 5e-9].into_iter().enumerate() {
                let law = Iso6358 { sonic_conductance: c, critical_ratio: b, subsonic_index: 0.5 };
                for share in [1e-3, 0.1, 0.5, 0.9, 0.99] {
                    let choked = law.flow(&gas(), CHAMBER, TEMPERATURE, 0.0);
                    let out = share * choked;
                    let valve = behind(&controls(true, b), i, out);
                    let passed = law.flow(&gas(), CHAMBER, TEMPERATURE, valve);
                    assert!((passed / out - 1.0).abs() < 1e-8, "{b} {share}: {passed} {out}");
                    // In the other direction the chamber is downstream, choked from 1/b on.
                    let into = 4.0 * share * choked;
                    let valve = behind(&controls(false, b), i, -into);
                    let passed = law.flow(&gas(), valve, TEMPERATURE, CHAMBER);
                    assert!((passed / into - 1.0).abs() < 1e-8, "{b} {share}: {passed} {into}");
                }
            }
        }
    }

    #[test]
    fn the_free_way_loses_nothing() {
        assert!((behind(&controls(true, 0.3), 0, -1.0) / CHAMBER - 1.0).abs() < 1e-13);
        assert!((behind(&controls(false, 0.3), 0, 1.0) / CHAMBER - 1.0).abs() < 1e-13);
        assert!((behind(&controls(true, 0.3), 0, 0.0) / CHAMBER - 1.0).abs() < 1e-13);
    }

    #[test]
    fn slopes_are_those_of_the_pressure_and_it_falls_on_beyond_the_choked_flow() {
        let known = GasState { exner: gas().exner(CHAMBER), temperature: TEMPERATURE };
        for b in [0.0, 0.3, 0.5, 0.6] {
            for (out, sign) in [(true, 1.0), (false, -1.0)] {
                let controls = controls(out, b);
                let choked = controls.choked[0] * CHAMBER / TEMPERATURE.sqrt();
                let at = |flow: f64| controls.ratio(0, &known, flow).far_end(known.exner, flow);
                for share in [0.1, 0.8, 0.98, 1.01, 1.5, 3.0, 9.0] {
                    let (flow, d) = (sign * share * choked, 1e-7 * choked);
                    let slope = (at(flow + d).exner - at(flow - d).exner) / (2.0 * d);
                    let by_flow = at(flow).by_flow;
                    assert!((by_flow / slope - 1.0).abs() < 1e-4, "{out} {b} {share}: {by_flow} {slope}");
                    assert!(by_flow < 0.0 && at(flow).exner > 0.0);
                }
            }
        }
    }
}
