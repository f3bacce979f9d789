//! The cost of an integration.

/// Counts of the work done. A slower program shows here without a clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Accepted steps.
    pub n_steps: u64,
    /// Steps tried again with a smaller size.
    pub n_rejected_steps: u64,
    /// Evaluations of the right-hand side.
    pub n_rhs_evaluations: u64,
    /// Restarts of the method: events and interruptions after which dx/dt had to be evaluated again.
    pub n_restarts: u64,
    /// Events of all kinds.
    pub n_events: u64,
}
