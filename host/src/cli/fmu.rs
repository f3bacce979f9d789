//! Arguments of `fmu`.

use std::path::PathBuf;

use clap::{ArgGroup, Args};

use super::RigChoice;

/// Arguments of `fmu`.
#[derive(Debug, Args)]
#[command(group(ArgGroup::new("part").required(true)))]
#[command(after_help = "\
A step of the FMU may have any length; between two samples of the rig (controller.period_s) its outputs hold. In a loop of plant
and controller, step both by one sample, the controller first: from sample k it makes the command that the plant needs for its
step from k to k + 1. Then both repeat `pneudrive simulate` in every integer.

Keys of the rig are parameters of the FMU, with their names: load.mass_kg. They are set before the simulation begins; the supply
pressure, the mass, the forces and the friction of the load, and gains may also change while it runs.")]
pub struct Fmu {
    /// The rig.
    #[command(flatten)]
    pub rig: RigChoice,
    /// The plant: a valve command in, sensors and physical state out
    #[arg(long, group = "part")]
    pub plant: bool,
    /// The controller: sensors in, a valve command out
    #[arg(long, group = "part")]
    pub controller: bool,
    /// Both, joined: a setpoint in
    #[arg(long, group = "part")]
    pub drive: bool,
    /// The version of the standard
    #[arg(long, value_name = "VERSION", default_value = "3.0", value_parser = ["2.0", "3.0"])]
    pub fmi: String,
    /// The file to write [default: RIG-PART.fmu in the current folder]
    #[arg(short, long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// The library that goes into the FMU; once for each system that it shall run on [default: the one that was built with
    /// this program, for this system]
    #[arg(long, value_name = "FILE")]
    pub library: Vec<PathBuf>,
    /// Replace the file if there is one
    #[arg(long)]
    pub overwrite: bool,
}
