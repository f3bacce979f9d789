//! How a simulated rig keeps time: a sample that comes late, and whether time goes on with the wall clock.

use std::sync::{Arc, Mutex, PoisonError};

/// A sample of the next runs that comes late. Clones are one and the same.
#[derive(Clone, Debug, Default)]
pub struct LateSample(Arc<Mutex<Option<(u64, u16)>>>);

impl LateSample {
    /// Sample k of each run comes so many microseconds after its instant.
    pub fn set(&self, k: u64, late_us: u16) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some((k, late_us));
    }

    /// How late a sample is, microseconds.
    #[must_use]
    pub fn lateness_of(&self, sample: u64) -> u16 {
        match *self.0.lock().unwrap_or_else(PoisonError::into_inner) {
            Some((k, late_us)) if k == sample => late_us,
            _ => 0,
        }
    }
}
