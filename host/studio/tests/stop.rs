//! A stop waits for nothing else that the studio does.

use std::io::{ErrorKind, Read};

use pneudrive_link::client::Client;
use pneudrive_protocol::Mode;
use pneudrive_rigs::virtual_rig::{Background, Listener, Pace, VirtualRig};
use pneudrive_sim::Rig;
use pneudrive_sim::rigfile::builtin;
use serde_json::json;

use crate::visitor::studio_at;
use crate::wire::{asked, status};

/// A test of the longest kind: seconds of work.
const LONG: &str = "test.duration_s=250";

#[test]
fn a_drive_that_no_page_commands_is_stopped_while_slow_requests_take_all_threads() {
    let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig");
    let rig = VirtualRig::new(rig, 0, Pace { fast: false, live: true }).expect("a rig");
    let rig = Background::start(rig, Listener::open("tcp:127.0.0.1:0").expect("a port"));
    let mut other = Client::connect(rig.port()).expect("a rig");
    other.arm().expect("armed");
    let studio = studio_at(Some(rig.port()));
    let host = studio.local_address().to_string();
    std::thread::spawn(move || studio.serve());
    let text = builtin("servo-b-tuned").expect("a built-in rig");
    let slow = json!({ "name": "servo-b-tuned", "text": text, "settings": [LONG] });
    let mut slow: Vec<_> = (0..6).map(|_| asked(&host, "/api/ensemble", &slow)).collect();
    // Connections are taken in their order, so an answer to one of these means that the slow requests are there.
    for _ in 0..3 {
        assert!(status(&mut asked(&host, "/api/port", &json!({}))).contains("405"));
    }
    // A short request waits for a thread.
    slow.push(asked(&host, "/api/check", &json!({ "name": "servo-b-tuned", "text": text, "settings": [] })));
    let mut stop = asked(&host, "/api/order", &json!({ "order": "stop" }));
    assert!(status(&mut stop).contains("202"));
    for mut page in slow {
        page.get_ref().set_nonblocking(true).expect("a socket");
        let none = page.read(&mut [0]).expect_err("it is at work");
        assert_eq!(none.kind(), ErrorKind::WouldBlock, "the slow requests were over before the stop");
    }
    assert_eq!(other.status().expect("a status").mode, Mode::Fault);
}
