//! Why an integration fails.

/// Most steps in a millisecond, tried or accepted: at that pace a second takes a quarter of an hour.
pub(crate) const MAX_STEPS: u64 = 200_000;

/// From this many steps in a millisecond on, a system is asked whether its equations still hold.
pub(crate) const MANY_STEPS: u64 = 5_000;

/// Why an integration fails.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum IntegrationError {
    /// The state is no longer a number.
    #[error(
        "the state stopped being a number at t = {at_s} s: a parameter is far outside of what the equations hold for"
    )]
    NotANumber {
        /// When.
        at_s: f64,
    },
    /// The step size fell to nothing.
    #[error(
        "the step size fell below {step_s:.1e} s at t = {at_s} s: the system is too stiff for these methods"
    )]
    StepTooSmall {
        /// When.
        at_s: f64,
        /// The step that would have been needed.
        step_s: f64,
    },
    /// The steps are so small that the run would not end.
    #[error(
        "a millisecond takes more than {MAX_STEPS} steps at t = {at_s} s: the system is too stiff for these methods"
    )]
    NoProgress {
        /// When.
        at_s: f64,
    },
    /// The state has reached a place where the equations of the system do not hold.
    #[error("at t = {at_s} s {why}")]
    BeyondModel {
        /// When.
        at_s: f64,
        /// The event, and the remedy.
        why: &'static str,
    },
    /// Events follow each other without end.
    #[error("events pile up at t = {at_s} s: two modes switch to each other endlessly")]
    EventsPileUp {
        /// When.
        at_s: f64,
    },
}

impl IntegrationError {
    /// When, s.
    #[must_use]
    pub fn at_s(&self) -> f64 {
        match *self {
            IntegrationError::NotANumber { at_s }
            | IntegrationError::StepTooSmall { at_s, .. }
            | IntegrationError::NoProgress { at_s }
            | IntegrationError::BeyondModel { at_s, .. }
            | IntegrationError::EventsPileUp { at_s } => at_s,
        }
    }
}
