//! Timing faults of a simulated rig: a sample that comes late.

use std::sync::{Arc, Mutex, PoisonError};

/// A sample of the next runs that comes late. Clones share it.
#[derive(Clone, Debug, Default)]
pub struct LateSample(Arc<Mutex<Option<(u64, u16)>>>);

impl LateSample {
    /// Delays sample k of each run by this many microseconds.
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
