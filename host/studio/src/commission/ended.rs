//! Why a page ends a long task.

use std::fmt::{self, Display, Formatter};

/// Why the page ends a long task.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// It stops the drive.
    Stopped,
    /// It asks only for the end of the task.
    Aborted,
    /// It has been silent for too long.
    Silent,
    /// Its connection has ended.
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
