//! What a reply says of the drive, its moves, its parameters and its record.

use serde::{Deserialize, Serialize};

/// What the drive is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    /// Drive disabled, valve at null.
    #[default]
    Disarmed,
    /// Drive enabled, valve at null.
    Armed,
    /// The axis is on its way to its stop or switch.
    Homing,
    /// The law drives the valve.
    Running,
    /// The moves are over.
    Done,
    /// Tripped: drive disabled, valve at null, until re-armed.
    Fault,
}

impl Mode {
    /// Whether the axis is on its way.
    #[must_use]
    pub fn moves(self) -> bool {
        matches!(self, Mode::Homing | Mode::Running)
    }
}

/// The drive at the last sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Status {
    /// What it is doing.
    pub mode: Mode,
    /// Why it tripped: a code of the controller; 0: it did not.
    pub fault: u8,
    /// Whether the axis has been referenced.
    pub referenced: bool,
    /// k: samples since the start of the run.
    pub index: u32,
    /// Length of the run, samples.
    pub duration_samples: u32,
    /// Setpoint in force (open loop: command asked for), counts.
    pub setpoint: i32,
    /// Encoder count.
    pub position: i32,
    /// Setpoint less position, counts.
    pub error: i32,
    /// Valve command, -2048 to 2048 counts.
    pub command: i16,
    /// Chamber 1 (blind side) pressure, raw.
    pub pressure_1: i16,
    /// Chamber 2 (rod side) pressure, raw.
    pub pressure_2: i16,
    /// Spool displacement, raw.
    pub spool: i16,
    /// Samples stored so far.
    pub recorded: u32,
    /// Frames that came damaged to the firmware since its reset.
    pub damaged_frames: u32,
}

/// Bins of a [`Spread`].
pub const HISTOGRAM_BINS: usize = 12;

/// The distribution of measured times about their nominal value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Spread {
    /// How many were taken.
    pub count: u32,
    /// The shortest, us.
    pub least_us: u32,
    /// The longest, us.
    pub most_us: u32,
    /// Bin 0 counts the times that are exact, bin b those that are off by 2^(b-1) to 2^b - 1 us, the last bin all
    /// that are off by more.
    pub bins: [u32; HISTOGRAM_BINS],
}

/// The progress of the moves of the run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Motion {
    /// The move in force: 0 none, 1 on its way, 2 arrived, 3 not reached; 4 the axis rests outside its tolerance, whatever it was.
    pub arrival: u8,
    /// Moves that have begun.
    pub begun: u16,
    /// Moves that ended without arriving.
    pub not_reached: u32,
    /// What the run has learned of the valve's null, counts.
    pub learned_null_offset: i32,
}

/// Where the parameters come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ConfigState {
    /// 0: never saved, 1: as stored, 2: stored by firmware with other parameters and taken over, 3: both stored sets
    /// are damaged.
    pub source: u8,
    /// Number of saves so far.
    pub saves: u32,
    /// CRC-32 of the parameters in force.
    pub hash: u32,
    /// Whether they are those that the next reset will load.
    pub saved: bool,
    /// Stored values that were ignored: parameters that this firmware does not know, or values outside
    /// their range.
    pub ignored: u16,
}

/// What the record holds and how it was taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RecordInfo<'a> {
    /// Name of the test.
    pub test: &'a str,
    /// Stored samples.
    pub samples: u32,
    /// k of the oldest one; negative before the start.
    pub first_index: i32,
    /// Every nth sample was stored; 1: all.
    pub decimation: u16,
    /// Stored samples asked for before k = 0.
    pub pre_trigger: u16,
    /// Whether the recorder is through; a record in the making still grows.
    pub complete: bool,
    /// Sample period by the board's own clock, nanoseconds.
    pub measured_period_ns: u32,
    /// Mean of the spool displacement, raw.
    pub mean_spool_raw: i16,
    /// CRC-32 of all stored samples from the oldest on ([`RecordCrc`](crate::RecordCrc)).
    pub crc32: u32,
}
