//! A rig on a computer that was busy with something else.

use std::time::Duration;

use pneudrive_controller::Mode;
use pneudrive_protocol::RequestBody;
use pneudrive_sim::Rig;

use super::caller::Caller;
use super::test_line::Line;
use super::{Pace, VirtualRig};

#[test]
fn a_host_whose_request_waited_while_the_computer_was_busy_was_not_silent() {
    let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig");
    let mut rig = VirtualRig::new(rig, 0, Pace { fast: false, live: false }).expect("a rig");
    let line = Line::default();
    let mut callers = vec![Caller::new(line.clone(), None)];
    line.ask(1, RequestBody::Arm { host: "one" });
    line.ask(2, RequestBody::Home);
    rig.hear(&mut callers);
    rig.catch_up(&mut callers).expect("it is simulated");
    assert_eq!(rig.control.state().supervisor.mode(), Mode::Homing);
    line.ask(3, RequestBody::Status);
    // Longer than safety.host_silence_s, with the request at the port.
    std::thread::sleep(Duration::from_millis(700));
    for _ in 0..2 {
        rig.catch_up(&mut callers).expect("it is simulated");
        assert_eq!(rig.control.state().supervisor.mode(), Mode::Homing, "its host was heard");
        rig.hear(&mut callers);
    }
}
