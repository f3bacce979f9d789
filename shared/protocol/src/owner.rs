//! Who commands the drive.

use serde::{Deserialize, Serialize};

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
    /// Its [session](crate::session); [`NOBODY`](crate::session::NOBODY): there is none.
    pub session: u32,
    /// How long it has been silent, milliseconds; 0 where the board has no clock for that.
    pub silent_ms: u32,
    /// What it calls itself, up to [`HOST_BYTES`](crate::session::HOST_BYTES).
    pub host: &'a str,
}
