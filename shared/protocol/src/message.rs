//! Requests of the PC and replies of the firmware. Enums gain variants at the end, nowhere else.

use serde::{Deserialize, Serialize};

use crate::session::Owner;
use crate::{MAX_MESSAGE, Values, frame};

/// What can be sent: a [`Request`] or a [`Reply`].
pub trait Message: Serialize {}

impl Message for Request<'_> {}
impl Message for Reply<'_> {}

/// What the PC wants, under a number that the reply repeats.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Request<'a> {
    /// Chosen by the PC; tells replies apart after a loss.
    pub sequence: u16,
    /// What is wanted.
    #[serde(borrow)]
    pub body: RequestBody<'a>,
}

/// What the PC can ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RequestBody<'a> {
    /// Who are you? Answered by [`ReplyBody::Info`].
    Info,
    /// How are you? Answered by [`ReplyBody::Status`].
    Status,
    /// Parameters of consecutive ids. Answered by [`ReplyBody::Config`].
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
    /// Enables the drive, valve at null; the only way out of a fault.
    Arm,
    /// Disables the drive.
    Disarm,
    /// Runs the moves from k = 0 at the next sample.
    Start,
    /// Trips the drive.
    Stop,
    /// The axis stands at this position now.
    Reference {
        /// Position, encoder counts.
        position_counts: i32,
    },
    /// A new test: forgets the moves of the one before and how its record was taken.
    TestBegin {
        /// Name of the test, kept with the record.
        name: &'a str,
        /// Length of the run, microseconds.
        duration_us: u32,
        /// Every how manyth sample is stored; 1: all.
        decimation: u16,
        /// Stored samples before k = 0.
        pre_trigger: u16,
    },
    /// Adds a move to the test; in order of time.
    TestMove {
        /// In force from the first sample not before it, microseconds after k = 0.
        time_us: u32,
        /// Setpoint (open loop: command), counts.
        target: i32,
    },
    /// What does the record hold? Answered by [`ReplyBody::RecordInfo`].
    RecordInfo,
    /// Samples of the record. Answered by [`ReplyBody::Chunk`].
    RecordRead {
        /// Position in the record; 0 is the oldest stored sample.
        first: u32,
        /// How many, up to [`CHUNK_SAMPLES`](crate::CHUNK_SAMPLES).
        count: u8,
    },
    /// Version 2. Homes the axis: moves it slowly to its stop or switch.
    Home,
    /// Version 2. How do the moves stand? Answered by [`ReplyBody::Motion`].
    Motion,
    /// Version 2. Stores the parameters for the next reset.
    ConfigSave,
    /// Version 2. Where do the parameters come from? Answered by [`ReplyBody::ConfigState`].
    ConfigState,
    /// Version 2. The fault log. Answered by [`ReplyBody::Events`].
    Events {
        /// Position in the log; 0 is the newest event.
        first: u8,
        /// How many, up to [`MAX_EVENTS`](crate::MAX_EVENTS).
        count: u8,
    },
    /// Version 2. How even are the samples? Answered by [`ReplyBody::Timing`].
    Timing,
    /// Version 3. Samples of a record that is named by its CRC: never those of a later one. Answered by
    /// [`ReplyBody::Chunk`].
    RecordChunk {
        /// CRC of the record, as [`RecordInfo`] has it.
        crc32: u32,
        /// Position in the record; 0 is the oldest stored sample.
        first: u32,
        /// How many, up to [`CHUNK_SAMPLES`](crate::CHUNK_SAMPLES).
        count: u8,
    },
    /// Version 3. Begins a stream of a run's samples, its rows numbered from 0 on, and ends the one before.
    /// The rows come unasked, as [`ReplyBody::Rows`] under the number of this request, as far as they are
    /// granted.
    StreamBegin {
        /// Every how manyth sample becomes a row; 0: none.
        every: u16,
        /// How many rows come at once, up to [`MAX_ROWS`](crate::MAX_ROWS).
        batch: u8,
    },
    /// Version 3. The rows before this one may come unasked: a host that has gone is not talked to for long.
    StreamGrant {
        /// Number of the first row that may not.
        until: u32,
    },
    /// Version 3. Rows of the stream again. Answered by [`ReplyBody::Rows`].
    StreamRead {
        /// Number of the first one.
        first: u32,
        /// How many, up to [`MAX_ROWS`](crate::MAX_ROWS).
        count: u8,
    },
    /// Version 4. How long the test is, in samples, and whether its moves come again; in place of the length
    /// that it began with.
    TestSpan {
        /// Number of the last sample, up to [`UNTIL_STOPPED`].
        last_sample: u32,
        /// The moves come again every so many samples; 0: they come once.
        round: u32,
    },
    /// Version 5. Enables the drive as [`RequestBody::Arm`] does. The session that asks owns it from now on.
    ArmAs {
        /// What the host calls itself, up to [`HOST_BYTES`](crate::session::HOST_BYTES).
        host: &'a str,
    },
    /// Version 5. The session that asks owns an enabled drive whose owner has gone. Nothing else is changed.
    TakeOver {
        /// What the host calls itself, up to [`HOST_BYTES`](crate::session::HOST_BYTES).
        host: &'a str,
    },
    /// Version 5. The owner goes and leaves the drive as it is: nobody need wait until its silence is noticed.
    Leave,
    /// Version 5. Who commands the drive? Answered by [`ReplyBody::Owner`].
    Owner,
    /// Version 5. A part of a [change](crate::change). The first one begins it anew, others follow without a gap.
    ChangePart {
        /// CRC-32 of the whole change.
        crc32: u32,
        /// Place of the part's first byte in the change.
        first: u16,
        /// The bytes, up to [`PART_BYTES`](crate::change::PART_BYTES).
        part: &'a [u8],
    },
    /// Version 5. Takes the change whose parts have come: all of it or, if anything is refused, nothing.
    ChangeTake {
        /// CRC-32 of the whole change.
        crc32: u32,
    },
    /// Version 5. Runs the moves from k = 0 at the next sample, if test and parameters are those that are named.
    StartTest {
        /// [`start_crc32`](crate::change::start_crc32) of both.
        crc32: u32,
    },
    /// Version 5. Lets a host in where a rig is reached over a network. Elsewhere it changes nothing.
    Token {
        /// What host and rig both know.
        token: &'a str,
    },
}

/// Last sample of a test that runs until it is stopped: the last one that can be counted, 64 days at 1.3 ms.
pub const UNTIL_STOPPED: u32 = u32::MAX - 1;

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
        /// The oldest version the firmware speaks.
        min_version: u16,
        /// The newest version the firmware speaks.
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
    /// How the drive is.
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
    Refused(#[serde(borrow)] Refused<'a>),
    /// Version 2. How the moves stand.
    Motion(Motion),
    /// Version 2. Where the parameters come from.
    ConfigState(ConfigState),
    /// Version 2. Events of the fault log.
    Events {
        /// Events in the log.
        total: u8,
        /// Position of the first one here; 0 is the newest.
        first: u8,
        /// [`Event::BYTES`](crate::Event::BYTES) each, newest first.
        events: &'a [u8],
    },
    /// Version 2. How even the samples are, by the board's clock, since its clock was last restarted.
    Timing {
        /// From a sample to the next.
        interval: Spread,
        /// From a sample to its output.
        latency: Spread,
    },
    /// Version 3. Rows of the stream. Asked for again: those from the first one on that are still held, or
    /// none.
    Rows {
        /// Number of the first one; a row before it that has not come is lost.
        first: u32,
        /// [`StreamedSample::BYTES`](crate::StreamedSample::BYTES) each.
        rows: &'a [u8],
    },
    /// Version 5. Who commands the drive.
    Owner(#[serde(borrow)] Owner<'a>),
}

/// What the drive is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    /// Drive disabled, valve at null.
    #[default]
    Disarmed,
    /// Drive enabled, valve at null.
    Armed,
    /// The law drives the valve.
    Running,
    /// The moves are over.
    Done,
    /// Tripped: drive disabled, valve at null, until re-armed.
    Fault,
}

/// The drive at the last sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Status {
    /// What it is doing.
    pub mode: Mode,
    /// Why it tripped: a code of the controller; 0: it did not.
    pub fault: u8,
    /// Whether the axis has been referenced.
    pub referenced: bool,
    /// k: samples since the start of the run.
    pub index: u32,
    /// Length of the run, samples.
    pub duration_samples: u32,
    /// Setpoint in force (open loop: command asked for), counts.
    pub setpoint: i32,
    /// Encoder count.
    pub position: i32,
    /// Setpoint less position, counts.
    pub error: i32,
    /// Valve command, -2048 to 2048 counts.
    pub command: i16,
    /// Chamber 1 (blind side) pressure, raw.
    pub pressure_1: i16,
    /// Chamber 2 (rod side) pressure, raw.
    pub pressure_2: i16,
    /// Spool displacement, raw.
    pub spool: i16,
    /// Samples stored so far.
    pub recorded: u32,
    /// Frames that came damaged to the firmware since its reset.
    pub damaged_frames: u32,
}

/// Bins of a [`Spread`].
pub const HISTOGRAM_BINS: usize = 12;

/// How times are spread about what they should be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Spread {
    /// How many were taken.
    pub count: u32,
    /// The shortest, us.
    pub least_us: u32,
    /// The longest, us.
    pub most_us: u32,
    /// Bin b counts those that are off by 2^(b-1) to 2^b - 1 us; bin 0 those that are not, the last one
    /// all larger ones.
    pub bins: [u32; HISTOGRAM_BINS],
}

/// How the moves of the run stand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Motion {
    /// Whether the drive is homing; [`Status`] says `Running` then.
    pub homing: bool,
    /// The move in force: 0 none, 1 on its way, 2 arrived, 3 not reached.
    pub arrival: u8,
    /// Moves that have begun.
    pub begun: u16,
    /// Moves that ended without arriving.
    pub not_reached: u32,
    /// What the run has learned of the valve's null, counts.
    pub learned_null_offset: i32,
}

/// Where the parameters come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ConfigState {
    /// 0: never saved, 1: as stored, 2: stored by another version and taken over, 3: both stored sets
    /// are damaged.
    pub source: u8,
    /// How often they were saved.
    pub saves: u32,
    /// CRC-32 of the parameters in force.
    pub hash: u32,
    /// Whether they are those that the next reset will load.
    pub saved: bool,
    /// Stored values that were ignored: parameters that this firmware does not know, or values outside
    /// their range.
    pub ignored: u16,
}

/// What the record holds and how it was taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RecordInfo<'a> {
    /// Name of the test.
    pub test: &'a str,
    /// Stored samples.
    pub samples: u32,
    /// k of the oldest one; negative before the start.
    pub first_index: i32,
    /// Every how manyth sample was stored.
    pub decimation: u16,
    /// Stored samples asked for before k = 0.
    pub pre_trigger: u16,
    /// Whether the recorder is through; a record in the making still grows.
    pub complete: bool,
    /// Sample period by the board's own clock, nanoseconds.
    pub measured_period_ns: u32,
    /// Mean of the spool displacement, raw.
    pub mean_spool_raw: i16,
    /// CRC-32 of all stored samples from the oldest on ([`RecordCrc`](crate::RecordCrc)).
    pub crc32: u32,
}

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
    /// The test lasts more samples than can be counted ([`UNTIL_STOPPED`]).
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
}

/// Codes of [`Refused::NotNow`] that are not the controller's, which stay below 128. A host of any version can read
/// the answer.
pub mod code {
    /// To a host of version 4 or older: what [`Refused::Owned`](super::Refused::Owned) says to others.
    pub const OWNED: u8 = 128;
    /// The test that a host of version 4 or older asks to start, or to add a move to, was stated by another host.
    pub const OTHER_TEST: u8 = 129;
    /// The rig asks for a [token](super::RequestBody::Token) before anything else.
    pub const TOKEN: u8 = 130;
}

/// The message is not one of this version, though it came whole: a later version's, most likely.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MessageError {
    /// The number it came under, to be answered with [`Refused::Unknown`]; None: not even that.
    pub sequence: Option<u16>,
}

/// The frame of a message at the front of `out`.
///
/// None if the message is above [`MAX_MESSAGE`] (its texts are longer than
/// [`MAX_TEXT`](crate::MAX_TEXT)) or `out` is too short; [`MAX_FRAME`](crate::MAX_FRAME) bytes are
/// always enough. Takes [`MAX_MESSAGE`] bytes of stack.
#[must_use]
pub fn encode<'out>(message: &impl Message, out: &'out mut [u8]) -> Option<&'out [u8]> {
    encode_and_know(message, out).map(|(frame, _)| frame)
}

/// The same, and the CRC of the message: to know it again ([`Recent`](crate::Recent)).
#[must_use]
pub fn encode_and_know<'out>(message: &impl Message, out: &'out mut [u8]) -> Option<(&'out [u8], u32)> {
    let mut buffer = [0; MAX_MESSAGE];
    let bytes = postcard::to_slice(message, &mut buffer).ok()?;
    let crc32 = frame::crc32(bytes);
    Some((frame::encode_with(crc32, bytes, out)?, crc32))
}

/// The request in a message. What follows a known body is skipped.
///
/// # Errors
/// For a message that is no request of this version.
pub fn decode_request(message: &[u8]) -> Result<Request<'_>, MessageError> {
    let (sequence, body, _later) = decode(message)?;
    Ok(Request { sequence, body })
}

/// The reply in a message. What follows a known body is skipped.
///
/// # Errors
/// For a message that is no reply of this version.
pub fn decode_reply(message: &[u8]) -> Result<Reply<'_>, MessageError> {
    let (sequence, body, _later) = decode(message)?;
    Ok(Reply { sequence, body })
}

/// The sequence number first, on its own: it is known whatever the body turns out to be. Then the body, and what stands
/// behind it.
pub(crate) fn decode<'a, Body: Deserialize<'a>>(
    message: &'a [u8],
) -> Result<(u16, Body, &'a [u8]), MessageError> {
    let (sequence, rest) = postcard::take_from_bytes(message).map_err(|_| MessageError { sequence: None })?;
    let (body, later) =
        postcard::take_from_bytes(rest).map_err(|_| MessageError { sequence: Some(sequence) })?;
    Ok((sequence, body, later))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Accumulator, CHUNK_SAMPLES, MAX_FRAME, MAX_ROWS, MAX_TEXT, MAX_VALUES, RecordedSample, StreamedSample,
    };

    /// The message that the frame of `message` carries.
    fn carried<'a>(message: &impl Message, accumulator: &'a mut Accumulator) -> &'a [u8] {
        let mut out = [0; MAX_FRAME];
        let (delimiter, frame) = encode(message, &mut out).expect("fits").split_last().expect("a frame");
        for &byte in frame {
            assert_eq!(accumulator.push(byte), None);
        }
        accumulator.push(*delimiter).expect("a frame").expect("whole")
    }

    #[test]
    fn the_largest_messages_fit() {
        let text = str::from_utf8(&[b'x'; MAX_TEXT]).expect("ASCII");
        let mut buffer = [0; 4 * MAX_VALUES];
        let values = Values::fill(&mut buffer, [-1; MAX_VALUES]).expect("room");
        let samples = [0xff; CHUNK_SAMPLES * RecordedSample::BYTES];
        let info = ReplyBody::Info {
            min_version: u16::MAX,
            version: u16::MAX,
            firmware: text,
            build: text,
            board: text,
            record_capacity: u32::MAX,
        };
        let record = RecordInfo {
            test: text,
            samples: u32::MAX,
            first_index: i32::MIN,
            decimation: u16::MAX,
            pre_trigger: u16::MAX,
            complete: true,
            measured_period_ns: u32::MAX,
            mean_spool_raw: i16::MIN,
            crc32: u32::MAX,
        };
        let bodies = [
            info,
            ReplyBody::RecordInfo(record),
            ReplyBody::Chunk { first: u32::MAX, samples: &samples },
            ReplyBody::Config { first_id: u16::MAX, values },
            ReplyBody::Rows { first: u32::MAX, rows: &[0xff; MAX_ROWS * StreamedSample::BYTES] },
            ReplyBody::Refused(Refused::Inconsistent { advice: text }),
        ];
        for body in bodies {
            let reply = Reply { sequence: u16::MAX, body };
            let mut accumulator = Accumulator::new();
            assert_eq!(decode_reply(carried(&reply, &mut accumulator)), Ok(reply));
        }
    }

    #[test]
    fn a_message_above_the_largest_is_not_encoded() {
        let reply = Reply { sequence: 1, body: ReplyBody::Chunk { first: 0, samples: &[0; MAX_MESSAGE] } };
        assert_eq!(encode(&reply, &mut [0; 2 * MAX_FRAME]), None);
        let request = Request { sequence: 1, body: RequestBody::Info };
        assert_eq!(encode(&request, &mut [0; 4]), None);
    }

    #[test]
    fn a_request_of_a_later_version_tells_its_sequence_number() {
        // 300 as a varint, then a variant that version 1 does not have.
        let later = [0xac, 0x02, 0x7f, 1, 2, 3];
        assert_eq!(decode_request(&later), Err(MessageError { sequence: Some(300) }));
        assert_eq!(decode_reply(&later), Err(MessageError { sequence: Some(300) }));
        assert_eq!(decode_request(&later[..2]), Err(MessageError { sequence: Some(300) }), "no body");
        assert_eq!(decode_request(&later[..1]), Err(MessageError { sequence: None }));
        assert_eq!(decode_request(&[]), Err(MessageError { sequence: None }));
        assert_eq!(decode_request(&[0xff; 8]), Err(MessageError { sequence: None }), "no u16");
    }

    #[test]
    fn what_a_later_version_appends_is_skipped() {
        let arm = Request { sequence: 7, body: RequestBody::Arm };
        assert_eq!(decode_request(&[7, 4]), Ok(arm));
        assert_eq!(decode_request(&[7, 4, 0xff, 0xff]), Ok(arm));
    }

    #[test]
    fn values_that_are_not_whole_are_no_message() {
        let refused = Err(MessageError { sequence: Some(7) });
        assert!(decode_request(&[7, 3, 1, 4, 1, 2, 3, 4]).is_ok());
        assert_eq!(decode_request(&[7, 3, 1, 3, 1, 2, 3]), refused);
        assert_eq!(decode_request(&[7, 3, 1, 4, 1, 2, 3]), refused, "more announced than there is");
    }
}
