//! A bracketed root of a scalar function.

/// The root of `f` between `a` and `b`, where `f` changes sign, to `tolerance` in the argument.
///
/// Chandrupatla's method (Advances in Engineering Software 28, 1997): bisection where the three
/// last points do not look like a monotone curve, else inverse quadratic interpolation. It cannot leave
/// the bracket and needs no derivative, which may be infinite at the root.
///
/// ```
/// use pneudrive_solver::bracketed_root;
///
/// let volume = |edge: f64| edge.powi(3) - 2.0;
/// let edge = bracketed_root(volume, [(0.0, -2.0), (2.0, 6.0)], 1e-14);
/// assert!((edge - 2.0_f64.cbrt()).abs() < 1e-14);
/// ```
pub fn bracketed_root(mut f: impl FnMut(f64) -> f64, bracket: [(f64, f64); 2], tolerance: f64) -> f64 {
    let [(mut b, mut fb), (mut a, mut fa)] = bracket;
    let (mut c, mut fc);
    let mut t = 0.5;
    for _ in 0..120 {
        let x = a + t * (b - a);
        let fx = f(x);
        if (fx > 0.0) == (fa > 0.0) {
            (c, fc) = (a, fa);
        } else {
            (c, fc, b, fb) = (b, fb, a, fa);
        }
        (a, fa) = (x, fx);
        let (best, f_best) = if fb.abs() < fa.abs() { (b, fb) } else { (a, fa) };
        let smallest = 2.0 * f64::EPSILON * best.abs() + 0.5 * tolerance;
        let t_least = smallest / (b - c).abs().max(f64::MIN_POSITIVE).max((b - a).abs());
        if t_least > 0.5 || f_best == 0.0 {
            return best;
        }
        // Not clamp(), which panics on NaN.
        t = interpolate(a, fa, b, fb, c, fc).unwrap_or(0.5).max(t_least).min(1.0 - t_least);
    }
    a
}

/// The place of the root between a and b by inverse quadratic interpolation, where that is safe.
#[inline]
fn interpolate(a: f64, fa: f64, b: f64, fb: f64, c: f64, fc: f64) -> Option<f64> {
    let xi = (a - b) / (c - b);
    let phi = (fa - fb) / (fc - fb);
    let monotone = phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi;
    monotone.then(|| fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn root(f: impl Fn(f64) -> f64, a: f64, b: f64) -> f64 {
        let bracket = [(a, f(a)), (b, f(b))];
        bracketed_root(f, bracket, 1e-15)
    }

    #[test]
    fn smooth_steep_and_flat_roots_are_found() {
        assert!((root(|x| x * x - 2.0, 0.0, 2.0) - 2.0_f64.sqrt()).abs() < 1e-14);
        assert!((root(|x| (x - 0.3).cbrt(), 0.0, 1.0) - 0.3).abs() < 1e-13);
        assert!((root(|x| (x - 0.7).powi(3), 0.0, 1.0) - 0.7).abs() < 1e-5);
        assert!(root(|x| x.signum() * x.abs().sqrt(), -1.0, 0.5).abs() < 1e-14);
    }

    #[test]
    fn either_order_of_the_bracket_will_do() {
        assert!((root(|x| 1.0 - x, 5.0, 0.0) - 1.0).abs() < 1e-14);
    }
}
