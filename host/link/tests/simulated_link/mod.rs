//! A rig at the end of a simulated line: the firmware's application on one side, a [`Link`] on the other,
//! and on the way there what goes wrong with lines. Time is virtual: it goes on by the bytes that the line
//! carries at 921,600 baud, and by waiting.

mod line;

use std::io;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use pneudrive_app::store::NoStore;
use pneudrive_app::{Board, Control, Recorder, Server};
use pneudrive_controller::{Command, Config, Observation, Sample};
use pneudrive_link::client::Client;
use pneudrive_link::port::{Link, READ_WAIT};
use pneudrive_protocol::{Accumulator, RecordedSample, ReplyBody, Request, decode_request};

use line::Line;
pub use line::{Faults, Random};

/// A board whose rod creeps out by 3 counts a sample.
#[derive(Default)]
pub struct CreepingBoard {
    pub store: NoStore,
    pub has_watchdog: bool,
    /// Whether it judges the silence of its host, by the time of the simulation.
    pub judges_silence: bool,
    position: i32,
    now_us: u64,
}

impl Board for CreepingBoard {
    type Store = NoStore;

    fn store(&mut self) -> &mut NoStore {
        &mut self.store
    }
    fn name(&self) -> &'static str {
        "simulated"
    }
    fn build(&self) -> &'static str {
        "test"
    }
    fn read_sensors(&mut self, _: &Config) -> Sample {
        self.position += 3;
        Sample { position: self.position, pressure_1: 1000, pressure_2: 2000, ..Sample::default() }
    }
    fn drive(&mut self, _: &Config, _: Command) {}
    fn now_us(&self) -> u64 {
        self.now_us
    }
    fn host_clock_ms(&self) -> Option<u64> {
        self.judges_silence.then_some(self.now_us / 1000)
    }
    fn has_watchdog(&self) -> bool {
        self.has_watchdog
    }
}

/// What another firmware makes of a request: its reply, or None where it does as this one.
pub type Other = fn(&Request<'_>) -> Option<ReplyBody<'static>>;

/// The rig, and the line to it.
pub struct Simulation {
    control: Control<Box<Recorder>>,
    server: Server,
    pub board: CreepingBoard,
    /// When the next sample is due, on a rig that takes some.
    next_sample: Option<Duration>,
    other: Option<Other>,
    /// What another firmware hears with.
    accumulator: Accumulator,
    now: Duration,
    /// The rig starts up until then, and hears nothing.
    pub deaf_until: Duration,
    /// What the rig says until then is lost.
    pub mute_until: Duration,
    /// A gateway that repeats what went through it last, and lets nothing else through.
    gateway: Option<Gateway>,
    /// The last frame that has gone to the rig.
    last_up: Vec<u8>,
    /// The numbers of all requests that have gone to the rig.
    numbers: Vec<u16>,
    /// From the PC to the rig, and back.
    pub up: Line,
    pub down: Line,
    pub broken: bool,
    /// Whether each side also hears what it says itself.
    pub echoes: bool,
    /// Bytes in both directions, ever, after which the line breaks.
    breaks_after: Option<usize>,
    /// The same, after which the rig is another one: with what it has run since.
    restarts_after: Option<(usize, Vec<RecordedSample>)>,
}

/// How often a gateway repeats a frame.
const REPEATS_EVERY: Duration = Duration::from_millis(50);

/// A gateway between host and rig that has lost the host, and repeats its last frame to the rig.
struct Gateway {
    frame: Vec<u8>,
    next: Duration,
}

/// How many cases to try: by default so many.
pub fn cases(variable: &str, default: u32) -> u32 {
    let wanted = std::env::var(variable).ok();
    wanted.map_or(default, |text| text.parse().unwrap_or_else(|_| panic!("{variable}={text} is no number")))
}

/// A rig that clients can be connected to.
#[derive(Clone)]
pub struct SimulatedRig(pub Arc<Mutex<Simulation>>);

/// Samples as no drive makes them.
pub fn any_samples(random: &mut Random, count: usize) -> Vec<RecordedSample> {
    let mut word = || random.next() as i16;
    let mut sample = || RecordedSample {
        position: i32::from(word()) << 9,
        pressure_1: word(),
        pressure_2: word(),
        command: word(),
        error: word(),
        spool: 0,
    };
    (0..count).map(|_| sample()).collect()
}

/// A recorder that holds these.
fn recorder_of(samples: &[RecordedSample]) -> Box<Recorder> {
    let mut recorder = Box::<Recorder>::default();
    recorder.arm(1, 0);
    recorder.start();
    for (index, sample) in (0..).zip(samples) {
        recorder.store(&Observation {
            running: true,
            index,
            position: sample.position,
            pressure_1: sample.pressure_1,
            pressure_2: sample.pressure_2,
            command: sample.command,
            error: i32::from(sample.error),
            spool: sample.spool,
            ..Observation::default()
        });
    }
    recorder
}

impl SimulatedRig {
    /// A rig with this record, at the end of a good line.
    pub fn with_record(samples: &[RecordedSample]) -> SimulatedRig {
        SimulatedRig(Arc::new(Mutex::new(Simulation {
            control: Control::with_recorder(recorder_of(samples)),
            server: Server::default(),
            board: CreepingBoard::default(),
            next_sample: None,
            other: None,
            accumulator: Accumulator::new(),
            now: Duration::ZERO,
            deaf_until: Duration::ZERO,
            mute_until: Duration::ZERO,
            gateway: None,
            last_up: Vec::new(),
            numbers: Vec::new(),
            up: Line::default(),
            down: Line::default(),
            broken: false,
            echoes: false,
            breaks_after: None,
            restarts_after: None,
        })))
    }

    /// Puts faults on both directions of the line.
    pub fn with_faults(self, faults: &Faults) -> SimulatedRig {
        self.change(|simulation| {
            simulation.up.faults = Some(faults.clone());
            simulation.down.faults = Some(faults.clone_apart());
        });
        self
    }

    /// Gives the rig another firmware.
    pub fn with_firmware(self, other: Other) -> SimulatedRig {
        self.change(|simulation| simulation.other = Some(other));
        self
    }

    pub fn change<T>(&self, change: impl FnOnce(&mut Simulation) -> T) -> T {
        change(&mut self.0.lock().expect("one thread"))
    }

    /// A client at the PC's end of the line, which is whole again if it broke.
    pub fn connect(&self) -> anyhow::Result<Client> {
        self.change(|simulation| simulation.broken = false);
        Client::over(Box::new(self.clone()), "the simulated rig")
    }
}

impl Simulation {
    /// The line breaks after so many more bytes.
    #[allow(dead_code)] // Tests of the program use it.
    pub fn breaks_in(&mut self, bytes: usize) {
        self.breaks_after = Some(self.carried() + bytes);
    }

    /// The rig is reset after so many more bytes, and has run again at once.
    #[allow(dead_code)] // Tests of the program use it.
    pub fn restarts_in(&mut self, bytes: usize, samples: &[RecordedSample]) {
        self.restarts_after = Some((self.carried() + bytes, samples.to_vec()));
    }

    fn carried(&self) -> usize {
        self.up.carried + self.down.carried
    }

    fn restarts(&mut self) {
        let carried = self.carried();
        if let Some((_, samples)) = self.restarts_after.take_if(|(limit, _)| carried >= *limit) {
            self.control = Control::with_recorder(recorder_of(&samples));
            self.server = Server::default();
        }
    }

    /// The rig is reset.
    pub fn reset(&mut self) {
        self.control = Control::with_recorder(recorder_of(&[]));
        self.server = Server::default();
        self.board.store.boot += 1;
    }

    /// So many samples pass in which nobody talks.
    pub fn rest(&mut self, samples: usize) {
        for _ in 0..samples {
            self.server.attend(&mut self.control);
        }
    }

    pub fn now(&self) -> Duration {
        self.now
    }

    /// From now on the rig hears its host's last frame again and again, and nothing new.
    pub fn repeats_the_last_frame(&mut self) {
        self.gateway = Some(Gateway { frame: self.last_up.clone(), next: self.now });
    }

    /// The numbers of all requests that have gone to the rig, in order.
    pub fn numbers_heard(&self) -> Vec<u16> {
        self.numbers.clone()
    }

    /// How the drive stands.
    pub fn mode(&self) -> pneudrive_controller::Mode {
        self.control.state().supervisor.mode()
    }

    /// Samples are taken from now on, as time goes on.
    pub fn take_samples(&mut self) {
        self.next_sample = Some(self.now);
    }

    /// Time goes on, and the samples that are due are taken.
    fn pass(&mut self, to: Duration) {
        while let Some(at) = self.next_sample.filter(|&at| at <= to) {
            self.board.now_us = at.as_micros() as u64;
            self.control.on_sample(&mut self.board);
            self.board.now_us += 500;
            self.control.on_output(&mut self.board);
            self.server.attend(&mut self.control);
            self.speak(at);
            self.repeat(at);
            self.next_sample = Some(at + Duration::from_micros(1300));
        }
        self.now = self.now.max(to);
    }

    /// Notes a frame that goes to the rig.
    fn note(&mut self, bytes: &[u8]) {
        self.last_up = bytes.to_vec();
        let mut accumulator: Accumulator = Accumulator::new();
        for &byte in bytes {
            let Some(Ok(message)) = accumulator.push(byte) else { continue };
            let request = decode_request(message).expect("a request");
            self.numbers.push(request.sequence);
        }
    }

    /// What a gateway repeats comes to the rig.
    fn repeat(&mut self, now: Duration) {
        let Some(gateway) = self.gateway.as_mut().filter(|gateway| gateway.next <= now) else { return };
        gateway.next = now + REPEATS_EVERY;
        let frame = gateway.frame.clone();
        self.hear(&frame);
    }

    /// What goes unasked, when the line has room.
    fn speak(&mut self, now: Duration) {
        let mut rows = Vec::new();
        if self.down.is_free(now) {
            let Ok(()) = self.server.speak(&mut rows);
        }
        if !rows.is_empty() {
            self.down.send(now, rows);
        }
    }

    /// Bytes come to the rig: it answers.
    fn hear(&mut self, bytes: &[u8]) {
        if self.now < self.deaf_until {
            return;
        }
        self.server.attend(&mut self.control);
        let mut replies = Vec::new();
        for &byte in bytes {
            match self.other {
                None => {
                    let Ok(()) =
                        self.server.receive(&[byte], &mut self.control, &mut self.board, &mut replies);
                }
                Some(other) => line::hear_as(other, byte, self, &mut replies),
            }
            // Each reply is a frame of its own on the line.
            if !replies.is_empty() {
                let reply = std::mem::take(&mut replies);
                if self.echoes {
                    self.up.send(self.now, reply.clone());
                }
                if self.now >= self.mute_until {
                    self.down.send(self.now, reply);
                }
            }
        }
    }

    /// What comes to the PC within its wait.
    fn read(&mut self) -> Vec<u8> {
        let deadline = self.now + READ_WAIT;
        loop {
            let (up, down) = (self.up.next_arrival(), self.down.next_arrival());
            let next = up.into_iter().chain(down).min().filter(|&next| next <= deadline);
            let Some(next) = next else {
                self.pass(deadline);
                return Vec::new();
            };
            self.pass(next);
            if up == Some(next) {
                let bytes = self.up.take();
                self.hear(&bytes);
            } else {
                return self.down.take();
            }
        }
    }

    fn breaks(&mut self) -> bool {
        let carried = self.carried();
        if self.breaks_after.is_some_and(|limit| carried >= limit) {
            self.breaks_after = None;
            self.broken = true;
        }
        self.broken |= self.up.breaks() | self.down.breaks();
        if self.broken {
            // What was on its way is gone.
            self.up.clear();
            self.down.clear();
        }
        self.broken
    }
}

impl Link for SimulatedRig {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.change(|simulation| {
            if simulation.breaks() {
                return Err(io::ErrorKind::BrokenPipe.into());
            }
            let bytes = simulation.read();
            buffer[..bytes.len()].copy_from_slice(&bytes);
            Ok(bytes.len())
        })
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.change(|simulation| {
            if simulation.breaks() {
                return Err(io::ErrorKind::BrokenPipe.into());
            }
            let now = simulation.now;
            simulation.restarts();
            if simulation.echoes {
                simulation.down.send(now, bytes.to_vec());
            }
            if simulation.gateway.is_none() {
                simulation.note(bytes);
                simulation.up.send(now, bytes.to_vec());
            }
            Ok(())
        })
    }

    fn now(&self) -> Duration {
        self.change(|simulation| simulation.now)
    }
}
