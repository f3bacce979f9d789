//! Requests of the PC.

use serde::{Deserialize, Serialize};

use crate::Values;

/// What the PC wants, under a number that the reply repeats.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Request<'a> {
    /// Chosen by the PC; the numbers of a session grow, and wrap.
    pub sequence: u16,
    /// The [session](crate::session) of the host.
    pub session: u32,
    /// The [boot](crate::session) of the drive that it is meant for.
    pub boot: u32,
    /// What is wanted.
    #[serde(borrow)]
    pub body: RequestBody<'a>,
}

/// What the PC can ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RequestBody<'a> {
    /// Who are you? Answered by [`ReplyBody::Info`](super::ReplyBody::Info).
    Info,
    /// How are you? Answered by [`ReplyBody::Status`](super::ReplyBody::Status).
    Status,
    /// Parameters of consecutive ids. Answered by [`ReplyBody::Config`](super::ReplyBody::Config).
    ConfigGet {
        /// Id of the first one.
        first_id: u16,
        /// How many, up to [`MAX_VALUES`](crate::MAX_VALUES).
        count: u8,
    },
    /// Changes parameters of consecutive ids: all of them or, if one is refused, none.
    ConfigSet {
        /// Id of the first one.
        first_id: u16,
        /// Their values, each in the unit of its parameter.
        #[serde(borrow)]
        values: Values<'a>,
    },
    /// Enables the drive, valve at null; the only way out of a fault. The session that asks owns the drive from now on.
    Arm {
        /// What the host calls itself, up to [`HOST_BYTES`](crate::session::HOST_BYTES).
        host: &'a str,
    },
    /// Disables the drive.
    Disarm,
    /// Runs the moves from k = 0 at the next sample, if test and parameters are those that are named.
    Start {
        /// [`start_crc32`](crate::change::start_crc32) of both.
        crc32: u32,
    },
    /// Trips the drive.
    Stop,
    /// The axis stands at this position now.
    Reference {
        /// Position, encoder counts.
        position_counts: i32,
    },
    /// What does the record hold? Answered by [`ReplyBody::RecordInfo`](super::ReplyBody::RecordInfo).
    RecordInfo,
    /// Samples of a record that is named by its CRC: never those of a later one. Answered by
    /// [`ReplyBody::Chunk`](super::ReplyBody::Chunk).
    RecordRead {
        /// CRC of the record, as [`RecordInfo`](super::RecordInfo) has it.
        crc32: u32,
        /// Position in the record; 0 is the oldest stored sample.
        first: u32,
        /// How many, up to [`CHUNK_SAMPLES`](crate::CHUNK_SAMPLES).
        count: u8,
    },
    /// Homes the axis: moves it slowly to its stop or switch.
    Home,
    /// The progress of the moves. Answered by [`ReplyBody::Motion`](super::ReplyBody::Motion).
    Motion,
    /// Stores the parameters for the next reset.
    ConfigSave,
    /// Where do the parameters come from? Answered by
    /// [`ReplyBody::ConfigState`](super::ReplyBody::ConfigState).
    ConfigState,
    /// The fault log. Answered by [`ReplyBody::Events`](super::ReplyBody::Events).
    Events {
        /// Position in the log; 0 is the newest event.
        first: u8,
        /// How many, up to [`MAX_EVENTS`](crate::MAX_EVENTS).
        count: u8,
    },
    /// The jitter of the samples. Answered by [`ReplyBody::Timing`](super::ReplyBody::Timing).
    Timing,
    /// Begins a stream of a run's samples, its rows numbered from 0 on, and ends the one before.
    /// The rows come unasked, as [`ReplyBody::Rows`](super::ReplyBody::Rows) under the number of this
    /// request, as far as they are granted.
    StreamBegin {
        /// Every nth sample becomes a row; 0: none does.
        every: u16,
        /// How many rows come at once, up to [`MAX_ROWS`](crate::MAX_ROWS).
        batch: u8,
    },
    /// Permits the rows before this one to come unasked, so that a host that has gone is soon sent no more.
    StreamGrant {
        /// Number of the first row that may not.
        until: u32,
    },
    /// Rows of the stream again. Answered by [`ReplyBody::Rows`](super::ReplyBody::Rows).
    StreamRead {
        /// Number of the first one.
        first: u32,
        /// How many, up to [`MAX_ROWS`](crate::MAX_ROWS).
        count: u8,
    },
    /// The session that asks owns an enabled drive whose owner has gone. Nothing else is changed.
    TakeOver {
        /// What the host calls itself, up to [`HOST_BYTES`](crate::session::HOST_BYTES).
        host: &'a str,
    },
    /// The owner leaves, and the drive stays as it is: nobody need wait until its silence is noticed.
    Leave,
    /// Who commands the drive? Answered by [`ReplyBody::Owner`](super::ReplyBody::Owner).
    Owner,
    /// A part of a [change](crate::change). The first one begins it anew, others follow without a gap.
    ChangePart {
        /// CRC-32 of the whole change.
        crc32: u32,
        /// Place of the part's first byte in the change.
        first: u16,
        /// The bytes, up to [`PART_BYTES`](crate::change::PART_BYTES).
        part: &'a [u8],
    },
    /// Takes the change whose parts have come: all of it or, if anything is refused, nothing.
    ChangeTake {
        /// CRC-32 of the whole change.
        crc32: u32,
    },
    /// Lets a host in where a rig is reached over a network. Elsewhere it changes nothing.
    Token {
        /// What host and rig both know.
        token: &'a str,
    },
    /// Which boot is this? Answered by [`ReplyBody::Boot`](super::ReplyBody::Boot).
    Boot,
    /// Walks the spool of a stepper valve back to its null from where it was before a reset. The drive must
    /// be disabled.
    SeekNull,
    /// The spool of a stepper valve is at its null. The drive must be disabled.
    AtNull,
    /// The test as the rig has it. Answered by [`ReplyBody::Test`](super::ReplyBody::Test).
    TestRead {
        /// Place of the first move.
        first: u8,
    },
    /// The table of move records. Answered by [`ReplyBody::MoveRecords`](super::ReplyBody::MoveRecords).
    MoveRecordsRead {
        /// Number of the first one, from 1 on.
        first: u8,
    },
    /// The digital inputs and outputs. Answered by [`ReplyBody::Io`](super::ReplyBody::Io).
    Io,
    /// Sets the digital inputs of a rig that emulates them. Those of a board are pins.
    IoSet {
        /// As [`input`](crate::io::input) has their bits.
        inputs: u8,
    },
    /// Feeds the watchdog no more, so that it must reset the board. The drive must be disarmed; it is in a fault
    /// until then, and arming it ends the trial.
    TryWatchdog,
}

impl RequestBody<'_> {
    /// Whether it may be carried out as often as it comes: it changes nothing, only raises what may be sent, or is a part of a
    /// change that has yet to be taken. A host gives each repeat of such a request a number of its own, so that a rig takes it
    /// for a sign of life. Any other request keeps its number when it is repeated: by that the rig carries it out once.
    #[must_use]
    pub fn is_idempotent(&self) -> bool {
        use RequestBody as Body;
        matches!(
            self,
            Body::Info
                | Body::Status
                | Body::ConfigGet { .. }
                | Body::RecordInfo
                | Body::RecordRead { .. }
                | Body::Motion
                | Body::ConfigState
                | Body::Events { .. }
                | Body::Timing
                | Body::StreamRead { .. }
                | Body::StreamGrant { .. }
                | Body::Owner
                | Body::Token { .. }
                | Body::ChangePart { .. }
                | Body::Boot
                | Body::TestRead { .. }
                | Body::MoveRecordsRead { .. }
                | Body::Io
        )
    }
}

/// Last sample of a test that runs until it is stopped: the last one that can be counted, 64 days at 1.3 ms.
pub const UNTIL_STOPPED: u32 = u32::MAX - 1;
