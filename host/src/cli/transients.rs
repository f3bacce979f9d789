//! Arguments of the commands that look at transients.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::{Integration, MethodName, Pages, RigChoice};

/// A time interval.
#[derive(Debug, Args)]
pub struct Interval {
    /// Ignore samples before this time, s from the start of the test
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = instant)]
    pub from: Option<f64>,
    /// Ignore samples after this time, s
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = instant)]
    pub to: Option<f64>,
}

fn instant(text: &str) -> Result<f64, String> {
    let seconds: f64 = text.parse().map_err(|_| "not a number of seconds".to_owned())?;
    if seconds.is_nan() { Err("not a number of seconds".to_owned()) } else { Ok(seconds) }
}

/// Arguments of `eval`.
#[derive(Debug, Args)]
pub struct Eval {
    /// A TARGET file, a streamed run, or a run folder
    pub file: PathBuf,
    /// The interval to evaluate.
    #[command(flatten)]
    pub interval: Interval,
    /// A move has settled within this distance of its setpoint [default: test.tolerance_mm of the rig; without a rig 0.05]
    #[arg(long, alias = "tolerance", value_name = "MM", value_parser = positive)]
    pub tolerance_mm: Option<f64>,
    /// The rig of a record; its cylinder is needed to compute the air used by the moves
    #[arg(long)]
    pub rig: Option<String>,
    /// For a run folder, total number of runs: the run and its perturbed runs, simulated again; figures are ranges over all of
    /// them. 1: only the run [default: as it was simulated]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub ensemble: Option<u16>,
    /// File for the page
    #[arg(long, value_name = "FILE", default_value = "eval.html")]
    pub out: PathBuf,
    /// Also write the channels, with velocity and acceleration, as CSV
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// How its pages are written.
    #[command(flatten)]
    pub pages: Pages,
}

fn positive(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err("must be more than 0".to_owned()) }
}

/// Arguments of `spectrum`.
#[derive(Debug, Args)]
pub struct Spectrum {
    /// A TARGET file, a streamed run, or a run folder
    pub file: PathBuf,
    /// The channel
    #[arg(value_enum)]
    pub channel: Channel,
    /// A second transient on the same graph
    #[arg(long, value_name = "FILE")]
    pub with: Option<PathBuf>,
    /// The second transient's channel [default: the same]
    #[arg(long, value_enum, requires = "with")]
    pub with_channel: Option<Channel>,
    /// The interval of time.
    #[command(flatten)]
    pub interval: Interval,
    /// Window function
    #[arg(long, value_enum, default_value_t = Window::Hann)]
    pub window: Window,
    /// File for the page
    #[arg(long, value_name = "FILE", default_value = "spectrum.html")]
    pub out: PathBuf,
    /// Also write the channel as 12-bit integers, -2048 to 2048, one per line
    #[arg(long, value_name = "FILE")]
    pub ascii: Option<PathBuf>,
    /// How its pages are written.
    #[command(flatten)]
    pub pages: Pages,
}

/// Names of the channels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Channel {
    /// The position, mm
    Position,
    /// Its velocity, as the controller estimates it, mm/s
    Velocity,
    /// Its acceleration, as the controller estimates it, mm/s^2
    Acceleration,
    /// Pressure in chamber 1, kPa
    #[value(name = "pressure-1")]
    Pressure1,
    /// Pressure in chamber 2, kPa
    #[value(name = "pressure-2")]
    Pressure2,
    /// The spool, mm
    Spool,
    /// The command, counts
    Command,
    /// The error, counts
    Error,
}

/// Names of the windows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Window {
    /// Narrow peaks, amplitudes up to 1.4 dB low
    Hann,
    /// Amplitudes to 0.01 dB, wide peaks
    FlatTop,
    /// No weighting: for a whole number of periods
    Rectangular,
}

/// Arguments of `overlay`.
#[derive(Debug, Args)]
pub struct Overlay {
    /// The reference for the others: a TARGET file, a streamed run, or a run folder
    pub reference: PathBuf,
    /// TARGET files, streamed runs, and run folders
    #[arg(required = true)]
    pub others: Vec<PathBuf>,
    /// How their times are aligned
    #[arg(long, value_enum, default_value_t = Align::Start)]
    pub align: Align,
    /// For runs, use the pressures at the ports of the valve, P_1v and P_2v, instead of those in the chambers
    #[arg(long)]
    pub ports: bool,
    /// The interval of the reference to compare.
    #[command(flatten)]
    pub interval: Interval,
    /// File for the page
    #[arg(long, value_name = "FILE", default_value = "report.html")]
    pub out: PathBuf,
    /// How its pages are written.
    #[command(flatten)]
    pub pages: Pages,
}

/// How transients are laid over each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Align {
    /// By the start of their tests
    Start,
    /// By the beginning of their first move
    Move,
    /// By the shift at which their positions agree best
    Correlation,
}

/// Arguments of `identify`.
#[derive(Debug, Args)]
pub struct Identify {
    /// The rig file to start from.
    #[command(flatten)]
    pub rig: RigChoice,
    /// TARGET files recorded with test.decimation=1, or runs streamed with --every 1
    #[arg(required_unless_present_any = ["plan", "tubing", "conductance"], conflicts_with_all = ["plan", "tubing", "conductance"], value_name = "TARGET")]
    pub targets: Vec<PathBuf>,
    /// Only fit the regression line of a pressure drop: a CSV table with flow_g_s (or flow_kg_s) and ratio, the pressure at
    /// the far end of a tube over that at its near end
    #[arg(long, value_name = "FILE", conflicts_with = "plan")]
    pub tubing: Option<PathBuf>,
    /// Only fit conductance C and critical ratio b of a path of the valve (ISO 6358): a CSV table with upstream_kpa and
    /// downstream_kpa (absolute), flow_l_min (or flow_g_s, flow_kg_s) and perhaps temperature_c
    #[arg(long, value_name = "FILE", conflicts_with_all = ["plan", "tubing"])]
    pub conductance: Option<PathBuf>,
    /// Only fit the regression line of the sample period: requested and measured, from these files
    #[arg(long)]
    pub timer: bool,
    /// Arm the rig at this port and run the tests that are needed. The piston must be near mid-stroke; it moves by up to
    /// 30 % of the stroke to either side
    #[arg(long, value_name = "PORT")]
    pub plan: Option<String>,
    /// Keys to fit, such as load.mass_kg,load.viscous_n_s_per_m [default: every value that is never known exactly: supply
    /// pressure, discharge, null, tubes, dead volumes, mass, friction, leakage, operator, and what the rig file gives as unknown]
    #[arg(long, value_name = "KEY,KEY...", value_delimiter = ',')]
    pub fit: Vec<String>,
    /// Write fitted.toml even if the model does not explain the data; the exit code is still 7
    #[arg(long)]
    pub despite_misfit: bool,
    /// Folder for fitted.toml, identification.json and identification.html
    #[arg(long, value_name = "DIR", default_value = "identified")]
    pub out: PathBuf,
    /// How to integrate.
    #[command(flatten)]
    pub integration: Integration,
    /// How its pages are written.
    #[command(flatten)]
    pub pages: Pages,
}

impl Identify {
    /// What `--plan` does on a rig, with the defaults.
    #[must_use]
    pub fn of_plan(rig: &RigChoice, port: &str, out: &Path, pages: Pages) -> Identify {
        Identify {
            rig: rig.clone(),
            targets: Vec::new(),
            tubing: None,
            conductance: None,
            timer: false,
            plan: Some(port.to_owned()),
            fit: Vec::new(),
            despite_misfit: false,
            out: out.to_owned(),
            integration: Integration { method: MethodName::DormandPrince, tolerance: None },
            pages,
        }
    }
}
