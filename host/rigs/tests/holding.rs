//! A drive whose run is over and whose host has gone holds for a while, and is then disarmed without a fault.

use std::time::{Duration, Instant};

use pneudrive_link::client::Client;
use pneudrive_protocol::{Mode, Presence};
use pneudrive_rigs::virtual_rig::{Background, Listener, Pace, VirtualRig};
use pneudrive_sim::Rig;

const SETTINGS: [&str; 3] = ["test.duration_s=0.3", "test.moves=[[0.0, 9000]]", "safety.hold_s=1"];

fn rig() -> Rig {
    let text = pneudrive_sim::rigfile::builtin("servo-b-tuned").expect("a built-in rig");
    Rig::read_with("servo-b-tuned", text, &SETTINGS.map(str::to_owned)).expect("a rig")
}

#[test]
fn a_drive_that_its_host_has_left_after_the_run_is_disarmed_when_its_hold_is_over() {
    let pace = Pace { fast: false, live: false };
    let served = VirtualRig::new(rig(), 0, pace).expect("a rig");
    let served = Background::start(served, Listener::open("tcp:127.0.0.1:0").expect("a port"));
    let mut host = Client::connect(served.port()).expect("an answer");
    host.download_test(&rig()).expect("disarmed");
    host.arm().expect("referenced");
    host.start().expect("armed");
    assert_eq!(host.follow(&false.into(), |_| {}).expect("no fault").mode, Mode::Done);
    let mut other = Client::connect(served.port()).expect("an answer");
    assert!(other.disarm().is_err(), "its host is there");
    drop(host);
    let left = Instant::now();
    while other.status().expect("an answer").mode == Mode::Done && left.elapsed() < Duration::from_secs(10) {
        std::thread::sleep(Duration::from_millis(10));
    }
    let status = other.status().expect("an answer");
    assert_eq!((status.mode, status.fault), (Mode::Disarmed, 0));
    let held_s = left.elapsed().as_secs_f64();
    assert!((0.9..2.0).contains(&held_s), "held for {held_s:.2} s, not 1 s");
    assert_eq!(other.owner().expect("an answer").presence, Presence::Nobody);
    assert!(other.record(|_, _| {}).is_ok(), "its record stays");
}
