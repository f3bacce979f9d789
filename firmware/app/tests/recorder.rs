//! What the recorder keeps of a run and of the time before it, on a scripted board.

use crate::bench::{ARM, AppBench};
use pneudrive_controller::Mode;
use pneudrive_controller::parameters::id;
use pneudrive_protocol::{ReplyBody, RequestBody, RequestRefusal, Values};

#[test]
fn a_chunk_is_that_of_the_record_that_is_named_or_is_refused() {
    let mut bench = AppBench::referenced();
    let crc_of_a_run = |bench: &mut AppBench| {
        bench.done(RequestBody::Disarm);
        bench.armed(9, 1, 0);
        bench.done(bench.start_request());
        bench.samples(12);
        bench.record();
        bench.ask_for(RequestBody::RecordInfo, |reply| match reply {
            ReplyBody::RecordInfo(info) => info.crc32,
            other => panic!("{other:?}"),
        })
    };
    let named = |crc32| RequestBody::RecordRead { crc32, first: 2, count: 3 };
    let [first, second] = [crc_of_a_run(&mut bench), crc_of_a_run(&mut bench)];
    assert!(bench.ask(named(second)).starts_with("Chunk { first: 2, samples: ["));
    let other = format!("{:?}", ReplyBody::Refused(RequestRefusal::OtherRecord));
    assert_eq!(bench.ask(named(first)), other, "of the run before");
    bench.done(ARM);
    assert_eq!(bench.ask(named(second)), other, "the next run has begun");
}

#[test]
fn a_test_runs_from_download_to_done_and_is_recorded_from_its_first_sample() {
    let mut bench = AppBench::referenced();
    bench.armed(9, 1, 0);
    bench.samples(4);
    assert!(bench.board.driven[..].iter().all(|command| command.counts == 0), "armed is null");
    bench.done(bench.start_request());
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
    let mut bench = AppBench::referenced();
    bench.armed(20, 3, 2);
    bench.samples(8); // stored while armed: samples 0, 3, 6 of these; 6 is two before the start
    bench.done(bench.start_request());
    let before = bench.board.position;
    bench.samples(22);
    let (first, samples) = bench.record();
    assert_eq!(first, -5);
    let offsets: Vec<i32> = samples.iter().map(|sample| (sample.position - before) / 3 - 1).collect();
    assert_eq!(offsets, [-5, -2, 0, 3, 6, 9, 12, 15, 18], "k of each, counted from the start");
}

#[test]
fn the_recorder_stops_when_it_is_full() {
    let mut bench = AppBench::referenced();
    bench.done(RequestBody::ConfigSet {
        first_id: id::POSITION_MAX_COUNTS,
        values: Values::fill(&mut [0; 4], [1_000_000]).expect("room"),
    });
    bench.armed(6000, 1, 0);
    bench.done(bench.start_request());
    bench.samples(6002);
    assert_eq!(bench.mode(), Mode::Done);
    let (_, samples) = bench.record();
    assert_eq!(samples.len(), pneudrive_app::recorder::CAPACITY);
    assert!(samples.windows(2).all(|pair| pair[1].position - pair[0].position == 3));
}

#[test]
fn chunks_can_be_asked_for_again_and_beyond_the_end_is_refused() {
    let mut bench = AppBench::referenced();
    let none = bench.read(0, 1);
    assert_eq!(bench.ask(none), "Refused(NoRecord)");
    bench.armed(39, 1, 0);
    bench.done(bench.start_request());
    bench.samples(41);
    let last = bench.read(30, 10);
    assert_eq!(bench.ask(last), bench.ask(last));
    for (first, count) in [(30, 11), (40, 1), (u32::MAX, 5), (0, 0)] {
        let beyond = bench.read(first, count);
        assert_eq!(bench.ask(beyond), "Refused(RecordRange { samples: 40 })");
    }
}

#[test]
fn the_sample_period_is_measured_by_the_board() {
    let mut bench = AppBench::referenced();
    bench.armed(100, 1, 0);
    bench.done(bench.start_request());
    bench.samples(1);
    for _ in 0..10 {
        bench.board.now_us += 13; // a clock that is 1 % slow
        bench.samples(1);
    }
    assert!(bench.ask(RequestBody::RecordInfo).contains("measured_period_ns: 1313000"));
}

#[test]
fn a_start_between_a_sample_and_its_output_does_not_lose_that_sample() {
    let mut bench = AppBench::referenced();
    bench.armed(9, 1, 2);
    bench.samples(4);
    bench.app.control.on_sample(&mut bench.board);
    let last_armed = bench.board.position;
    bench.done(bench.start_request());
    bench.app.control.on_output(&mut bench.board);
    bench.board.now_us += 1300;
    bench.samples(11);
    let (first, samples) = bench.record();
    assert_eq!((first, samples[1].position, samples[2].position), (-2, last_armed, last_armed + 3));
    assert_eq!(samples.len(), 12);
}

#[test]
fn samples_from_before_the_start_have_the_origin_that_the_homing_run_found() {
    let mut bench = AppBench::referenced();
    bench.armed(9, 1, 4);
    bench.samples(6);
    bench.done(RequestBody::Home);
    bench.board.stop = Some(-100);
    while bench.mode() == Mode::Homing {
        bench.samples(1);
    }
    (bench.board.stop, bench.board.stands) = (None, true);
    bench.samples(2);
    bench.done(bench.start_request());
    bench.samples(11);
    let (first, samples) = bench.record();
    assert_eq!((first, samples.len()), (-2, 12), "none from before the homing run");
    assert!(samples.iter().all(|sample| sample.position == 0), "at the stop all the time");
}
