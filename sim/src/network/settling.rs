//! When Newton's method has converged, and which flows count as zero.

/// kg/s: a flow has converged if its correction is smaller.
pub(super) const SMALLEST: f64 = 1e-12;

/// A node's w has not converged if its correction is more than this part of it.
pub(super) const ARRIVED: f64 = 0.01;

/// kg/s: a smaller flow counts as zero.
pub(super) const NO_FLOW: f64 = 1e-20;
