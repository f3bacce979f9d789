//! Whether the control is in time. How long an instruction takes is not known more closely than one cycle to six.

use std::sync::atomic::AtomicBool;
use std::time::Duration;

use pneudrive_flashed_image::board::Lateness;
use pneudrive_flashed_image::target::FlashedTarget;
use pneudrive_flashed_image::time::{Corner, FAST, MICROSECOND, SLOWEST, microseconds};
use pneudrive_hil_tests::requests::{IN_A_RUN, LEARNING, fill_log};
use pneudrive_hil_tests::{Target, body};
use pneudrive_link::client::Client;
use pneudrive_protocol::Mode;
use pneudrive_sim::Rig;

/// Rigs with the shortest and the usual period of the built-in ones.
const RIGS: [&str; 2] = ["burrows", "servo-b-tuned"];

fn worst(target: &FlashedTarget) -> Lateness {
    target.with(|machine| std::mem::take(&mut machine.board().lateness)).expect("a board that runs")
}

/// A board whose fault log is full, with a client that has armed it.
fn started(rig: &Rig, corner: Corner) -> (FlashedTarget, Client) {
    let target = FlashedTarget::start(rig, corner).expect("a board");
    let mut client = target.connect().expect("a rig that answers");
    fill_log(&mut client).expect("referenced");
    client.download_test(rig).expect("disarmed");
    client.arm().expect("referenced");
    (target, client)
}

/// Asks a drive that moves everything, again and again until its run is over.
fn ask_all_the_time(client: &mut Client, rig: &Rig) {
    let mut rounds = 0;
    while client.status().expect("an answer").mode == Mode::Running {
        for question in &IN_A_RUN {
            if let Err(error) = (question.ask)(client, rig) {
                let status = client.status().expect("an answer");
                panic!(
                    "{}: {error:#}; the drive is {:?}, fault {}",
                    question.name, status.mode, status.fault
                );
            }
        }
        rounds += 1;
    }
    assert!(rounds > 3, "the run was over after {rounds} rounds");
    client.follow(&AtomicBool::new(false), |_| {}).expect("no fault");
}

fn assert_in_time(target: &FlashedTarget, limits_us: [u64; 2], what: &str) {
    let Lateness { sample, output } = worst(target);
    println!("{what}: {:.1} us, {:.1} us", microseconds(sample), microseconds(output));
    let [sample_us, output_us] = limits_us;
    assert!(sample > 0 && sample <= sample_us * MICROSECOND, "{what}: {sample}");
    assert!(output > 0 && output <= output_us * MICROSECOND, "{what}: {output}");
}

/// With nobody asking for anything, the encoder is read and the command goes out within 10 us and 5 us of their
/// instants, at both ends.
#[test]
fn the_control_by_itself_is_in_time_at_one_cycle_and_at_six() {
    for (name, corner) in RIGS.into_iter().flat_map(|name| [(name, FAST), (name, SLOWEST)]) {
        let (target, _client) = started(&body::rig(name, &["test.duration_s=0.6"]), corner);
        let _ = worst(&target);
        std::thread::sleep(Duration::from_millis(100));
        assert_in_time(&target, [10, 5], &format!("{name}, {corner:?}"));
    }
}

/// A drive that moves is asked everything, its record is read while it holds, and it is armed anew with what it has learned:
/// nothing is later than 40 us. A sample or an output trips at 100 us.
#[test]
fn no_request_makes_the_control_late_at_one_cycle_and_at_six() {
    for (name, corner) in RIGS.into_iter().flat_map(|name| [(name, FAST), (name, SLOWEST)]) {
        let rig = body::rig(name, &["test.duration_s=3", LEARNING[0], LEARNING[1]]);
        let (target, mut client) = started(&rig, corner);
        client.start().expect("armed");
        ask_all_the_time(&mut client, &rig);
        client.record(|_, _| {}).expect("a record");
        client.arm().expect("the drive holds");
        assert_in_time(&target, [40, 40], &format!("{name} and every request, {corner:?}"));
    }
}
