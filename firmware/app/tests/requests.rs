//! Every request with its reply, the recorder, and what trips, on a scripted board.

mod bench;

use bench::Bench;
use pneudrive_controller::parameters::id;
use pneudrive_controller::{Command, Fault, Mode, Refusal};
use pneudrive_protocol::{
    Accumulator, MAX_FRAME, MAX_VALUES, Refused, ReplyBody, RequestBody, Values, decode_reply,
};

#[test]
fn a_new_rig_is_disarmed_with_the_valve_at_null() {
    let mut bench = Bench::default();
    bench.samples(3);
    assert_eq!(bench.board.driven, [Command::OFF; 3]);
    let status = bench.ask(RequestBody::Status);
    assert!(status.contains("mode: Disarmed") && status.contains("referenced: false"), "{status}");
    let info = bench.ask(RequestBody::Info);
    assert!(info.contains("board: \"fake\"") && info.contains("build: \"test\""), "{info}");
}

#[test]
fn an_arm_that_comes_late_a_second_time_does_not_follow_on_the_disarm() {
    let mut bench = Bench::referenced();
    let [arm, disarm] = [RequestBody::Arm, RequestBody::Disarm].map(|body| bench.frame(body));
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
fn a_chunk_is_that_of_the_record_that_is_named_or_is_refused() {
    let mut bench = Bench::referenced();
    let crc_of_a_run = |bench: &mut Bench| {
        bench.done(RequestBody::Disarm);
        bench.armed(9, 1, 0);
        bench.done(RequestBody::Start);
        bench.samples(12);
        bench.record();
        bench.ask_for(RequestBody::RecordInfo, |reply| match reply {
            ReplyBody::RecordInfo(info) => info.crc32,
            other => panic!("{other:?}"),
        })
    };
    let named = |crc32| RequestBody::RecordChunk { crc32, first: 2, count: 3 };
    let [first, second] = [crc_of_a_run(&mut bench), crc_of_a_run(&mut bench)];
    let unnamed = bench.ask(RequestBody::RecordRead { first: 2, count: 3 });
    assert_eq!(bench.ask(named(second)), unnamed);
    let other = format!("{:?}", ReplyBody::Refused(Refused::OtherRecord));
    assert_eq!(bench.ask(named(first)), other, "of the run before");
    bench.done(RequestBody::Arm);
    assert_eq!(bench.ask(named(second)), other, "the next run has begun");
}

#[test]
fn what_only_reads_is_answered_as_often_as_it_is_asked() {
    let mut bench = Bench::referenced();
    let [status, motion] = [RequestBody::Status, RequestBody::Motion].map(|body| bench.frame(body));
    let [first, second] = [bench.send(&status), bench.send(&motion)];
    assert_eq!([bench.send(&status), bench.send(&motion)], [first, second]);
}

#[test]
fn closed_loop_is_refused_before_the_axis_is_referenced() {
    let mut bench = Bench::default();
    bench.armed(9, 1, 0);
    bench.refused(RequestBody::Start, Refusal::NotReferenced);
    assert_eq!(bench.mode(), Mode::Armed);
}

#[test]
fn a_test_runs_from_download_to_done_and_is_recorded_from_its_first_sample() {
    let mut bench = Bench::referenced();
    bench.armed(9, 1, 0);
    bench.samples(4);
    assert!(bench.board.driven[..].iter().all(|command| command.counts == 0), "armed is null");
    bench.done(RequestBody::Start);
    assert_eq!(bench.board.runs, 1);
    let before = bench.board.position;
    bench.samples(10);
    assert_eq!(bench.mode(), Mode::Running, "until the output of sample 9 is over");
    bench.samples(1);
    assert_eq!(bench.mode(), Mode::Done);
    bench.samples(5);
    let (first, samples) = bench.record();
    assert_eq!((first, samples.len()), (0, 10), "samples 0 to 9, and none after");
    for (k, sample) in samples.iter().enumerate() {
        let position = before + 3 * (k as i32 + 1);
        assert_eq!(sample.position, position);
        let setpoint = if k < 4 { 500 } else { 0 };
        assert_eq!(i32::from(sample.error), setpoint - position);
        assert_eq!((sample.pressure_1, sample.pressure_2, sample.spool), (100, 200, 2000));
        assert_eq!(sample.command, bench.board.driven[4 + k].counts, "as it was driven");
    }
    assert!(bench.board.driven.last().expect("driven").drive_enable, "done holds in closed loop");
}

#[test]
fn every_nth_sample_is_stored_and_the_newest_ones_before_the_start_with_their_distance() {
    let mut bench = Bench::referenced();
    bench.armed(20, 3, 2);
    bench.samples(8); // stored while armed: samples 0, 3, 6 of these; 6 is two before the start
    bench.done(RequestBody::Start);
    let before = bench.board.position;
    bench.samples(22);
    let (first, samples) = bench.record();
    assert_eq!(first, -5);
    let offsets: Vec<i32> = samples.iter().map(|sample| (sample.position - before) / 3 - 1).collect();
    assert_eq!(offsets, [-5, -2, 0, 3, 6, 9, 12, 15, 18], "k of each, counted from the start");
}

#[test]
fn the_recorder_stops_when_it_is_full() {
    let mut bench = Bench::referenced();
    bench.done(RequestBody::ConfigSet {
        first_id: id::POSITION_MAX_COUNTS,
        values: Values::fill(&mut [0; 4], [1_000_000]).expect("room"),
    });
    bench.armed(6000, 1, 0);
    bench.done(RequestBody::Start);
    bench.samples(6002);
    assert_eq!(bench.mode(), Mode::Done);
    let (_, samples) = bench.record();
    assert_eq!(samples.len(), pneudrive_app::recorder::CAPACITY);
    assert!(samples.windows(2).all(|pair| pair[1].position - pair[0].position == 3));
}

#[test]
fn chunks_can_be_asked_for_again_and_beyond_the_end_is_refused() {
    let mut bench = Bench::referenced();
    assert_eq!(bench.ask(RequestBody::RecordRead { first: 0, count: 1 }), "Refused(NoRecord)");
    bench.armed(39, 1, 0);
    bench.done(RequestBody::Start);
    bench.samples(41);
    let chunk = |first, count| RequestBody::RecordRead { first, count };
    assert_eq!(bench.ask(chunk(30, 10)), bench.ask(chunk(30, 10)));
    for (first, count) in [(30, 11), (40, 1), (u32::MAX, 5), (0, 0)] {
        assert_eq!(bench.ask(chunk(first, count)), "Refused(RecordRange { samples: 40 })");
    }
}

#[test]
fn a_request_that_comes_twice_is_carried_out_once_and_answered_twice() {
    let mut bench = Bench::referenced();
    bench.done(RequestBody::TestBegin { name: "t", duration_us: 13_000, decimation: 1, pre_trigger: 0 });
    let frame = bench.frame(RequestBody::TestMove { time_us: 0, target: 1 });
    assert_eq!(bench.send(&frame), bench.send(&frame));
    assert_eq!(bench.app.control.test().sequence().moves().len(), 1);
    bench.done(RequestBody::Arm);
    let frame = bench.frame(RequestBody::Start);
    assert_eq!(bench.send(&frame), bench.send(&frame), "not refused as running already");
}

#[test]
fn parameters_change_all_or_none_and_only_while_disarmed() {
    let mut bench = Bench::referenced();
    let set = |first_id, values: &[i32]| -> (u16, Vec<u8>) {
        let mut room = [0; 4 * MAX_VALUES];
        Values::fill(&mut room, values.iter().copied()).expect("room");
        (first_id, room[..4 * values.len()].to_vec())
    };
    let ask_set = |bench: &mut Bench, first_id, values: &[i32]| {
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
        bench.ask(RequestBody::ConfigGet { first_id: id::HOMING_BACK_OFF_COUNTS, count: 2 }),
        "Refused(UnknownParameter { id: 57 })"
    );
    bench.armed(10, 1, 0);
    let refused = format!("Refused(NotNow({}))", Refusal::NotDisarmed.code());
    assert_eq!(ask_set(&mut bench, id::VELOCITY_GAIN, &[1]), refused);
    bench.refused(
        RequestBody::TestBegin { name: "", duration_us: 1, decimation: 1, pre_trigger: 0 },
        Refusal::NotDisarmed,
    );
    bench.refused(RequestBody::TestMove { time_us: 0, target: 0 }, Refusal::NotDisarmed);
}

#[test]
fn moves_out_of_order_and_too_many_are_refused() {
    let mut bench = Bench::referenced();
    bench.done(RequestBody::TestBegin { name: "t", duration_us: 13_000, decimation: 1, pre_trigger: 0 });
    for _ in 0..64 {
        bench.done(RequestBody::TestMove { time_us: 2600, target: 1 });
    }
    assert_eq!(bench.ask(RequestBody::TestMove { time_us: 0, target: 1 }), "Refused(MovesOutOfOrder)");
    assert_eq!(bench.ask(RequestBody::TestMove { time_us: 2600, target: 1 }), "Refused(TooManyMoves)");
}

#[test]
fn nothing_starts_that_is_not_armed_or_has_no_moves() {
    let mut bench = Bench::referenced();
    bench.done(RequestBody::Arm);
    bench.refused(RequestBody::Start, Refusal::NoMoves);
    bench.done(RequestBody::Disarm);
    bench.refused(RequestBody::Start, Refusal::NotArmed);
    assert_eq!(bench.mode(), Mode::Fault(Fault::CommandWhileDisarmed));
    bench.samples(1);
    assert_eq!(bench.board.driven, [Command::OFF]);
}

#[test]
fn a_stop_is_off_at_the_very_next_output_also_between_a_sample_and_its_output() {
    let mut bench = Bench::referenced();
    bench.armed(100, 1, 0);
    bench.done(RequestBody::Start);
    bench.samples(3);
    bench.app.control.on_sample(&mut bench.board);
    bench.done(RequestBody::Stop);
    bench.app.control.on_output(&mut bench.board);
    assert_eq!(bench.board.driven.last(), Some(&Command::OFF));
    assert!(bench.ask(RequestBody::Status).contains("mode: Fault, fault: 1"));
    bench.done(RequestBody::Disarm);
    assert_eq!(bench.mode(), Mode::Fault(Fault::Stop), "only arming leaves a fault");
    bench.done(RequestBody::Arm);
    assert_eq!(bench.mode(), Mode::Armed);
}

#[test]
fn a_late_or_missing_sample_trips_an_enabled_drive() {
    for (delay_us, trips) in [(100, false), (101, true), (1300, true), (-100, false), (-101, true)] {
        let mut bench = Bench::referenced();
        bench.armed(100, 1, 0);
        bench.done(RequestBody::Start);
        bench.samples(3);
        bench.board.now_us = bench.board.now_us.saturating_add_signed(delay_us);
        bench.samples(1);
        let expected = if trips { Mode::Fault(Fault::LateSample) } else { Mode::Running };
        assert_eq!(bench.mode(), expected, "{delay_us} us late");
    }
}

/// The lateness of samples alone was judged: an output could come 254 us late every few samples.
#[test]
fn a_late_output_trips_an_enabled_drive_before_it_is_driven() {
    for (after_us, trips) in [(500, false), (600, false), (601, true), (1299, true)] {
        let mut bench = Bench::referenced();
        bench.armed(100, 1, 0);
        bench.done(RequestBody::Start);
        bench.samples(3);
        bench.app.control.on_sample(&mut bench.board);
        assert_ne!(bench.app.control.state().observation().command, 0);
        bench.board.now_us += after_us;
        bench.app.control.on_output(&mut bench.board);
        let expected = if trips { Mode::Fault(Fault::LateOutput) } else { Mode::Running };
        assert_eq!(bench.mode(), expected, "{after_us} us after its sample");
        assert_eq!(bench.board.driven.last() == Some(&Command::OFF), trips, "{after_us} us");
    }
}

#[test]
fn an_output_behind_an_arming_has_no_sample_to_be_late_for() {
    let mut bench = Bench::referenced();
    bench.board.now_us = 70_000_000;
    bench.test(100, 1, 0);
    bench.app.control.on_sample(&mut bench.board);
    bench.done(RequestBody::Arm);
    bench.board.now_us += 5000;
    bench.app.control.on_output(&mut bench.board);
    assert_eq!(bench.mode(), Mode::Armed);
}

#[test]
fn a_silent_host_trips_a_running_move_and_nothing_else() {
    let mut bench = Bench::referenced();
    bench.board.host_clock_ms = Some(1000);
    bench.armed(1000, 1, 0);
    bench.board.host_clock_ms = Some(9000);
    bench.samples(1);
    assert_eq!(bench.mode(), Mode::Armed, "no move runs");
    bench.done(RequestBody::Start);
    bench.board.host_clock_ms = Some(9500);
    bench.samples(1);
    assert_eq!(bench.mode(), Mode::Running);
    bench.ask(RequestBody::Status);
    bench.board.host_clock_ms = Some(10_000);
    bench.samples(1);
    assert_eq!(bench.mode(), Mode::Running, "it was heard at 9.5 s");
    bench.board.host_clock_ms = Some(10_001);
    bench.samples(1);
    assert_eq!(bench.mode(), Mode::Fault(Fault::HostSilent));
}

/// Once a homing run went on to its end though the program that had asked for it was killed.
#[test]
fn a_silent_host_trips_a_homing_run() {
    let mut bench = Bench::default();
    bench.board.host_clock_ms = Some(1000);
    bench.done(RequestBody::Arm);
    bench.done(RequestBody::Home);
    bench.board.host_clock_ms = Some(1500);
    bench.samples(1);
    assert_eq!(bench.mode(), Mode::Homing);
    bench.board.host_clock_ms = Some(1501);
    bench.samples(1);
    assert_eq!(bench.mode(), Mode::Fault(Fault::HostSilent));
    assert_eq!(bench.board.driven.last(), Some(&Command::OFF));
}

#[test]
fn the_sample_period_is_measured_by_the_board() {
    let mut bench = Bench::referenced();
    bench.armed(100, 1, 0);
    bench.done(RequestBody::Start);
    bench.samples(1);
    for _ in 0..10 {
        bench.board.now_us += 13; // a clock that is 1 % slow
        bench.samples(1);
    }
    assert!(bench.ask(RequestBody::RecordInfo).contains("measured_period_ns: 1313000"));
}

#[test]
fn noise_between_requests_costs_nothing_but_the_count_of_damaged_frames() {
    let mut bench = Bench::referenced();
    let noise: Vec<u8> = (0..200u16).map(|i| (i * 37 % 251) as u8).chain([0]).collect();
    bench.send(&noise);
    assert!(bench.ask(RequestBody::Status).contains("damaged_frames: "));
    assert!(!bench.ask(RequestBody::Status).contains("damaged_frames: 0"));
}

#[test]
fn a_request_of_a_later_version_is_answered_as_unknown() {
    let mut bench = Bench::default();
    let mut frame = [0; MAX_FRAME];
    let frame = pneudrive_protocol::frame::encode(&[5, 99, 1, 2, 3], &mut frame).expect("fits").to_vec();
    let reply = bench.send(&frame);
    let mut accumulator: Accumulator = Accumulator::new();
    let message = reply.iter().find_map(|&byte| accumulator.push(byte).map(|m| m.expect("whole").to_vec()));
    let message = message.expect("a reply");
    let reply = decode_reply(&message).expect("a reply");
    assert_eq!((reply.sequence, reply.body), (5, ReplyBody::Refused(Refused::Unknown)));
}

#[test]
fn names_of_tests_are_cut_at_a_character() {
    let mut bench = Bench::referenced();
    let name = "e".repeat(31) + "\u{e9}";
    bench.done(RequestBody::TestBegin { name: &name, duration_us: 1, decimation: 1, pre_trigger: 0 });
    assert_eq!(bench.app.control.test().name(), "e".repeat(31));
}

#[test]
fn a_start_between_a_sample_and_its_output_does_not_lose_that_sample() {
    let mut bench = Bench::referenced();
    bench.armed(9, 1, 2);
    bench.samples(4);
    bench.app.control.on_sample(&mut bench.board);
    let last_armed = bench.board.position;
    bench.done(RequestBody::Start);
    bench.app.control.on_output(&mut bench.board);
    bench.board.now_us += 1300;
    bench.samples(11);
    let (first, samples) = bench.record();
    assert_eq!((first, samples[1].position, samples[2].position), (-2, last_armed, last_armed + 3));
    assert_eq!(samples.len(), 12);
}

#[test]
fn samples_from_before_the_start_have_the_origin_that_the_homing_run_found() {
    let mut bench = Bench::referenced();
    bench.armed(9, 1, 4);
    bench.samples(6);
    bench.done(RequestBody::Home);
    bench.board.stop = Some(-100);
    while bench.mode() == Mode::Homing {
        bench.samples(1);
    }
    (bench.board.stop, bench.board.stands) = (None, true);
    bench.samples(2);
    bench.done(RequestBody::Start);
    bench.samples(11);
    let (first, samples) = bench.record();
    assert_eq!((first, samples.len()), (-2, 12), "none from before the homing run");
    assert!(samples.iter().all(|sample| sample.position == 0), "at the stop all the time");
}

#[test]
fn a_reference_sets_the_counter_and_a_new_encoder_takes_the_reference_away() {
    let mut bench = Bench::default();
    bench.done(RequestBody::Reference { position_counts: 4000 });
    bench.samples(1);
    assert!(bench.ask(RequestBody::Status).contains("position: 4003"));
    let set = |bench: &mut Bench, id, value: i32| {
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
    let mut bench = Bench::referenced();
    bench.armed(9, 1, 0);
    bench.done(RequestBody::Start);
    bench.samples(11);
    bench.done(RequestBody::Disarm);
    assert_eq!(bench.record().1.len(), 10);
    let mut room = [0; 4];
    let values = Values::fill(&mut room, [1400]).expect("room");
    bench.done(RequestBody::ConfigSet { first_id: id::PERIOD_US, values });
    assert_eq!(bench.ask(RequestBody::RecordRead { first: 0, count: 1 }), "Refused(NoRecord)");
    bench.done(RequestBody::Arm);
    bench.refused(RequestBody::Start, Refusal::NoMoves);
}
