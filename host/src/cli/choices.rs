//! Arguments that several commands have: which rig, how it is integrated, with which perturbed runs, and what
//! its pages are like.

use clap::{Args, ValueEnum};
use pneudrive_records::judged::Spacing;
use pneudrive_report::Library;
use pneudrive_sim::{Accuracy, Method, PERTURBATION, Rig};

/// Which rig, and what to change in it.
#[derive(Clone, Debug, Args)]
pub struct RigChoice {
    /// A built-in rig (`pneudrive rig list`) or a rig file
    #[arg(value_name = "RIG")]
    pub rig: String,
    /// Change a key of the rig, such as load.mass_kg=2.5; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = setting)]
    pub settings: Vec<String>,
}

/// `key=value` with something on both sides.
fn setting(text: &str) -> Result<String, String> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() && !value.trim().is_empty() => Ok(text.to_owned()),
        _ => Err("write KEY=VALUE, such as load.mass_kg=2.5".to_owned()),
    }
}

/// How a run is integrated.
#[derive(Debug, Args)]
pub struct Integration {
    /// Integration method
    #[arg(long, value_enum, default_value_t = MethodName::DormandPrince)]
    pub method: MethodName,
    /// Allowed error of a step, relative to the scale of each state [default: 1e-11 in closed loop, else 1e-9, or
    /// 3e-8 with a stepper]
    #[arg(long, value_name = "X", value_parser = tolerance)]
    pub tolerance: Option<f64>,
}

fn tolerance(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if (1e-13..=1e-2).contains(&value) { Ok(value) } else { Err("must be between 1e-13 and 1e-2".to_owned()) }
}

impl Integration {
    /// What the library takes.
    #[must_use]
    pub fn accuracy(&self, rig: &Rig) -> Accuracy {
        let method = match self.method {
            MethodName::DormandPrince => Method::DormandPrince,
            MethodName::Merson => Method::Merson,
        };
        Accuracy { method, tolerance: self.tolerance.unwrap_or(Accuracy::of(rig).tolerance) }
    }
}

/// Names of the methods.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum MethodName {
    /// Dormand-Prince 5(4)
    DormandPrince,
    /// Runge-Kutta-Merson 4(3), as in the thesis
    Merson,
}

/// How pages are written.
#[derive(Clone, Copy, Debug, Args)]
pub struct Pages {
    /// Put the plotting library into the page instead of beside it: one file, for sending
    #[arg(long)]
    pub single_file: bool,
}

impl Pages {
    /// What the library takes.
    #[must_use]
    pub fn library(self) -> Library {
        if self.single_file { Library::Embedded } else { Library::Linked }
    }
}

/// Runs beside the nominal one.
#[derive(Clone, Copy, Debug, Args)]
pub struct EnsembleChoice {
    /// Total number of runs: the rig itself, and perturbed runs whose mass and starting position differ very slightly; figures
    /// are ranges over all of them. 1: only the rig itself
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub ensemble: u16,
    /// Distance of the perturbed runs: relative change of the mass, and change of the starting position relative to the stroke
    #[arg(long, value_name = "X", default_value_t = PERTURBATION, value_parser = change)]
    pub change: f64,
}

fn change(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if (1e-12..=0.1).contains(&value) { Ok(value) } else { Err("must be between 1e-12 and 0.1".to_owned()) }
}

impl EnsembleChoice {
    /// What the library takes.
    #[must_use]
    pub fn spacing(&self) -> Spacing {
        Spacing { runs: usize::from(self.ensemble), relative: self.change }
    }
}
