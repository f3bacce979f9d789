//! Arguments of the commands that ask the model.

use std::path::PathBuf;

use clap::Args;
use pneudrive_sim::characteristics::CURVES;

use super::RigChoice;

/// Arguments of `characterise`.
#[derive(Debug, Args)]
#[command(after_help = curves())]
pub struct Characterise {
    /// The rig.
    #[command(flatten)]
    pub rig: RigChoice,
    /// The curve, or all
    #[arg(value_name = "CURVE", value_parser = curve)]
    pub curve: String,
    /// Where to leave CURVE.csv and CURVE.html
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}

/// Every curve.
pub const ALL: &str = "all";

fn curves() -> String {
    let lines = CURVES.iter().map(|curve| format!("  {:<20}{}\n", curve.name, curve.about));
    format!("Curves:\n{}  {ALL:<20}every one that the rig has\n", lines.collect::<String>())
}

fn curve(text: &str) -> Result<String, String> {
    let names: Vec<&str> = CURVES.iter().map(|curve| curve.name).chain([ALL]).collect();
    if names.contains(&text) {
        Ok(text.to_owned())
    } else {
        Err(format!("choose one of {}", names.join(", ")))
    }
}
