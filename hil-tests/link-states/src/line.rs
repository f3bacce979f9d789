//! The line between a host and the rig: two queues, and copies of frames that are still somewhere on their way.

use arrayvec::ArrayVec;
use pneudrive_protocol::Accumulator;

use crate::intern::Id;

/// Frames that a queue holds.
pub const QUEUE: usize = 3;

/// A frame on its way, by its number, and whether the rig was reset since it was sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Frame(u32);

impl Frame {
    const FROM_BEFORE: u32 = 1 << 31;

    /// A frame that is sent now.
    #[must_use]
    pub fn new(id: Id) -> Frame {
        assert!(id < Frame::FROM_BEFORE, "fewer frames than that");
        Frame(id)
    }

    /// Its number.
    #[must_use]
    pub fn id(self) -> Id {
        self.0 & !Frame::FROM_BEFORE
    }

    /// The same, sent before the rig was reset.
    #[must_use]
    pub fn from_before(self) -> Frame {
        Frame(self.0 | Frame::FROM_BEFORE)
    }

    /// Whether the rig was reset since it was sent.
    #[must_use]
    pub fn is_from_before(self) -> bool {
        self.0 & Frame::FROM_BEFORE != 0
    }
}

/// Frames on their way in one direction.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct InFlight {
    /// In order, the next one first.
    pub queue: ArrayVec<Frame, QUEUE>,
    /// Copies that come at any later time, or never; in the order of their numbers.
    pub late: ArrayVec<Frame, QUEUE>,
}

impl InFlight {
    /// Takes frames into the queue. False if they have no room, and none is taken then.
    #[must_use]
    pub fn take(&mut self, frames: &[Id]) -> bool {
        let room = self.queue.remaining_capacity() >= frames.len();
        self.queue.extend(frames.iter().filter(|_| room).map(|&frame| Frame::new(frame)));
        room
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

    /// The rig is reset: what is on its way was sent before. That is noted of those frames where it matters.
    pub fn outlives_reset(&mut self, matters: impl Fn(Id) -> bool) {
        for frame in self.queue.iter_mut().chain(&mut self.late).filter(|frame| matters(frame.id())) {
            *frame = frame.from_before();
        }
        self.late.sort_unstable();
    }

    /// Whether nothing is on its way, but for copies.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.queue.is_empty()
    }
}

/// The message in a frame.
pub(crate) fn message(frame: &[u8]) -> Vec<u8> {
    let mut accumulator: Accumulator = Accumulator::new();
    let whole = frame.iter().find_map(|&byte| accumulator.push(byte)?.ok().map(<[u8]>::to_vec));
    whole.expect("a frame that was sent whole")
}
