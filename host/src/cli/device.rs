//! Arguments of `device`.

use std::ops::RangeInclusive;
use std::path::PathBuf;

use clap::{Args, Subcommand};
use pneudrive_records::parameter_names::whole_number;
use pneudrive_session::bring_up::{MAX_PERCENT, PUSH_WAIT_S};

use super::PortChoice;

/// Arguments of `device`.
#[derive(Debug, Args)]
pub struct Device {
    /// The port.
    #[command(flatten)]
    pub port: PortChoice,
    /// Show figures as the rig sends them, in counts and samples, instead of mm, kPa and s
    #[arg(long, global = true)]
    pub counts: bool,
    /// What to do.
    #[command(subcommand)]
    pub action: DeviceAction,
}

/// Subcommands of `device`.
#[derive(Debug, Subcommand)]
pub enum DeviceAction {
    /// Show firmware, board, protocol, parameters and timing of the rig
    Info,
    /// Show the state of the rig
    Status,
    /// Enable the drive, with its valve at null; the only way out of a fault. The rig discards its last record: download
    /// it first (`pneudrive record`)
    Arm,
    /// Disable the drive
    Disarm,
    /// Stop at once, with a fault that only arming clears
    Stop,
    /// Set the encoder's counter to the current position. The drive must be disarmed
    #[command(allow_negative_numbers = true)]
    Reference {
        /// Current position from the retracted end: encoder counts, or with a unit, such as 98.72mm
        #[arg(value_name = "COUNTS|MM", value_parser = position)]
        position: Position,
    },
    /// Home the axis: move it slowly to its stop or switch, which references the counts. The drive
    /// must be armed
    Home,
    /// Move slowly to a place, at 50 mm/s: the drive is armed for that, holds afterwards, and Ctrl-C stops it. Its record is
    /// replaced
    Go {
        /// The place, from the retracted end, such as 120mm
        #[arg(value_name = "MM", value_parser = millimetres, allow_negative_numbers = true)]
        to_mm: f64,
        /// The rig file of the drive
        #[arg(long)]
        rig: String,
    },
    /// Move slowly on from where it stands, at 10 mm/s and by 30 mm at most; as go otherwise
    Jog {
        /// How far, such as 5mm; negative: towards the retracted end
        #[arg(value_name = "MM", value_parser = millimetres, allow_hyphen_values = true)]
        by_mm: f64,
        /// The rig file of the drive
        #[arg(long)]
        rig: String,
    },
    /// Locate the spool of a stepper valve after a reset. The drive must be disarmed
    #[command(subcommand)]
    Valve(ValveAction),
    /// Show the fault log, newest first
    Faults,
    /// Show what the drive keeps of what its law has learned (controller.adapt), or forget it
    Learned {
        /// The rig file of the drive: masses in kg and forces in N instead of parts of what the file says
        #[arg(long)]
        rig: Option<String>,
        /// Begin afresh, also after a reset. The drive must be disarmed
        #[arg(long, conflicts_with = "rig")]
        forget: bool,
    },
    /// Read, change, store, export and import the controller's parameters
    #[command(subcommand)]
    Config(ConfigAction),
    /// Show, change and store the move records: moves that the drive's digital inputs begin by number, without a PC
    #[command(subcommand)]
    Records(RecordsAction),
    /// Show the digital inputs and outputs; set the inputs of a virtual rig, which has no pins
    Io {
        /// What changes: number=0 to 15, and start, acknowledge, run, enable = on or off: enable=on run=on number=3
        #[arg(value_name = "INPUT=VALUE")]
        settings: Vec<String>,
    },
    /// Check a new board and its wires one by one: sensors, encoder by hand, enable line, pulses of a few mm that show
    /// what is swapped, and the watchdog, which resets the board. Asks before the cylinder moves. The rig's test is replaced
    BringUp(BringUp),
}

/// Arguments of `device bring-up`.
#[derive(Debug, Args)]
pub struct BringUp {
    /// Let the cylinder move without being asked; questions that need an eye at the drive are left out
    #[arg(long)]
    pub yes: bool,
    /// Write the report to this file, as Markdown; one that exists is replaced
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// How long to wait for the slide to be pushed by hand, s; 0: it is not asked for
    #[arg(long, value_name = "S", default_value_t = 20, value_parser = clap::value_parser!(u16).range(range_of(PUSH_WAIT_S)))]
    pub push_wait: u16,
    /// The largest command of a pulse, percent of the valve
    #[arg(long, value_name = "PERCENT", default_value_t = 30, value_parser = clap::value_parser!(u8).range(range_of(MAX_PERCENT)))]
    pub most: u8,
}

/// From the least to the most.
fn range_of<T: Into<i64>>([least, most]: [T; 2]) -> RangeInclusive<i64> {
    least.into()..=most.into()
}

/// A position of the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Position {
    /// By the encoder, counts.
    Counts(i32),
    /// From the retracted end, mm.
    Millimetres(f64),
}

fn position(text: &str) -> Result<Position, String> {
    match text.ends_with("mm") {
        true => millimetres(text).map(Position::Millimetres),
        false => whole_number(text).map(Position::Counts),
    }
}

/// A length with its unit, mm.
fn millimetres(text: &str) -> Result<f64, String> {
    let mm = text.strip_suffix("mm").and_then(|mm| mm.trim().parse().ok()).filter(|mm: &f64| mm.is_finite());
    mm.ok_or_else(|| format!("{text:?} is not a length such as 98.72mm"))
}

/// Subcommands of `device valve`.
#[derive(Clone, Copy, Debug, Subcommand)]
pub enum ValveAction {
    /// Walk the spool back to its null from where it was before the reset. The drive is enabled meanwhile and the
    /// valve open: the cylinder may move
    SeekNull,
    /// Declare that the spool is at its null: you have set it there, or seen that the cylinder does not move
    AtNull,
}

/// Subcommands of `device config`.
#[derive(Debug, Subcommand)]
pub enum ConfigAction {
    /// Print one parameter, or all
    Get {
        /// Its name, as the key in a rig file: controller.velocity_gain
        name: Option<String>,
    },
    /// Change a parameter; the drive must be disarmed
    #[command(allow_negative_numbers = true)]
    Set {
        /// Its name; `controller.gain_profile[3]` is one entry of the gain profile. NAME=VALUE is accepted as well
        name: String,
        /// The new value, as in a rig file: safety.hold_s 60, controller.loop open
        value: Option<String>,
    },
    /// Write all parameters to a file, one per line
    Export {
        /// The file
        file: PathBuf,
    },
    /// Load the controller's parameters from a rig or an exported file; the drive must be disarmed
    Import {
        /// A built-in rig, a rig file, or a file written by `export`
        from: String,
    },
    /// Store the parameters, so that they survive a reset; the drive must be disarmed
    Save,
}

/// Subcommands of `device records`.
#[derive(Debug, Subcommand)]
pub enum RecordsAction {
    /// Print the records
    Show,
    /// Make one record; the drive must be disarmed
    #[command(allow_negative_numbers = true)]
    Set {
        /// Its number, 1 to 14; number 15 is no record, it homes the axis
        #[arg(value_parser = clap::value_parser!(u8).range(1..=15))]
        number: u8,
        /// What it does: the keys of [[test.move]], and dwell_s: to_mm=120 profile=s-curve velocity_mm_s=300 dwell_s=0.1
        #[arg(required = true, value_name = "KEY=VALUE")]
        settings: Vec<String>,
    },
    /// Remove one record; the drive must be disarmed
    Remove {
        /// Its number
        #[arg(value_parser = clap::value_parser!(u8).range(1..=15))]
        number: u8,
    },
    /// Make the records of a file the whole table; the drive must be disarmed
    Load {
        /// A TOML file with a table `[[record]]` for each: number, dwell_s, and the keys of `[[test.move]]`
        file: PathBuf,
    },
    /// Store records and parameters, so that they survive a reset; the drive must be disarmed
    Save,
}
