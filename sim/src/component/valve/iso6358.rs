//! Flow through a component known by its sonic conductance C, critical ratio b and subsonic index m (ISO 6358-1).
//!
//! ```text
//! mdot = C rho_0 P_u sqrt(T_0/T_u)                                  r <= b,   r = P_d/P_u
//! mdot = C rho_0 P_u sqrt(T_0/T_u) (1 - ((r - b)/(1 - b))^2)^m      r >  b    (m = 0.5: a quarter of an ellipse)
//! rho_0 = 1.185 kg/m^3, T_0 = 293.15 K: the standard reference atmosphere (100 kPa, 65 % humidity)
//! ```
//!
//! As [`crate::network`] wants it, over the Exner pressures w of [`crate::component::gas`]:
//!
//! ```text
//! mdot^2 = K/T_u psi(w_u, w_d),   K = (C rho_0)^2 T_0,   psi = P_u^2 g^(2m)
//! g = 1 for r <= b,   1 - ((r - b)/(1 - b))^2 above,     g' = -2 (r - b)/(1 - b)^2
//! dpsi/dw_u = P_u (2 G - r G') dP_u/dw_u,   dpsi/dw_d = P_u G' dP_d/dw_d,   G = g^(2m),   dP/dw = n/(n-1) P/w
//! ```
//!
//! psi and its slopes are continuous at r = b. For m other than 0.5 the slope of g^(2m) at r = 1 is infinite or 0, which leaves a
//! flow at rest without a unique pressure. From r = 0.999 on a parabola takes its place, with the same value and slope there and
//! 0 at r = 1; no data sheet says anything of so small a drop. An isentropic orifice of the same choked flow passes within 0.4 %
//! of the ellipse for b = 0.528.

use crate::component::gas::{FlowFunction, Gas};

/// rho_0, kg/m^3.
pub const REFERENCE_DENSITY: f64 = 1.185;
/// T_0, K.
pub const REFERENCE_TEMPERATURE: f64 = 293.15;
/// m of the ellipse.
const ELLIPSE: f64 = 0.5;
/// Pressure ratio from which on a parabola takes the place of other exponents.
const NEARLY_LEVEL: f64 = 0.999;

/// What ISO 6358 knows of a component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Iso6358 {
    /// C, m^3/(s Pa) at the reference atmosphere; 1 dm^3/(s bar) is 1e-8.
    pub sonic_conductance: f64,
    /// b, at least 0 and below 1.
    pub critical_ratio: f64,
    /// m, above 0 and below 1; 0.5 is the ellipse.
    pub subsonic_index: f64,
}

impl Iso6358 {
    /// Mass flow in kg/s, for an upstream pressure (Pa) and temperature (K) and a pressure downstream
    /// that is not higher.
    #[must_use]
    pub fn flow(&self, gas: &Gas, pressure_up: f64, temperature_up: f64, pressure_down: f64) -> f64 {
        let psi = self.flow_function(gas, gas.exner(pressure_up), gas.exner(pressure_down));
        (self.conductance() / temperature_up * psi.value).sqrt()
    }

    /// K: with the flow function over the upstream temperature it makes a squared mass flow.
    pub(crate) fn conductance(&self) -> f64 {
        let choked = self.sonic_conductance * REFERENCE_DENSITY;
        choked * choked * REFERENCE_TEMPERATURE
    }

    /// psi from `upstream` to `downstream`, Exner pressures of which the first is not the lower.
    pub(crate) fn flow_function(&self, gas: &Gas, upstream: f64, downstream: f64) -> FlowFunction {
        let up = gas.pressure(upstream);
        let by_exner = 1.0 / gas.exner_exponent();
        let down = gas.pressure(downstream);
        let ratio = down / up;
        if ratio <= self.critical_ratio {
            let value = up * up;
            return FlowFunction {
                value,
                by_upstream: 2.0 * by_exner * value / upstream,
                by_downstream: 0.0,
            };
        }
        let (g, slope) = self.share(ratio);
        FlowFunction {
            value: up * up * g,
            by_upstream: by_exner * up * up / upstream * (2.0 * g - ratio * slope),
            by_downstream: by_exner * up * down / downstream * slope,
        }
    }

    /// G at a pressure ratio above b: the square of the share of the choked flow, and its slope.
    fn share(&self, ratio: f64) -> (f64, f64) {
        if self.subsonic_index == ELLIPSE {
            return self.ellipse(ratio);
        }
        let power = |ratio| {
            let (g, slope) = self.ellipse(ratio);
            let raised = libm::pow(g, 2.0 * self.subsonic_index);
            (raised, 2.0 * self.subsonic_index * raised / g * slope)
        };
        if ratio <= NEARLY_LEVEL {
            return power(ratio);
        }
        let width = 1.0 - NEARLY_LEVEL;
        let (last, slope) = power(NEARLY_LEVEL);
        let (left, bend) = ((1.0 - ratio) / width, -slope * width / last - 1.0);
        (last * left * (1.0 - bend + bend * left), -last / width * (1.0 - bend + 2.0 * bend * left))
    }

    /// g and its slope.
    pub(crate) fn ellipse(&self, ratio: f64) -> (f64, f64) {
        let width = 1.0 - self.critical_ratio;
        let beyond = (ratio - self.critical_ratio) / width;
        // 1 - beyond^2, without the loss of digits at r = 1.
        ((1.0 - ratio) / width * (1.0 + beyond), -2.0 * beyond / width)
    }
}

/// r from which on the flow of an [`Opening`] goes to 0 in proportion.
pub(crate) const NEARLY_FULL: f64 = 0.999;

/// An opening between two vessels. Near r = 1 the ellipse of ISO 6358 has an infinite slope over r, so that two vessels would come to
/// the same pressure within a finite time and the flow would not be defined by what is missing:
///
/// ```text
/// phi(r) = phi_1 u (a + (1 - a) u),  u = (1 - r)/0.001         r > 0.999
/// ```
///
/// with the value phi_1 and the slope of the ellipse where they meet. Other programs do likewise (Simscape: linear from 0.999 or
/// 0.995 on).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Opening {
    /// C rho_0 sqrt(T_0), kg sqrt(K)/(s Pa).
    pub choked: f64,
    pub ellipse: Iso6358,
    /// phi_1 and a.
    pub nearly_full: [f64; 2],
}

impl Opening {
    /// From C (m^3/(s Pa)) and b.
    pub fn new(sonic_conductance: f64, critical_ratio: f64) -> Opening {
        let ellipse = Iso6358 { sonic_conductance, critical_ratio, subsonic_index: ELLIPSE };
        let (square, slope) = ellipse.ellipse(NEARLY_FULL);
        // phi = sqrt(square), and d ln phi/d ln u = 2 - a at u = 1.
        let per_u = -0.5 * slope / square * (1.0 - NEARLY_FULL);
        Opening {
            choked: sonic_conductance * REFERENCE_DENSITY * REFERENCE_TEMPERATURE.sqrt(),
            ellipse,
            nearly_full: [square.sqrt(), 2.0 - per_u],
        }
    }

    /// kg/s from air of a pressure (Pa) and a temperature (K) to a pressure that is not higher.
    pub fn flow(&self, (pressure_up, temperature_up): (f64, f64), pressure_down: f64) -> f64 {
        self.choked * pressure_up / temperature_up.sqrt() * self.share(pressure_down / pressure_up)
    }

    /// phi.
    pub fn share(&self, ratio: f64) -> f64 {
        if ratio <= self.ellipse.critical_ratio {
            return 1.0;
        }
        if ratio <= NEARLY_FULL {
            return self.ellipse.ellipse(ratio).0.sqrt();
        }
        let (u, [level, bend]) = ((1.0 - ratio) / (1.0 - NEARLY_FULL), self.nearly_full);
        level * u * (bend + (1.0 - bend) * u)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const VALVE: Iso6358 = Iso6358 { sonic_conductance: 2e-8, critical_ratio: 0.4, subsonic_index: 0.5 };

    fn gas() -> Gas {
        Gas::new(1.4, 286.76)
    }

    /// psi over pressures in Pa.
    fn psi(valve: &Iso6358, up: f64, down: f64) -> FlowFunction {
        valve.flow_function(&gas(), gas().exner(up), gas().exner(down))
    }

    /// By hand: 2e-8 1.185 7e5 = 16.59 g/s at T_0, and 1/sqrt(2) of it at twice T_0.
    #[test]
    fn a_choked_valve_of_2_litres_a_second_and_bar_passes_16_59_grams_a_second_at_7_bar() {
        for down in [0.0, 1e5, 2.8e5] {
            assert!((VALVE.flow(&gas(), 7e5, 293.15, down) - 16.59e-3).abs() < 1e-15);
        }
        let hot = VALVE.flow(&gas(), 7e5, 586.3, 1e5);
        assert!((hot - 11.730_9e-3).abs() < 1e-7, "{hot}");
    }

    /// b = 0.4, r = 0.7: half way, so sqrt(3)/2 of the choked flow.
    #[test]
    fn above_the_critical_ratio_the_flow_follows_an_ellipse() {
        let got = VALVE.flow(&gas(), 7e5, 293.15, 4.9e5);
        assert!((got / 16.59e-3 - 0.75_f64.sqrt()).abs() < 1e-12, "{got}");
        // r = 6.4/7: (r - b)/(1 - b) = 6/7, so sqrt(13)/7 of it.
        let flat = VALVE.flow(&gas(), 7e5, 293.15, 6.4e5);
        assert!((flat / 16.59e-3 - 13_f64.sqrt() / 7.0).abs() < 1e-12, "{flat}");
    }

    #[test]
    fn nothing_flows_at_equal_pressures() {
        assert_eq!(psi(&VALVE, 7e5, 7e5).value, 0.0);
    }

    #[test]
    fn value_and_slopes_are_continuous_at_the_critical_ratio() {
        let below = psi(&VALVE, 7e5, 2.8e5 * (1.0 - 1e-9));
        let above = psi(&VALVE, 7e5, 2.8e5 * (1.0 + 1e-9));
        let scale = below.value / gas().exner(7e5);
        assert!((below.value / above.value - 1.0).abs() < 1e-12);
        assert!((below.by_upstream - above.by_upstream).abs() < 1e-7 * scale);
        assert!((below.by_downstream - above.by_downstream).abs() < 1e-7 * scale);
        assert_eq!(below.by_downstream, 0.0);
    }

    #[test]
    fn slopes_are_those_of_the_value() {
        for (n, b, m) in
            [(1.4, 0.4, 0.5), (1.4, 0.0, 0.5), (1.3, 0.25, 0.5), (1.4, 0.32, 0.55), (1.4, 0.2, 0.42)]
        {
            let (gas, valve) =
                (Gas::new(n, 286.76), Iso6358 { critical_ratio: b, subsonic_index: m, ..VALVE });
            let up = gas.exner(589e3);
            for ratio in [0.1, 0.3, 0.5, 0.7, 0.95, 0.9985, 0.9993] {
                let (down, d) = (gas.exner(589e3 * ratio), 1e-6 * up);
                let at = |u: f64, v: f64| valve.flow_function(&gas, u, v).value;
                let f = valve.flow_function(&gas, up, down);
                let by_up = (at(up + d, down) - at(up - d, down)) / (2.0 * d);
                let by_down = (at(up, down + d) - at(up, down - d)) / (2.0 * d);
                let near = |slope: f64, difference: f64| {
                    (slope - difference).abs() < 1e-8 * f.value / up + 1e-6 * difference.abs()
                };
                assert!(near(f.by_upstream, by_up), "{n} {b} {m} {ratio}");
                assert!(near(f.by_downstream, by_down), "{n} {b} {m} {ratio}");
            }
        }
    }

    /// b = 0.4, r = 0.7: half way, so (3/4)^m of the choked flow.
    #[test]
    fn the_subsonic_index_bends_the_flow_above_the_critical_ratio() {
        for m in [0.4, 0.5, 0.6] {
            let valve = Iso6358 { subsonic_index: m, ..VALVE };
            let got = valve.flow(&gas(), 7e5, 293.15, 4.9e5) / 16.59e-3;
            assert!((got - 0.75_f64.powf(m)).abs() < 1e-12, "{m}: {got}");
            assert!((valve.flow(&gas(), 7e5, 293.15, 1e5) - 16.59e-3).abs() < 1e-15, "{m}");
        }
    }

    #[test]
    fn next_to_equal_pressures_the_flow_falls_to_0_without_a_jump_of_value_or_slope() {
        for m in [0.3, 0.42, 0.6, 0.8] {
            let valve = Iso6358 { subsonic_index: m, ..VALVE };
            let [before, after] = [-1e-9, 1e-9].map(|by| valve.share(NEARLY_LEVEL + by));
            assert!((before.0 / after.0 - 1.0).abs() < 1e-5, "{m}: {before:?} {after:?}");
            assert!((before.1 / after.1 - 1.0).abs() < 1e-5, "{m}: {before:?} {after:?}");
            assert_eq!(valve.share(1.0).0, 0.0);
            let ratios = (0..=1000).map(|i| valve.share(0.999 + 1e-6 * f64::from(i)));
            assert!(ratios.into_iter().all(|(g, slope)| g >= 0.0 && slope < 0.0), "{m}: it falls");
        }
    }

    #[test]
    fn with_b_of_0_528_it_is_an_isentropic_orifice_within_0_4_percent() {
        let ellipse = Iso6358 { critical_ratio: 0.528, ..VALVE };
        let isentropic = |ratio: f64| gas().flow_function(gas().exner(7e5), gas().exner(7e5 * ratio)).value;
        let mut largest = 0.0_f64;
        for i in 0..1000 {
            let ratio = f64::from(i) / 1000.0;
            let got = (psi(&ellipse, 7e5, 7e5 * ratio).value / 49e10).sqrt();
            let expected = (isentropic(ratio) / isentropic(0.0)).sqrt();
            largest = largest.max((got / expected - 1.0).abs());
        }
        assert!(largest < 4e-3 && largest > 1e-3, "{largest}");
    }
}
