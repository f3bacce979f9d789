//! The size of the next step.
//!
//! ```text
//! h_new/h = 0.9 err^(-1/p)                                          from one step
//! h_new/h = 0.9 err^(-1/p) (h/h_before) (err_before/err)^(1/p)      from two: the error continues its trend
//! h_new/h = 0.955 err^(-3/4p) err_before^(3/8p)                     from two: the error returns to its mean
//! ```
//!
//! The shorter of the first two is taken (predictive controller: Gustafsson, ACM Transactions on Mathematical Software 20,
//! 1994), so that steps shrink in time where the solution gets rougher. After a rejected step the next one is no longer
//! than the one that was accepted.
//!
//! Errors that go up and down from step to step have no trend: those of an oscillation in a few steps a period, and of
//! steps that stability ends. Once a step of a stretch was rejected against its trend, the third counts as well (PI
//! controller: Gustafsson, ACM Transactions on Mathematical Software 17, 1991; Hairer and Wanner, Solving Ordinary Differential
//! Equations II, IV.2). It holds steps at the bound of stability with next to no rejections. Where a system says that it oscillates,
//! steps are many a period, and their errors do have a trend.

/// A step cut short whose error over the allowed one is less says nothing of the size for the allowed one.
pub(crate) const NEXT_TO_NONE: f64 = 1e-6;

/// An error over the allowed one that is less counts as this in a trend.
const LITTLE: f64 = 1e-2;

/// The last accepted step of this stretch: its size, and err^(1/p) of its error over the allowed one.
#[derive(Clone, Copy, Debug)]
struct Before {
    h: f64,
    root: f64,
}

/// The step-size control of a smooth stretch.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct StepControl {
    before: Option<Before>,
    rejected: bool,
    /// Whether a trial of this stretch was rejected against its trend, or left no number.
    overshot: bool,
}

impl StepControl {
    /// The step that an error over the allowed one, of a trial of size `h`, asks for, over h. The error goes
    /// with this power of the step. A step that is good enough is taken into account.
    #[inline]
    pub fn factor(&mut self, h: f64, error: f64, order: f64) -> f64 {
        let root = root_of(error.max(1e-10), order);
        let good = error <= 1.0;
        let plain = 0.9 / root;
        let predicted = match self.before {
            Some(before) if good => {
                let trend = plain * h / before.h * before.root / root;
                if self.overshot { trend.min(damped(root, before.root)) } else { trend }
            }
            _ => plain,
        };
        let max_growth = if self.rejected { 1.0 } else { 5.0 };
        if good {
            let at_least = if error < LITTLE { root_of(LITTLE, order) } else { root };
            *self = StepControl { before: Some(Before { h, root: at_least }), rejected: false, ..*self };
        }
        plain.min(predicted).clamp(0.2, max_growth)
    }

    /// A step was too long, of a system that oscillates or does not.
    #[inline]
    pub fn reject(&mut self, oscillates: bool) {
        self.rejected = true;
        self.overshot |= self.before.is_some() && !oscillates;
    }
}

/// 0.955 root^(-3/4) before^(3/8).
#[inline(never)]
fn damped(root: f64, before: f64) -> f64 {
    let [half, half_before] = [root, before].map(f64::sqrt);
    let quarter_before = half_before.sqrt();
    0.955 / (half * half.sqrt()) * quarter_before * quarter_before.sqrt()
}

/// The largest size of a step that suits the method for short steps, by the errors of such steps, or of long ones if
/// there were none.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShortSteps {
    /// s.
    largest: f64,
    /// A long step with less error, over the allowed one, might have been a short one.
    hint: f64,
    /// The value of `hint` as long as no short step fails.
    most: f64,
}

impl ShortSteps {
    /// No step is short.
    pub const NEVER: ShortSteps = ShortSteps { largest: 0.0, hint: -1.0, most: -1.0 };

    /// For steps with this relative error: of a solution that changes within a time T, a step h of order 5 has an error of
    /// (h/T)^5, and of order 3 one of (h/T)^3.
    pub fn new(tolerance: f64) -> ShortSteps {
        let most = 0.5 * root_of(tolerance * tolerance, 3.0);
        ShortSteps { largest: 0.0, hint: most, most }
    }

    /// Whether a step of `h` is to be a short one.
    #[inline]
    pub fn fits(&self, h: f64) -> bool {
        h <= self.largest
    }

    /// A long step of `h` had this error over the allowed one.
    #[inline]
    pub fn note_long(&mut self, h: f64, error: f64) {
        if error <= self.hint {
            self.largest = self.largest.max(h);
        }
    }

    /// A short step of `h` had this error over the allowed one; whether it is good enough.
    #[inline]
    pub fn note(&mut self, h: f64, error: f64) -> bool {
        let good = error <= 1.0;
        self.largest = if error.is_finite() { h * 0.9 / root_of(error.max(1e-3), 3.0) } else { 0.0 };
        self.hint = if good { (1.1 * self.hint).min(self.most) } else { 0.3 * self.hint };
        good
    }
}

/// The root of this order (a whole number) of x > 0, to a thousandth: a step's size needs no more.
///
/// A part of the exponent, and two of Newton's steps on y^n = x.
#[inline]
fn root_of(x: f64, order: f64) -> f64 {
    const ONE: u64 = 1.0_f64.to_bits();
    let n = order as u64;
    let mut y = f64::from_bits(ONE - ONE / n + x.to_bits() / n);
    for _ in 0..2 {
        let power = (1..n).fold(1.0, |power, _| power * y);
        y += (x / power - y) / order;
    }
    y
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rejections of `steps` steps from `h` on, with an error that goes with h.
    fn rejections(mut h: f64, steps: u32, error_of: impl Fn(f64) -> f64) -> u32 {
        let (mut control, mut accepted, mut rejected) = (StepControl::default(), 0, 0);
        while accepted < steps {
            let error = error_of(h);
            h *= control.factor(h, error, 5.0);
            if error <= 1.0 {
                accepted += 1;
            } else {
                control.reject(false);
                rejected += 1;
            }
        }
        rejected
    }

    #[test]
    fn an_error_that_goes_with_its_power_is_met_by_the_next_trial() {
        for size in [1.5, 100.0, 1500.0] {
            assert_eq!(rejections(1.0, 50, |h| size * h.powi(5)), 1, "{size}");
        }
    }

    #[test]
    fn roots_are_right_to_a_thousandth() {
        for order in [4.0, 5.0] {
            for exponent in -40..120 {
                let x = 10_f64.powf(0.25 * f64::from(exponent));
                let (got, expected) = (root_of(x, order), x.powf(1.0 / order));
                assert!((got / expected - 1.0).abs() < 1e-3, "{x} {order}: {got} {expected}");
            }
        }
    }
}
