//! A program that has gone leaves its drive at once, however the rig notices.

use std::collections::VecDeque;
use std::io::{self, Read, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use pneudrive_protocol::{InSession, MAX_FRAME, Presence, Request, RequestBody, encode};
use pneudrive_sim::Rig;

use super::caller::Caller;
use super::{Pace, VirtualRig};

/// The rig's end of a line; a program writes into it, and breaks its way back or the whole of it.
#[derive(Clone, Default)]
struct Line {
    asked: Arc<Mutex<VecDeque<u8>>>,
    way_back_is_broken: Arc<AtomicBool>,
    is_closed: Arc<AtomicBool>,
}

impl Line {
    fn ask(&self, sequence: u16, body: RequestBody<'_>) {
        let mut frame = [0; MAX_FRAME];
        let asked = InSession { request: Request { sequence, body }, session: 7 };
        self.asked.lock().expect("one thread").extend(encode(&asked, &mut frame).expect("fits"));
    }
}

impl Read for Line {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self.asked.lock().expect("one thread").read(buffer) {
            Ok(0) if self.is_closed.load(Ordering::Relaxed) => Ok(0),
            Ok(0) => Err(io::ErrorKind::WouldBlock.into()),
            count => count,
        }
    }
}

impl Write for Line {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.way_back_is_broken.load(Ordering::Relaxed) {
            true => Err(io::ErrorKind::BrokenPipe.into()),
            false => Ok(bytes.len()),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_host_that_has_gone_owns_nothing_whether_reading_or_writing_finds_that_out() {
    for writing in [false, true] {
        let settings = ["safety.host_silence_s=0".to_owned()];
        let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig").with_settings(&settings);
        let pace = Pace { fast: false, live: false };
        let mut rig = VirtualRig::new(rig.expect("valid"), 0, pace).expect("a rig");
        let line = Line::default();
        let mut callers = vec![Caller::new(line.clone(), None)];
        line.ask(1, RequestBody::ArmAs { host: "one" });
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
