//! The run that gives counts their meaning.

use crate::bench::{ControllerBench, at};
use pneudrive_controller::parameters::id;
use pneudrive_controller::{Fault, Mode, Refusal, Sample};

const FAR: &[(u32, i32)] = &[(0, 20_000)];

#[test]
fn a_homing_run_against_a_stop_gives_counts_their_meaning() {
    let homing = [(id::HOMING_STILL_MS, 13), (id::HOMING_POSITION_COUNTS, -10), (id::END_MIN_COUNTS, -10)];
    let mut bench = ControllerBench::armed(&homing, &[(0, -10)]);
    bench.take(at(5000));
    bench.state.home(&bench.config).expect("armed");
    assert!(!bench.state.supervisor.is_referenced(), "until it has ended");
    for k in 0..40 {
        assert_eq!(bench.take(at(5000 - 50 * k)), -200, "sample {k}");
    }
    assert_eq!(bench.hold(at(3050), 9), -200);
    assert_eq!(bench.take(at(3050)), 200, "the tenth sample without a step: back off");
    assert_eq!(bench.take(at(3449)), 200);
    assert_eq!(bench.take(at(3450)), -200, "400 counts from it: once more");
    assert_eq!(bench.hold(at(3050), 10), -200);
    assert!(!bench.state.supervisor.is_referenced(), "until it has been found twice");
    assert_eq!(bench.take(at(3050)), 0);
    assert_eq!(bench.mode(), Mode::Armed);
    assert!(bench.state.supervisor.is_referenced());
    bench.state.start(&bench.config, &bench.sequence).expect("referenced");
    assert_eq!(bench.take(at(3050)), 0);
    assert_eq!(bench.state.observation().position, -10);
}

#[test]
fn a_homing_run_is_refused_unless_armed_and_trips_when_it_finds_nothing() {
    let mut bench = ControllerBench::armed(&[(id::HOMING_SWITCH, 1), (id::HOMING_TIMEOUT_MS, 13)], FAR);
    bench.state.supervisor.disarm();
    assert_eq!(bench.state.home(&bench.config), Err(Refusal::NotArmed));
    assert_eq!(bench.mode(), Mode::Disarmed, "refused without a trip");
    bench.state.supervisor.arm().expect("disarmed");
    bench.state.home(&bench.config).expect("armed");
    assert_eq!(bench.state.start(&bench.config, &bench.sequence), Err(Refusal::Running));
    bench.hold(at(100), 9);
    assert_eq!(bench.mode(), Mode::Homing);
    assert_eq!(bench.take(at(100)), 0);
    assert_eq!(bench.mode(), Mode::Fault(Fault::HomingFailed));
}

#[test]
fn a_homing_run_ends_at_the_edge_of_its_switch() {
    let mut bench = ControllerBench::armed(&[(id::HOMING_SWITCH, 1)], FAR);
    bench.state.home(&bench.config).expect("armed");
    find_switch(&mut bench, 890);
    assert_eq!(bench.mode(), Mode::Armed);
    bench.take(at(890));
    assert_eq!(bench.state.observation().position, 0);
}

/// Two approaches to the edge of a switch at `edge`, and the way back between them.
fn find_switch(bench: &mut ControllerBench, edge: i32) {
    let closed = Sample { home_switch: true, ..at(edge) };
    assert_eq!(bench.take(at(edge + 10)), -200);
    assert_eq!(bench.take(closed), 200);
    assert_eq!(bench.take(at(edge + 400)), -200);
    assert_eq!(bench.take(closed), 0);
}

/// It was found wherever the axis stood, and the drive went on with positions that meant nothing.
#[test]
fn a_homing_run_with_a_dead_encoder_trips() {
    for switch in [0, 1] {
        let changes = [(id::HOMING_STILL_MS, 13), (id::NO_MOTION_MS, 13), (id::HOMING_SWITCH, switch)];
        let mut bench = ControllerBench::armed(&changes, FAR);
        bench.state.home(&bench.config).expect("armed");
        // 9220 / 98 samples at 200 of 2048, behind the 10 that it may stand on the way to a stop.
        bench.hold(at(100), if switch == 0 { 104 } else { 95 });
        assert_eq!(bench.mode(), Mode::Homing);
        assert_eq!(bench.take(at(100)), 0);
        assert_eq!(bench.mode(), Mode::Fault(Fault::NoMotion), "switch: {switch}");
        assert!(!bench.state.supervisor.is_referenced());
    }
}

/// 21 samples of 439 beyond the idle part are 9219, as much as is allowed in 13 ms; the first sample has no command yet.
#[test]
fn a_homing_run_may_push_an_axis_that_stands_as_long_as_is_allowed_and_no_longer() {
    let changes = [(id::NO_MOTION_MS, 13), (id::HOMING_SWITCH, 1), (id::HOMING_COMMAND_COUNTS, 102 + 439)];
    let mut bench = ControllerBench::armed(&changes, FAR);
    bench.state.home(&bench.config).expect("armed");
    assert_eq!(bench.hold(at(100), 22), 541);
    assert_eq!(bench.take(at(100)), 0);
    assert_eq!(bench.mode(), Mode::Fault(Fault::NoMotion));
}

/// Counts mean nothing during a homing run, so its positions trip nothing; its steps do.
#[test]
fn a_homing_run_is_watched_by_what_needs_no_reference() {
    let mut bench = ControllerBench::armed(&[], FAR);
    bench.state.home(&bench.config).expect("armed");
    bench.take(at(1_000_000));
    assert_eq!(bench.mode(), Mode::Homing);
    bench.take(at(1_000_600));
    assert_eq!(bench.mode(), Mode::Fault(Fault::EncoderStep));
}

/// Whoever reads the state between that sample and the next is told that the axis is referenced.
#[test]
fn the_position_that_was_last_seen_counts_from_a_new_reference_at_once() {
    let homing = [(id::HOMING_SWITCH, 1), (id::HOMING_POSITION_COUNTS, 70)];
    let mut bench = ControllerBench::armed(&homing, FAR);
    bench.take(at(12_345));
    bench.state.reference(500);
    assert_eq!(bench.state.observation().position, 500);
    bench.state.home(&bench.config).expect("armed");
    find_switch(&mut bench, 12_290);
    assert_eq!((bench.mode(), bench.state.observation().position), (Mode::Armed, 70));
}
