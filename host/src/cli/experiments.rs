//! Arguments of the commands that run the model.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Args;
use pneudrive_optimise::sweep::execution::Shard;
use pneudrive_optimise::sweep::metric::FIGURES;
use pneudrive_thesis::characteristics::CURVES;
use pneudrive_thesis::study::{STARTS, STUDIES};

use super::percent::percent;
use super::{EnsembleChoice, Pages, RigChoice};

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
    /// Folder for CURVE.csv and CURVE.html
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Lay measured points over the first graph: a CSV table whose header names its axes as CURVE.csv does, such as
    /// command_percent,flow_l_min, and perhaps spread, their standard deviation
    #[arg(long, value_name = "FILE")]
    pub points: Option<PathBuf>,
    /// How its pages are written.
    #[command(flatten)]
    pub pages: Pages,
}

/// Every curve.
pub const ALL: &str = "all";

fn curves() -> String {
    let lines = CURVES.iter().map(|curve| format!("  {:<20}{}\n", curve.name, curve.about));
    format!("Curves:\n{}  {ALL:<20}every curve that the rig has\n", lines.collect::<String>())
}

fn curve(text: &str) -> Result<String, String> {
    let names: Vec<&str> = CURVES.iter().map(|curve| curve.name).chain([ALL]).collect();
    if names.contains(&text) {
        Ok(text.to_owned())
    } else {
        Err(format!("choose one of {}", names.join(", ")))
    }
}

/// Arguments of `study`.
#[derive(Debug, Args)]
#[command(after_help = studies())]
pub struct Study {
    /// The study, all of them, or list
    #[arg(value_name = "NAME", value_parser = study)]
    pub name: String,
    /// Folder for NAME.html and, with all, index.html
    #[arg(long, value_name = "DIR", required_if_eq_any(with_pages()))]
    pub out: Option<PathBuf>,
    /// Number of starts of each drive; each has another position on the stroke and another phase of the dither
    #[arg(long, value_name = "N", default_value_t = STARTS as u16, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub starts: u16,
    /// How its pages are written.
    #[command(flatten)]
    pub pages: Pages,
}

/// Lists the studies and runs none.
pub const LIST: &str = "list";

fn studies() -> String {
    let lines =
        STUDIES.iter().map(|study| format!("  {:<20}{}, {}\n", study.name, study.section, study.about));
    format!("Studies:\n{}  {ALL:<20}every study, with a table of the results\n", lines.collect::<String>())
}

/// Names that write pages.
fn with_pages() -> Vec<(&'static str, &'static str)> {
    STUDIES.iter().map(|study| study.name).chain([ALL]).map(|name| ("name", name)).collect()
}

fn study(text: &str) -> Result<String, String> {
    let names: Vec<&str> = STUDIES.iter().map(|study| study.name).chain([ALL, LIST]).collect();
    if names.contains(&text) {
        Ok(text.to_owned())
    } else {
        Err(format!("choose one of {}", names.join(", ")))
    }
}

/// Arguments of `thesis`.
#[derive(Debug, Args)]
pub struct Thesis {
    /// Folder for thesis.html and thesis.toml
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Only this section and its subsections, such as 7.1 or 8.2.4
    #[arg(long, value_name = "SECTION")]
    pub only: Option<String>,
    /// Number of starts of each drive of a study, as in `pneudrive study`
    #[arg(long, value_name = "N", default_value_t = STARTS as u16, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub starts: u16,
}

/// Arguments of `sweep`.
#[derive(Debug, Args)]
#[command(after_help = figures())]
pub struct Sweep {
    /// The sweep file: the varied keys, the collected figures
    #[arg(value_name = "SWEEP.toml")]
    pub file: PathBuf,
    /// Folder for sweep.csv, sweep.html and sweep.journal [default: a folder named like the file]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Runs of each point: the rig itself, and perturbed runs whose mass and starting position differ very slightly;
    /// metrics are ranges over all of them. Not for a sweep with draws [default: ensemble in the file, or 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub ensemble: Option<u16>,
    /// Number of threads [default: one for each processor]
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// Run only this part of the points, such as 2/4, in a separate folder
    #[arg(long, value_name = "I/N", value_parser = shard, default_value = "1/1", hide_default_value = true)]
    pub shard: Shard,
    /// Do not ask for confirmation, however long it takes
    #[arg(long)]
    pub yes: bool,
    /// How its pages are written.
    #[command(flatten)]
    pub pages: Pages,
}

/// Arguments of `merge`.
#[derive(Debug, Args)]
pub struct Merge {
    /// Folders of the shards
    #[arg(required = true, value_name = "DIR")]
    pub folders: Vec<PathBuf>,
    /// Folder for the joined sweep
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// How its pages are written.
    #[command(flatten)]
    pub pages: Pages,
}

/// The smallest file of a sweep that shows something.
const SWEEP_FILE: &str = "\
A sweep file:

  rig = \"press\"                       # or a rig file beside this one

  [vary]
  load.mass_kg = [4, 8, 12]           # or { from = 4, to = 12, steps = 9 }

  [metrics]
  settling_s = \"settling_s\"           # of the worst move; one of the figures below
  overshoot_mm = \"overshoot_mm\"

It may also have [set], [draw], [objective] and [constraints] (docs/DESIGN.md, docs/examples/sweep-load.toml).

";

fn figures() -> String {
    let lines = FIGURES.iter().map(|figure| format!("  {:<22}{}\n", figure.name, figure.meaning));
    format!("{SWEEP_FILE}Figures of a move:\n{}", lines.collect::<String>())
}

fn shard(text: &str) -> Result<Shard, String> {
    let read = || {
        let (number, of) = text.split_once('/')?;
        let shard = Shard { number: number.trim().parse().ok()?, of: of.trim().parse().ok()? };
        (1..=shard.of).contains(&shard.number).then_some(shard)
    };
    read().ok_or_else(|| "write I/N with I from 1 to N, such as 2/4".to_owned())
}

/// Arguments of `ladder`.
#[derive(Debug, Args)]
pub struct Ladder {
    /// The rig.
    #[command(flatten)]
    pub rig: RigChoice,
    /// Folder for ladder.html
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Its perturbed runs.
    #[command(flatten)]
    pub members: EnsembleChoice,
    /// Do not ask for confirmation, however long it takes
    #[arg(long)]
    pub yes: bool,
    /// How its pages are written.
    #[command(flatten)]
    pub pages: Pages,
}

/// Arguments of `tune`.
#[derive(Debug, Args)]
pub struct Tune {
    /// The rig.
    #[command(flatten)]
    pub rig: RigChoice,
    /// Folder for tuned.toml and tune.html
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Size of the step, mm
    #[arg(long = "step", value_name = "MM", default_value_t = 60.0, value_parser = positive)]
    pub step_mm: f64,
    /// The drive has settled within this distance of its setpoint, mm [default: test.tolerance_mm of the rig]
    #[arg(long, alias = "settled", value_name = "MM", value_parser = positive)]
    pub tolerance_mm: Option<f64>,
    /// Largest overshoot allowed, % of the step
    #[arg(long = "overshoot", value_name = "PERCENT", default_value_t = 1.0, value_parser = positive)]
    pub overshoot_percent: f64,
    /// Time for the step each way, s; a longer time shows better whether the drive comes to rest
    #[arg(long = "time", value_name = "S", default_value_t = 1.5, value_parser = time)]
    pub time_s: f64,
    /// Largest deviation of the load's mass
    #[arg(long, value_name = "PERCENT", default_value = "30%", value_parser = percent)]
    pub load: f64,
    /// Largest deviation of the load's friction
    #[arg(long, value_name = "PERCENT", default_value = "30%", value_parser = percent)]
    pub friction: f64,
    /// Largest deviation of the supply pressure
    #[arg(long, value_name = "PERCENT", default_value = "0%", value_parser = percent)]
    pub supply: f64,
    /// Largest deviation of the valve's conductances
    #[arg(long, value_name = "PERCENT", default_value = "0%", value_parser = percent)]
    pub valve: f64,
    /// No step goes below this position, mm [default: the soft limit, or the allowed overshoot from the end]
    #[arg(long = "lowest", value_name = "MM", value_parser = position)]
    pub lowest_mm: Option<f64>,
    /// No step goes above this position, mm
    #[arg(long = "highest", value_name = "MM", value_parser = position)]
    pub highest_mm: Option<f64>,
    /// Fix a key at a value (operator.dither_mm=0), or at the file's value (operator.dither_mm); may be repeated
    #[arg(long = "fix", value_name = "KEY[=VALUE]")]
    pub fixed: Vec<String>,
    /// Number of draws from the spread on which the gains are judged; the search does not see them
    #[arg(long, value_name = "N", default_value_t = 60, value_parser = draws)]
    pub draws: usize,
    /// Number of candidates per generation [default: 24; with the law cascade 8]
    #[arg(long, value_name = "N", value_parser = several)]
    pub population: Option<usize>,
    /// Number of generations; 0: only judge the gains of the file [default: 25; with the law cascade 6]
    #[arg(long, value_name = "N", value_parser = generations)]
    pub generations: Option<usize>,
    /// Seed of the search; the same seed finds the same gains
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Number of threads [default: one for each core]
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// Do not ask for confirmation, however long it takes
    #[arg(long)]
    pub yes: bool,
    /// How its pages are written.
    #[command(flatten)]
    pub pages: Pages,
}

fn positive(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err("must be above 0".to_owned()) }
}

/// In whole milliseconds.
fn time(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    let is_allowed = (0.1..=100.0).contains(&value);
    is_allowed.then(|| (1e3 * value).round() / 1e3).ok_or_else(|| "must be between 0.1 and 100".to_owned())
}

fn position(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if value >= 0.0 && value.is_finite() { Ok(value) } else { Err("must be 0 or more".to_owned()) }
}

fn several(text: &str) -> Result<usize, String> {
    whole(text, 2)
}

fn draws(text: &str) -> Result<usize, String> {
    whole(text, 1)
}

fn generations(text: &str) -> Result<usize, String> {
    whole(text, 0)
}

fn whole(text: &str, least: usize) -> Result<usize, String> {
    let value: usize = text.parse().map_err(|_| "not a whole number".to_owned())?;
    let is_allowed = (least..=10_000).contains(&value);
    is_allowed.then_some(value).ok_or_else(|| format!("must be between {least} and 10000"))
}
