//! Arguments of `commission`.

use std::path::PathBuf;

use clap::Args;

use super::{Pages, PortChoice, RigChoice};

/// Arguments of `commission`.
#[derive(Debug, Args)]
pub struct Commission {
    /// The rig file by the data sheets of the drive.
    #[command(flatten)]
    pub rig: RigChoice,
    /// The port.
    #[command(flatten)]
    pub port: PortChoice,
    /// Let the cylinder move without being asked
    #[arg(long)]
    pub yes: bool,
    /// How far the trial moves go to either side of the middle, percent of the stroke
    #[arg(long, value_name = "PERCENT", default_value_t = 20, value_parser = clap::value_parser!(u8).range(1..=40))]
    pub trial: u8,
    /// Folder for the rig file with the values found, the records and the report
    #[arg(long, value_name = "DIR", default_value = "commissioned")]
    pub out: PathBuf,
    /// How its pages are written.
    #[command(flatten)]
    pub pages: Pages,
}
