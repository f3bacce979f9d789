//! The downloaded test.

use heapless::String;
use pneudrive_controller::{Move, Sequence};
use pneudrive_protocol::UNTIL_STOPPED;

use crate::name::cut;

/// Bytes of a test's name.
pub const NAME_BYTES: usize = 32;

/// The downloaded test.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Test {
    name: String<NAME_BYTES>,
    pub(super) decimation: u16,
    pub(super) pre_trigger: u16,
    pub(super) sequence: Sequence,
    crc32: Option<u32>,
}

impl Test {
    /// A test without moves yet. A longer name is cut.
    #[must_use]
    pub fn new(name: &str, duration_samples: u32, decimation: u16, pre_trigger: u16) -> Test {
        let sequence = Sequence::new(duration_samples);
        Test { name: cut(name), decimation, pre_trigger, sequence, crc32: None }
    }

    /// Makes it the test of a move record: this move alone, until it is over.
    pub(super) fn become_record(&mut self, number: u8, only: Move) {
        let digits = [b'0' + number / 10, b'0' + number % 10];
        self.name = cut("record ");
        let _ = self.name.push_str(core::str::from_utf8(&digits).unwrap_or(""));
        (self.decimation, self.pre_trigger) = (1, 0);
        self.sequence.become_one(only, UNTIL_STOPPED);
        self.crc32 = None;
    }

    /// The same, to be known by this CRC-32.
    #[must_use]
    pub fn named(self, crc32: u32) -> Test {
        Test { crc32: Some(crc32), ..self }
    }

    /// The CRC-32 by which a start names it; None if no host has stated it.
    #[must_use]
    pub fn crc32(&self) -> Option<u32> {
        self.crc32
    }

    /// The name.
    #[must_use]
    pub fn name(&self) -> &str {
        self.name.as_str()
    }

    /// The moves and the length of the run.
    #[must_use]
    pub fn sequence(&self) -> &Sequence {
        &self.sequence
    }
}
