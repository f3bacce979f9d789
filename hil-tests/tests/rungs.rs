//! The headline: the same samples give the same commands, equal in every bit, on every rung.

use std::sync::atomic::AtomicBool;

use pneudrive::client::{Client, Record};
use pneudrive_controller::Observation;
use pneudrive_hil_tests::{Target, VirtualTarget};
use pneudrive_protocol::{Mode, RecordedSample};
use pneudrive_sim::{Accuracy, Rig, run};

fn rig(name: &str, settings: &[&str]) -> Rig {
    let text = pneudrive_sim::rig::builtin(name).expect("a built-in rig");
    let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
    Rig::read_with(name, text, &settings).unwrap_or_else(|problems| panic!("{problems}"))
}

/// Downloads, arms, starts and follows the rig's test, and pulls its record.
fn run_and_record(target: &impl Target, rig: &Rig) -> Record {
    let mut client = target.connect().expect("a rig that answers");
    run_on(&mut client, rig);
    let record = client.record(|_, _| {}).expect("a record");
    client.disarm().expect("an answer");
    record
}

fn run_on(client: &mut Client, rig: &Rig) {
    client.download_test(rig).expect("a disarmed rig takes a test");
    client.arm().expect("referenced");
    client.start().expect("armed");
    assert_eq!(client.follow(&AtomicBool::new(false), |_| {}).expect("no fault").mode, Mode::Done);
}

/// A rig in the middle of a run that will not end by itself, and who started it.
fn in_a_long_run() -> (VirtualTarget, Client) {
    let rig = rig("servo-b", &["test.duration_s=3000"]);
    let target = VirtualTarget::start(&rig, "tcp:127.0.0.1:0").expect("a virtual rig");
    let mut client = target.connect().expect("a rig that answers");
    client.download_test(&rig).expect("disarmed");
    client.arm().expect("referenced");
    client.start().expect("armed");
    (target, client)
}

/// What the recorder stores of an observation.
fn recorded(seen: &Observation) -> RecordedSample {
    RecordedSample {
        position: seen.position,
        pressure_1: seen.pressure_1,
        pressure_2: seen.pressure_2,
        command: seen.command,
        error: seen.error as i16,
        spool: seen.spool,
    }
}

/// The first different sample fails, with both sides.
fn assert_equal_in_every_integer(target: &impl Target, rig: &Rig) {
    let simulated = run(rig, Accuracy::default()).expect("a transient").observations;
    let record = run_and_record(target, rig);
    assert_eq!(record.samples.len(), simulated.len(), "{}: samples", target.name());
    for (k, (on_rig, seen)) in record.samples.iter().zip(&simulated).enumerate() {
        assert_eq!(
            *on_rig,
            recorded(seen),
            "{}: sample {k} (left: recorded, right: simulated)",
            target.name()
        );
    }
    assert!(simulated.iter().any(|seen| seen.command != 0), "a test that moves nothing proves nothing");
}

#[test]
fn the_record_of_the_virtual_rig_is_the_simulation_in_closed_loop() {
    for name in ["servo-a", "servo-a-tuned", "servo-b", "servo-b-tuned", "servo-c", "servo-c-tuned"] {
        let rig = rig(
            name,
            &["test.duration_s=5", "test.moves=[[0.0, 8192], [0.3, 16384], [1.72, 8192], [3.2, 12000]]"],
        );
        let target = VirtualTarget::start(&rig, "tcp:127.0.0.1:0").expect("a virtual rig");
        assert_equal_in_every_integer(&target, &rig);
    }
}

/// Moore's law, the relay and the valve that is thrown over; as long as the recorder holds.
#[test]
fn the_record_of_the_virtual_rig_is_the_simulation_of_the_other_built_in_rigs() {
    for name in ["lut-stepper", "lut-solenoid", "burrows", "bang-bang"] {
        let rig = rig(name, &["test.duration_s=2.1"]);
        let target = VirtualTarget::start(&rig, "tcp:127.0.0.1:0").expect("a virtual rig");
        assert_equal_in_every_integer(&target, &rig);
    }
}

#[test]
fn the_record_of_the_virtual_rig_is_the_simulation_in_open_loop() {
    let moves = "test.moves=[[0.0, 0], [0.1, 512], [0.5, -512], [1.2, 200], [3.0, -2048]]";
    let rig = rig("servo-b", &["controller.loop=open", moves, "test.duration_s=5"]);
    let target = VirtualTarget::start(&rig, "tcp:127.0.0.1:0").expect("a virtual rig");
    assert_equal_in_every_integer(&target, &rig);
}

#[test]
fn rows_of_a_trace_in_between_change_nothing() {
    // 2.6 s is both a sample and a millisecond: the two end alike.
    let every_sample = rig("servo-b", &["test.duration_s=2.6"]);
    let every_millisecond = rig("servo-b", &["test.duration_s=2.6", "test.trace_period_s=0.001"]);
    let transient = |rig: &Rig| run(rig, Accuracy::default()).expect("a transient");
    let (a, b) = (transient(&every_sample), transient(&every_millisecond));
    assert_eq!(a.observations, b.observations);
    assert_eq!(a.work.integrator, b.work.integrator, "the same steps");
    let at = |run: &pneudrive_sim::Run, time: f64| {
        run.rows.iter().find(|row| (row.time - time).abs() < 1e-9).map(|row| row.plant)
    };
    assert_eq!(at(&a, 2.6), at(&b, 2.6), "the same bits");
}

#[cfg(unix)]
#[test]
fn a_pty_carries_the_same_record_as_tcp() {
    let rig = rig("servo-b-tuned", &["test.duration_s=0.5"]);
    let over = |door: &str| {
        let target = VirtualTarget::start(&rig, door).expect("a virtual rig");
        run_and_record(&target, &rig).samples
    };
    assert_eq!(over("pty"), over("tcp:127.0.0.1:0"));
}

#[test]
fn each_start_begins_from_the_same_state() {
    let rig = rig("servo-b", &["test.duration_s=0.6"]);
    let target = VirtualTarget::start(&rig, "tcp:127.0.0.1:0").expect("a virtual rig");
    let first = run_and_record(&target, &rig).samples;
    assert_eq!(run_and_record(&target, &rig).samples, first);
}

#[test]
fn a_stop_ends_a_run_in_a_named_fault_and_arming_leaves_it() {
    let (_target, mut client) = in_a_long_run();
    client.stop().expect("an answer");
    let error = client.follow(&AtomicBool::new(false), |_| {}).expect_err("stopped").to_string();
    assert!(error.contains("stop (a stop was requested)"), "{error}");
    client.arm().expect("arming leaves the fault");
    assert_eq!(client.status().expect("an answer").mode, Mode::Armed);
}

#[test]
fn a_rig_without_a_record_says_so() {
    let rig = rig("servo-b", &[]);
    let target = VirtualTarget::start(&rig, "tcp:127.0.0.1:0").expect("a virtual rig");
    let mut client = target.connect().expect("a rig that answers");
    let error = client.record(|_, _| {}).expect_err("no record").to_string();
    assert!(error.contains("nothing has been recorded"), "{error}");
}

/// A second program must reach the rig while the first one follows a run.
#[test]
fn a_stop_from_another_program_reaches_a_running_rig() {
    let (target, mut first) = in_a_long_run();
    target.connect().expect("the same rig").stop().expect("an answer");
    let error = first.follow(&AtomicBool::new(false), |_| {}).expect_err("stopped").to_string();
    assert!(error.contains("stop (a stop was requested)"), "{error}");
}

#[test]
fn an_interrupted_run_is_stopped() {
    let (_target, mut client) = in_a_long_run();
    client.follow(&AtomicBool::new(true), |_| {}).expect_err("stopped");
    assert_eq!(client.status().expect("an answer").mode, Mode::Fault);
}

#[test]
fn a_rig_that_is_given_another_period_keeps_that_time() {
    let file = rig("servo-b", &["test.duration_s=0.5"]);
    let other = rig("servo-b", &["test.duration_s=0.5", "controller.period_s=0.002"]);
    let target = VirtualTarget::start(&file, "tcp:127.0.0.1:0").expect("a virtual rig");
    let mut client = target.connect().expect("a rig that answers");
    client.import_parameters(&other.parameters()).expect("disarmed");
    drop(client);
    assert_equal_in_every_integer(&target, &other);
}

#[test]
fn the_record_of_a_stepper_drive_is_the_simulation() {
    let settings = [
        "operator.model=stepper",
        "test.duration_s=5",
        "test.moves=[[0.0, 8192], [0.3, 16384], [1.72, 8192]]",
    ];
    let rig = rig("servo-b", &settings);
    let target = VirtualTarget::start(&rig, "tcp:127.0.0.1:0").expect("a virtual rig");
    assert_equal_in_every_integer(&target, &rig);
}
