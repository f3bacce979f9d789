//! Why a request was not carried out.

use serde::{Deserialize, Serialize};

use crate::owner::Owner;

/// Why a request was not carried out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RequestRefusal<'a> {
    /// The mode of the drive forbids it; with the controller's code of the refusal, or one from [`code`].
    NotNow(u8),
    /// There is no parameter of this id.
    UnknownParameter {
        /// The id.
        id: u16,
    },
    /// The value is outside the range of its parameter.
    OutOfRange {
        /// Id of the parameter.
        id: u16,
        /// The value, in the unit of the parameter.
        value: i32,
    },
    /// The parameters do not go together.
    Inconsistent {
        /// What must be.
        advice: &'a str,
    },
    /// The test lasts more samples than can be counted ([`UNTIL_STOPPED`](crate::UNTIL_STOPPED)).
    TestTooLong,
    /// The move is before the last one.
    MovesOutOfOrder,
    /// There is no room for another move.
    TooManyMoves,
    /// Nothing has been recorded.
    NoRecord,
    /// The record has no such samples.
    RecordRange {
        /// How many it has.
        samples: u32,
    },
    /// This firmware does not know the request.
    Unknown,
    /// The board's flash could not be written.
    NotStored,
    /// The record is not the one that was named.
    OtherRecord,
    /// Another host commands the drive, or has armed it and gone.
    Owned(#[serde(borrow)] Owner<'a>),
    /// A part of the change is missing: begin it anew.
    ChangeNotWhole,
    /// Test or parameters are not those that the start has named.
    OtherTest,
    /// The request was meant for another [boot](crate::session): the drive has been reset since.
    OtherBoot {
        /// The number of this one.
        number: u32,
    },
}

/// Codes of [`RequestRefusal::NotNow`] that are not the controller's, which stay below 128.
pub mod code {
    /// Another host commands the drive: why the digital inputs have begun nothing. A host is told by
    /// [`RequestRefusal::Owned`](super::RequestRefusal::Owned).
    pub const OWNED: u8 = 128;
    /// The rig asks for a [token](crate::RequestBody::Token) before anything else.
    pub const TOKEN: u8 = 129;
    /// The owner was silent for too long after it had armed the drive or taken it over: it must do so again before it
    /// moves the drive.
    pub const HOST_WAS_SILENT: u8 = 130;
    /// The inputs of this board are pins.
    pub const INPUTS_ARE_PINS: u8 = 131;
    /// This board has no watchdog.
    pub const NO_WATCHDOG: u8 = 132;
    /// The drive is in a fault, which arming leaves.
    pub const IN_FAULT: u8 = 133;
}
