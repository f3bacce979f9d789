//! A rig that lies: a virtual rig, and between it and the program somebody who changes what it says.

pub mod lies;

use std::collections::HashMap;
use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use pneudrive_protocol::{
    Accumulator, MAX_FRAME, Reply, ReplyBody, RequestBody, decode_reply, decode_request, encode,
};
use pneudrive_rigs::virtual_rig::Background;

/// What becomes of a reply of the rig.
pub enum Says {
    /// It goes on to the program as it is.
    Truth,
    /// It is lost.
    Nothing,
    /// The program hears these bytes in its place.
    Instead(Vec<u8>),
    /// The line is cut.
    HangUp,
}

/// What a lie remembers of one connection.
#[derive(Default)]
pub struct Memory {
    /// Replies of the kind that the lie is about, so far.
    pub count: u32,
    /// Number of the request that began a stream.
    pub stream: Option<u16>,
    /// Whether a run has been started.
    pub started: bool,
}

/// How a rig lies.
#[derive(Clone, Copy)]
pub struct Lie {
    /// What it makes of the reply to a request.
    pub on_reply: fn(&mut Memory, &RequestBody<'_>, &Reply<'_>) -> Says,
    /// What it says unasked, some hundred times a second.
    pub unasked: fn(&mut Memory) -> Vec<u8>,
}

/// The frame of a reply.
pub fn frame(sequence: u16, body: ReplyBody<'_>) -> Vec<u8> {
    let mut frame = [0; MAX_FRAME];
    encode(&Reply { sequence, body }, &mut frame).expect("fits").to_vec()
}

/// A rig that lies, at a port of this machine.
pub struct HostileRig {
    port: String,
    over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl HostileRig {
    /// Begins to listen in front of an honest rig, which goes on behind it.
    pub fn before(rig: Background, lie: Lie) -> HostileRig {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        listener.set_nonblocking(true).expect("a port that does not block");
        let port = format!("tcp://{}", listener.local_addr().expect("bound"));
        let over = Arc::new(AtomicBool::new(false));
        let seen = Arc::clone(&over);
        let thread = std::thread::spawn(move || {
            let address = rig.port().trim_start_matches("tcp://").to_owned();
            while !seen.load(Ordering::Relaxed) {
                match listener.accept() {
                    Ok((program, _)) => {
                        let rig = TcpStream::connect(&address).expect("the honest rig listens");
                        Between::new(program, rig, lie).serve(&seen);
                    }
                    Err(_) => std::thread::sleep(Duration::from_millis(2)),
                }
            }
        });
        HostileRig { port, over, thread: Some(thread) }
    }

    pub fn port(&self) -> &str {
        &self.port
    }
}

impl Drop for HostileRig {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
        self.thread.take().map(JoinHandle::join);
    }
}

/// Who stands between a program and the honest rig.
struct Between {
    program: TcpStream,
    rig: TcpStream,
    lie: Lie,
    memory: Memory,
    asked: Accumulator,
    answered: Accumulator,
    /// Messages of requests, by their number.
    requests: HashMap<u16, Vec<u8>>,
}

/// Bytes that have come; None at the end.
fn some(stream: &mut TcpStream, bytes: &mut [u8]) -> Option<usize> {
    match stream.read(bytes) {
        Ok(0) => None,
        Ok(count) => Some(count),
        Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => Some(0),
        Err(_) => None,
    }
}

impl Between {
    fn new(program: TcpStream, rig: TcpStream, lie: Lie) -> Between {
        for stream in [&program, &rig] {
            stream.set_nonblocking(false).expect("a stream");
            stream.set_nodelay(true).expect("a stream");
            stream.set_read_timeout(Some(Duration::from_millis(1))).expect("a stream");
            stream.set_write_timeout(Some(Duration::from_millis(200))).expect("a stream");
        }
        let (asked, answered) = (Accumulator::new(), Accumulator::new());
        Between { program, rig, lie, memory: Memory::default(), asked, answered, requests: HashMap::new() }
    }

    /// Until either side has gone.
    fn serve(mut self, over: &AtomicBool) {
        let mut bytes = vec![0; 65_536];
        while !over.load(Ordering::Relaxed) {
            let Some(count) = some(&mut self.program, &mut bytes) else { return };
            if !self.ask(&bytes[..count]) {
                return;
            }
            let Some(count) = some(&mut self.rig, &mut bytes) else { return };
            let unasked = (self.lie.unasked)(&mut self.memory);
            let answered = self.answer(&bytes[..count]);
            if !self.say(&unasked) || !answered {
                return;
            }
        }
    }

    fn ask(&mut self, bytes: &[u8]) -> bool {
        for &byte in bytes {
            let Some(Ok(message)) = self.asked.push(byte) else { continue };
            let Ok(request) = decode_request(message) else { continue };
            match request.body {
                RequestBody::StreamBegin { every: 1.., .. } => self.memory.stream = Some(request.sequence),
                RequestBody::StreamBegin { .. } => self.memory.stream = None,
                RequestBody::Start { .. } => self.memory.started = true,
                _ => {}
            }
            self.requests.insert(request.sequence, message.to_vec());
        }
        self.rig.write_all(bytes).is_ok()
    }

    fn answer(&mut self, bytes: &[u8]) -> bool {
        let mut printed = Vec::new();
        let mut hung_up = false;
        for &byte in bytes {
            let Some(Ok(message)) = self.answered.push(byte) else { continue };
            let Ok(reply) = decode_reply(message) else { continue };
            let request = self.requests.get(&reply.sequence).and_then(|asked| decode_request(asked).ok());
            let Some(request) = request else { continue };
            match (self.lie.on_reply)(&mut self.memory, &request.body, &reply) {
                Says::Truth => printed.extend(frame(reply.sequence, reply.body)),
                Says::Nothing => {}
                Says::Instead(bytes) => printed.extend(bytes),
                Says::HangUp => hung_up = true,
            }
        }
        self.say(&printed) && !hung_up
    }

    /// A program that reads nothing is not waited for.
    fn say(&mut self, bytes: &[u8]) -> bool {
        match self.program.write_all(bytes) {
            Ok(()) => true,
            Err(error) => matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut),
        }
    }
}
