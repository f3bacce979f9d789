//! A host whose answers are lost still lives; one whose requests a gateway repeats may be dead.

use std::time::Duration;

use pneudrive_controller::{Fault, Mode};
use pneudrive_link::client::Client;
use pneudrive_sim::Rig;

use crate::simulated_link::{Random, SimulatedRig, any_samples};

/// A drive that runs a test of ten seconds for this client, and trips once it has missed it for 0.5 s.
fn moving() -> (SimulatedRig, Client) {
    let text = "name = \"long\"\n[test]\nmoves = [[0, 8000]]\nduration_s = 10.0\nposition_m = 1.2e-3\n";
    let rig = SimulatedRig::with_record(&[]);
    rig.change(|simulation| {
        simulation.board.judges_silence = true;
        simulation.take_samples();
    });
    let mut client = rig.connect().expect("an answer");
    client.reference(0).expect("disarmed");
    client.download_test(&Rig::read("test", text).expect("a rig file")).expect("disarmed");
    client.arm().expect("referenced");
    client.start().expect("armed");
    (rig, client)
}

fn mode(rig: &SimulatedRig) -> Mode {
    rig.change(|simulation| simulation.mode())
}

#[test]
fn a_moving_drive_whose_answers_are_lost_for_600_ms_does_not_trip_as_its_host_goes_on_asking() {
    let (rig, mut client) = moving();
    for _ in 0..20 {
        client.status().expect("an answer");
    }
    rig.change(|simulation| simulation.mute_until = simulation.now() + Duration::from_millis(600));
    let before = rig.change(|simulation| simulation.now());
    client.status().expect("an answer after 0.6 s");
    let after = rig.change(|simulation| simulation.now());
    assert!(after - before > Duration::from_millis(600), "{:?}", after - before);
    assert_eq!(mode(&rig), Mode::Running);
    assert!(client.losses().1 >= 5, "{:?}", client.losses());
}

#[test]
fn a_moving_drive_that_hears_only_copies_of_its_hosts_last_question_trips() {
    let (rig, mut client) = moving();
    client.status().expect("an answer");
    rig.change(|simulation| simulation.repeats_the_last_frame());
    let before = rig.change(|simulation| simulation.now());
    client.status().expect_err("the gateway lets nothing through");
    assert_eq!(mode(&rig), Mode::Fault(Fault::HostSilent));
    assert!(rig.change(|simulation| simulation.now()) - before < Duration::from_secs(2));
}

/// Whatever answer comes first ends the question, be it that to an earlier repeat of it; those to earlier questions do not.
#[test]
fn a_late_answer_to_an_earlier_repeat_is_an_answer() {
    let (rig, mut client) = moving();
    rig.change(|simulation| simulation.down.delay = Duration::from_millis(250));
    let before = rig.change(|simulation| simulation.now());
    let first = client.status().expect("an answer");
    let after = rig.change(|simulation| simulation.now());
    assert!(
        after - before < Duration::from_millis(300),
        "the answer to the first request: {:?}",
        after - before
    );
    let second = client.status().expect("an answer");
    assert!(second.index > first.index + 100, "{} and {}: of a later question", first.index, second.index);
}

#[test]
fn a_download_whose_answers_are_lost_keeps_its_host_the_owner_of_a_drive_that_holds() {
    let samples = any_samples(&mut Random(5), 300);
    let rig = SimulatedRig::with_record(&samples);
    let mut client = rig.connect().expect("an answer");
    let head = client.record_head().expect("a record");
    let before = rig.change(|simulation| simulation.numbers_heard());
    rig.change(|simulation| simulation.mute_until = simulation.now() + Duration::from_millis(600));
    let pieces = pneudrive_link::client::Pieces::none(head.samples);
    let record = client.download(&head, pieces, |_, _| Ok(())).expect("the whole record");
    assert_eq!(record.samples, samples);
    let numbers = rig.change(|simulation| simulation.numbers_heard());
    assert!(numbers.len() - before.len() >= 50, "each repeat has a number of its own: {numbers:?}");
    let grow = numbers.array_windows().all(|[one, next]| next.wrapping_sub(*one).cast_signed() > 0);
    assert!(grow, "and each is newer than the one before: {numbers:?}");
}
