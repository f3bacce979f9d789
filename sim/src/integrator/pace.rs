//! How long the next step should be.
//!
//! ```text
//! h_new/h = 0.9 err^(-1/p)                                          from one step
//! h_new/h = 0.9 err^(-1/p) (h/h_before) (err_before/err)^(1/p)      from two: what comes changes as what came
//! ```
//!
//! The shorter of the two (Gustafsson, ACM Transactions on Mathematical Software 20, 1994): a stretch that
//! gets rougher from step to step is not met with steps that are too long for it. After a rejected step
//! the next one is no longer than the one that was accepted.

/// The last accepted step of this stretch: its size and its error over the allowed one.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pace {
    before: Option<(f64, f64)>,
    rejected: bool,
}

impl Pace {
    /// The step that an error over the allowed one, of a trial of size `h`, asks for, over h. The error goes
    /// with this power of the step.
    pub fn factor(&self, h: f64, error: f64, order: f64) -> f64 {
        let root = |value: f64| libm::pow(value, 1.0 / order);
        let error = error.max(1e-10);
        let plain = 0.9 / root(error);
        let foreseen = match self.before {
            Some((h_before, error_before)) if error <= 1.0 => {
                plain * h / h_before * root(error_before / error)
            }
            _ => plain,
        };
        let most = if self.rejected { 1.0 } else { 5.0 };
        plain.min(foreseen).clamp(0.2, most)
    }

    /// Takes an accepted step into account.
    pub fn note(&mut self, h: f64, error: f64) {
        *self = Pace { before: Some((h, error.max(1e-2))), rejected: false };
    }

    /// A step was too long.
    pub fn reject(&mut self) {
        self.rejected = true;
    }
}
