//! A rig that can be reached from a network obeys programs that know its token, and no others.

use std::process::Command;

use pneudrive_rigs::virtual_rig::{Background, Listener, Pace, Token, VirtualRig};
use pneudrive_sim::Rig;

const SECRET: &str = "correct horse battery staple";

fn rig() -> VirtualRig {
    let rig = Rig::builtin("servo-b").expect("built in");
    VirtualRig::new(rig, 0, Pace { fast: true, live: false }).expect("a rig")
}

/// What `pneudrive device status` says with this token, and whether it succeeds.
fn status(port: &str, token: Option<&str>) -> (bool, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pneudrive"));
    command.args(["device", "--port", port, "status"]);
    command.env_remove("PNEUDRIVE_TOKEN");
    if let Some(token) = token {
        command.env("PNEUDRIVE_TOKEN", token);
    }
    let output = command.output().expect("the program runs");
    let printed = [output.stdout, output.stderr].concat();
    (output.status.success(), String::from_utf8(printed).expect("UTF-8"))
}

#[test]
fn a_door_to_the_network_without_a_token_is_not_opened() {
    let error = Listener::open("tcp:0.0.0.0:0").err().expect("anybody could move the drive").to_string();
    assert!(
        error.contains("can be reached from the network") && error.contains("PNEUDRIVE_TOKEN"),
        "{error}"
    );
    assert!(Listener::open("tcp:127.0.0.1:0").is_ok());
    let token = Token::new(SECRET).expect("long enough");
    assert!(Listener::open_with("tcp:0.0.0.0:0", Some(token)).is_ok());
}

#[test]
fn programs_without_the_token_are_told_what_is_missing_and_do_nothing() {
    let listener = Listener::open_with("tcp:127.0.0.1:0", Some(Token::new(SECRET).expect("long enough")));
    let rig = Background::start(rig(), listener.expect("a port"));
    let (done, printed) = status(rig.port(), None);
    assert!(!done && printed.contains("it asks for a token; set PNEUDRIVE_TOKEN"), "{printed}");
    let (done, printed) = status(rig.port(), Some("correct horse battery stapler"));
    assert!(!done && printed.contains("was it started with another PNEUDRIVE_TOKEN?"), "{printed}");
    let (done, printed) = status(rig.port(), Some(SECRET));
    assert!(done && printed.starts_with("mode        disarmed"), "{printed}");
}

#[test]
fn a_rig_that_asks_for_no_token_obeys_programs_that_have_one() {
    let rig = Background::start(rig(), Listener::open("tcp:127.0.0.1:0").expect("a port"));
    let (done, printed) = status(rig.port(), Some(SECRET));
    assert!(done, "{printed}");
}
