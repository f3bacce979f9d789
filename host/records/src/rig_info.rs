//! A rig's report: its identity, and its parameters.

use pneudrive_controller::Parameters;
use pneudrive_controller::parameters::lookup;

/// The identity of a rig.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Info {
    /// Newest protocol version that it speaks.
    pub version: u16,
    /// Version of the firmware.
    pub firmware: String,
    /// Its build.
    pub build: String,
    /// Kind of board.
    pub board: String,
    /// Samples that its buffer holds.
    pub record_capacity: u32,
}

/// The parameters of a rig.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RigParameters {
    /// The values; defaults where the firmware has no such parameter.
    pub values: Parameters,
    /// Ids that the firmware, being older, does not have.
    pub lacking: Vec<u16>,
}

impl RigParameters {
    /// Names of the parameters that the firmware does not have.
    #[must_use]
    pub fn lacking_names(&self) -> Vec<&'static str> {
        let mut names: Vec<&str> = self.lacking.iter().filter_map(|&id| Some(lookup(id)?.name)).collect();
        names.dedup();
        names
    }
}
