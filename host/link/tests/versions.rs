//! A PC and a rig of different versions: what works goes on, what does not is refused by name.

mod simulated_link;

use pneudrive_controller::Parameters;
use pneudrive_controller::parameters::{TABLE, id};
use pneudrive_protocol::{
    MAX_FRAME, Mode, Refused, Reply, ReplyBody, Request, RequestBody, UNTIL_STOPPED, decode_reply,
    decode_request, encode,
};
use pneudrive_records::target::TargetFile;
use pneudrive_sim::Rig;

use simulated_link::{Random, SimulatedRig, Simulation, any_samples};

/// `Info` as a firmware of version 1 answers it: the bytes of `wire_v01.rs` behind the sequence number.
const INFO_V1: [u8; 33] = [
    0x00, // ReplyBody::Info
    0x01, // min_version 1
    0x01, // version 1
    0x05, 0x30, 0x2e, 0x31, 0x2e, 0x30, // firmware "0.1.0"
    0x07, 0x61, 0x31, 0x62, 0x32, 0x63, 0x33, 0x64, // build "a1b2c3d"
    0x0b, 0x6e, 0x75, 0x63, 0x6c, 0x65, 0x6f, 0x2d, 0x66, 0x34, 0x34, 0x36, // board "nucleo-f446"
    0x80, 0x20, // record_capacity 4096
    0x00, 0x00, // and what a later version appends is skipped
];

/// The last scalar parameter of the first firmware.
const LAST_OF_V1: u16 = id::MAX_STEPS;

fn frame_of(sequence: u16, body: ReplyBody<'_>) -> Option<Vec<u8>> {
    let mut frame = [0; MAX_FRAME];
    Some(encode(&Reply { sequence, body }, &mut frame).expect("fits").to_vec())
}

fn info(sequence: u16, min_version: u16, version: u16) -> Option<Vec<u8>> {
    let (firmware, build, board) = ("pneudrive 0.0.9", "b", "old board");
    let info = ReplyBody::Info { min_version, version, firmware, build, board, record_capacity: 4389 };
    frame_of(sequence, info)
}

/// The version that a request came with.
fn version_of(body: &RequestBody<'_>) -> u16 {
    match body {
        RequestBody::TryWatchdog => 9,
        RequestBody::MoveRecordsRead { .. } | RequestBody::Io | RequestBody::IoSet { .. } => 8,
        RequestBody::TestRead { .. } => 7,
        RequestBody::Boot => 6,
        RequestBody::ArmAs { .. }
        | RequestBody::TakeOver { .. }
        | RequestBody::Leave
        | RequestBody::Owner => 5,
        RequestBody::TestSpan { .. } => 4,
        RequestBody::RecordChunk { .. }
        | RequestBody::StreamBegin { .. }
        | RequestBody::StreamGrant { .. }
        | RequestBody::StreamRead { .. } => 3,
        RequestBody::Home
        | RequestBody::Motion
        | RequestBody::ConfigSave
        | RequestBody::ConfigState
        | RequestBody::Events { .. }
        | RequestBody::Timing => 2,
        _ => 1,
    }
}

/// What a firmware of an older version, with scalar parameters up to `last`, does otherwise than the newest.
fn older(message: &[u8], version: u16, last: u16) -> Option<Vec<u8>> {
    let Request { sequence, body } = decode_request(message).expect("a request");
    if version_of(&body) > version {
        return frame_of(sequence, ReplyBody::Refused(Refused::Unknown));
    }
    match body {
        RequestBody::Info => info(sequence, 1, version),
        RequestBody::ConfigGet { first_id, count } => {
            let unknown = (first_id..first_id + u16::from(count)).find(|id| (last + 1..256).contains(id))?;
            frame_of(sequence, ReplyBody::Refused(Refused::UnknownParameter { id: unknown }))
        }
        RequestBody::ConfigSet { first_id, values } => {
            let ids = first_id..first_id + values.len() as u16;
            let unknown = ids.into_iter().find(|id| (last + 1..256).contains(id))?;
            frame_of(sequence, ReplyBody::Refused(Refused::UnknownParameter { id: unknown }))
        }
        _ => None,
    }
}

fn version_1(message: &[u8]) -> Option<Vec<u8>> {
    let Request { sequence, body } = decode_request(message).expect("a request");
    if body == RequestBody::Info {
        let number = match sequence {
            0..128 => vec![sequence as u8],
            128..16_384 => vec![sequence as u8 | 0x80, (sequence >> 7) as u8],
            _ => vec![sequence as u8 | 0x80, (sequence >> 7) as u8 | 0x80, (sequence >> 14) as u8],
        };
        let message = [&number[..], &INFO_V1].concat();
        return pneudrive_protocol::frame::encode(&message, &mut [0; MAX_FRAME]).map(<[u8]>::to_vec);
    }
    older(message, 1, LAST_OF_V1)
}

fn version_2(message: &[u8]) -> Option<Vec<u8>> {
    older(message, 2, id::HOMING_SWITCH)
}

fn version_3(message: &[u8]) -> Option<Vec<u8>> {
    older(message, 3, id::HOMING_SWITCH)
}

fn version_4(message: &[u8]) -> Option<Vec<u8>> {
    older(message, 4, id::HOMING_SWITCH)
}

fn version_5(message: &[u8]) -> Option<Vec<u8>> {
    older(message, 5, id::HOMING_SWITCH)
}

fn version_10(message: &[u8]) -> Option<Vec<u8>> {
    let Request { sequence, body } = decode_request(message).expect("a request");
    if body == RequestBody::Info { info(sequence, 1, 10) } else { None }
}

fn only_version_10(message: &[u8]) -> Option<Vec<u8>> {
    let Request { sequence, .. } = decode_request(message).expect("a request");
    info(sequence, 10, 10)
}

#[test]
fn the_record_of_an_older_rig_is_downloaded_and_its_file_names_the_parameters_that_it_has() {
    for (firmware, version, first_lacking) in
        [(version_1 as simulated_link::Older, 1, "dead_zone_counts"), (version_2, 2, "homing_command_counts")]
    {
        let samples = any_samples(&mut Random(7), 1000);
        let mut client =
            SimulatedRig::with_record(&samples).with_firmware(firmware).connect().expect("an answer");
        let info = client.info().expect("an answer");
        assert_eq!(info.version, version);
        let parameters = client.parameters().expect("those that it has");
        assert_eq!(parameters.values, Parameters::default());
        assert_eq!(parameters.lacking_names()[0], first_lacking);
        let record = client.record(|_, _| {}).expect("a record");
        assert_eq!(record.samples, samples);
        let file = TargetFile::new(&record, &info, &parameters).expect("counted");
        assert_eq!(file.get("param.period_us"), Some("1300"));
        assert_eq!(file.get(&format!("param.{first_lacking}")), None);
        assert_eq!(TargetFile::from_text(&file.to_text()).expect("whole"), file);
    }
}

#[test]
fn a_record_that_changes_while_an_older_rig_sends_it_is_found_out_at_the_end() {
    let [one, other] = [8, 9].map(|seed| any_samples(&mut Random(seed), 1000));
    let rig = SimulatedRig::with_record(&one).with_firmware(version_2);
    rig.change(|simulation| simulation.restarts_in(8000, &other));
    let error = rig.connect().expect("an answer").record(|_, _| {}).expect_err("of two runs");
    assert!(error.to_string().contains("the record changed while it was read"), "{error:#}");
}

fn version_6(message: &[u8]) -> Option<Vec<u8>> {
    older(message, 6, id::VELOCITY_FEED_FORWARD)
}

#[test]
fn a_rig_of_version_6_takes_no_profiles_and_does_not_tell_its_moves() {
    let mut client = SimulatedRig::with_record(&[]).with_firmware(version_6).connect().expect("an answer");
    assert_eq!(client.test().expect("nothing is asked"), None);
    let rig = |test: &str| Rig::read_with("rig.toml", test, &[]).expect("a rig");
    let curve = rig("[test]\nmoves = [[0.0, 8192], [3.0, 9000]]\nduration_s = 4.0\nprofile = \"s-curve\"\n");
    let refused = client.download_test(&curve).expect_err("it would step").to_string();
    assert!(
        refused.contains("too old for moves with profiles (test.move, test.profile), which needs version 7"),
        "{refused}"
    );
    client.download_test(&rig("")).expect("steps are taken as ever");
}

fn version_7(message: &[u8]) -> Option<Vec<u8>> {
    older(message, 7, id::ACCELERATION_FEED_FORWARD)
}

#[test]
fn a_rig_of_version_7_has_no_move_records_and_is_told_nothing_of_them() {
    let mut client = SimulatedRig::with_record(&[]).with_firmware(version_7).connect().expect("an answer");
    for refused in [client.move_records().map(drop), client.replace_move_records(&[])] {
        let refused = refused.expect_err("too old").to_string();
        assert!(refused.contains("too old for move records, which needs version 8"), "{refused}");
    }
}

#[test]
fn what_an_older_rig_cannot_do_is_refused_by_name() {
    let rig = SimulatedRig::with_record(&[]).with_firmware(version_1);
    let mut client = rig.connect().expect("an answer");
    let homing = client.home().expect_err("version 1 has no homing").to_string();
    assert!(
        homing.contains("(0.1.0) speaks version 1 of the protocol and is too old for homing"),
        "{homing}"
    );
    let stream = client.stream_begin(1, 769.0).expect_err("version 1 has no stream").to_string();
    assert!(stream.contains("too old for a stream, which needs version 3"), "{stream}");
    client.status().expect("what it can do goes on");
}

#[test]
fn a_test_that_an_older_rig_cannot_keep_is_refused_and_others_are_taken() {
    let mut client = SimulatedRig::with_record(&[]).with_firmware(version_3).connect().expect("an answer");
    let test = |settings: &[&str]| {
        let settings: Vec<String> = settings.iter().map(|&setting| setting.to_owned()).collect();
        let text = pneudrive_sim::rig::builtin("servo-b").expect("a built-in rig");
        Rig::read_with("servo-b", text, &settings).expect("a test")
    };
    client.download_test(&test(&[])).expect("as ever");
    for (test, last_sample) in [(test(&["test.repeat_every_s=3"]), 100), (test(&[]), UNTIL_STOPPED)] {
        let error = client.prepare(&test, last_sample, None).expect_err("too old").to_string();
        assert!(
            error.contains("repeats its moves or lasts more than 71 minutes, which needs version 4"),
            "{error}"
        );
    }
}

#[test]
fn an_older_rig_takes_the_parameters_that_it_has_unless_one_that_it_lacks_would_matter() {
    let rig = SimulatedRig::with_record(&[]).with_firmware(version_1);
    let mut client = rig.connect().expect("an answer");
    let mut parameters = Parameters::default();
    parameters.set(id::VELOCITY_GAIN, 77).expect("in range");
    let left_out = client.import_parameters(&parameters).expect("disarmed");
    let newer = TABLE.iter().filter(|parameter| (LAST_OF_V1 + 1..256).contains(&parameter.id));
    assert_eq!(left_out, newer.map(|parameter| parameter.name).collect::<Vec<_>>());
    assert_eq!(client.parameters().expect("an answer").values.get(id::VELOCITY_GAIN), Some(77));

    parameters.set(id::VELOCITY_GAIN, 78).expect("in range");
    parameters.set(id::DWELL_US, 5000).expect("in range");
    let error = client.import_parameters(&parameters).expect_err("it would dwell").to_string();
    assert!(
        error.contains("has no parameter controller.dwell_s, which should be 0.005 (default 0)"),
        "{error}"
    );
    let values = client.parameters().expect("an answer").values;
    assert_eq!(values.get(id::VELOCITY_GAIN), Some(77), "nothing was changed");
}

#[test]
fn parameters_are_changed_all_or_none_and_by_older_firmware_not_at_all() {
    let rig = SimulatedRig::with_record(&[]);
    let mut client = rig.connect().expect("an answer");
    client
        .change_parameters(&[(id::VELOCITY_GAIN, 77), (id::ACCELERATION_GAIN, 3), (id::HOLD_MS, 900)])
        .expect("disarmed");
    let error = client.change_parameters(&[(id::VELOCITY_GAIN, 78), (id::SCALE, 0)]).expect_err("no scale");
    assert!(error.to_string().contains("controller.scale = 0 is out of range"), "{error}");
    let values = client.parameters().expect("an answer").values;
    let read = [id::VELOCITY_GAIN, id::ACCELERATION_GAIN, id::HOLD_MS, id::SCALE].map(|id| values.get(id));
    assert_eq!(read, [Some(77), Some(3), Some(900), Parameters::default().get(id::SCALE)]);
    let mut client = SimulatedRig::with_record(&[]).with_firmware(version_4).connect().expect("an answer");
    let error = client.change_parameters(&[(id::VELOCITY_GAIN, 7)]).expect_err("too old").to_string();
    assert!(error.contains("too old for parameters that are changed as a whole"), "{error}");
}

#[test]
fn a_rig_that_knows_no_owner_is_armed_and_disarmed_by_whoever_asks() {
    for older in [version_2, version_3, version_4] {
        let rig = SimulatedRig::with_record(&[]).with_firmware(older);
        let [mut one, mut other] = [(); 2].map(|()| rig.connect().expect("an answer"));
        one.arm().expect("as ever");
        assert_eq!(other.owner().expect("nothing is asked"), None);
        other.disarm().expect("as ever");
        assert_eq!(one.status().expect("an answer").mode, Mode::Disarmed);
    }
}

#[test]
fn a_rig_that_tells_no_boot_is_armed_as_ever_and_known_not_to() {
    for older in [version_1 as simulated_link::Older, version_2, version_3, version_4, version_5] {
        let rig = SimulatedRig::with_record(&[]).with_firmware(older);
        rig.change(|simulation| simulation.board.store.boot = 3);
        let mut client = rig.connect().expect("an answer");
        assert!(!client.names_its_boot());
        client.arm().expect("as ever");
        client.disarm().expect("as ever");
    }
}

#[test]
fn what_was_meant_for_a_rig_before_its_reset_is_refused_by_name_and_a_new_connection_goes_on() {
    let rig = SimulatedRig::with_record(&[]);
    rig.change(|simulation| simulation.board.store.boot = 3);
    let mut client = rig.connect().expect("an answer");
    assert!(client.names_its_boot());
    client.arm().expect("disarmed");
    rig.change(Simulation::reset);
    for error in
        [client.arm().map(drop), client.set_parameters(id::VELOCITY_GAIN, &[7]), client.save_parameters()]
    {
        let error = error.expect_err("of another boot").to_string();
        assert!(error.contains("the rig was reset since this program connected (boot 4 now)"), "{error}");
    }
    client.disarm().expect("whoever may disarm, may in any boot");
    client.status().expect("reading goes on");
    rig.connect().expect("an answer").arm().expect("it means this boot");
}

#[test]
fn a_newer_rig_is_talked_to_as_long_as_it_speaks_a_version_that_is_known() {
    let samples = any_samples(&mut Random(7), 100);
    let rig = SimulatedRig::with_record(&samples).with_firmware(version_10);
    assert_eq!(rig.connect().expect("an answer").record(|_, _| {}).expect("a record").samples, samples);
    let rig = SimulatedRig::with_record(&samples).with_firmware(only_version_10);
    let error = rig.connect().err().expect("no common version").to_string();
    assert!(
        error.contains("speaks protocol versions 10 to 10, this program 1 to 9; update the older"),
        "{error}"
    );
}

/// An older program knows the first variants alone: its requests get answers of theirs.
#[test]
fn an_older_program_is_answered_in_its_own_version() {
    let rig = SimulatedRig::with_record(&any_samples(&mut Random(7), 100));
    rig.change(|simulation| simulation.rest(100));
    for (body, answer) in [
        (RequestBody::Info, 0),
        (RequestBody::Status, 1),
        (RequestBody::ConfigGet { first_id: 1, count: 30 }, 2),
        (RequestBody::ConfigGet { first_id: 60, count: 200 }, 6),
        (RequestBody::Disarm, 3),
        (RequestBody::RecordInfo, 4),
        (RequestBody::RecordRead { first: 0, count: 32 }, 5),
        (RequestBody::Start, 6),
    ] {
        let reply = rig.change(|simulation| simulation.answer(&Request { sequence: 5, body }));
        assert_eq!(reply[..2], [5, answer], "{body:?}");
        decode_reply(&reply).expect("a reply");
    }
}
