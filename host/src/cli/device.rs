//! Arguments of `device`.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use pneudrive_records::parameter_names::whole_number;

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
    /// Locate the spool of a stepper valve after a reset. The drive must be disarmed
    #[command(subcommand)]
    Valve(ValveAction),
    /// Show the fault log, newest first
    Faults,
    /// Read, change, store, export and import the controller's parameters
    #[command(subcommand)]
    Config(ConfigAction),
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
    let Some(mm) = text.strip_suffix("mm") else { return whole_number(text).map(Position::Counts) };
    let mm = mm.trim().parse().ok().filter(|mm: &f64| mm.is_finite());
    mm.map(Position::Millimetres).ok_or_else(|| format!("{text:?} is not a length such as 98.72mm"))
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
