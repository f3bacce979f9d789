//! The line between a host and the rig: two queues, and copies of frames that are still somewhere on their way.

use arrayvec::ArrayVec;

use crate::intern::Id;

/// Frames that a queue holds.
pub const QUEUE: usize = 3;

/// Frames on their way in one direction.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Way {
    /// In order, the next one first.
    pub queue: ArrayVec<Id, QUEUE>,
    /// Copies that come at any later time, or never; in the order of their numbers.
    pub late: ArrayVec<Id, QUEUE>,
}

impl Way {
    /// Takes frames into the queue. False if they have no room, and none is taken then.
    #[must_use]
    pub fn take(&mut self, frames: &[Id]) -> bool {
        self.queue.try_extend_from_slice(frames).is_ok()
    }

    /// The next frame is lost.
    #[must_use]
    pub fn lose_next(&mut self) -> bool {
        self.queue.pop_at(0).is_some()
    }

    /// A copy of the next frame comes late.
    #[must_use]
    pub fn copy_next(&mut self) -> bool {
        let Some(&next) = self.queue.first() else { return false };
        let fits = self.late.try_push(next).is_ok();
        self.late.sort_unstable();
        fits
    }

    /// Whether nothing is on its way, but for copies.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.queue.is_empty()
    }
}
