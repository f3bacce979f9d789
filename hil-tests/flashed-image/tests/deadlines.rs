//! Whether the control is in time. How long an instruction takes is not known more closely than one cycle to six.

use std::sync::atomic::AtomicBool;

use pneudrive_controller::Fault;
use pneudrive_flashed_image::board::Lateness;
use pneudrive_flashed_image::target::FlashedTarget;
use pneudrive_flashed_image::time::{Corner, FAST, LAID_OUT_FOR, MICROSECOND, SLOWEST, microseconds};
use pneudrive_hil_tests::{Target, body};
use pneudrive_link::client::Client;
use pneudrive_protocol::Mode;

/// Rigs with the shortest and the usual period of the built-in ones.
const RIGS: [&str; 2] = ["burrows", "servo-b-tuned"];

fn worst(target: &FlashedTarget) -> Lateness {
    target.with(|machine| std::mem::take(&mut machine.board().lateness)).expect("a board that runs")
}

fn started(name: &str, corner: Corner) -> (FlashedTarget, Client) {
    let rig = body::rig(name, &["test.duration_s=0.6"]);
    let target = FlashedTarget::start(&rig, corner).expect("a board");
    let mut client = target.connect().expect("a rig that answers");
    client.download_test(&rig).expect("disarmed");
    client.arm().expect("referenced");
    (target, client)
}

/// With nobody asking for anything, the encoder is read and the command goes out within 10 us and 5 us of their
/// instants, at both ends.
#[test]
fn the_control_by_itself_is_in_time_at_one_cycle_and_at_six() {
    for (name, corner) in RIGS.into_iter().flat_map(|name| [(name, FAST), (name, SLOWEST)]) {
        let (target, _client) = started(name, corner);
        let _ = worst(&target);
        std::thread::sleep(std::time::Duration::from_millis(100));
        let Lateness { sample, output } = worst(&target);
        println!("{name}, {corner:?}: {:.1} us, {:.1} us", microseconds(sample), microseconds(output));
        assert!(sample > 0 && sample <= 10 * MICROSECOND, "{name}, {corner:?}: {sample}");
        assert!(output > 0 && output <= 5 * MICROSECOND, "{name}, {corner:?}: {output}");
    }
}

/// A whole run with its requests, its stream of status and its record: nothing is later than the 100 us that the
/// drive allows a sample.
#[test]
fn the_control_is_in_time_beside_requests_up_to_two_cycles_an_instruction() {
    for (name, corner) in RIGS.into_iter().flat_map(|name| [(name, FAST), (name, LAID_OUT_FOR)]) {
        let (target, mut client) = started(name, corner);
        client.start().expect("armed");
        client.follow(&AtomicBool::new(false), |_| {}).expect("no fault");
        client.record(|_, _| {}).expect("a record");
        let Lateness { sample, output } = worst(&target);
        println!("{name}, {corner:?}: {:.1} us, {:.1} us", microseconds(sample), microseconds(output));
        assert!(sample <= 100 * MICROSECOND && output <= 100 * MICROSECOND, "{name}, {corner:?}");
    }
}

/// At six cycles the longest requests keep the control out for too long: a start of a period of 0.5 ms trips the drive
/// by name, before anything has moved. Once requests are shorter, this test fails, and the one above takes its corner.
#[test]
fn a_request_that_keeps_the_control_out_for_too_long_trips_the_drive_before_it_moves() {
    let (_target, mut client) = started("burrows", SLOWEST);
    client.start().expect_err("the drive has tripped on the way");
    let status = client.status().expect("an answer");
    assert_eq!((status.mode, status.fault), (Mode::Fault, Fault::LateSample.code()));
    assert_eq!(status.index, 0, "no sample of the run");
}
