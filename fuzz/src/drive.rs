//! A whole rig that two sessions talk to: the real server, supervisor, law, recorder and storage, on a board whose rod
//! follows the valve.

use std::convert::Infallible;

use arbitrary::{Result, Unstructured};
use pneudrive_app::fault_log::{MEMORY_BYTES, Memory};
use pneudrive_app::ram_flash::RamFlash;
use pneudrive_app::store::{FlashStore, Store as _};
use pneudrive_app::{Board, Control, Recorder, Server};
use pneudrive_controller::{Command, Config, Mode, Sample};
use pneudrive_protocol::change::{PART_BYTES, start_crc32};
use pneudrive_protocol::{
    Accumulator, MAX_FRAME, ReplyBody, Request, RequestBody, decode_reply, decode_request, encode, frame,
};

use crate::checks::{Seen, check, check_boot, drives, moves};
use crate::requests::{Room, body, change};

/// The sessions of the hosts.
const SESSIONS: [u32; 3] = [0x1001, 0x2002, 0x3003];

/// The most samples that an input asks for.
const MAX_SAMPLES: u32 = 400;

type Store = FlashStore<RamFlash, Box<Memory>>;

/// A board whose rod follows the valve.
#[derive(Debug)]
struct Rod {
    store: Store,
    now_us: u64,
    clock_ms: u64,
    position: i32,
    driven: Command,
}

impl Board for Rod {
    type Store = Store;

    fn store(&mut self) -> &mut Store {
        &mut self.store
    }

    fn name(&self) -> &'static str {
        "fuzz"
    }

    fn build(&self) -> &'static str {
        "fuzz"
    }

    fn read_sensors(&mut self, _: &Config) -> Sample {
        let pushed = if self.driven.drive_enable { i32::from(self.driven.counts) / 64 } else { 0 };
        self.position = self.position.saturating_add(pushed);
        let home_switch = self.position < -1000;
        Sample { position: self.position, pressure_1: 1600, pressure_2: 2400, spool: 2048, home_switch }
    }

    fn drive(&mut self, _: &Config, command: Command) {
        self.driven = command;
    }

    fn now_us(&self) -> u64 {
        self.now_us
    }

    fn host_clock_ms(&self) -> Option<u64> {
        Some(self.clock_ms)
    }
}

/// What happens next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// A request.
    Request,
    /// A request that has come before.
    Copy,
    /// A change in parts, the request to take it, and what may come between.
    Change,
    /// Samples, evenly.
    Samples,
    /// A time in which nobody is heard.
    Silence,
    /// A sample that comes late.
    Late,
    /// Bytes that are no frame.
    Noise,
    /// The rig is reset.
    Reset,
}

/// What happens next, requests and samples most often.
const STEPS: [Step; 16] = [
    Step::Request,
    Step::Request,
    Step::Request,
    Step::Request,
    Step::Request,
    Step::Request,
    Step::Copy,
    Step::Copy,
    Step::Change,
    Step::Change,
    Step::Samples,
    Step::Samples,
    Step::Silence,
    Step::Late,
    Step::Noise,
    Step::Reset,
];

/// Whatever hosts ask for, in whatever order and at whatever time: the rig does not panic; each request has one reply,
/// which can be read, or none if it came before; what is refused changes nothing; parameters change by a request that
/// was carried out alone; the drive is enabled by an arming alone, and moves for its owner alone.
pub fn requests(bytes: &[u8]) {
    let mut rig = Rig::new();
    let mut u = Unstructured::new(bytes);
    while !u.is_empty() && rig.step(&mut u).is_ok() {}
}

struct Rig {
    control: Box<Control<Recorder>>,
    /// One for each host.
    servers: [Box<Server>; 3],
    rod: Rod,
    sequence: u16,
    sent: Vec<(usize, Vec<u8>)>,
    /// The last change that was sent, and the last record, by their CRC-32.
    change: u32,
    samples: u32,
    /// The boot that each host means: the one that it was told last.
    meant: [u32; 3],
}

fn store_in(flash: RamFlash) -> Store {
    let memory: Box<Memory> = Box::new([0; MEMORY_BYTES]);
    FlashStore::take_up(flash, RamFlash::layout(), memory).expect("the layout of this flash").0
}

fn board() -> Rod {
    let store = store_in(RamFlash::default());
    Rod { store, now_us: 0, clock_ms: 1, position: 0, driven: Command::OFF }
}

impl Rig {
    fn new() -> Rig {
        let mut rig = Rig {
            control: Box::default(),
            servers: Default::default(),
            rod: board(),
            sequence: 0,
            sent: Vec::new(),
            change: 0,
            samples: 0,
            meant: [1; 3],
        };
        rig.reset();
        rig
    }

    fn reset(&mut self) {
        *self.control = Control::default();
        self.servers = Default::default();
        let before = self.rod.store.boot();
        self.rod.store = store_in(self.rod.store.flash().clone());
        assert!(self.rod.store.boot() > before, "a boot has a number of its own");
        self.control.take_up(&mut self.rod);
        assert!(!self.control.configuration().is_lost(), "no power was cut");
        let _ = self.control.set_referenced();
    }

    fn step(&mut self, u: &mut Unstructured<'_>) -> Result<()> {
        match *u.choose(&STEPS)? {
            Step::Request => self.any_request(u),
            Step::Copy => {
                if let Some(nth) = self.sent.len().checked_sub(1) {
                    let (host, frame) = self.sent[nth - u.int_in_range(0..=nth.min(12))?].clone();
                    self.receive(host, &frame);
                }
                Ok(())
            }
            Step::Change => self.any_change(u),
            Step::Samples => {
                let count = u.int_in_range(1..=20)?;
                (0..count).for_each(|_| self.sample(1300));
                Ok(())
            }
            Step::Silence => {
                self.rod.clock_ms += u64::from(*u.choose(&[100u32, 501, 61_000])?);
                self.sample(1300);
                Ok(())
            }
            Step::Late => {
                self.sample(u.int_in_range(0..=5000)?);
                Ok(())
            }
            Step::Noise => self.noise(u),
            Step::Reset => {
                self.reset();
                Ok(())
            }
        }
    }

    fn host(u: &mut Unstructured<'_>) -> Result<usize> {
        u.choose(&[0, 0, 0, 1, 1, 2]).copied()
    }

    fn any_request(&mut self, u: &mut Unstructured<'_>) -> Result<()> {
        let host = Rig::host(u)?;
        let named = match u.int_in_range(0..=2u8)? {
            0 => self.change,
            1 => self.record_crc32(),
            _ => start_crc32(self.control.test().crc32().unwrap_or(0), self.control.configuration().hash()),
        };
        let mut room = Room::default();
        let mut inner = Unstructured::new(u.bytes(u.len().min(24))?);
        let body = body(&mut inner, named, &mut room)?;
        self.ask(host, body);
        Ok(())
    }

    /// The CRC-32 of the record, if it is over.
    fn record_crc32(&mut self) -> u32 {
        let over = !matches!(self.control.state().supervisor.mode(), Mode::Armed | Mode::Running);
        over.then(|| self.control.recorder.digest(usize::MAX)).flatten().unwrap_or(0)
    }

    fn any_change(&mut self, u: &mut Unstructured<'_>) -> Result<()> {
        let host = Rig::host(u)?;
        let bytes = change(u)?;
        let crc32 = frame::crc32(&bytes);
        for (index, part) in bytes.chunks(PART_BYTES).enumerate() {
            self.ask(host, RequestBody::ChangePart { crc32, first: (index * PART_BYTES) as u16, part });
        }
        self.change = crc32;
        if u.ratio(1, 8)? {
            self.any_request(u)?;
        }
        self.ask(host, RequestBody::ChangeTake { crc32 });
        Ok(())
    }

    fn noise(&mut self, u: &mut Unstructured<'_>) -> Result<()> {
        let (host, count) = (Rig::host(u)?, u.int_in_range(0..=24)?);
        // A frame in noise would be one that the checks do not know of.
        let mut bytes: Vec<u8> = u.bytes(count.min(u.len()))?.iter().map(|&byte| byte.max(1)).collect();
        bytes.push(0);
        let mut accumulator: Accumulator = Accumulator::new();
        if bytes.iter().any(|&byte| matches!(accumulator.push(byte), Some(Ok(_)))) {
            return Ok(());
        }
        let reply = self.hear(host, &bytes);
        assert!(reply.is_empty(), "what is no frame has no reply");
        Ok(())
    }

    fn ask(&mut self, host: usize, body: RequestBody<'_>) {
        self.sequence = self.sequence.wrapping_add(1);
        let (sequence, session, boot) = (self.sequence, SESSIONS[host], self.meant[host]);
        let mut room = [0; MAX_FRAME];
        let framed = encode(&Request { sequence, session, boot, body }, &mut room);
        // A text may be too long to be sent.
        let Some(frame) = framed.map(<[u8]>::to_vec) else { return };
        self.sent.push((host, frame.clone()));
        let replied = self.receive(host, &frame);
        assert!(replied, "a new request has a reply: {body:?}");
    }

    /// Gives a request to the rig and looks at what becomes of it; whether it was answered.
    fn receive(&mut self, host: usize, frame: &[u8]) -> bool {
        let before = Seen::of(&self.control);
        let owner = self.control.owner(&self.rod).session;
        let enabled = before.mode;
        let replies = self.hear(host, frame);
        let meant = message(frame);
        let request = decode_request(&meant).expect("a request that was sent");
        let after = Seen::of(&self.control);
        let reply = (!replies.is_empty()).then(|| message(&replies));
        let reply = reply.as_deref().map(|reply| decode_reply(reply).expect("a reply of this version"));
        check(&request, reply.as_ref(), &before, &after, owner);
        let now = self.rod.store.boot();
        // A host that is told of another boot connects again.
        let told = check_boot(request.boot, now, reply.as_ref(), &before, &after);
        self.meant[host] = told.unwrap_or(self.meant[host]);
        let arms = matches!(request.body, RequestBody::Arm { .. });
        assert!(drives(enabled) || !drives(after.mode) || arms, "{:?} enabled the drive", request.body);
        reply.is_some()
    }

    fn hear(&mut self, host: usize, bytes: &[u8]) -> Vec<u8> {
        let mut replies = Vec::new();
        let heard: core::result::Result<(), Infallible> =
            self.servers[host].receive(bytes, &mut self.control, &mut self.rod, &mut replies);
        let Ok(()) = heard;
        replies
    }

    fn sample(&mut self, interval_us: u32) {
        self.samples += 1;
        if self.samples > MAX_SAMPLES {
            return;
        }
        self.rod.now_us += u64::from(interval_us);
        self.rod.clock_ms += 1;
        let before = self.control.state().supervisor.mode();
        let parameters = self.control.parameters().clone();
        self.control.on_sample(&mut self.rod);
        self.control.on_output(&mut self.rod);
        let after = self.control.state().supervisor.mode();
        assert!(drives(before) || !drives(after), "a sample enables no drive");
        assert!(moves(before) || !moves(after), "a sample starts no run");
        assert_eq!(
            self.rod.driven.drive_enable,
            drives(after),
            "the enable line is that of the mode {after:?}"
        );
        let null = self.rod.driven.counts == 0;
        assert!(null || moves(after) || after == Mode::Done, "{:?} in the mode {after:?}", self.rod.driven);
        assert_eq!(&parameters, self.control.parameters(), "a sample changes no parameter");
        for server in &mut self.servers {
            server.attend(&mut self.control);
            let mut rows = Vec::new();
            let Ok(()) = server.speak(&mut rows) as core::result::Result<(), Infallible>;
            if !rows.is_empty() {
                let rows = message(&rows);
                let rows = decode_reply(&rows).expect("a reply of this version");
                assert!(matches!(rows.body, ReplyBody::Rows { .. }), "only rows come unasked");
            }
        }
        let _ = self.control.tidy_up(&mut self.rod);
    }
}

/// The message in the first frame of these bytes.
fn message(frame: &[u8]) -> Vec<u8> {
    let mut accumulator: Accumulator = Accumulator::new();
    let whole = frame.iter().find_map(|&byte| accumulator.push(byte)?.ok().map(<[u8]>::to_vec));
    whole.expect("a frame that was sent whole")
}
