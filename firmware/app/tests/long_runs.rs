//! Tests that last long: longer than their microseconds can be counted, round after round, until they are stopped.

use crate::bench::{ARM, AppBench, change};
use pneudrive_controller::parameters::id;
use pneudrive_controller::{Mode, Refusal};
use pneudrive_protocol::change::Entry;
use pneudrive_protocol::{RequestBody, UNTIL_STOPPED, Values};

/// An open-loop drive with a sample each 20 ms, whose test has two moves.
fn slow_bench() -> AppBench {
    let mut bench = AppBench::referenced();
    for (first_id, value) in [(id::PERIOD_US, 20_000), (id::OPEN_LOOP, 1)] {
        let mut room = [0; 4];
        let values = Values::fill(&mut room, [value]).expect("room");
        bench.done(RequestBody::ConfigSet { first_id, values });
    }
    bench
}

/// A test that ends with this sample, of two moves that come again every so many samples.
fn test(last_sample: u32, round: u32) -> [Entry<'static>; 3] {
    let test = Entry::Test { name: "long", last_sample, round, decimation: 1, pre_trigger: 0 };
    [test, Entry::Move { at_sample: 0, target: 40 }, Entry::Move { at_sample: 2, target: 0 }]
}

/// Samples on end, a period of this bench apart.
fn pass(bench: &mut AppBench, samples: u32) {
    for _ in 0..samples {
        bench.board.position = 500;
        bench.samples(1);
        bench.board.now_us += 20_000 - 1300;
        bench.board.driven.clear();
    }
}

fn setpoint(bench: &AppBench) -> i32 {
    bench.app.control.state().observation().setpoint
}

#[test]
fn a_test_of_two_hours_runs_for_two_hours_and_its_moves_come_again_each_round() {
    let mut bench = slow_bench();
    let two_hours = 7_200_000_000_u64 / 20_000;
    bench.takes(&test(two_hours as u32, 5));
    bench.done(ARM);
    bench.done(bench.start_request());
    for k in 0..=two_hours {
        pass(&mut bench, 1);
        assert_eq!(setpoint(&bench), if k % 5 < 2 { 40 } else { 0 }, "sample {k}");
        assert_eq!(bench.mode(), Mode::Running, "sample {k}");
    }
    pass(&mut bench, 1);
    assert_eq!(bench.mode(), Mode::Done, "behind the last sample");
    let motion = bench.ask(RequestBody::Motion);
    assert!(motion.contains("begun: 65535"), "as many as the message can tell: {motion}");
}

#[test]
fn a_test_without_an_end_runs_until_it_is_stopped() {
    let mut bench = slow_bench();
    bench.takes(&test(UNTIL_STOPPED, 5));
    bench.done(ARM);
    bench.done(bench.start_request());
    pass(&mut bench, 300_000);
    assert_eq!(bench.mode(), Mode::Running, "after 100 minutes");
    bench.done(RequestBody::Disarm);
    assert_eq!(bench.mode(), Mode::Disarmed);
}

#[test]
fn a_span_that_cannot_be_kept_is_refused_and_changes_nothing() {
    let mut bench = slow_bench();
    bench.takes(&test(99, 3));
    assert_eq!(bench.take(&change(&test(u32::MAX, 0))), "Refused(TestTooLong)");
    assert_eq!(
        bench.take(&change(&test(50, 2))),
        "Refused(MovesOutOfOrder)",
        "the second move is at sample 2"
    );
    bench.done(ARM);
    let refused = format!("Refused(NotNow({}))", Refusal::NotDisarmed.code());
    assert_eq!(bench.take(&change(&test(50, 3))), refused);
    let sequence = bench.app.control.test().sequence();
    assert_eq!((sequence.duration_samples, sequence.round()), (99, 3));
}
