//! A sharp restriction in place of a tube (multiple flow node, 6.55 to 6.60).
//!
//! ```text
//! m|m| = K/T psi(w_up, w_down),   K = 2n/((n-1)R) (Cd A)^2,   psi = w_u w_d^e (w_u - w_d)
//! ```
//!
//! with psi and e of [`crate::component::gas`]. With w at the known end and b = m^2 T / (K w^(e+2)):
//!
//! ```text
//! known upstream,    r = w_far/w:  r^e (1 - r) = b       d ln r/d ln m = -2 (1-r)/((e+1) r - e)
//! known downstream:                r (r - 1) = b         d ln r/d ln m =  2 (r-1)/(2r-1)
//!   choked, r > (e+1)/e:           r^(e+2) = b/b*        d ln r/d ln m =  2/(e+2)
//! ```
//!
//! b* = psi(1, 0), the greatest. Known upstream the steepest fall is at
//! r_s = (2 + s e)/(2 + s (e+1)).

use super::{Ratio, STEEPEST};
use crate::component::air::GasState;
use crate::component::gas::Gas;

/// Four reach rounding at any flow; one is to spare.
const MAX_ITERATIONS: u32 = 5;

/// A restriction and where it chokes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Connector {
    gas: Gas,
    /// e = 2/(n-1).
    e: f64,
    /// 1/(K b*): makes m^2 T / w^(e+2) a squared fraction of the choking flow.
    per_choking: f64,
    /// b*.
    most: f64,
    /// Known upstream: b/b* and r where the far pressure falls as steeply as it may.
    steepest: (f64, f64),
}

impl Connector {
    pub(super) fn new(gas: Gas, discharge: f64, diameter_m: f64) -> Connector {
        let e = 2.0 / (gas.heat_capacity_ratio - 1.0);
        let area = discharge * core::f64::consts::FRAC_PI_4 * diameter_m * diameter_m;
        let most = gas.flow_function(1.0, 0.0).value;
        let r = (2.0 + STEEPEST * e) / (2.0 + STEEPEST * (e + 1.0));
        Connector {
            gas,
            e,
            per_choking: 1.0 / (gas.flow_constant() * area * area),
            most,
            steepest: (gas.flow_function(1.0, r).value / most, r),
        }
    }

    pub(super) fn ratio(&self, known: &GasState, flow: f64) -> Ratio {
        // psi(w, 0) = b* w^(e+2).
        let choking = self.gas.flow_function(known.exner, 0.0).value;
        let fraction = self.per_choking * known.temperature * flow * flow / choking;
        if flow > 0.0 { self.known_upstream(fraction) } else { self.known_downstream(fraction) }
    }

    /// `fraction` is b/b*.
    fn known_upstream(&self, fraction: f64) -> Ratio {
        let (steepest, value) = self.steepest;
        if fraction >= steepest {
            return Ratio::beyond_choking(value, (fraction / steepest).sqrt() - 1.0);
        }
        let e = self.e;
        let b = fraction * self.most;
        // Exact at rest and at choking.
        let mut r = (e + (1.0 - fraction).sqrt()) / (e + 1.0);
        let mut slope = -1.0;
        for _ in 0..MAX_ITERATIONS {
            let psi = self.gas.flow_function(1.0, r);
            slope = psi.by_downstream;
            let step = (psi.value - b) / slope;
            r -= step;
            if step.abs() < 1e-11 {
                break;
            }
        }
        Ratio { value: r, elasticity: 2.0 * b / (r * slope) }
    }

    fn known_downstream(&self, fraction: f64) -> Ratio {
        let e = self.e;
        let b = fraction * self.most;
        let root = (1.0 + 4.0 * b).sqrt();
        let r = 0.5 * (1.0 + root);
        if e * r <= e + 1.0 {
            return Ratio { value: r, elasticity: 4.0 * b / (root + root * root) };
        }
        Ratio { value: libm::pow(fraction, 1.0 / (e + 2.0)), elasticity: 2.0 / (e + 2.0) }
    }
}
