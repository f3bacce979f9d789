//! Which law the flow through a restriction follows, in the form that the network works with: a
//! squared mass flow is K / T_u psi(w_u, w_d).
//!
//! | law | psi | K |
//! |---|---|---|
//! | orifice | isentropic flow function ([`crate::component::gas`]) | (C_d A)^2 2n/((n-1)R) |
//! | Perry | the same times C_d(r)^2 ([`crate::component::valve::discharge`]) | A^2 2n/((n-1)R) |
//! | map | P_u^2 q(r)^2 ([`crate::component::valve::flow_map`]) | rho_0^2 T_0 |
//! | ISO 6358 | P_u^2 and a power of an ellipse ([`crate::component::valve::iso6358`]) | (C rho_0)^2 T_0 |

use crate::component::gas::{FlowFunction, Gas};
use crate::component::valve::discharge::{self, perry, perry_slope};
use crate::component::valve::flow_map::Slice;
use crate::component::valve::iso6358::Iso6358;
use crate::number::Number;
use crate::values::Rig;

/// A law of flow.
#[allow(clippy::large_enum_variant, reason = "laws are few, and handed on by reference")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FlowLaw {
    /// An orifice with a constant coefficient of discharge.
    Orifice,
    /// An orifice whose coefficient of discharge depends on the pressure ratio.
    Perry,
    /// A component known by its sonic conductance and critical ratio.
    Iso6358(Iso6358),
    /// A path with a measured map, the spool where it is: of nodes 1 and 2.
    Map([Slice; 2]),
}

impl FlowLaw {
    /// The laws of a rig's lands that have areas: to the supply and to the exhaust.
    #[must_use]
    pub fn of_areas(rig: &Rig) -> [FlowLaw; 2] {
        match rig.get(&discharge::keys::DISCHARGE_MODEL) {
            discharge::DischargeKind::Perry => [FlowLaw::Perry; 2],
            discharge::DischargeKind::Constant => [FlowLaw::Orifice; 2],
        }
    }

    /// psi from `upstream` to `downstream` (Exner pressures).
    #[must_use]
    pub fn psi(&self, gas: &Gas, upstream: f64, downstream: f64) -> f64 {
        self.flow_function(gas, upstream, downstream).value
    }

    /// The same with its slopes.
    #[inline(always)]
    pub(crate) fn flow_function<N: Number>(&self, gas: &Gas, upstream: N, downstream: N) -> FlowFunction<N> {
        match self {
            FlowLaw::Orifice => gas.flow_function(upstream, downstream),
            FlowLaw::Perry => one_by_one(upstream, downstream, |_, up, down| with_perry(gas, up, down)),
            FlowLaw::Iso6358(component) => {
                one_by_one(upstream, downstream, |_, up, down| component.flow_function(gas, up, down))
            }
            FlowLaw::Map(nodes) => {
                one_by_one(upstream, downstream, |i, up, down| nodes[i].flow_function(gas, up, down))
            }
        }
    }

    /// The law of node `i` alone.
    pub(crate) fn of_node(&self, i: usize) -> FlowLaw {
        match self {
            FlowLaw::Map(nodes) => FlowLaw::Map([nodes[i]; 2]),
            other => *other,
        }
    }
}

/// A flow function that has to ask how large its pressures are.
#[inline]
fn one_by_one<N: Number>(
    upstream: N,
    downstream: N,
    function: impl Fn(usize, f64, f64) -> FlowFunction,
) -> FlowFunction<N> {
    let mut slopes = [[0.0; 2]; 2];
    let value = N::of(|i| {
        let found = function(i, upstream.lane(i), downstream.lane(i));
        slopes[i] = [found.by_upstream, found.by_downstream];
        found.value
    });
    let [by_upstream, by_downstream] = [0, 1].map(|over| N::of(|i| slopes[i][over]));
    FlowFunction { value, by_upstream, by_downstream }
}

fn with_perry(gas: &Gas, upstream: f64, downstream: f64) -> FlowFunction {
    let psi = gas.flow_function(upstream, downstream);
    let ratio = gas.pressure(downstream) / gas.pressure(upstream);
    let discharge = perry(ratio);
    // dr/dw = +- r / (exponent w), and C_d^2 changes by 2 C_d dC_d.
    let by_ratio = 2.0 * discharge * perry_slope(ratio) * psi.value * ratio / gas.exner_exponent();
    let by_downstream = if ratio > 0.0 { by_ratio / downstream } else { 0.0 };
    let square = discharge * discharge;
    FlowFunction {
        value: square * psi.value,
        by_upstream: square * psi.by_upstream - by_ratio / upstream,
        by_downstream: square * psi.by_downstream + by_downstream,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_are_those_of_the_value_for_every_law() {
        let gas = Gas::new(1.4, 286.76);
        let iso = Iso6358 { sonic_conductance: 2e-8, critical_ratio: 0.3, subsonic_index: 0.5 };
        for law in [FlowLaw::Orifice, FlowLaw::Perry, FlowLaw::Iso6358(iso)] {
            let up = gas.exner(589e3);
            for ratio in [0.2, 0.45, 0.7, 0.95] {
                let (down, d) = (gas.exner(589e3 * ratio), 1e-6 * up);
                let f = law.flow_function(&gas, up, down);
                let at = |up, down| law.flow_function(&gas, up, down).value;
                let by_up = (at(up + d, down) - at(up - d, down)) / (2.0 * d);
                let by_down = (at(up, down + d) - at(up, down - d)) / (2.0 * d);
                let scale = f.value / up;
                assert!((f.by_upstream - by_up).abs() < 1e-6 * scale, "{law:?} {ratio}");
                assert!((f.by_downstream - by_down).abs() < 1e-6 * scale, "{law:?} {ratio}");
            }
        }
    }

    #[test]
    fn perry_passes_0_84_of_an_ideal_orifice_into_vacuum() {
        let gas = Gas::new(1.4, 286.76);
        let [ideal, perry] =
            [FlowLaw::Orifice, FlowLaw::Perry].map(|law| law.flow_function(&gas, 40.0, 1e-6).value.sqrt());
        assert!((perry / ideal - 0.8414).abs() < 1e-4);
    }
}
