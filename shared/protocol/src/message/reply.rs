//! Replies of the firmware.

use serde::{Deserialize, Serialize};

use super::{ConfigState, Motion, RecordInfo, RequestRefusal, Spread, Status};
use crate::Values;
use crate::owner::Owner;

/// The answer to a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Reply<'a> {
    /// The number of the request.
    pub sequence: u16,
    /// The answer.
    #[serde(borrow)]
    pub body: ReplyBody<'a>,
}

/// What the firmware can answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ReplyBody<'a> {
    /// Who is speaking. Never changes, whatever the version.
    Info {
        /// [`VERSION`](crate::VERSION) of the firmware.
        version: u16,
        /// Version of the firmware.
        firmware: &'a str,
        /// What it was built from.
        build: &'a str,
        /// The board it runs on.
        board: &'a str,
        /// Samples the record has room for.
        record_capacity: u32,
    },
    /// The state of the drive.
    Status(Status),
    /// Parameters of consecutive ids.
    Config {
        /// Id of the first one.
        first_id: u16,
        /// Their values, each in the unit of its parameter.
        #[serde(borrow)]
        values: Values<'a>,
    },
    /// The request was carried out.
    Done,
    /// What the record holds.
    RecordInfo(#[serde(borrow)] RecordInfo<'a>),
    /// Samples of the record.
    Chunk {
        /// Position in the record of the first one; 0 is the oldest stored sample.
        first: u32,
        /// [`RecordedSample::BYTES`](crate::RecordedSample::BYTES) each;
        /// [`RecordedSample::read`](crate::RecordedSample::read) takes them apart.
        samples: &'a [u8],
    },
    /// The request was not carried out, and nothing was changed.
    Refused(#[serde(borrow)] RequestRefusal<'a>),
    /// The progress of the moves.
    Motion(Motion),
    /// Where the parameters come from.
    ConfigState(ConfigState),
    /// Events of the fault log.
    Events {
        /// Events in the log.
        total: u8,
        /// Position of the first one here; 0 is the newest.
        first: u8,
        /// [`Event::BYTES`](crate::Event::BYTES) each, newest first.
        events: &'a [u8],
    },
    /// Jitter of the samples by the board's clock, since that was last restarted.
    Timing {
        /// From a sample to the next.
        interval: Spread,
        /// From a sample to its output.
        latency: Spread,
    },
    /// Rows of the stream. In answer to [`StreamRead`](super::RequestBody::StreamRead): those from the first
    /// requested one on that are still held, or none.
    Rows {
        /// Number of the first one; a row before it that has not come is lost.
        first: u32,
        /// [`StreamedSample::BYTES`](crate::StreamedSample::BYTES) each.
        rows: &'a [u8],
    },
    /// Who commands the drive.
    Owner(#[serde(borrow)] Owner<'a>),
    /// Which boot of the drive this is.
    Boot {
        /// Different for each boot; [`NO_BOOT`](crate::session::NO_BOOT): the board cannot tell its boots apart.
        number: u32,
    },
    /// The test, and moves of it.
    Test {
        /// Number of its last sample.
        last_sample: u32,
        /// Its moves repeat every this many samples; 0: they come once.
        round: u32,
        /// Moves that it has.
        total: u8,
        /// Place of the first one here.
        first: u8,
        /// [`ProfiledMove::BYTES`](crate::ProfiledMove::BYTES) each.
        moves: &'a [u8],
    },
    /// Move records of consecutive numbers.
    MoveRecords {
        /// Number of the first one.
        first: u8,
        /// [`ProfiledMove::BYTES`](crate::ProfiledMove::BYTES) each, as [`Entry::MoveRecord`](crate::change::Entry::MoveRecord)
        /// has them; kind [`NO_MOVE`](crate::profiled::NO_MOVE): there is none of this number.
        records: &'a [u8],
    },
    /// The digital inputs and outputs, and what the inputs have begun.
    Io {
        /// As they are read, as [`input`](crate::io::input) has their bits.
        inputs: u8,
        /// As they count: once they have been the same for a few samples.
        settled: u8,
        /// As [`output`](crate::io::output) has their bits.
        outputs: u8,
        /// The number that was begun last.
        number: u8,
        /// Why the last start was not carried out; 0: it was, or there was none.
        refused: u8,
    },
}
