//! Adiabatic flow with friction in a pipe (6.6.2; Appendix VIII with EQUATIONS section 4).
//!
//! ```text
//! M^2 (1 + (n-1)/2 M^2) = (mdot/(A P))^2 R T_0/n                           (VIII.3, VIII.14)
//! 4fL*/D = (1-M^2)/(n M^2) + (n+1)/(2n) ln[(n+1)M^2/(2+(n-1)M^2)]          (VIII.2)
//! P/P*   = (1/M) sqrt[(n+1)/(2+(n-1)M^2)]                                  (VIII.1)
//! 4fL*_far/D = 4fL*_known/D - 4fL/D   known end upstream                   (VIII.6)
//! 4fL*_far/D = 4fL*_known/D + 4fL/D   known end downstream                 (VIII.16)
//! ```
//!
//! The line is adiabatic, so that T_0, the stagnation temperature of the air, is the same all along it: that of
//! the place the air comes from (EQUATIONS section 12). The static temperature, which VIII.3 and VIII.14 have, is
//! T = T_0/(1 + (n-1)/2 M^2).
//!
//! In y = (n+1)M^2/(2+(n-1)M^2), the square of the speed over the critical speed, VIII.2 becomes
//! 4fL*/D = (n+1)/(2n) (1/y - 1 + ln y). With y at the known end and x = y/y_far - 1, VIII.6, VIII.16
//! and the pressure ratio VIII.10, VIII.18 are
//!
//! ```text
//! x - y ln(1+x) = -+ y a,   a = 2n/(n+1) 4fL/D
//! P_far/P = (1 + x - c y) / ((1 - c y) sqrt(1+x)),   c = (n-1)/(n+1)
//! d ln(P_far/P)/d ln mdot = x [(1+cy)(2+x-(1+c)y) - (1-cy)(1-y)] / ((1+cy)(1+x-cy)(1+x-y))
//! ```
//!
//! which hold without loss from no flow (y = 0, x = -+ y a) to M = 1 (y = 1, or 1 + x = y at the far
//! end). The slope over mdot is at the known end's pressure and T_0; it follows from
//! dx (1+x-y)/(1+x) = dy (ln(1+x) -+ a) and d ln y/d ln mdot = 2 (1-cy)/(1+cy).
//!
//! A known downstream end with M > 1 is choked: its pressure is raised until M = 1, so that the far
//! pressure is in proportion to the flow, with the slope that it has at M = 1.

use super::{Ratio, STEEPEST};
use crate::component::air::GasState;
use crate::component::gas::Gas;
use pneudrive_solver::bracketed_root;

/// 4fL/D below which the drop of a pipe is neglected.
pub(super) const MIN_SPAN: f64 = 1e-12;

/// Two reach rounding at any Mach number and length; one is to spare.
const MAX_ITERATIONS: u32 = 3;

/// A pipe and where it chokes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pipe {
    gas: Gas,
    /// a = 2n/(n+1) 4fL/D.
    friction: f64,
    /// R / (n A^2): makes T_0 m^2 / P^2 the F = M^2 (1 + (n-1)/2 M^2).
    mach: f64,
    /// c = (n-1)/(n+1).
    c: f64,
    /// Known upstream: F and Exner ratio where the far pressure falls as steeply as it may.
    steepest: (f64, f64),
}

impl Pipe {
    /// A pipe of a span 4fL/D above [`MIN_SPAN`].
    pub(super) fn new(gas: Gas, span: f64, diameter_m: f64) -> Pipe {
        let n = gas.heat_capacity_ratio;
        let area = core::f64::consts::FRAC_PI_4 * diameter_m * diameter_m;
        let mut pipe = Pipe {
            gas,
            friction: 2.0 * n / (n + 1.0) * span,
            mach: gas.gas_constant / (n * area * area),
            c: (n - 1.0) / (n + 1.0),
            steepest: (0.0, 0.0),
        };
        pipe.steepest = pipe.find_steepest();
        pipe
    }

    pub(super) fn ratio(&self, known: &GasState, flow: f64) -> Ratio {
        let flux = flow / self.gas.pressure(known.exner);
        let flux_squared = self.mach * known.temperature * flux * flux;
        if flow > 0.0 { self.known_upstream(flux_squared) } else { self.known_downstream(flux_squared) }
    }

    /// For F at the known end.
    fn known_upstream(&self, flux_squared: f64) -> Ratio {
        let (steepest, value) = self.steepest;
        if flux_squared >= steepest {
            return Ratio::beyond_choking(value, (flux_squared / steepest).sqrt() - 1.0);
        }
        let y = self.critical_speed(flux_squared);
        self.exner_ratio(y, shift(y, -self.friction))
    }

    fn known_downstream(&self, flux_squared: f64) -> Ratio {
        let sonic = 0.5 * (self.gas.heat_capacity_ratio + 1.0);
        if flux_squared <= sonic {
            let y = self.critical_speed(flux_squared);
            return self.exner_ratio(y, shift(y, self.friction));
        }
        let exponent = self.gas.exner_exponent();
        let at_sonic = self.exner_ratio(1.0, shift(1.0, self.friction)).value;
        let raised = libm::pow(flux_squared / sonic, 0.5 * exponent);
        Ratio { value: at_sonic * raised, elasticity: exponent }
    }

    /// y of F, by way of M^2.
    fn critical_speed(&self, flux_squared: f64) -> f64 {
        let n = self.gas.heat_capacity_ratio;
        let mach_squared = 2.0 * flux_squared / (1.0 + (1.0 + 2.0 * (n - 1.0) * flux_squared).sqrt());
        (n + 1.0) * mach_squared / (2.0 + (n - 1.0) * mach_squared)
    }

    /// P_far/P in Exner pressures, and its elasticity.
    fn exner_ratio(&self, y: f64, x: f64) -> Ratio {
        let (cy, r) = (self.c * y, 1.0 + x);
        let pressure = (r - cy) / ((1.0 - cy) * r.sqrt());
        let slope = (1.0 + cy) * (1.0 + r - y - cy) - (1.0 - cy) * (1.0 - y);
        let exponent = self.gas.exner_exponent();
        Ratio {
            value: libm::pow(pressure, exponent),
            elasticity: exponent * x * slope / ((1.0 + cy) * (r - cy) * (r - y)),
        }
    }

    /// By the Mach number at the far end: the nearer to 1, the steeper.
    fn find_steepest(&self) -> (f64, f64) {
        let at = |ln_z: f64| {
            // z = 1/y_far - 1.
            let y_far = 1.0 / (1.0 + libm::exp(ln_z));
            let back = 1.0 + shift(y_far, self.friction);
            let y = y_far / back;
            (y, self.exner_ratio(y, 1.0 / back - 1.0))
        };
        let excess = |ln_z| libm::log(-at(ln_z).1.elasticity / STEEPEST);
        let (near, far) = (libm::log(1e-12), libm::log(1.0 + self.friction));
        let ln_z = bracketed_root(excess, [(near, excess(near)), (far, excess(far))], 1e-9);
        let (y, ratio) = at(ln_z);
        let n = self.gas.heat_capacity_ratio;
        let mach_squared = 2.0 * y / (n + 1.0 - (n - 1.0) * y);
        (mach_squared * (1.0 + 0.5 * (n - 1.0) * mach_squared), ratio.value)
    }
}

/// x of x - y ln(1+x) = y a: how far 1/y is from here, relatively, where 4fL*/D differs by that of a.
///
/// With v = (1+x)/y it is v - 1 - ln v = X: Lambert's W by the iteration of Fritsch, Shafer and
/// Crowley (Communications of the ACM 16, 1973), of fourth order for one logarithm each. It starts at
/// the lower of two upper bounds: v - 1 = sqrt(2X) + X, high by at most 16 %, and the tangent at x = 0,
/// which is exact where the flow is small.
fn shift(y: f64, a: f64) -> f64 {
    let to_critical = 1.0 - y + y * libm::log(y.max(f64::MIN_POSITIVE));
    let scaled = (to_critical + y * a).max(0.0);
    let guess = y - 1.0 + (2.0 * y * scaled).sqrt() + scaled;
    let mut x = guess.min(y * a / (1.0 - y));
    for _ in 0..MAX_ITERATIONS {
        let from_critical = 1.0 + x - y;
        if from_critical <= 0.0 {
            return y - 1.0;
        }
        let f = x - y * libm::log1p(x) - y * a;
        let square = 2.0 * from_critical * (from_critical - 2.0 / 3.0 * f);
        let step = (1.0 + x) * f / from_critical * (square - f * y) / (square - 2.0 * f * y);
        x -= step;
        if step.abs() <= 1e-4 * from_critical {
            break;
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From no flow to M = 1 at either end, and from a joint to a capillary: the equation is met to
    /// rounding.
    #[test]
    fn the_shift_solves_its_equation_in_few_iterations() {
        for i in 0..=1000 {
            let y = 1.0 - libm::pow(10.0, -0.012 * f64::from(i));
            for y in [y, 1.0 - y] {
                let to_critical = 1.0 / y - 1.0 + libm::log(y);
                for exponent in -12..=8 {
                    let a = libm::pow(10.0, f64::from(exponent));
                    for a in [a, -a] {
                        if a + to_critical <= 1e-9 {
                            continue;
                        }
                        let x = shift(y, a);
                        let residual = x - y * libm::log1p(x) - y * a;
                        let scale = x.abs() + y * (libm::log1p(x).abs() + a.abs());
                        assert!(residual.abs() <= 8.0 * f64::EPSILON * scale, "{y} {a}: {x}, {residual}");
                        assert!(x >= y - 1.0 && x * a >= 0.0, "{y} {a}: {x}");
                    }
                }
            }
        }
    }
}
