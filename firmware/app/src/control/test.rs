//! What was downloaded to be run.

use pneudrive_controller::Sequence;

/// Bytes of a test's name.
pub const NAME_BYTES: usize = 32;

/// What was downloaded to be run.
#[derive(Clone, Debug, Default)]
pub struct Test {
    name: [u8; NAME_BYTES],
    name_len: usize,
    pub(super) decimation: u16,
    pub(super) pre_trigger: u16,
    pub(super) sequence: Sequence,
}

impl Test {
    /// A test without moves yet. A longer name is cut.
    #[must_use]
    pub fn new(name: &str, duration_samples: u32, decimation: u16, pre_trigger: u16) -> Test {
        let mut test = Test { decimation, pre_trigger, ..Test::default() };
        test.sequence = Sequence::new(duration_samples);
        let cut = (0..=name.len().min(NAME_BYTES)).rev().find(|&end| name.is_char_boundary(end));
        let bytes = name.as_bytes().get(..cut.unwrap_or(0)).unwrap_or(&[]);
        for (to, from) in test.name.iter_mut().zip(bytes) {
            *to = *from;
        }
        test.name_len = bytes.len();
        test
    }

    /// The name.
    #[must_use]
    pub fn name(&self) -> &str {
        self.name.get(..self.name_len).and_then(|bytes| core::str::from_utf8(bytes).ok()).unwrap_or("")
    }

    /// The moves and the length of the run.
    #[must_use]
    pub fn sequence(&self) -> &Sequence {
        &self.sequence
    }
}
