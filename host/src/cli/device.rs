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
    /// Figures as the rig sends them, in counts and samples, not in mm, kPa and s
    #[arg(long, global = true)]
    pub counts: bool,
    /// What to do.
    #[command(subcommand)]
    pub action: DeviceAction,
}

/// Subcommands of `device`.
#[derive(Debug, Subcommand)]
pub enum DeviceAction {
    /// Who the rig is
    Info,
    /// How the rig is
    Status,
    /// Enable the drive, valve at null; the only way out of a fault. The rig gives up its last record: fetch
    /// it first (`pneudrive record`)
    Arm,
    /// Disable the drive
    Disarm,
    /// Stop at once: a fault that only arming leaves
    Stop,
    /// State where the axis stands; sets the encoder's counter. The drive must be disarmed
    #[command(allow_negative_numbers = true)]
    Reference {
        /// Position now, from the retracted end on: encoder counts, or with its unit, such as 98.72mm
        #[arg(value_name = "COUNTS|MM", value_parser = place)]
        place: Place,
    },
    /// Home the axis: move it slowly to its stop or switch, which gives counts their meaning. The drive
    /// must be armed
    Home,
    /// The spool of a stepper valve, of which a reset leaves no more than a note. The drive must be disarmed
    #[command(subcommand)]
    Valve(ValveAction),
    /// The fault log, newest first
    Faults,
    /// Parameters of the controller
    #[command(subcommand)]
    Config(ConfigAction),
}

/// Where an axis stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// By the encoder, counts.
    Counts(i32),
    /// From the retracted end, mm.
    Millimetres(f64),
}

fn place(text: &str) -> Result<Place, String> {
    let Some(mm) = text.strip_suffix("mm") else { return whole_number(text).map(Place::Counts) };
    let mm = mm.trim().parse().ok().filter(|mm: &f64| mm.is_finite());
    mm.map(Place::Millimetres).ok_or_else(|| format!("{text:?} is no length such as 98.72mm"))
}

/// Subcommands of `device valve`.
#[derive(Clone, Copy, Debug, Subcommand)]
pub enum ValveAction {
    /// Walk the spool back to its null from where it was before the reset. The drive is enabled meanwhile and the
    /// valve open: the cylinder may move
    SeekNull,
    /// The spool is at its null: you have set it there, or seen that nothing moves with it
    AtNull,
}

/// Subcommands of `device config`.
#[derive(Debug, Subcommand)]
pub enum ConfigAction {
    /// One parameter, or all
    Get {
        /// Its name, that of the key in a rig file: controller.velocity_gain
        name: Option<String>,
    },
    /// Change a parameter; the drive must be disarmed
    #[command(allow_negative_numbers = true)]
    Set {
        /// Its name; an entry of the gain profile is named like `controller.gain_profile[3]`
        name: String,
        /// The new value, as a rig file has it: safety.hold_s 60, controller.loop open
        value: String,
    },
    /// Write all parameters to a file, a line each
    Export {
        /// The file
        file: PathBuf,
    },
    /// Take over the controller's parameters of a rig, or of an exported file; the drive must be disarmed
    Import {
        /// A built-in rig, a rig file, or what `export` has written
        from: String,
    },
    /// Store the parameters, for the next reset; the drive must be disarmed
    Save,
}
