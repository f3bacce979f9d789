//! What was downloaded to be run.

use pneudrive_controller::Sequence;

use crate::name::Name;

/// Bytes of a test's name.
pub const NAME_BYTES: usize = 32;

/// What was downloaded to be run.
#[derive(Clone, Debug, Default)]
pub struct Test {
    name: Name<NAME_BYTES>,
    pub(super) decimation: u16,
    pub(super) pre_trigger: u16,
    pub(super) sequence: Sequence,
}

impl Test {
    /// A test without moves yet. A longer name is cut.
    #[must_use]
    pub fn new(name: &str, duration_samples: u32, decimation: u16, pre_trigger: u16) -> Test {
        let sequence = Sequence::new(duration_samples);
        Test { name: Name::new(name), decimation, pre_trigger, sequence }
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
