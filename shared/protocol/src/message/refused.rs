//! Why a request was not carried out.

use serde::{Deserialize, Serialize};

use crate::owner::Owner;

/// Why a request was not carried out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Refused<'a> {
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
    /// Version 2. The board's flash could not be written.
    NotStored,
    /// Version 3. The record is not the one that was named.
    OtherRecord,
    /// Version 5. Another host commands the drive, or has armed it and gone.
    Owned(#[serde(borrow)] Owner<'a>),
    /// Version 5. A part of the change is missing: begin it anew.
    ChangeNotWhole,
    /// Version 5. Test or parameters are not those that the start has named.
    OtherTest,
    /// Version 6. The request was meant for another [boot](crate::boot): the drive has been reset since.
    OtherBoot {
        /// The number of this one.
        number: u32,
    },
}

/// Codes of [`Refused::NotNow`] that are not the controller's, which stay below 128. A host of any version can read
/// the answer.
pub mod code {
    /// To a host of version 4 or older: what [`Refused::Owned`](super::Refused::Owned) says to others.
    pub const OWNED: u8 = 128;
    /// The test that a host of version 4 or older asks to start, or to add a move to, was stated by another host.
    pub const OTHER_TEST: u8 = 129;
    /// The rig asks for a [token](crate::RequestBody::Token) before anything else.
    pub const TOKEN: u8 = 130;
    /// Version 6. Since the owner has armed the drive or taken it over, it was silent for too long to move it: it does
    /// so again before.
    pub const HOST_WAS_SILENT: u8 = 131;
    /// Version 8. The inputs of this board are pins.
    pub const INPUTS_ARE_PINS: u8 = 132;
    /// Version 9. This board has no watchdog.
    pub const NO_WATCHDOG: u8 = 133;
    /// Version 9. The drive is in a fault, which arming leaves.
    pub const IN_FAULT: u8 = 134;
}
