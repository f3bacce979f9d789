//! What was downloaded to be run.

use heapless::String;
use pneudrive_controller::{Move, Sequence};
use pneudrive_protocol::UNTIL_STOPPED;
use pneudrive_protocol::session::{INPUTS, OLD_HOSTS};

use crate::name::cut;

/// Bytes of a test's name.
pub const NAME_BYTES: usize = 32;

/// What was downloaded to be run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Test {
    name: String<NAME_BYTES>,
    pub(super) decimation: u16,
    pub(super) pre_trigger: u16,
    pub(super) sequence: Sequence,
    origin: Origin,
}

/// Where a test comes from: only its author adds to it and starts it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Origin {
    /// Stated request by request, by a host of this session.
    Session(u32),
    /// Taken whole, with this CRC-32.
    Whole(u32),
}

impl Default for Origin {
    fn default() -> Self {
        Origin::Session(OLD_HOSTS)
    }
}

impl Test {
    /// A test without moves yet. A longer name is cut.
    #[must_use]
    pub fn new(name: &str, duration_samples: u32, decimation: u16, pre_trigger: u16) -> Test {
        let sequence = Sequence::new(duration_samples);
        Test { name: cut(name), decimation, pre_trigger, sequence, origin: Origin::default() }
    }

    /// Makes it the test of a move record: this move alone, until it is over.
    pub(super) fn become_record(&mut self, number: u8, only: Move) {
        let digits = [b'0' + number / 10, b'0' + number % 10];
        self.name = cut("record ");
        let _ = self.name.push_str(core::str::from_utf8(&digits).unwrap_or(""));
        (self.decimation, self.pre_trigger) = (1, 0);
        self.sequence.become_one(only, UNTIL_STOPPED);
        self.origin = Origin::Session(INPUTS);
    }

    /// The same, by the host of this session.
    #[must_use]
    pub fn by(self, session: u32) -> Test {
        Test { origin: Origin::Session(session), ..self }
    }

    /// The same, to be known by this CRC-32.
    #[must_use]
    pub fn named(self, crc32: u32) -> Test {
        Test { origin: Origin::Whole(crc32), ..self }
    }

    /// Whether the host of this session has stated it.
    #[must_use]
    pub fn is_by(&self, session: u32) -> bool {
        self.origin == Origin::Session(session)
    }

    /// The CRC-32 by which a start names it; None if it was stated request by request.
    #[must_use]
    pub fn crc32(&self) -> Option<u32> {
        match self.origin {
            Origin::Whole(crc32) => Some(crc32),
            Origin::Session(_) => None,
        }
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
