//! When Newton's method has found the flows, and what counts as none.

/// kg/s: a flow whose correction is smaller is found.
pub(super) const SMALLEST: f64 = 1e-12;

/// A node's w whose correction is more than this part of it is not found.
pub(super) const ARRIVED: f64 = 0.01;

/// kg/s: less than this counts as no flow.
pub(super) const NO_FLOW: f64 = 1e-20;
