//! The plant bus: the data that a board and a simulated plant exchange once a sample, in lock step.
//!
//! The board speaks first and the plant answers, with a fixed number of bytes each. Each side waits for the other.
//! First each side says [`HELLO`]. Then, for every sample, the board sends [`Outputs`]: the result of the sample
//! before, and whether the plant moves on. The plant goes on to the next sample instant and answers with [`Inputs`].
//! All numbers are little-endian.
//!
//! | `Outputs`, byte | holds |
//! |---|---|
//! | 0..2 | command, counts or steps |
//! | 2 | pulse of a stepper |
//! | 3 | 1: the drive is enabled |
//! | 4 | the plant stays (0), moves on (1), begins a run (2), or moves on after the moves of a run (3) |
//! | 5..8 | ticks of the longest part of a request since the outputs before ([`with_request_ticks`]); 0: not told |
//! | 8..12, 12..16 | period and delay of the run that begins, microseconds; 0 otherwise |
//! | 16..20, 20..24 | ticks of the board's counter that `on_sample` and `on_output` took |
//!
//! | `Inputs`, byte | holds |
//! |---|---|
//! | 0..4 | position, counts |
//! | 4..6, 6..8 | pressures, raw |
//! | 8..10 | spool, raw |
//! | 10 | bit 0: the plant is frozen; bit 1: the homing switch is closed; bit 2: [`Tempo::in_step`]; the others are 0 |
//! | 11 | [`Tempo::late_us`], in 16 us |
//!
//! These bytes are append-only: bits that are 0 may get a meaning, and a step of the plant another number
//! (`firmware/app/tests/plant_bus_v1.rs`).

use pneudrive_controller::{Command, Sample};

/// Version of these bytes.
pub const VERSION: u8 = 1;

/// The first bytes in either direction.
pub const HELLO: [u8; 4] = [b'P', b'N', b'B', VERSION];

/// The plant's action before it gives the next sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Next {
    /// It stays as it is: no run is on.
    #[default]
    Stay,
    /// It moves on by a period, with the command in force from `delay` after the sample.
    Advance,
    /// The same, after the moves of a run: the drive holds.
    Hold,
    /// It goes back to its initial state: the next sample is k = 0 of a run with this timing.
    Begin {
        /// Sample period, microseconds.
        period_us: u32,
        /// From a sample to its output, microseconds.
        delay_us: u32,
    },
}

/// The cost of one sample, in ticks of the board's counter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ticks {
    /// Of `Control::on_sample`.
    pub sample: u32,
    /// Of `Control::on_output`.
    pub output: u32,
}

/// From the board to the plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outputs {
    /// The action of the drive stage from the output of the sample before on.
    pub command: Command,
    /// The plant's action.
    pub next: Next,
    /// The cost of the sample before.
    pub ticks: Ticks,
}

impl Outputs {
    /// Length on the bus.
    pub const BYTES: usize = 24;

    /// The safe output: null, disabled, the plant stays.
    pub const OFF: Outputs =
        Outputs { command: Command::OFF, next: Next::Stay, ticks: Ticks { sample: 0, output: 0 } };

    /// As it travels.
    #[must_use]
    pub fn to_bytes(self) -> [u8; Self::BYTES] {
        let (next, period_us, delay_us) = match self.next {
            Next::Stay => (0, 0, 0),
            Next::Advance => (1, 0, 0),
            Next::Hold => (3, 0, 0),
            Next::Begin { period_us, delay_us } => (2, period_us, delay_us),
        };
        let Command { counts, step, drive_enable } = self.command;
        let numbers = [period_us, delay_us, self.ticks.sample, self.ticks.output];
        let fields = counts
            .to_le_bytes()
            .into_iter()
            .chain(step.to_le_bytes())
            .chain([u8::from(drive_enable), next, 0, 0, 0])
            .chain(numbers.into_iter().flat_map(u32::to_le_bytes));
        let mut bytes = [0; Self::BYTES];
        bytes.iter_mut().zip(fields).for_each(|(to, from)| *to = from);
        bytes
    }

    /// As it came; None for a step of the plant that this version does not know.
    #[must_use]
    pub fn from_bytes(bytes: [u8; Self::BYTES]) -> Option<Outputs> {
        let [c0, c1, step, enable, next, _, _, _, rest @ ..] = bytes;
        let [p0, p1, p2, p3, d0, d1, d2, d3, s0, s1, s2, s3, o0, o1, o2, o3] = rest;
        let next = match next {
            0 => Next::Stay,
            1 => Next::Advance,
            2 => Next::Begin {
                period_us: u32::from_le_bytes([p0, p1, p2, p3]),
                delay_us: u32::from_le_bytes([d0, d1, d2, d3]),
            },
            3 => Next::Hold,
            _ => return None,
        };
        Some(Outputs {
            command: Command {
                counts: i16::from_le_bytes([c0, c1]),
                step: i8::from_le_bytes([step]),
                drive_enable: enable == 1,
            },
            next,
            ticks: Ticks {
                sample: u32::from_le_bytes([s0, s1, s2, s3]),
                output: u32::from_le_bytes([o0, o1, o2, o3]),
            },
        })
    }
}

/// Says in outputs that are about to travel how long the longest piece of a request has taken: a board with an interrupt
/// locks it out for as long ([`SharedDrive`](crate::SharedDrive)). In ticks, as [`Ticks`].
pub fn with_request_ticks(outputs: &mut [u8; Outputs::BYTES], ticks: u32) {
    let [b0, b1, b2, _] = ticks.min(0x00ff_ffff).to_le_bytes();
    let [_, _, _, _, _, t0, t1, t2, ..] = outputs;
    (*t0, *t1, *t2) = (b0, b1, b2);
}

/// The action in outputs that have arrived.
#[must_use]
pub fn request_ticks(outputs: &[u8; Outputs::BYTES]) -> u32 {
    let [_, _, _, _, _, t0, t1, t2, ..] = *outputs;
    u32::from_le_bytes([t0, t1, t2, 0])
}

/// From the plant to the board.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Inputs {
    /// The sensors at the sample instant.
    pub sample: Sample,
    /// The plant stands still: the board may rest until its port or its timer calls.
    pub frozen: bool,
}

impl Inputs {
    /// Length on the bus.
    pub const BYTES: usize = 12;

    /// As it travels.
    #[must_use]
    pub fn to_bytes(self) -> [u8; Self::BYTES] {
        let [x0, x1, x2, x3] = self.sample.position.to_le_bytes();
        let [p0, p1] = self.sample.pressure_1.to_le_bytes();
        let [q0, q1] = self.sample.pressure_2.to_le_bytes();
        let [s0, s1] = self.sample.spool.to_le_bytes();
        let flags = u8::from(self.frozen) | u8::from(self.sample.home_switch) << 1;
        [x0, x1, x2, x3, p0, p1, q0, q1, s0, s1, flags, 0]
    }

    /// As it came; bits that this version does not know are passed over.
    #[must_use]
    pub fn from_bytes(bytes: [u8; Self::BYTES]) -> Inputs {
        let [x0, x1, x2, x3, p0, p1, q0, q1, s0, s1, flags, _] = bytes;
        Inputs {
            sample: Sample {
                position: i32::from_le_bytes([x0, x1, x2, x3]),
                pressure_1: i16::from_le_bytes([p0, p1]),
                pressure_2: i16::from_le_bytes([q0, q1]),
                spool: i16::from_le_bytes([s0, s1]),
                home_switch: flags & 2 != 0,
            },
            frozen: flags & 1 != 0,
        }
    }
}

/// The course of time, which the plant reports beside the sensors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tempo {
    /// By the board's clock the sample comes this much after its instant, microseconds: up to 4080, in steps of 16.
    pub late_us: u16,
    /// The board's clock keeps step with the wall clock: silence of the host means something.
    pub in_step: bool,
}

/// Bit of the byte of switches.
const IN_STEP: u8 = 1 << 2;

/// Microseconds of a step of the lateness.
const LATE_STEP_US: u16 = 16;

impl Tempo {
    /// Puts it into inputs that are about to travel. A lateness between two steps is rounded down.
    pub fn mark(self, inputs: &mut [u8; Inputs::BYTES]) {
        let [.., flags, late] = inputs;
        *flags |= if self.in_step { IN_STEP } else { 0 };
        *late = (self.late_us / LATE_STEP_US).min(u16::from(u8::MAX)) as u8;
    }

    /// The tempo in inputs that have arrived.
    #[must_use]
    pub fn of(inputs: &[u8; Inputs::BYTES]) -> Tempo {
        let [.., flags, late] = inputs;
        Tempo { late_us: u16::from(*late) * LATE_STEP_US, in_step: flags & IN_STEP != 0 }
    }
}
