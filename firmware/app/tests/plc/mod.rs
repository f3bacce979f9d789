//! A PLC at the digital inputs of a drive with flash, whose rod goes as its valve says: contacts that bounce, and what
//! goes wrong meanwhile.

pub mod oracle;

use pneudrive_app::fault_log::{MEMORY_BYTES, Memory};
use pneudrive_app::store::{FlashStore, Layout, Store as _};
use pneudrive_app::{Board, Control, Server};
use pneudrive_controller::{Command, Config, Mode, Sample};
use pneudrive_protocol::io::input::{ACKNOWLEDGE, ENABLE, NUMBER, RUN, START};
use pneudrive_protocol::{MAX_FRAME, Request, RequestBody, encode};

use crate::nor_flash::{Flash, SECTOR};

/// Time from a sample to the next, microseconds: the default of the parameters.
pub const PERIOD_US: u64 = 1300;

/// Bytes of a slot of the fault log on both boards; the second one of the Nucleo is longer.
const SLOT: u32 = 16 * 1024;
const SLOTS: usize = 4;
/// Sectors of a slot.
const SECTORS: usize = SLOT as usize / SECTOR;

/// Numbers by SplitMix64: the same on every machine.
pub struct Random(pub u64);

impl Random {
    /// Below `end`, which is not 0.
    pub fn below(&mut self, end: u32) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % u64::from(end)) as u32
    }
}

/// A board whose rod goes at a speed in proportion to its valve's command, beyond a null that drifts.
pub struct Plant {
    pub store: FlashStore<Flash<4>, Memory>,
    pub position: i32,
    pub now_us: u64,
    pub inputs: u8,
    pub shown: u8,
    pub driven: Command,
    /// The command at which the rod stands, counts.
    pub null: i32,
}

impl Board for Plant {
    type Store = FlashStore<Flash<4>, Memory>;

    fn store(&mut self) -> &mut Self::Store {
        &mut self.store
    }
    fn name(&self) -> &'static str {
        "with a rod"
    }
    fn build(&self) -> &'static str {
        "test"
    }
    fn read_sensors(&mut self, _: &Config) -> Sample {
        if self.driven.drive_enable {
            self.position += (i32::from(self.driven.counts) - self.null) / 8;
        }
        Sample { position: self.position, pressure_1: 2000, pressure_2: 2000, ..Sample::default() }
    }
    fn drive(&mut self, _: &Config, command: Command) {
        self.driven = command;
    }
    fn now_us(&self) -> u64 {
        self.now_us
    }
    fn host_clock_ms(&self) -> Option<u64> {
        Some(self.now_us / 1000)
    }
    fn inputs(&mut self) -> u8 {
        self.inputs
    }
    fn show(&mut self, outputs: u8) {
        self.shown = outputs;
    }
}

/// What happens at a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// These inputs go on or off.
    Sets(u8, bool),
    /// These inputs go to this.
    Becomes(u8, u8),
    /// A host stops the drive.
    HostStops,
    /// A sample is late.
    Late,
}

/// The drive, and the host that may stop it.
pub struct Machine {
    pub control: Box<Control>,
    server: Box<Server>,
    pub board: Plant,
    sequence: u16,
}

impl Machine {
    /// A drive in its first boot, with a flash as that of the Nucleo.
    pub fn new() -> Machine {
        let slot = |nth: u32| nth * SLOT..(nth + 1) * SLOT;
        let layout = Layout { config: [slot(0), slot(1)], faults: [slot(2), slot(3)] };
        let flash = Flash::new(SLOTS * SECTORS);
        let (store, ..) = FlashStore::take_up(flash, layout, [0; MEMORY_BYTES]).expect("it fits");
        let board =
            Plant { store, position: 200, now_us: 0, inputs: 0, shown: 0, driven: Command::OFF, null: 0 };
        let mut machine = Machine { control: Box::default(), server: Box::default(), board, sequence: 0 };
        machine.control.take_up(&mut machine.board);
        machine.control.set_referenced().expect("disarmed");
        machine
    }

    /// Most erases of a sector of each slot: two of the configuration, two of the fault log.
    pub fn erases(&self) -> [u32; SLOTS] {
        let erases = &self.board.store.flash().erases;
        std::array::from_fn(|slot| erases[slot * SECTORS..][..SECTORS].iter().copied().max().unwrap_or(0))
    }

    /// A host stops the drive by a request.
    pub fn stop(&mut self) {
        self.sequence = self.sequence.wrapping_add(1);
        let boot = self.board.store().boot();
        let request = Request { sequence: self.sequence, session: 1007, boot, body: RequestBody::Stop };
        let mut room = [0; MAX_FRAME];
        let frame = encode(&request, &mut room).expect("fits");
        let mut reply = Vec::new();
        let Ok(()) = self.server.receive(frame, &mut self.control, &mut self.board, &mut reply);
        assert!(!reply.is_empty(), "a stop is answered");
    }

    pub fn mode(&self) -> Mode {
        self.control.state().supervisor.mode()
    }
}

/// Samples of a cycle, about 0.2 s.
pub const CYCLE: u32 = 150;

/// What happens in a cycle of a machine, and at which of its samples. Every cycle has a start; a third of them have more.
pub fn cycle(random: &mut Random, faulty: bool) -> Vec<(u32, Event)> {
    let mut events = Vec::new();
    let number = 1 + random.below(3) as u8;
    let late = random.below(12) == 0;
    let start = 35 + random.below(10);
    let number_at = if late { start + random.below(30) } else { random.below(start) };
    events.push((number_at, Event::Becomes(NUMBER, number)));
    contact(random, &mut events, START, start, true);
    let end = start + 40 + random.below(15);
    contact(random, &mut events, START, end, false);
    if faulty && random.below(10) < 8 || random.below(15) == 0 {
        let before = if random.below(4) == 0 { CYCLE - 30 } else { 12 };
        let at = random.below(before);
        contact(random, &mut events, ACKNOWLEDGE, at, true);
        let end = at + 10 + random.below(10);
        contact(random, &mut events, ACKNOWLEDGE, end, false);
    }
    let at = random.below(CYCLE - 30);
    match random.below(20) {
        0 | 1 => off_and_on(random, &mut events, RUN, at),
        2 => off_and_on(random, &mut events, ENABLE, at),
        3 | 4 => events.push((at, Event::HostStops)),
        5 => events.push((at, Event::Late)),
        6 => events.push((at, Event::Becomes(NUMBER, number & random.below(16) as u8))), // a cut cable
        _ => {}
    }
    // In order; of one sample, in that in which they were made.
    events.sort_by_key(|&(at, _)| at);
    events
}

/// A contact goes on or off, and bounces.
fn contact(random: &mut Random, events: &mut Vec<(u32, Event)>, input: u8, at: u32, on: bool) {
    for bounce in 0..random.below(4) {
        events.push((at + 2 * bounce, Event::Sets(input, on)));
        events.push((at + 2 * bounce + 1, Event::Sets(input, !on)));
    }
    events.push((at + 6, Event::Sets(input, on)));
}

fn off_and_on(random: &mut Random, events: &mut Vec<(u32, Event)>, input: u8, at: u32) {
    contact(random, events, input, at, false);
    let end = at + 7 + random.below(15);
    contact(random, events, input, end, true);
}
