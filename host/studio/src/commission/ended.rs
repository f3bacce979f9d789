//! Why a page ends what takes longer.

use std::fmt::{self, Display, Formatter};

/// Why the page ends what takes longer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// It stops the drive.
    Stopped,
    /// It asks for no more than the end.
    Aborted,
    /// It says nothing any more.
    Silent,
    /// It has gone.
    Gone,
}

impl Display for Ended {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Ended::Stopped => "ended: the drive was stopped",
            Ended::Aborted => "ended by the page; the drive is disarmed",
            Ended::Silent => "ended: the page was silent",
            Ended::Gone => "ended: the page has gone",
        })
    }
}

impl std::error::Error for Ended {}
