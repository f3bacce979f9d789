//! The bytes of version 1, as a peer of version 1 sends and expects them.
//!
//! DO NOT CHANGE THIS TEST. If it fails, the protocol was broken: append instead, and put what is
//! new into a file of its own. The bytes were worked out apart from the crate (by a script that
//! writes varints, CRC-32 and COBS by their definitions).

use pneudrive_protocol::{
    Accumulator, MAX_FRAME, Mode, RecordInfo, RecordedSample, Refused, Reply, ReplyBody, Request,
    RequestBody, Status, Values, decode_reply, decode_request, encode,
};

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
    crc32: 0xcbf4_3926,
};

const SAMPLES: [RecordedSample; 2] = [
    RecordedSample {
        position: 8192,
        pressure_1: 1638,
        pressure_2: 2412,
        command: -2048,
        error: -1,
        spool: 2047,
    },
    RecordedSample { position: -1, pressure_1: 0, pressure_2: 1, command: 2, error: 3, spool: 4 },
];

fn values(bytes: &[u8]) -> Values<'_> {
    Values::new(bytes).expect("whole values")
}

/// The message in a frame.
fn unframed(frame: &[u8]) -> Vec<u8> {
    let mut accumulator: Accumulator = Accumulator::new();
    let (delimiter, before) = frame.split_last().expect("a frame");
    for &byte in before {
        assert_eq!(accumulator.push(byte), None);
    }
    accumulator.push(*delimiter).expect("a frame").expect("whole").to_vec()
}

fn assert_request(request: Request<'_>, message: &[u8], frame: &[u8]) {
    assert_eq!(encode(&request, &mut [0; MAX_FRAME]), Some(frame));
    assert_eq!(unframed(frame), message);
    assert_eq!(decode_request(message), Ok(request));
}

fn assert_reply(reply: Reply<'_>, message: &[u8], frame: &[u8]) {
    assert_eq!(encode(&reply, &mut [0; MAX_FRAME]), Some(frame));
    assert_eq!(unframed(frame), message);
    assert_eq!(decode_reply(message), Ok(reply));
}

#[test]
fn request_info() {
    let request = Request { sequence: 0, body: RequestBody::Info };
    #[rustfmt::skip]
    let message = [
        0x00, // sequence 0
        0x00, // RequestBody::Info
    ];
    #[rustfmt::skip]
    let frame = [
        0x01, 0x01, 0x05, 0xff, 0x12, 0xd9, 0x41, 0x00,
    ];
    assert_request(request, &message, &frame);
}

#[test]
fn request_status() {
    let request = Request { sequence: 1, body: RequestBody::Status };
    #[rustfmt::skip]
    let message = [
        0x01, // sequence 1
        0x01, // RequestBody::Status
    ];
    #[rustfmt::skip]
    let frame = [
        0x07, 0x01, 0x01, 0x28, 0x13, 0xc5, 0x2f, 0x00,
    ];
    assert_request(request, &message, &frame);
}

#[test]
fn request_config_get() {
    let request = Request { sequence: 127, body: RequestBody::ConfigGet { first_id: 256, count: 64 } };
    #[rustfmt::skip]
    let message = [
        0x7f, // sequence 127
        0x02, // RequestBody::ConfigGet
        0x80, 0x02, // first_id 256
        0x40, // count 64
    ];
    #[rustfmt::skip]
    let frame = [
        0x0a, 0x7f, 0x02, 0x80, 0x02, 0x40, 0x1a, 0x70, 0x76, 0xb2, 0x00,
    ];
    assert_request(request, &message, &frame);
}

#[test]
fn request_config_set() {
    let request =
        Request { sequence: 128, body: RequestBody::ConfigSet { first_id: 2, values: values(&VALUES) } };
    #[rustfmt::skip]
    let message = [
        0x80, 0x01, // sequence 128
        0x03, // RequestBody::ConfigSet
        0x02, // first_id 2
        0x0c, // values: 12 bytes
        0xf4, 0x01, 0x00, 0x00, // 500
        0x07, 0xff, 0xff, 0xff, // -249
        0x00, 0x00, 0x00, 0x80, // the smallest i32
    ];
    #[rustfmt::skip]
    let frame = [
        0x08, 0x80, 0x01, 0x03, 0x02, 0x0c, 0xf4, 0x01, 0x01, 0x05, 0x07, 0xff, 0xff, 0xff, 0x01, 0x01,
        0x06, 0x80, 0x09, 0x1a, 0x4c, 0x6a, 0x00,
    ];
    assert_request(request, &message, &frame);
}

#[test]
fn request_arm() {
    let request = Request { sequence: 300, body: RequestBody::Arm };
    #[rustfmt::skip]
    let message = [
        0xac, 0x02, // sequence 300
        0x04, // RequestBody::Arm
    ];
    #[rustfmt::skip]
    let frame = [
        0x08, 0xac, 0x02, 0x04, 0x8d, 0xdb, 0x78, 0x1a, 0x00,
    ];
    assert_request(request, &message, &frame);
}

#[test]
fn request_disarm() {
    let request = Request { sequence: 16383, body: RequestBody::Disarm };
    #[rustfmt::skip]
    let message = [
        0xff, 0x7f, // sequence 16383
        0x05, // RequestBody::Disarm
    ];
    #[rustfmt::skip]
    let frame = [
        0x08, 0xff, 0x7f, 0x05, 0x49, 0x7c, 0x14, 0x99, 0x00,
    ];
    assert_request(request, &message, &frame);
}

#[test]
fn request_start() {
    let request = Request { sequence: 16384, body: RequestBody::Start };
    #[rustfmt::skip]
    let message = [
        0x80, 0x80, 0x01, // sequence 16384
        0x06, // RequestBody::Start
    ];
    #[rustfmt::skip]
    let frame = [
        0x09, 0x80, 0x80, 0x01, 0x06, 0xd3, 0xe6, 0x50, 0xdd, 0x00,
    ];
    assert_request(request, &message, &frame);
}

#[test]
fn request_stop() {
    let request = Request { sequence: 65535, body: RequestBody::Stop };
    #[rustfmt::skip]
    let message = [
        0xff, 0xff, 0x03, // sequence 65535
        0x07, // RequestBody::Stop
    ];
    #[rustfmt::skip]
    let frame = [
        0x09, 0xff, 0xff, 0x03, 0x07, 0x60, 0x2b, 0x90, 0xf4, 0x00,
    ];
    assert_request(request, &message, &frame);
}

#[test]
fn request_reference() {
    let request = Request { sequence: 8, body: RequestBody::Reference { position_counts: -8192 } };
    #[rustfmt::skip]
    let message = [
        0x08, // sequence 8
        0x08, // RequestBody::Reference
        0xff, 0x7f, // position_counts -8192
    ];
    #[rustfmt::skip]
    let frame = [
        0x09, 0x08, 0x08, 0xff, 0x7f, 0x94, 0x37, 0x7d, 0xb9, 0x00,
    ];
    assert_request(request, &message, &frame);
}

#[test]
fn request_test_begin() {
    let request = Request {
        sequence: 9,
        body: RequestBody::TestBegin {
            name: "step",
            duration_us: 2_000_000,
            decimation: 1,
            pre_trigger: 200,
        },
    };
    #[rustfmt::skip]
    let message = [
        0x09, // sequence 9
        0x09, // RequestBody::TestBegin
        0x04, 0x73, 0x74, 0x65, 0x70, // name "step"
        0x80, 0x89, 0x7a, // duration_us 2000000
        0x01, // decimation 1
        0xc8, 0x01, // pre_trigger 200
    ];
    #[rustfmt::skip]
    let frame = [
        0x12, 0x09, 0x09, 0x04, 0x73, 0x74, 0x65, 0x70, 0x80, 0x89, 0x7a, 0x01, 0xc8, 0x01, 0xeb, 0x56,
        0xe1, 0xb2, 0x00,
    ];
    assert_request(request, &message, &frame);
}

#[test]
fn request_test_move() {
    let request = Request { sequence: 10, body: RequestBody::TestMove { time_us: 100_000, target: 16_384 } };
    #[rustfmt::skip]
    let message = [
        0x0a, // sequence 10
        0x0a, // RequestBody::TestMove
        0xa0, 0x8d, 0x06, // time_us 100000
        0x80, 0x80, 0x02, // target 16384
    ];
    #[rustfmt::skip]
    let frame = [
        0x0d, 0x0a, 0x0a, 0xa0, 0x8d, 0x06, 0x80, 0x80, 0x02, 0x19, 0x44, 0x2b, 0x11, 0x00,
    ];
    assert_request(request, &message, &frame);
}

#[test]
fn request_record_info() {
    let request = Request { sequence: 11, body: RequestBody::RecordInfo };
    #[rustfmt::skip]
    let message = [
        0x0b, // sequence 11
        0x0b, // RequestBody::RecordInfo
    ];
    #[rustfmt::skip]
    let frame = [
        0x07, 0x0b, 0x0b, 0xbc, 0x12, 0xff, 0x35, 0x00,
    ];
    assert_request(request, &message, &frame);
}

#[test]
fn request_record_read() {
    let request = Request { sequence: 12, body: RequestBody::RecordRead { first: 4096, count: 32 } };
    #[rustfmt::skip]
    let message = [
        0x0c, // sequence 12
        0x0c, // RequestBody::RecordRead
        0x80, 0x20, // first 4096
        0x20, // count 32
    ];
    #[rustfmt::skip]
    let frame = [
        0x0a, 0x0c, 0x0c, 0x80, 0x20, 0x20, 0x4e, 0xba, 0xdb, 0x06, 0x00,
    ];
    assert_request(request, &message, &frame);
}

#[test]
fn reply_info() {
    let reply = Reply {
        sequence: 0,
        body: ReplyBody::Info {
            min_version: 1,
            version: 1,
            firmware: "0.1.0",
            build: "a1b2c3d",
            board: "nucleo-f446",
            record_capacity: 4096,
        },
    };
    #[rustfmt::skip]
    let message = [
        0x00, // sequence 0
        0x00, // ReplyBody::Info
        0x01, // min_version 1
        0x01, // version 1
        0x05, 0x30, 0x2e, 0x31, 0x2e, 0x30, // firmware "0.1.0"
        0x07, 0x61, 0x31, 0x62, 0x32, 0x63, 0x33, 0x64, // build "a1b2c3d"
        0x0b, 0x6e, 0x75, 0x63, 0x6c, 0x65, 0x6f, 0x2d, 0x66, 0x34, 0x34, 0x36, // board "nucleo-f446"
        0x80, 0x20, // record_capacity 4096
    ];
    #[rustfmt::skip]
    let frame = [
        0x01, 0x01, 0x23, 0x01, 0x01, 0x05, 0x30, 0x2e, 0x31, 0x2e, 0x30, 0x07, 0x61, 0x31, 0x62, 0x32,
        0x63, 0x33, 0x64, 0x0b, 0x6e, 0x75, 0x63, 0x6c, 0x65, 0x6f, 0x2d, 0x66, 0x34, 0x34, 0x36, 0x80,
        0x20, 0x63, 0x7e, 0xd2, 0xaa, 0x00,
    ];
    assert_reply(reply, &message, &frame);
}

#[test]
fn reply_status() {
    let reply = Reply { sequence: 1, body: ReplyBody::Status(STATUS) };
    #[rustfmt::skip]
    let message = [
        0x01, // sequence 1
        0x01, // ReplyBody::Status
        0x04, // mode Fault
        0x03, // fault 3
        0x01, // referenced
        0xf0, 0xa2, 0x04, // index 70000
        0x82, 0x0c, // duration_samples 1538
        0x80, 0x80, 0x02, // setpoint 16384
        0x21, // position -17
        0xa2, 0x80, 0x02, // error 16401
        0xff, 0x1f, // command -2048
        0xcc, 0x19, // pressure_1 1638
        0xd8, 0x25, // pressure_2 2412
        0xfe, 0x1f, // spool 2047
        0x80, 0x08, // recorded 1024
        0xff, 0xff, 0xff, 0xff, 0x0f, // damaged_frames, the largest u32
    ];
    #[rustfmt::skip]
    let frame = [
        0x25, 0x01, 0x01, 0x04, 0x03, 0x01, 0xf0, 0xa2, 0x04, 0x82, 0x0c, 0x80, 0x80, 0x02, 0x21, 0xa2,
        0x80, 0x02, 0xff, 0x1f, 0xcc, 0x19, 0xd8, 0x25, 0xfe, 0x1f, 0x80, 0x08, 0xff, 0xff, 0xff, 0xff,
        0x0f, 0xd2, 0xbd, 0x5b, 0x57, 0x00,
    ];
    assert_reply(reply, &message, &frame);
}

#[test]
fn reply_config() {
    let reply = Reply { sequence: 128, body: ReplyBody::Config { first_id: 2, values: values(&VALUES) } };
    #[rustfmt::skip]
    let message = [
        0x80, 0x01, // sequence 128
        0x02, // ReplyBody::Config
        0x02, // first_id 2
        0x0c, // values: 12 bytes
        0xf4, 0x01, 0x00, 0x00, // 500
        0x07, 0xff, 0xff, 0xff, // -249
        0x00, 0x00, 0x00, 0x80, // the smallest i32
    ];
    #[rustfmt::skip]
    let frame = [
        0x08, 0x80, 0x01, 0x02, 0x02, 0x0c, 0xf4, 0x01, 0x01, 0x05, 0x07, 0xff, 0xff, 0xff, 0x01, 0x01,
        0x06, 0x80, 0xe1, 0xc1, 0xb7, 0xd3, 0x00,
    ];
    assert_reply(reply, &message, &frame);
}

#[test]
fn reply_done() {
    let reply = Reply { sequence: 65535, body: ReplyBody::Done };
    #[rustfmt::skip]
    let message = [
        0xff, 0xff, 0x03, // sequence 65535
        0x03, // ReplyBody::Done
    ];
    #[rustfmt::skip]
    let frame = [
        0x09, 0xff, 0xff, 0x03, 0x03, 0x79, 0xef, 0xfd, 0xf3, 0x00,
    ];
    assert_reply(reply, &message, &frame);
}

#[test]
fn reply_record_info() {
    let reply = Reply { sequence: 11, body: ReplyBody::RecordInfo(RECORD_INFO) };
    #[rustfmt::skip]
    let message = [
        0x0b, // sequence 11
        0x04, // ReplyBody::RecordInfo
        0x04, 0x73, 0x74, 0x65, 0x70, // test "step"
        0xca, 0x0d, // samples 1738
        0x8f, 0x03, // first_index -200
        0x01, // decimation 1
        0xc8, 0x01, // pre_trigger 200
        0x01, // complete
        0xad, 0xac, 0x4f, // measured_period_ns 1300013
        0x86, 0x20, // mean_spool_raw 2051
        0xa6, 0xf2, 0xd0, 0xdf, 0x0c, // crc32 0xcbf43926
    ];
    #[rustfmt::skip]
    let frame = [
        0x1e, 0x0b, 0x04, 0x04, 0x73, 0x74, 0x65, 0x70, 0xca, 0x0d, 0x8f, 0x03, 0x01, 0xc8, 0x01, 0x01,
        0xad, 0xac, 0x4f, 0x86, 0x20, 0xa6, 0xf2, 0xd0, 0xdf, 0x0c, 0xdc, 0x56, 0x58, 0x49, 0x00,
    ];
    assert_reply(reply, &message, &frame);
}

#[test]
fn reply_chunk() {
    let samples = SAMPLES.map(|sample| sample.to_bytes());
    let reply =
        Reply { sequence: 12, body: ReplyBody::Chunk { first: 4096, samples: samples.as_flattened() } };
    #[rustfmt::skip]
    let message = [
        0x0c, // sequence 12
        0x05, // ReplyBody::Chunk
        0x80, 0x20, // first 4096
        0x1c, // samples: 28 bytes
        0x00, 0x20, 0x00, 0x00, // position 8192
        0x66, 0x06, // pressure_1 1638
        0x6c, 0x09, // pressure_2 2412
        0x00, 0xf8, // command -2048
        0xff, 0xff, // error -1
        0xff, 0x07, // spool 2047
        0xff, 0xff, 0xff, 0xff, 0x00, 0x00, 0x01, 0x00, 0x02, 0x00, 0x03, 0x00, 0x04, 0x00, // the second sample likewise: -1, 0, 1, 2, 3, 4
    ];
    #[rustfmt::skip]
    let frame = [
        0x06, 0x0c, 0x05, 0x80, 0x20, 0x1c, 0x02, 0x20, 0x01, 0x05, 0x66, 0x06, 0x6c, 0x09, 0x0a, 0xf8,
        0xff, 0xff, 0xff, 0x07, 0xff, 0xff, 0xff, 0xff, 0x01, 0x02, 0x01, 0x02, 0x02, 0x02, 0x03, 0x02,
        0x04, 0x05, 0xcb, 0xc7, 0xa9, 0xc4, 0x00,
    ];
    assert_reply(reply, &message, &frame);
}

#[test]
fn refused_not_now() {
    let reply = Reply { sequence: 20, body: ReplyBody::Refused(Refused::NotNow(3)) };
    #[rustfmt::skip]
    let message = [
        0x14, // sequence 20
        0x06, // ReplyBody::Refused
        0x00, // Refused::NotNow
        0x03, // the controller's refusal 3
    ];
    #[rustfmt::skip]
    let frame = [
        0x03, 0x14, 0x06, 0x06, 0x03, 0xdc, 0x32, 0xbb, 0x63, 0x00,
    ];
    assert_reply(reply, &message, &frame);
}

#[test]
fn refused_unknown_parameter() {
    let reply = Reply { sequence: 21, body: ReplyBody::Refused(Refused::UnknownParameter { id: 600 }) };
    #[rustfmt::skip]
    let message = [
        0x15, // sequence 21
        0x06, // ReplyBody::Refused
        0x01, // Refused::UnknownParameter
        0xd8, 0x04, // id 600
    ];
    #[rustfmt::skip]
    let frame = [
        0x0a, 0x15, 0x06, 0x01, 0xd8, 0x04, 0x0a, 0x51, 0x07, 0x04, 0x00,
    ];
    assert_reply(reply, &message, &frame);
}

#[test]
fn refused_out_of_range() {
    let reply =
        Reply { sequence: 22, body: ReplyBody::Refused(Refused::OutOfRange { id: 2, value: 100_000 }) };
    #[rustfmt::skip]
    let message = [
        0x16, // sequence 22
        0x06, // ReplyBody::Refused
        0x02, // Refused::OutOfRange
        0x02, // id 2
        0xc0, 0x9a, 0x0c, // value 100000
    ];
    #[rustfmt::skip]
    let frame = [
        0x0c, 0x16, 0x06, 0x02, 0x02, 0xc0, 0x9a, 0x0c, 0x87, 0xb6, 0x45, 0x8c, 0x00,
    ];
    assert_reply(reply, &message, &frame);
}

#[test]
fn refused_inconsistent() {
    let reply = Reply { sequence: 23, body: ReplyBody::Refused(Refused::Inconsistent { advice: "swap" }) };
    #[rustfmt::skip]
    let message = [
        0x17, // sequence 23
        0x06, // ReplyBody::Refused
        0x03, // Refused::Inconsistent
        0x04, 0x73, 0x77, 0x61, 0x70, // advice "swap"
    ];
    #[rustfmt::skip]
    let frame = [
        0x0d, 0x17, 0x06, 0x03, 0x04, 0x73, 0x77, 0x61, 0x70, 0x72, 0x5c, 0x4f, 0x07, 0x00,
    ];
    assert_reply(reply, &message, &frame);
}

#[test]
fn refused_test_too_long() {
    let reply = Reply { sequence: 24, body: ReplyBody::Refused(Refused::TestTooLong) };
    #[rustfmt::skip]
    let message = [
        0x18, // sequence 24
        0x06, // ReplyBody::Refused
        0x04, // Refused::TestTooLong
    ];
    #[rustfmt::skip]
    let frame = [
        0x08, 0x18, 0x06, 0x04, 0x45, 0x48, 0x43, 0xbc, 0x00,
    ];
    assert_reply(reply, &message, &frame);
}

#[test]
fn refused_moves_out_of_order() {
    let reply = Reply { sequence: 25, body: ReplyBody::Refused(Refused::MovesOutOfOrder) };
    #[rustfmt::skip]
    let message = [
        0x19, // sequence 25
        0x06, // ReplyBody::Refused
        0x05, // Refused::MovesOutOfOrder
    ];
    #[rustfmt::skip]
    let frame = [
        0x08, 0x19, 0x06, 0x05, 0xe4, 0x12, 0x86, 0xca, 0x00,
    ];
    assert_reply(reply, &message, &frame);
}

#[test]
fn refused_too_many_moves() {
    let reply = Reply { sequence: 26, body: ReplyBody::Refused(Refused::TooManyMoves) };
    #[rustfmt::skip]
    let message = [
        0x1a, // sequence 26
        0x06, // ReplyBody::Refused
        0x06, // Refused::TooManyMoves
    ];
    #[rustfmt::skip]
    let frame = [
        0x08, 0x1a, 0x06, 0x06, 0x07, 0xfd, 0xc9, 0x51, 0x00,
    ];
    assert_reply(reply, &message, &frame);
}

#[test]
fn refused_no_record() {
    let reply = Reply { sequence: 27, body: ReplyBody::Refused(Refused::NoRecord) };
    #[rustfmt::skip]
    let message = [
        0x1b, // sequence 27
        0x06, // ReplyBody::Refused
        0x07, // Refused::NoRecord
    ];
    #[rustfmt::skip]
    let frame = [
        0x08, 0x1b, 0x06, 0x07, 0xa6, 0xa7, 0x0c, 0x27, 0x00,
    ];
    assert_reply(reply, &message, &frame);
}

#[test]
fn refused_record_range() {
    let reply = Reply { sequence: 28, body: ReplyBody::Refused(Refused::RecordRange { samples: 1738 }) };
    #[rustfmt::skip]
    let message = [
        0x1c, // sequence 28
        0x06, // ReplyBody::Refused
        0x08, // Refused::RecordRange
        0xca, 0x0d, // samples 1738
    ];
    #[rustfmt::skip]
    let frame = [
        0x0a, 0x1c, 0x06, 0x08, 0xca, 0x0d, 0x83, 0xc0, 0xee, 0x07, 0x00,
    ];
    assert_reply(reply, &message, &frame);
}

#[test]
fn refused_unknown() {
    let reply = Reply { sequence: 29, body: ReplyBody::Refused(Refused::Unknown) };
    #[rustfmt::skip]
    let message = [
        0x1d, // sequence 29
        0x06, // ReplyBody::Refused
        0x09, // Refused::Unknown
    ];
    #[rustfmt::skip]
    let frame = [
        0x08, 0x1d, 0x06, 0x09, 0x13, 0xf6, 0x39, 0xc4, 0x00,
    ];
    assert_reply(reply, &message, &frame);
}

#[test]
fn the_modes_have_their_numbers() {
    let modes = [
        (Mode::Disarmed, 0x00),
        (Mode::Armed, 0x01),
        (Mode::Running, 0x02),
        (Mode::Done, 0x03),
        (Mode::Fault, 0x04),
    ];
    for (mode, number) in modes {
        let reply = Reply { sequence: 1, body: ReplyBody::Status(Status { mode, ..Status::default() }) };
        let frame = encode(&reply, &mut [0; MAX_FRAME]).expect("fits").to_vec();
        assert_eq!(unframed(&frame), [0x01, 0x01, number, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
    }
}

#[test]
fn the_sizes_of_version_1() {
    assert_eq!(pneudrive_protocol::MIN_VERSION, 1, "version 1 is still spoken");
    assert_eq!(pneudrive_protocol::MAX_MESSAGE, 512);
    assert_eq!(MAX_FRAME, 520);
    assert_eq!((pneudrive_protocol::MAX_VALUES, pneudrive_protocol::CHUNK_SAMPLES), (64, 32));
    assert_eq!(RecordedSample::BYTES, 14);
}
