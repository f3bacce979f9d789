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

/// The last accepted step of this stretch: its size, and err^(1/p) of its error over the allowed one.
#[derive(Clone, Copy, Debug)]
struct Before {
    h: f64,
    root: f64,
}

/// What is known of the pace of this stretch.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pace {
    before: Option<Before>,
    rejected: bool,
}

impl Pace {
    /// The step that an error over the allowed one, of a trial of size `h`, asks for, over h. The error goes
    /// with this power of the step. A step that is good enough is taken into account.
    pub fn factor(&mut self, h: f64, error: f64, order: f64) -> f64 {
        let root = libm::pow(error.max(1e-10), 1.0 / order);
        let plain = 0.9 / root;
        let good = error <= 1.0;
        let foreseen = match self.before {
            Some(before) if good => plain * h / before.h * before.root / root,
            _ => plain,
        };
        let most = if self.rejected { 1.0 } else { 5.0 };
        if good {
            // A step of next to no error says little.
            let least = if error < 1e-2 { libm::pow(1e-2, 1.0 / order) } else { root };
            *self = Pace { before: Some(Before { h, root: least }), rejected: false };
        }
        plain.min(foreseen).clamp(0.2, most)
    }

    /// A step was too long.
    pub fn reject(&mut self) {
        self.rejected = true;
    }
}
