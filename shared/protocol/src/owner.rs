//! Who commands the drive.

use serde::{Deserialize, Serialize};

/// The session of all hosts of version 4 and older.
pub const OLD_HOSTS: u32 = 0;

/// The owner of a drive that its digital inputs have enabled. No host has this session.
pub const INPUTS: u32 = u32::MAX;

/// Bytes of the name that a host gives itself. A longer one is cut.
pub const HOST_BYTES: usize = 32;

/// Whether somebody commands the drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Presence {
    /// Nobody does: the drive is disabled.
    #[default]
    Nobody,
    /// Its owner is there: others may read and stop.
    There,
    /// Its owner has gone, or has been silent for too long: whoever wants to may take over.
    Gone,
}

/// Who commands the drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Owner<'a> {
    /// Whether there is one.
    pub presence: Presence,
    /// Its session; [`OLD_HOSTS`]: of version 4 or older.
    pub session: u32,
    /// For how long nothing has been heard of it, milliseconds; 0 where the board has no clock for that.
    pub silent_ms: u32,
    /// What it calls itself, up to [`HOST_BYTES`].
    pub host: &'a str,
}
