//! What trips an enabled drive at its very next output: a stop, lateness, a silent host. On a scripted board.

use crate::bench::{ARM, AppBench};
use pneudrive_controller::{Command, Fault, Mode};
use pneudrive_protocol::RequestBody;

#[test]
fn a_stop_is_off_at_the_very_next_output_also_between_a_sample_and_its_output() {
    let mut bench = AppBench::referenced();
    bench.armed(100, 1, 0);
    bench.done(bench.start_request());
    bench.samples(3);
    bench.app.control.on_sample(&mut bench.board);
    bench.done(RequestBody::Stop);
    bench.app.control.on_output(&mut bench.board);
    assert_eq!(bench.board.driven.last(), Some(&Command::OFF));
    assert!(bench.ask(RequestBody::Status).contains("mode: Fault, fault: 1"));
    bench.done(RequestBody::Disarm);
    assert_eq!(bench.mode(), Mode::Fault(Fault::Stop), "only arming leaves a fault");
    bench.done(ARM);
    assert_eq!(bench.mode(), Mode::Armed);
}

#[test]
fn a_late_or_missing_sample_trips_an_enabled_drive() {
    for (delay_us, trips) in [(100, false), (101, true), (1300, true), (-100, false), (-101, true)] {
        let mut bench = AppBench::referenced();
        bench.armed(100, 1, 0);
        bench.done(bench.start_request());
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
        let mut bench = AppBench::referenced();
        bench.armed(100, 1, 0);
        bench.done(bench.start_request());
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
    let mut bench = AppBench::referenced();
    bench.board.now_us = 70_000_000;
    bench.test(100, 1, 0);
    bench.app.control.on_sample(&mut bench.board);
    bench.done(ARM);
    bench.board.now_us += 5000;
    bench.app.control.on_output(&mut bench.board);
    assert_eq!(bench.mode(), Mode::Armed);
}

#[test]
fn a_silent_host_trips_a_running_move_and_nothing_else() {
    let mut bench = AppBench::referenced();
    bench.board.host_clock_ms = Some(1000);
    bench.armed(1000, 1, 0);
    bench.board.host_clock_ms = Some(9000);
    bench.samples(1);
    assert_eq!(bench.mode(), Mode::Armed, "no move runs");
    bench.done(RequestBody::TakeOver { host: "bench" });
    bench.done(bench.start_request());
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
    let mut bench = AppBench::default();
    bench.board.host_clock_ms = Some(1000);
    bench.done(ARM);
    bench.done(RequestBody::Home);
    bench.board.host_clock_ms = Some(1500);
    bench.samples(1);
    assert_eq!(bench.mode(), Mode::Homing);
    bench.board.host_clock_ms = Some(1501);
    bench.samples(1);
    assert_eq!(bench.mode(), Mode::Fault(Fault::HostSilent));
    assert_eq!(bench.board.driven.last(), Some(&Command::OFF));
}
