//! The bytes of every message, as a peer of version 1 sends and expects them.
//!
//! WHAT STANDS HERE DOES NOT CHANGE. If a test fails, a rig or a program that somebody has would no longer be understood: take
//! the change back, and append instead. A new message, refusal, mode or entry of a change goes behind the last one of its enum,
//! and its bytes go behind the last line of its table here; a test counts them. Work the bytes out apart from the crate, by the
//! definitions of varint (LEB128, signed numbers zigzag), CRC-32 and COBS, as those here were.

use pneudrive_protocol::change::{Entries, Entry, PART_BYTES, start_crc32, test_crc32};
use pneudrive_protocol::io::{input, output, refused};
use pneudrive_protocol::profiled::NO_MOVE;
use pneudrive_protocol::session::{FIRST, INPUTS, NO_BOOT, NOBODY};
use pneudrive_protocol::{
    Accumulator, ConfigState, Event, MAX_FRAME, MAX_MESSAGE, Message, Mode, Motion, Owner, Presence,
    ProfiledMove, RecordInfo, RecordedSample, Reply, ReplyBody, Request, RequestBody, RequestRefusal, Spread,
    Status, StreamedSample, UNTIL_STOPPED, VERSION, Values, code, decode_reply, decode_request, encode,
};

const CRC32: u32 = 0xcbf43926;

/// 500, -249 and the smallest i32.
const VALUES: [u8; 12] = [0xf4, 0x01, 0x00, 0x00, 0x07, 0xff, 0xff, 0xff, 0x00, 0x00, 0x00, 0x80];

const STATUS: Status = Status {
    mode: Mode::Fault,
    fault: 3,
    referenced: true,
    index: 70_000,
    duration_samples: 1538,
    setpoint: 16_384,
    position: -17,
    error: 16_401,
    command: -2048,
    pressure_1: 1638,
    pressure_2: 2412,
    spool: 2047,
    recorded: 1024,
    damaged_frames: u32::MAX,
};

const RECORD_INFO: RecordInfo<'_> = RecordInfo {
    test: "step",
    samples: 1738,
    first_index: -200,
    decimation: 1,
    pre_trigger: 200,
    complete: true,
    measured_period_ns: 1_300_013,
    mean_spool_raw: 2051,
    crc32: CRC32,
};

const SAMPLE: RecordedSample = RecordedSample {
    position: -17,
    pressure_1: 1638,
    pressure_2: 2412,
    command: -2048,
    error: -1,
    spool: 2047,
};

const MOTION: Motion = Motion { arrival: 2, begun: 3, not_reached: 70_000, learned_null_offset: -5 };

const CONFIG_STATE: ConfigState = ConfigState { source: 2, saves: 9, hash: CRC32, saved: true, ignored: 4 };

const EVENT: Event = Event { number: 9, boot: 3, time_us: 1 << 40, index: 70_000, position: -17, code: 7 };

const INTERVAL: Spread =
    Spread { count: 9, least_us: 1297, most_us: 70_000, bins: [2, 2, 2, 1, 0, 0, 0, 0, 0, 0, 0, 2] };

const LATENCY: Spread =
    Spread { count: 8, least_us: 500, most_us: 503, bins: [7, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0] };

const OWNER: Owner<'_> = Owner { presence: Presence::Gone, session: 0xfeed_beef, silent_ms: 700, host: "pc" };

const MOVE: ProfiledMove =
    ProfiledMove { at_sample: 231, target: -5, kind: 1, numbers: [300, 50, 7, 0, 0, 0] };

fn frame_of(message: &impl Message) -> Vec<u8> {
    encode(message, &mut [0; MAX_FRAME]).expect("fits").to_vec()
}

/// The message in a frame.
fn message_of(message: &impl Message) -> Vec<u8> {
    let mut accumulator: Accumulator = Accumulator::new();
    let whole =
        frame_of(message).iter().find_map(|&byte| accumulator.push(byte).map(|all| all.map(<[u8]>::to_vec)));
    whole.expect("a frame").expect("whole")
}

/// Sequence 300, session 0xfeedbeef and boot 70,000 stand before the body of a request.
fn assert_request(body: RequestBody<'_>, bytes: &[u8]) {
    let request = Request { sequence: 300, session: 0xfeed_beef, boot: 70_000, body };
    let message = [&[0xac, 0x02, 0xef, 0xfd, 0xb6, 0xf7, 0x0f, 0xf0, 0xa2, 0x04][..], bytes].concat();
    assert_eq!(message_of(&request), message);
    assert_eq!(decode_request(&message), Ok(request));
}

/// Sequence 300 stands before the body of a reply.
fn assert_reply(body: ReplyBody<'_>, bytes: &[u8]) {
    let reply = Reply { sequence: 300, body };
    let message = [&[0xac, 0x02][..], bytes].concat();
    assert_eq!(message_of(&reply), message);
    assert_eq!(decode_reply(&message), Ok(reply));
}

fn assert_refused(refused: RequestRefusal<'_>, bytes: &[u8]) {
    assert_reply(ReplyBody::Refused(refused), &[&[0x06], bytes].concat());
}

fn assert_entry(entry: Entry<'_>, bytes: &[u8]) {
    assert_eq!(entry.write(&mut [0; PART_BYTES]), Some(bytes));
    assert!(Entries::of(bytes).eq([Ok(entry)]));
}

#[test]
#[rustfmt::skip]
fn frames() {
    let first = Request { sequence: 0, session: FIRST, boot: NO_BOOT, body: RequestBody::Info };
    assert_eq!(frame_of(&first), [0x01, 0x03, 0x80, 0x01, 0x01, 0x05, 0x11, 0x2b, 0xb9, 0x2a, 0x00]);
    let home = Request { sequence: 300, session: 0xfeed_beef, boot: 70_000, body: RequestBody::Home };
    assert_eq!(frame_of(&home), [0x10, 0xac, 0x02, 0xef, 0xfd, 0xb6, 0xf7, 0x0f, 0xf0, 0xa2, 0x04, 0x0b, 0x30, 0x41, 0xb2, 0x73, 0x00]);
    let status = Reply { sequence: 300, body: ReplyBody::Status(STATUS) };
    assert_eq!(frame_of(&status),
        [0x26, 0xac, 0x02, 0x01, 0x05, 0x03, 0x01, 0xf0, 0xa2, 0x04, 0x82, 0x0c, 0x80, 0x80, 0x02, 0x21, 0xa2, 0x80, 0x02, 0xff, 0x1f, 0xcc, 0x19, 0xd8, 0x25, 0xfe, 0x1f, 0x80, 0x08, 0xff, 0xff, 0xff, 0xff, 0x0f, 0xa0, 0xf8, 0x77, 0x66, 0x00]);
    let timing = Reply { sequence: 300, body: ReplyBody::Timing { interval: INTERVAL, latency: LATENCY } };
    assert_eq!(frame_of(&timing),
        [0x0e, 0xac, 0x02, 0x0a, 0x09, 0x91, 0x0a, 0xf0, 0xa2, 0x04, 0x02, 0x02, 0x02, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x08, 0x02, 0x08, 0xf4, 0x03, 0xf7, 0x03, 0x07, 0x02, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x05, 0x9f, 0x84, 0xf5, 0xfc, 0x00]);
    assert_eq!((VERSION, MAX_MESSAGE, MAX_FRAME), (1, 512, 520));
}

#[test]
#[rustfmt::skip]
fn requests() {
    assert_request(RequestBody::Info,
        &[0x00]);
    assert_request(RequestBody::Status,
        &[0x01]);
    assert_request(RequestBody::ConfigGet { first_id: 256, count: 64 },
        &[0x02, 0x80, 0x02, 0x40]);
    assert_request(RequestBody::ConfigSet { first_id: 2, values: Values::new(&VALUES).expect("whole") },
        &[0x03, 0x02, 0x0c, 0xf4, 0x01, 0x00, 0x00, 0x07, 0xff, 0xff, 0xff, 0x00, 0x00, 0x00, 0x80]);
    assert_request(RequestBody::Arm { host: "pc" },
        &[0x04, 0x02, 0x70, 0x63]);
    assert_request(RequestBody::Disarm,
        &[0x05]);
    assert_request(RequestBody::Start { crc32: CRC32 },
        &[0x06, 0xa6, 0xf2, 0xd0, 0xdf, 0x0c]);
    assert_request(RequestBody::Stop,
        &[0x07]);
    assert_request(RequestBody::Reference { position_counts: -8192 },
        &[0x08, 0xff, 0x7f]);
    assert_request(RequestBody::RecordInfo,
        &[0x09]);
    assert_request(RequestBody::RecordRead { crc32: CRC32, first: 4352, count: 32 },
        &[0x0a, 0xa6, 0xf2, 0xd0, 0xdf, 0x0c, 0x80, 0x22, 0x20]);
    assert_request(RequestBody::Home,
        &[0x0b]);
    assert_request(RequestBody::Motion,
        &[0x0c]);
    assert_request(RequestBody::ConfigSave,
        &[0x0d]);
    assert_request(RequestBody::ConfigState,
        &[0x0e]);
    assert_request(RequestBody::Events { first: 2, count: 16 },
        &[0x0f, 0x02, 0x10]);
    assert_request(RequestBody::Timing,
        &[0x10]);
    assert_request(RequestBody::StreamBegin { every: 300, batch: 24 },
        &[0x11, 0xac, 0x02, 0x18]);
    assert_request(RequestBody::StreamGrant { until: 70_000 },
        &[0x12, 0xf0, 0xa2, 0x04]);
    assert_request(RequestBody::StreamRead { first: 70_000, count: 24 },
        &[0x13, 0xf0, 0xa2, 0x04, 0x18]);
    assert_request(RequestBody::TakeOver { host: "pc" },
        &[0x14, 0x02, 0x70, 0x63]);
    assert_request(RequestBody::Leave,
        &[0x15]);
    assert_request(RequestBody::Owner,
        &[0x16]);
    assert_request(RequestBody::ChangePart { crc32: CRC32, first: 448, part: &[2, 0, 0x7f] },
        &[0x17, 0xa6, 0xf2, 0xd0, 0xdf, 0x0c, 0xc0, 0x03, 0x03, 0x02, 0x00, 0x7f]);
    assert_request(RequestBody::ChangeTake { crc32: CRC32 },
        &[0x18, 0xa6, 0xf2, 0xd0, 0xdf, 0x0c]);
    assert_request(RequestBody::Token { token: "secret" },
        &[0x19, 0x06, 0x73, 0x65, 0x63, 0x72, 0x65, 0x74]);
    assert_request(RequestBody::Boot,
        &[0x1a]);
    assert_request(RequestBody::SeekNull,
        &[0x1b]);
    assert_request(RequestBody::AtNull,
        &[0x1c]);
    assert_request(RequestBody::TestRead { first: 9 },
        &[0x1d, 0x09]);
    assert_request(RequestBody::MoveRecordsRead { first: 9 },
        &[0x1e, 0x09]);
    assert_request(RequestBody::Io,
        &[0x1f]);
    assert_request(RequestBody::IoSet { inputs: 0xd3 },
        &[0x20, 0xd3]);
    assert_request(RequestBody::TryWatchdog,
        &[0x21]);
}

#[test]
#[rustfmt::skip]
fn replies() {
    assert_reply(ReplyBody::Info { version: 1, firmware: "0.1.0", build: "a1b2c3d", board: "nucleo", record_capacity: 4096 },
        &[0x00, 0x01, 0x05, 0x30, 0x2e, 0x31, 0x2e, 0x30, 0x07, 0x61, 0x31, 0x62, 0x32, 0x63, 0x33, 0x64, 0x06, 0x6e, 0x75, 0x63, 0x6c, 0x65, 0x6f, 0x80, 0x20]);
    assert_reply(ReplyBody::Status(STATUS),
        &[0x01, 0x05, 0x03, 0x01, 0xf0, 0xa2, 0x04, 0x82, 0x0c, 0x80, 0x80, 0x02, 0x21, 0xa2, 0x80, 0x02, 0xff, 0x1f, 0xcc, 0x19, 0xd8, 0x25, 0xfe, 0x1f, 0x80, 0x08, 0xff, 0xff, 0xff, 0xff, 0x0f]);
    assert_reply(ReplyBody::Config { first_id: 2, values: Values::new(&VALUES).expect("whole") },
        &[0x02, 0x02, 0x0c, 0xf4, 0x01, 0x00, 0x00, 0x07, 0xff, 0xff, 0xff, 0x00, 0x00, 0x00, 0x80]);
    assert_reply(ReplyBody::Done,
        &[0x03]);
    assert_reply(ReplyBody::RecordInfo(RECORD_INFO),
        &[0x04, 0x04, 0x73, 0x74, 0x65, 0x70, 0xca, 0x0d, 0x8f, 0x03, 0x01, 0xc8, 0x01, 0x01, 0xad, 0xac, 0x4f, 0x86, 0x20, 0xa6, 0xf2, 0xd0, 0xdf, 0x0c]);
    assert_reply(ReplyBody::Chunk { first: 4096, samples: &SAMPLE.to_bytes() },
        &[0x05, 0x80, 0x20, 0x0e, 0xef, 0xff, 0xff, 0xff, 0x66, 0x06, 0x6c, 0x09, 0x00, 0xf8, 0xff, 0xff, 0xff, 0x07]);
    assert_reply(ReplyBody::Refused(RequestRefusal::NotNow(3)),
        &[0x06, 0x00, 0x03]);
    assert_reply(ReplyBody::Motion(MOTION),
        &[0x07, 0x02, 0x03, 0xf0, 0xa2, 0x04, 0x09]);
    assert_reply(ReplyBody::ConfigState(CONFIG_STATE),
        &[0x08, 0x02, 0x09, 0xa6, 0xf2, 0xd0, 0xdf, 0x0c, 0x01, 0x04]);
    assert_reply(ReplyBody::Events { total: 5, first: 2, events: &EVENT.to_bytes() },
        &[0x09, 0x05, 0x02, 0x19, 0x09, 0x00, 0x00, 0x00, 0x03, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x70, 0x11, 0x01, 0x00, 0xef, 0xff, 0xff, 0xff, 0x07]);
    assert_reply(ReplyBody::Timing { interval: INTERVAL, latency: LATENCY },
        &[0x0a, 0x09, 0x91, 0x0a, 0xf0, 0xa2, 0x04, 0x02, 0x02, 0x02, 0x01, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x02, 0x08, 0xf4, 0x03, 0xf7, 0x03, 0x07, 0x00, 0x01, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00]);
    assert_reply(ReplyBody::Rows { first: 70_000, rows: &StreamedSample { index: 70_000, sample: SAMPLE }.to_bytes() },
        &[0x0b, 0xf0, 0xa2, 0x04, 0x12, 0x70, 0x11, 0x01, 0x00, 0xef, 0xff, 0xff, 0xff, 0x66, 0x06, 0x6c, 0x09, 0x00, 0xf8, 0xff, 0xff, 0xff, 0x07]);
    assert_reply(ReplyBody::Owner(OWNER),
        &[0x0c, 0x02, 0xef, 0xfd, 0xb6, 0xf7, 0x0f, 0xbc, 0x05, 0x02, 0x70, 0x63]);
    assert_reply(ReplyBody::Boot { number: 70_000 },
        &[0x0d, 0xf0, 0xa2, 0x04]);
    assert_reply(ReplyBody::Test { last_sample: 3076, round: 0, total: 3, first: 2, moves: &MOVE.to_bytes() },
        &[0x0e, 0x84, 0x18, 0x00, 0x03, 0x02, 0x21, 0xe7, 0x00, 0x00, 0x00, 0xfb, 0xff, 0xff, 0xff, 0x2c, 0x01, 0x00, 0x00, 0x32, 0x00, 0x00, 0x00, 0x07, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x01]);
    assert_reply(ReplyBody::MoveRecords { first: 9, records: &MOVE.to_bytes() },
        &[0x0f, 0x09, 0x21, 0xe7, 0x00, 0x00, 0x00, 0xfb, 0xff, 0xff, 0xff, 0x2c, 0x01, 0x00, 0x00, 0x32, 0x00, 0x00, 0x00, 0x07, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x01]);
    assert_reply(ReplyBody::Io { inputs: 0xd3, settled: 0xc3, outputs: 5, number: 3, refused: 160 },
        &[0x10, 0xd3, 0xc3, 0x05, 0x03, 0xa0]);
}

#[test]
#[rustfmt::skip]
fn refusals() {
    assert_refused(RequestRefusal::NotNow(3),
        &[0x00, 0x03]);
    assert_refused(RequestRefusal::UnknownParameter { id: 600 },
        &[0x01, 0xd8, 0x04]);
    assert_refused(RequestRefusal::OutOfRange { id: 2, value: 100_000 },
        &[0x02, 0x02, 0xc0, 0x9a, 0x0c]);
    assert_refused(RequestRefusal::Inconsistent { advice: "swap" },
        &[0x03, 0x04, 0x73, 0x77, 0x61, 0x70]);
    assert_refused(RequestRefusal::TestTooLong,
        &[0x04]);
    assert_refused(RequestRefusal::MovesOutOfOrder,
        &[0x05]);
    assert_refused(RequestRefusal::TooManyMoves,
        &[0x06]);
    assert_refused(RequestRefusal::NoRecord,
        &[0x07]);
    assert_refused(RequestRefusal::RecordRange { samples: 1738 },
        &[0x08, 0xca, 0x0d]);
    assert_refused(RequestRefusal::Unknown,
        &[0x09]);
    assert_refused(RequestRefusal::NotStored,
        &[0x0a]);
    assert_refused(RequestRefusal::OtherRecord,
        &[0x0b]);
    assert_refused(RequestRefusal::Owned(OWNER),
        &[0x0c, 0x02, 0xef, 0xfd, 0xb6, 0xf7, 0x0f, 0xbc, 0x05, 0x02, 0x70, 0x63]);
    assert_refused(RequestRefusal::ChangeNotWhole,
        &[0x0d]);
    assert_refused(RequestRefusal::OtherTest,
        &[0x0e]);
    assert_refused(RequestRefusal::OtherBoot { number: 4 },
        &[0x0f, 0x04]);
}

/// The first number that is not taken, which a message that is appended here takes away.
#[test]
fn every_message_stands_here() {
    let request =
        |variant| decode_request(&[&[0xac, 0x02, 0x80, 0x01, 0, variant][..], &[0; 64]].concat()).is_ok();
    let is_known = |body: [u8; 2]| decode_reply(&[&[0xac, 0x02], &body[..], &[0; 64]].concat()).is_ok();
    assert!(request(33) && !request(34), "requests");
    assert!(is_known([16, 0]) && !is_known([17, 0]), "replies");
    assert!(is_known([6, 15]) && !is_known([6, 16]), "refusals");
    assert!(is_known([1, 5]) && !is_known([1, 6]), "modes");
    assert!(is_known([12, 2]) && !is_known([12, 3]), "presences");
    let entry = |variant| Entries::of(&[variant, 0, 0, 0, 0, 0, 0]).next().expect("bytes").is_ok();
    assert!(entry(4) && !entry(5), "entries of a change");
}

/// What a change holds, and the numbers by which a start names its test and the parameters in force.
#[test]
#[rustfmt::skip]
fn entries_of_a_change() {
    assert_entry(Entry::Parameters { first_id: 2, values: Values::new(&VALUES).expect("whole") },
        &[0x00, 0x02, 0x0c, 0xf4, 0x01, 0x00, 0x00, 0x07, 0xff, 0xff, 0xff, 0x00, 0x00, 0x00, 0x80]);
    assert_entry(Entry::Test { name: "step", last_sample: UNTIL_STOPPED, round: 3077, decimation: 1, pre_trigger: 300 },
        &[0x01, 0x04, 0x73, 0x74, 0x65, 0x70, 0xfe, 0xff, 0xff, 0xff, 0x0f, 0x85, 0x18, 0x01, 0xac, 0x02]);
    assert_entry(Entry::Move { at_sample: 231, target: -5 },
        &[0x02, 0xe7, 0x01, 0x09]);
    assert_entry(Entry::Profile { bytes: &MOVE.to_bytes() },
        &[0x03, 0x21, 0xe7, 0x00, 0x00, 0x00, 0xfb, 0xff, 0xff, 0xff, 0x2c, 0x01, 0x00, 0x00, 0x32, 0x00, 0x00, 0x00, 0x07, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x01]);
    assert_entry(Entry::MoveRecord { number: 3, bytes: &MOVE.to_bytes() },
        &[0x04, 0x03, 0x21, 0xe7, 0x00, 0x00, 0x00, 0xfb, 0xff, 0xff, 0xff, 0x2c, 0x01, 0x00, 0x00, 0x32, 0x00, 0x00, 0x00, 0x07, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x01]);
    let change = [
        0x00, 0x02, 0x0c, 0xf4, 0x01, 0x00, 0x00, 0x07, 0xff, 0xff, 0xff, 0x00, 0x00, 0x00, 0x80, 0x01, 0x04, 0x73, 0x74, 0x65, 0x70, 0xfe, 0xff, 0xff, 0xff, 0x0f, 0x85, 0x18, 0x01, 0xac, 0x02, 0x02, 0xe7, 0x01, 0x09, 0x03, 0x21, 0xe7, 0x00, 0x00, 0x00, 0xfb, 0xff, 0xff, 0xff, 0x2c, 0x01, 0x00, 0x00, 0x32, 0x00, 0x00, 0x00, 0x07, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x01, 0x04, 0x03, 0x21, 0xe7, 0x00, 0x00, 0x00, 0xfb, 0xff, 0xff, 0xff, 0x2c, 0x01, 0x00, 0x00, 0x32, 0x00, 0x00, 0x00, 0x07, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x01,
    ];
    assert_eq!(test_crc32(&change), 0x4e742e0c);
    assert_eq!(start_crc32(test_crc32(&change), CRC32), 0x08fa3064);
}

#[test]
#[rustfmt::skip]
fn moves_as_bytes() {
    let wave = ProfiledMove { at_sample: 70_000, target: 8192, kind: 2, numbers: [0xffff_f63c, 3846, 0xb7c2_fea2, 3350, 0xffff_fff9, u32::MAX] };
    assert_eq!(wave.to_bytes(),
        [0x70, 0x11, 0x01, 0x00, 0x00, 0x20, 0x00, 0x00, 0x3c, 0xf6, 0xff, 0xff, 0x06, 0x0f, 0x00, 0x00, 0xa2, 0xfe, 0xc2, 0xb7, 0x16, 0x0d, 0x00, 0x00, 0xf9, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x02]);
    assert_eq!(ProfiledMove::from_bytes(&wave.to_bytes()), Some(wave));
    let none = ProfiledMove { kind: NO_MOVE, ..ProfiledMove::default() };
    assert_eq!(none.to_bytes()[32], 0xff);
}

#[test]
fn numbers_that_have_a_meaning() {
    let modes = [Mode::Disarmed, Mode::Armed, Mode::Homing, Mode::Running, Mode::Done, Mode::Fault];
    for (number, mode) in (0..).zip(modes) {
        let status = Status { mode, ..Status::default() };
        let message = message_of(&Reply { sequence: 1, body: ReplyBody::Status(status) });
        assert_eq!(message, [1, 1, number, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
    }
    for (number, presence) in (0..).zip([Presence::Nobody, Presence::There, Presence::Gone]) {
        let owner = Owner { presence, ..Owner::default() };
        assert_eq!(
            message_of(&Reply { sequence: 1, body: ReplyBody::Owner(owner) }),
            [1, 12, number, 0, 0, 0]
        );
    }
    assert_eq!((NOBODY, FIRST, INPUTS, NO_BOOT), (0, 128, u32::MAX, 0));
    assert_eq!([code::OWNED, code::TOKEN, code::HOST_WAS_SILENT], [128, 129, 130]);
    assert_eq!([code::INPUTS_ARE_PINS, code::NO_WATCHDOG, code::IN_FAULT], [131, 132, 133]);
    assert_eq!(
        [input::NUMBER, input::START, input::ACKNOWLEDGE, input::RUN, input::ENABLE],
        [15, 16, 32, 64, 128]
    );
    assert_eq!(input::HOMING, 15);
    assert_eq!([output::READY, output::IN_POSITION, output::FAULT, output::LAMP], [1, 2, 4, 8]);
    assert_eq!(
        [refused::NO_RECORD, refused::OPEN_LOOP, refused::FAULT, refused::UNSETTLED],
        [160, 161, 162, 163]
    );
}
