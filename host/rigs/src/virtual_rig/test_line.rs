//! A line to a virtual rig, for its tests.

use std::collections::VecDeque;
use std::io::{self, Read, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use pneudrive_protocol::{MAX_FRAME, Request, RequestBody, encode};

/// The rig's end of a line; a program writes into it, and breaks its way back or the whole of it.
#[derive(Clone, Default)]
pub struct Line {
    asked: Arc<Mutex<VecDeque<u8>>>,
    pub way_back_is_broken: Arc<AtomicBool>,
    pub is_closed: Arc<AtomicBool>,
}

impl Line {
    /// A request to a rig in its first boot.
    pub fn ask(&self, sequence: u16, body: RequestBody<'_>) {
        let mut frame = [0; MAX_FRAME];
        let request = Request { sequence, session: 1007, boot: 1, body };
        self.asked.lock().expect("one thread").extend(encode(&request, &mut frame).expect("fits"));
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
