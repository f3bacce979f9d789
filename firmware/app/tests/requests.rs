//! Every request with its reply, on a scripted board.

use crate::bench::{ARM, AppBench};
use pneudrive_controller::parameters::{TABLE, id};
use pneudrive_controller::{Command, Fault, Mode, Refusal};
use pneudrive_protocol::change::Entry;
use pneudrive_protocol::{
    Accumulator, MAX_FRAME, MAX_VALUES, ReplyBody, RequestBody, RequestRefusal, Values, decode_reply,
};

#[test]
fn a_new_rig_is_disarmed_with_the_valve_at_null() {
    let mut bench = AppBench::default();
    bench.samples(3);
    assert_eq!(bench.board.driven, [Command::OFF; 3]);
    let status = bench.ask(RequestBody::Status);
    assert!(status.contains("mode: Disarmed") && status.contains("referenced: false"), "{status}");
    let info = bench.ask(RequestBody::Info);
    assert!(info.contains("board: \"fake\"") && info.contains("build: \"test\""), "{info}");
}

#[test]
fn an_arm_that_comes_late_a_second_time_does_not_follow_on_the_disarm() {
    let mut bench = AppBench::referenced();
    let [arm, disarm] = [ARM, RequestBody::Disarm].map(|body| bench.frame(body));
    let answer = bench.send(&arm);
    assert_eq!(bench.send(&arm), answer, "its reply was lost: it is answered again");
    bench.send(&disarm);
    assert_eq!(bench.send(&arm), [], "an echo of the line");
    assert_eq!(bench.mode(), Mode::Disarmed);
    bench.ask(RequestBody::Info);
    assert_eq!(bench.send(&arm), [], "nor does it when another program has begun");
    for until in 1..20 {
        bench.done(RequestBody::StreamGrant { until });
    }
    assert_eq!(bench.send(&arm), [], "nor after a stream has gone on for a while");
    assert_eq!(bench.mode(), Mode::Disarmed);
}

#[test]
fn a_disarm_with_the_number_of_an_earlier_one_is_carried_out_when_the_numbers_have_come_round() {
    let mut bench = AppBench::referenced();
    bench.done(RequestBody::Disarm);
    let number = bench.sequence;
    bench.done(ARM);
    while bench.sequence.wrapping_add(1) != number {
        bench.ask(RequestBody::Status);
    }
    assert!(matches!(bench.mode(), Mode::Armed));
    bench.done(RequestBody::Disarm);
    assert_eq!((bench.sequence, bench.mode()), (number, Mode::Disarmed));
}

#[test]
fn what_only_reads_is_answered_as_often_as_it_is_asked() {
    let mut bench = AppBench::referenced();
    let [status, motion] = [RequestBody::Status, RequestBody::Motion].map(|body| bench.frame(body));
    let [first, second] = [bench.send(&status), bench.send(&motion)];
    assert_eq!([bench.send(&status), bench.send(&motion)], [first, second]);
}

#[test]
fn closed_loop_is_refused_before_the_axis_is_referenced() {
    let mut bench = AppBench::default();
    bench.armed(9, 1, 0);
    bench.refused(bench.start_request(), Refusal::NotReferenced);
    assert_eq!(bench.mode(), Mode::Armed);
}

#[test]
fn a_request_that_comes_twice_is_carried_out_once_and_answered_twice() {
    let mut bench = AppBench::referenced();
    bench.armed(9, 1, 0);
    let frame = bench.frame(bench.start_request());
    assert_eq!(bench.send(&frame), bench.send(&frame), "not refused as running already");
}

#[test]
fn parameters_change_all_or_none_and_only_while_disarmed() {
    let mut bench = AppBench::referenced();
    let set = |first_id, values: &[i32]| -> (u16, Vec<u8>) {
        let mut room = [0; 4 * MAX_VALUES];
        Values::fill(&mut room, values.iter().copied()).expect("room");
        (first_id, room[..4 * values.len()].to_vec())
    };
    let ask_set = |bench: &mut AppBench, first_id, values: &[i32]| {
        let (first_id, bytes) = set(first_id, values);
        bench.ask(RequestBody::ConfigSet { first_id, values: Values::new(&bytes).expect("whole") })
    };
    assert_eq!(ask_set(&mut bench, id::VELOCITY_GAIN, &[1000, 2000]), "Done");
    assert_eq!(bench.app.control.config().law.acceleration_gain, 2000);
    assert_eq!(
        ask_set(&mut bench, id::VELOCITY_GAIN, &[7, 70_000]),
        format!("Refused(OutOfRange {{ id: {}, value: 70000 }})", id::ACCELERATION_GAIN)
    );
    assert_eq!(bench.app.control.config().law.velocity_gain, 1000, "none of a refused set is taken");
    assert!(ask_set(&mut bench, id::DELAY_US, &[5000]).contains("delay_us must be less than period_us"));
    assert_eq!(ask_set(&mut bench, 200, &[1]), "Refused(UnknownParameter { id: 200 })");
    assert_eq!(
        bench.ask(RequestBody::ConfigGet { first_id: id::VELOCITY_GAIN, count: 2 }),
        "Config { first_id: 7, values: [1000, 2000] }"
    );
    assert_eq!(
        bench.ask(RequestBody::ConfigGet { first_id: TABLE.len() as u16 - 1, count: 2 }),
        format!("Refused(UnknownParameter {{ id: {} }})", TABLE.len())
    );
    bench.armed(10, 1, 0);
    let refused = format!("Refused(NotNow({}))", Refusal::NotDisarmed.code());
    assert_eq!(ask_set(&mut bench, id::VELOCITY_GAIN, &[1]), refused);
}

#[test]
fn nothing_starts_that_is_not_armed_or_has_no_moves() {
    let mut bench = AppBench::referenced();
    bench.done(ARM);
    bench.refused(bench.start_request(), Refusal::NoMoves);
    bench.done(RequestBody::Disarm);
    bench.refused(bench.start_request(), Refusal::NotArmed);
    assert_eq!(bench.mode(), Mode::Fault(Fault::CommandWhileDisarmed));
    bench.samples(1);
    assert_eq!(bench.board.driven, [Command::OFF]);
}

#[test]
fn noise_between_requests_costs_nothing_but_the_count_of_damaged_frames() {
    let mut bench = AppBench::referenced();
    let noise: Vec<u8> = (0..200u16).map(|i| (i * 37 % 251) as u8).chain([0]).collect();
    bench.send(&noise);
    assert!(bench.ask(RequestBody::Status).contains("damaged_frames: "));
    assert!(!bench.ask(RequestBody::Status).contains("damaged_frames: 0"));
}

#[test]
fn a_request_of_a_later_version_is_answered_as_unknown() {
    let mut bench = AppBench::default();
    let mut frame = [0; MAX_FRAME];
    let later = [5, 0x80, 0x01, 0, 99, 1, 2, 3];
    let frame = pneudrive_protocol::frame::encode(&later, &mut frame).expect("fits").to_vec();
    let reply = bench.send(&frame);
    let mut accumulator: Accumulator = Accumulator::new();
    let message = reply.iter().find_map(|&byte| accumulator.push(byte).map(|m| m.expect("whole").to_vec()));
    let message = message.expect("a reply");
    let reply = decode_reply(&message).expect("a reply");
    assert_eq!((reply.sequence, reply.body), (5, ReplyBody::Refused(RequestRefusal::Unknown)));
}

#[test]
fn names_of_tests_are_cut_at_a_character() {
    let mut bench = AppBench::referenced();
    let name = "e".repeat(31) + "\u{e9}";
    bench.takes(&[Entry::Test { name: &name, last_sample: 1, round: 0, decimation: 1, pre_trigger: 0 }]);
    assert_eq!(bench.app.control.test().name(), "e".repeat(31));
}

#[test]
fn a_reference_sets_the_counter_and_a_new_encoder_takes_the_reference_away() {
    let mut bench = AppBench::default();
    bench.done(RequestBody::Reference { position_counts: 4000 });
    bench.samples(1);
    assert!(bench.ask(RequestBody::Status).contains("position: 4003"));
    let set = |bench: &mut AppBench, id, value: i32| {
        let mut room = [0; 4];
        bench.done(RequestBody::ConfigSet {
            first_id: id,
            values: Values::fill(&mut room, [value]).expect("room"),
        });
    };
    set(&mut bench, id::VELOCITY_GAIN, 5);
    assert!(bench.app.control.state().supervisor.is_referenced(), "a gain changes no counts");
    set(&mut bench, id::ENCODER_INVERTED, 1);
    assert!(!bench.app.control.state().supervisor.is_referenced());
}

#[test]
fn a_new_timing_takes_the_moves_with_it_and_a_change_the_record() {
    let mut bench = AppBench::referenced();
    bench.armed(9, 1, 0);
    bench.done(bench.start_request());
    bench.samples(11);
    bench.done(RequestBody::Disarm);
    assert_eq!(bench.record().1.len(), 10);
    let mut room = [0; 4];
    let values = Values::fill(&mut room, [1400]).expect("room");
    bench.done(RequestBody::ConfigSet { first_id: id::PERIOD_US, values });
    let none = bench.read(0, 1);
    assert_eq!(bench.ask(none), "Refused(NoRecord)");
    bench.done(ARM);
    bench.refused(bench.start_request(), Refusal::NoMoves);
}
