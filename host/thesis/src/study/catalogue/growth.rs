//! When a figure counts as larger or smaller.

/// Whether something grows with a change; None if it differs by less than that, or the runs do not show it.
pub(super) fn grows(own: Option<f64>, changed: Option<f64>, least: f64) -> Option<bool> {
    let by = changed? - own?;
    (by.abs() > least).then_some(by > 0.0)
}

/// A swing that differs by less is the same, mm: two counts.
pub(super) const SAME_MM: f64 = 0.025;
