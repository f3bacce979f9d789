//! A program that has gone leaves its drive at once, however the rig notices.

use std::sync::atomic::Ordering;

use pneudrive_protocol::{Presence, RequestBody};
use pneudrive_sim::Rig;

use super::caller::Caller;
use super::test_line::Line;
use super::{Pace, VirtualRig};

#[test]
fn a_host_that_has_gone_owns_nothing_whether_reading_or_writing_finds_that_out() {
    for writing in [false, true] {
        let settings = ["safety.host_silence_s=0".to_owned()];
        let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig").with_settings(&settings);
        let pace = Pace { fast: false, live: false };
        let mut rig = VirtualRig::new(rig.expect("valid"), 0, pace).expect("a rig");
        let line = Line::default();
        let mut callers = vec![Caller::new(line.clone(), None)];
        line.ask(1, RequestBody::Arm { host: "one" });
        rig.hear(&mut callers);
        assert_eq!(rig.control.presence(&rig.board), Presence::There);
        if writing {
            line.way_back_is_broken.store(true, Ordering::Relaxed);
            line.ask(2, RequestBody::Status);
        } else {
            line.is_closed.store(true, Ordering::Relaxed);
        }
        rig.hear(&mut callers);
        assert!(callers.is_empty());
        assert_eq!(rig.control.presence(&rig.board), Presence::Gone, "writing: {writing}");
    }
}
