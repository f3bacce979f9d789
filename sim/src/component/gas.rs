//! The ideal gas, and its isentropic flow through a restriction.
//!
//! Pressure is carried as the Exner pressure `w = P^((n-1)/n)`: along an isentrope w is proportional
//! to the temperature, and the flow function of the thesis (V.9) loses its powers:
//!
//! ```text
//! (mdot / (Cd A))^2 = 2 n / ((n-1) R T_u) * w_u w_d^e (w_u - w_d),   e = 2/(n-1)
//! choked: w_d -> w_u e/(e+1)                                        (V.10, r_crit = 0.5283 for n = 1.4)
//! ```
//!
//! For air (n = 1.4) e is 5 and P = w^3.5, so that no power function is called. Any other ratio of
//! heat capacities costs one power a restriction.

use crate::key::keys;
use crate::number::Number;
use crate::values::Rig;

keys! {
    HEAT_CAPACITY_RATIO: f64 = number("gas.heat_capacity_ratio", 1.4, 1.01, 1.9, "C(1)", "Ratio of the heat capacities at constant pressure and volume.");
    GAS_CONSTANT_J_PER_KG_K: f64 = number("gas.gas_constant_j_per_kg_k", 286.76, 10.0, 10_000.0, "C(2)", "Specific gas constant.");
}

impl Gas {
    /// The gas of a rig.
    #[must_use]
    pub fn of(rig: &Rig) -> Gas {
        Gas::new(rig.get(&keys::HEAT_CAPACITY_RATIO), rig.get(&keys::GAS_CONSTANT_J_PER_KG_K))
    }
}

/// Ratio of heat capacities and gas constant, with what follows from them.
#[derive(Clone, Copy, Debug)]
pub struct Gas {
    /// n, ratio of heat capacities (thesis C(1)).
    pub heat_capacity_ratio: f64,
    /// R, J/(kg K) (thesis C(2)).
    pub gas_constant: f64,
    /// (n-1)/n.
    exner_exponent: f64,
    /// e = 2/(n-1).
    flow_exponent: f64,
    /// e/(e+1): w downstream over w upstream where the flow chokes.
    sonic_part: f64,
    /// Whether n = 1.4, where all powers are whole or halves.
    diatomic: bool,
}

/// w_u w_d^e (w_u - w_d) and its slopes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FlowFunction<N = f64> {
    pub value: N,
    pub by_upstream: N,
    pub by_downstream: N,
}

impl Gas {
    /// A gas with a ratio of heat capacities above 1 and a gas constant in J/(kg K).
    #[must_use]
    pub fn new(heat_capacity_ratio: f64, gas_constant: f64) -> Gas {
        let flow_exponent = 2.0 / (heat_capacity_ratio - 1.0);
        Gas {
            heat_capacity_ratio,
            gas_constant,
            exner_exponent: (heat_capacity_ratio - 1.0) / heat_capacity_ratio,
            flow_exponent,
            sonic_part: flow_exponent / (flow_exponent + 1.0),
            diatomic: heat_capacity_ratio == 1.4,
        }
    }

    /// w = P^((n-1)/n) of a pressure in Pa.
    #[must_use]
    pub fn exner(&self, pressure_pa: f64) -> f64 {
        libm::pow(pressure_pa, self.exner_exponent)
    }

    /// w over another w where P is `ratio` of the other P. Ratios are near 1: for air y^7 = r^2 by three steps of
    /// Halley's method,
    ///
    /// ```text
    /// y -> y (3 y^7 + 4 r^2) / (4 y^7 + 3 r^2)
    /// ```
    ///
    /// to the last digits for ratios from 0.25 to 2, and by the library beyond.
    #[inline(always)]
    pub(crate) fn exner_ratio<N: Number>(&self, ratio: N) -> N {
        let (three, four) = (N::from(3.0), N::from(4.0));
        let near = N::all(ratio.at_least(N::from(0.25))) && N::all(N::from(2.0).at_least(ratio));
        if !(self.diatomic && near) {
            return N::of(|i| libm::pow(ratio.lane(i), self.exner_exponent));
        }
        let (square, beyond) = (ratio * ratio, ratio - N::from(1.0));
        let mut y = N::from(1.0) + beyond * (N::from(2.0 / 7.0) - beyond * N::from(5.0 / 49.0));
        for _ in 0..3 {
            let y2 = y * y;
            let y7 = y2 * y2 * (y2 * y);
            y = y * ((three * y7 + four * square) / (four * y7 + three * square));
        }
        y
    }

    /// P in Pa of an Exner pressure.
    #[must_use]
    #[inline]
    pub fn pressure(&self, exner: f64) -> f64 {
        self.pressure_of(exner)
    }

    /// The same of two.
    #[inline(always)]
    pub(crate) fn pressure_of<N: Number>(&self, exner: N) -> N {
        if self.diatomic {
            exner * exner * exner * exner.root()
        } else {
            N::of(|i| libm::pow(exner.lane(i), 1.0 / self.exner_exponent))
        }
    }

    /// P' in Pa/s of an Exner pressure and its rate: P'/P = n/(n-1) w'/w.
    pub(crate) fn pressure_rate(&self, exner: f64, rate: f64) -> f64 {
        self.pressure(exner) * rate / (self.exner_exponent * exner)
    }

    /// (n-1)/n: the slope of ln w over ln P.
    pub(crate) fn exner_exponent(&self) -> f64 {
        self.exner_exponent
    }

    /// 2 n / ((n-1) R): with (Cd A)^2 over the upstream temperature it makes the flow function a
    /// squared mass flow.
    pub(crate) fn flow_constant(&self) -> f64 {
        2.0 * self.heat_capacity_ratio / ((self.heat_capacity_ratio - 1.0) * self.gas_constant)
    }

    /// Whether n = 1.4, as air has it: then no power function is called.
    pub(crate) fn is_diatomic(&self) -> bool {
        self.diatomic
    }

    /// The flow function from `upstream` to `downstream`, choked where it must be: at e/(e+1) of the upstream
    /// w the slope over the downstream one is zero, so that the other two go on as they are.
    #[inline(always)]
    pub(crate) fn flow_function<N: Number>(&self, upstream: N, downstream: N) -> FlowFunction<N> {
        if self.diatomic {
            return self.flow_function_of_air(upstream, downstream);
        }
        self.flow_function_by(upstream, downstream, |exner| {
            let power = N::of(|i| libm::pow(exner.lane(i), self.flow_exponent));
            [power / exner, power]
        })
    }

    /// The same for a gas that is diatomic.
    #[inline(always)]
    pub(crate) fn flow_function_of_air<N: Number>(&self, upstream: N, downstream: N) -> FlowFunction<N> {
        self.flow_function_by(upstream, downstream, |exner| {
            let square = exner * exner;
            let fourth = square * square;
            [fourth, fourth * exner]
        })
    }

    /// The same times `factor`, which comes late.
    #[inline(always)]
    pub(crate) fn flow_function_of_air_times<N: Number>(
        &self,
        factor: N,
        upstream: N,
        downstream: N,
    ) -> FlowFunction<N> {
        let sonic = upstream * N::from(self.sonic_part);
        let throat = downstream.larger(sonic);
        let (square, drop) = (throat * throat, upstream - throat);
        let fourth = square * square;
        let by_downstream = factor * (fourth * (upstream * (N::from(self.flow_exponent) * drop - throat)));
        FlowFunction {
            value: factor * (fourth * (throat * (upstream * drop))),
            by_upstream: factor * (fourth * (throat * (upstream + drop))),
            by_downstream: N::choose(downstream.above(sonic), by_downstream, N::from(0.0)),
        }
    }

    /// The same with w^(e-1) and w^e by `powers`.
    #[inline(always)]
    fn flow_function_by<N: Number>(
        &self,
        upstream: N,
        downstream: N,
        powers: impl Fn(N) -> [N; 2],
    ) -> FlowFunction<N> {
        let (e, sonic) = (N::from(self.flow_exponent), upstream * N::from(self.sonic_part));
        let throat = downstream.larger(sonic);
        let [lower, power] = powers(throat);
        let drop = upstream - throat;
        let by_downstream = upstream * lower * (e * drop - throat);
        FlowFunction {
            value: upstream * power * drop,
            by_upstream: power * (upstream + drop),
            by_downstream: N::choose(downstream.above(sonic), by_downstream, N::from(0.0)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mass flow through an orifice from stagnation, thesis V.9 and V.11 as derived (EQUATIONS 1).
    fn textbook_flow(area: f64, p_up: f64, t_up: f64, p_down: f64, n: f64, r: f64) -> f64 {
        let critical = (2.0 / (n + 1.0)).powf(n / (n - 1.0));
        let ratio = (p_down / p_up).max(critical);
        area * p_up / t_up.sqrt()
            * (n / r).sqrt()
            * ratio.powf(1.0 / n)
            * (2.0 / (n - 1.0) * (1.0 - ratio.powf((n - 1.0) / n))).sqrt()
    }

    fn flow(gas: &Gas, area: f64, p_up: f64, t_up: f64, p_down: f64) -> f64 {
        let function = gas.flow_function(gas.exner(p_up), gas.exner(p_down));
        (area * area * gas.flow_constant() / t_up * function.value).sqrt()
    }

    #[test]
    fn exner_and_pressure_are_inverse() {
        for n in [1.4, 1.3, 1.667] {
            let gas = Gas::new(n, 286.76);
            for pressure in [1e4, 101_300.0, 589_000.0, 2e6] {
                let back = gas.pressure(gas.exner(pressure));
                assert!((back / pressure - 1.0).abs() < 1e-13, "{n} {pressure} {back}");
            }
        }
    }

    #[test]
    fn a_ratio_of_exner_pressures_is_the_power_of_that_of_pressures() {
        for n in [1.4, 1.3] {
            let gas = Gas::new(n, 286.76);
            for i in 1..100 {
                let ratio = 0.04 * f64::from(i);
                let expected = libm::pow(ratio, (n - 1.0) / n);
                let off = gas.exner_ratio(ratio) / expected - 1.0;
                assert!(off.abs() < 1e-15, "{n} {ratio}: {off:e}");
            }
        }
    }

    #[test]
    fn the_rate_of_the_pressure_is_the_slope_of_the_pressure() {
        for n in [1.4, 1.3] {
            let gas = Gas::new(n, 286.76);
            let at = |t: f64| gas.pressure(gas.exner(4e5) + 2.0 * t);
            let slope = (at(1e-5) - at(-1e-5)) / 2e-5;
            let rate = gas.pressure_rate(gas.exner(4e5), 2.0);
            assert!((rate / slope - 1.0).abs() < 1e-8, "{rate} {slope}");
        }
    }

    #[test]
    fn the_flow_function_is_that_of_the_textbook_choked_and_unchoked() {
        for n in [1.4, 1.3, 1.667] {
            let gas = Gas::new(n, 286.76);
            for ratio in [0.1, 0.5, 0.5282, 0.5283, 0.6, 0.9, 0.999, 1.0] {
                let (got, expected) = (
                    flow(&gas, 8e-6, 589e3, 294.0, 589e3 * ratio),
                    textbook_flow(8e-6, 589e3, 294.0, 589e3 * ratio, n, 286.76),
                );
                assert!((got - expected).abs() < 1e-12 * expected + 1e-12, "{n} {ratio}: {got} {expected}");
            }
        }
    }

    /// EQUATIONS section 1: 3.3 mm, 589 kPa, 294 K, Cd = 1 gives 11.880 g/s.
    #[test]
    fn a_choked_port_of_the_thesis_passes_11_88_grams_a_second() {
        let area = std::f64::consts::PI / 4.0 * 0.0033 * 0.0033;
        let got = flow(&Gas::new(1.4, 286.76), area, 589e3, 294.0, 101.3e3);
        assert!((got - 11.880e-3).abs() < 5e-7, "{got}");
    }

    #[test]
    fn flow_stops_growing_at_the_critical_pressure_ratio_of_0_5283() {
        let gas = Gas::new(1.4, 286.76);
        let at = |ratio: f64| flow(&gas, 1e-5, 1e5, 294.0, ratio * 1e5);
        assert_eq!(at(0.52), at(0.3));
        assert_eq!(at(0.52828), at(0.1));
        assert!(at(0.5284) < at(0.5282));
        let critical = gas.pressure(gas.exner(1.0) * 5.0 / 6.0);
        assert!((critical - 0.528_281_787_717_174).abs() < 1e-14);
    }

    #[test]
    fn slopes_are_those_of_the_value() {
        for n in [1.4, 1.3] {
            let gas = Gas::new(n, 286.76);
            let up = gas.exner(589e3);
            for ratio in [0.2, 0.5, 0.7, 0.95] {
                let (down, d) = (gas.exner(589e3 * ratio), 1e-6 * up);
                let f = gas.flow_function(up, down);
                let central = |a: f64, b: f64| (a - b) / (2.0 * d);
                let by_up =
                    central(gas.flow_function(up + d, down).value, gas.flow_function(up - d, down).value);
                let by_down =
                    central(gas.flow_function(up, down + d).value, gas.flow_function(up, down - d).value);
                let scale = f.value / up;
                assert!((f.by_upstream - by_up).abs() < 1e-6 * scale, "{n} {ratio}");
                assert!((f.by_downstream - by_down).abs() < 1e-6 * scale, "{n} {ratio}");
            }
        }
    }
}
