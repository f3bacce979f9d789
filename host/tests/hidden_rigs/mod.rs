//! The proof of an identification: virtual rigs whose values nobody tells it, identified as a user does it.
//!
//! `pneudrive virtual` serves a rig with a spread, noise and dither on; `pneudrive identify --plan` runs its tests on it
//! over the link and fits them with its defaults. What it leaves in `identification.json` is held against the rig that was
//! drawn, which a seed fixes ([`pneudrive_sim::Rig::spread`]).
#![allow(dead_code)] // The test uses a part, the example another one.

pub mod coverage;
pub mod rigs;

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Instant;

use anyhow::{Context, Result, bail, ensure};
use pneudrive_sim::Rig;
use serde_json::Value;

use coverage::Miss;

/// How far hidden values lie from the file's at most: a part of them.
pub const HIDDEN: f64 = 0.1;

/// A rig that is to be identified.
#[derive(Clone, Debug)]
pub struct Hidden {
    /// What it is, for a line of a report.
    pub name: String,
    /// The rig file that the user has.
    pub model: String,
    /// That of the virtual rig, before the spread.
    pub real: String,
    /// What the rig file lacks.
    pub lacks: Option<String>,
    /// Whether the virtual rig has neither spread nor noise: its file has the hidden values.
    pub quiet: bool,
    /// Whether it goes on between the tests, as a real one does: each begins with what the one before has left of warmth and hysteresis.
    pub live: bool,
    /// Fixes the spread and the noise.
    pub seed: u64,
}

/// An interval that was told.
#[derive(Clone, Debug)]
pub struct Told {
    /// The key.
    pub key: String,
    /// In the unit of the key.
    pub estimate: f64,
    /// Likewise.
    pub standard_error: f64,
    /// Ends of the 95 % interval, or of the one that is widened by a misfit.
    pub interval: [f64; 2],
    /// Whether it rests on what is assumed more than on the data.
    pub rests_on_assumptions: bool,
    /// What the virtual rig had.
    pub truth: f64,
}

/// An effect that is said to explain a misfit.
#[derive(Clone, Debug)]
pub struct Cause {
    /// By which a rig file has it.
    pub settings: String,
    /// What was found and its standard error, in the unit of the key, if it is a number.
    pub value: Option<(f64, f64)>,
}

/// What became of an identification.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The intervals.
    pub told: Vec<Told>,
    /// Whether the model is said to explain the data.
    pub fits: bool,
    /// What is said to explain a misfit as well as any.
    pub causes: Vec<Cause>,
    /// Keys that are said to be unseen.
    pub unseen: Vec<String>,
    /// Runs of a transient on the model.
    pub runs: u64,
    /// Evaluations of its equations in these.
    pub evaluations: u64,
    /// Seconds for plan and fit.
    pub seconds: f64,
}

impl Hidden {
    /// The rig that the virtual rig is.
    ///
    /// # Errors
    /// When it is not valid.
    pub fn truth(&self) -> Result<Rig> {
        let real = Rig::read("real.toml", &self.real)?;
        Ok(if self.quiet { real } else { real.spread(HIDDEN, self.seed)? })
    }

    /// Has `program`, which is pneudrive, serve the rig and identify it; all files go to a folder.
    ///
    /// # Errors
    /// When the rig is not valid, or the identification came to no end, with what it said.
    pub fn identify(&self, program: &Path, folder: &Path) -> Result<Trial> {
        fs::write(folder.join("model.toml"), &self.model)?;
        fs::write(folder.join("real.toml"), &self.real)?;
        let truth = self.truth()?;
        let served = Served::start(self, program, folder)?;
        let begun = Instant::now();
        let mut command = Command::new(program);
        command.current_dir(folder).args(["identify", "model.toml", "--plan", &served.port]);
        let output = command.output().with_context(|| program.display().to_string())?;
        let seconds = begun.elapsed().as_secs_f64();
        let printed = String::from_utf8_lossy(&output.stderr);
        let numbers = fs::read_to_string(folder.join("identified/identification.json"));
        let Ok(numbers) = numbers else { bail!("{}", printed.lines().last().unwrap_or("it said nothing")) };
        Trial::of(&serde_json::from_str(&numbers)?, &truth, seconds)
    }
}

impl Trial {
    /// What `identification.json` tells of the rig `truth`.
    fn of(json: &Value, truth: &Rig, seconds: f64) -> Result<Trial> {
        let list = |name: &str| json[name].as_array().cloned().unwrap_or_default();
        let told = list("parameters").iter().map(|told| Told::of(told, truth)).collect::<Option<_>>();
        let unseen =
            list("unseen").iter().filter_map(|unseen| Some(unseen["key"].as_str()?.to_owned())).collect();
        let named = |cause: &&Value| cause["as_good_as_best"] == true && cause["significant"] == true;
        let causes = list("causes");
        let causes = causes.iter().filter(named).map(Cause::of).collect::<Option<_>>();
        Ok(Trial {
            causes: causes.context("identification.json lacks settings of a cause")?,
            told: told.context("identification.json lacks numbers")?,
            fits: json["fits"] == true && json["converged"] == true,
            unseen,
            runs: json["runs"].as_u64().unwrap_or(0),
            evaluations: json["evaluations"].as_u64().unwrap_or(0),
            seconds,
        })
    }

    /// The misses beyond two standard errors, in a line.
    #[must_use]
    pub fn summary(&self) -> String {
        let missed = self.told.iter().filter(|told| !told.holds());
        let missed: Vec<String> =
            missed.map(|told| format!("{}{:+.1}", told.key, told.miss().standard_errors)).collect();
        let fits = if self.fits { "fits" } else { "no fit" };
        let causes = if self.causes.is_empty() {
            String::new()
        } else {
            let settings: Vec<&str> = self.causes.iter().map(|cause| cause.settings.as_str()).collect();
            format!("; causes: {}", settings.join(" or "))
        };
        format!(
            "{fits} after {} runs, {:.1} million evaluations, {:.1} s; missed: {}{causes}",
            self.runs,
            1e-6 * self.evaluations as f64,
            self.seconds,
            missed.join(" ")
        )
    }
}

impl Cause {
    fn of(json: &Value) -> Option<Cause> {
        let value = json["value"].as_f64().zip(json["standard_error"].as_f64());
        Some(Cause { settings: json["settings"].as_str()?.to_owned(), value })
    }
}

impl Told {
    fn of(json: &Value, truth: &Rig) -> Option<Told> {
        let key = json["key"].as_str()?;
        let number = |name: &str| json[name].as_f64();
        let ends = json["interval"].as_array()?;
        Some(Told {
            estimate: number("estimate")?,
            standard_error: number("standard_error")?,
            interval: [ends.first()?.as_f64()?, ends.get(1)?.as_f64()?],
            rests_on_assumptions: json["rests_on"].as_array().is_some_and(|keys| !keys.is_empty()),
            truth: truth.number_at(key)?,
            key: key.to_owned(),
        })
    }

    /// Whether the interval holds what was hidden.
    #[must_use]
    pub fn holds(&self) -> bool {
        (self.interval[0]..=self.interval[1]).contains(&self.truth)
    }

    /// By how much the estimate is off.
    #[must_use]
    pub fn miss(&self) -> Miss {
        Miss {
            standard_errors: (self.estimate - self.truth) / self.standard_error,
            held: self.holds(),
            standard_error: self.standard_error / self.truth.abs(),
            rests_on_assumptions: self.rests_on_assumptions,
        }
    }
}

/// A virtual rig on a port, as long as it lives.
struct Served {
    program: Child,
    port: String,
}

impl Served {
    fn start(hidden: &Hidden, program: &Path, folder: &Path) -> Result<Served> {
        let spread = format!("{}%", 100.0 * HIDDEN);
        let mut command = Command::new(program);
        command.current_dir(folder).args(["virtual", "real.toml", "--listen", "tcp:127.0.0.1:0"]);
        if !hidden.quiet {
            command.args(["--spread", &spread, "--seed", &hidden.seed.to_string()]);
        }
        command.arg(if hidden.live { "--live" } else { "--fast" });
        let mut program = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?;
        let mut line = String::new();
        let terminal = program.stdout.take().context("a pipe")?;
        BufReader::new(terminal).read_line(&mut line)?;
        let port = line.trim().rsplit(' ').next().unwrap_or_default().to_owned();
        let served = Served { program, port };
        ensure!(served.port.starts_with("tcp://"), "the virtual rig does not start");
        Ok(served)
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}
