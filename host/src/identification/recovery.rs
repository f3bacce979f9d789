//! The proof of a fit: transients of a virtual rig with hidden values, and whether they are found.

use std::fmt;
use std::sync::atomic::AtomicBool;

use anyhow::Result;
use pneudrive_sim::{Accuracy, Rig};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use super::parameter::{Parameter, usual};
use super::recording::Recording;
use super::{Identification, identify, moves};
use crate::client::Client;
use crate::target::TargetFile;
use crate::virtual_rig::{Background, Door, Pace, VirtualRig};

/// How far a hidden value lies from the file's at most, as a rule: a part of it, or of what is plausible.
pub const HIDDEN: f64 = 0.1;

/// The drive whose values are hidden: servo-drive B with a piston that leaks and sensors that are noisy.
const SETTINGS: [&str; 5] = [
    "controller.loop=open",
    "operator.dither_mm=0",
    "actuator.leakage=laminar",
    "actuator.leakage_coefficient=1e-9",
    "sensors.noise_counts=1",
];

/// What a trial begins with.
#[derive(Clone, Debug)]
pub struct Case {
    /// The rig file.
    pub model: Rig,
    /// What was hidden, in the unit of its key, parameter by parameter.
    pub hidden: Vec<(Parameter, f64)>,
    /// The tests on the drive that has these values.
    pub recordings: Vec<Recording>,
}

impl Case {
    /// Draws values that lie `hidden` from the file's at most, in u, and records the tests on a virtual rig that has
    /// them.
    ///
    /// # Errors
    /// When the virtual rig breaks down.
    pub fn draw(seed: u64, hidden: f64) -> Result<Case> {
        let rig = drive()?;
        let parameters = usual(&rig)?;
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut draw = || (random.next_u64() >> 11) as f64 / (1u64 << 52) as f64 - 1.0;
        // Far away not every draw is a rig: a port does not pass more than what comes.
        let (hidden, real) = loop {
            let values: Vec<f64> =
                parameters.iter().map(|parameter| parameter.value(hidden * draw())).collect();
            let numbers: Vec<_> =
                parameters.iter().map(|parameter| parameter.key.path).zip(values.iter().copied()).collect();
            if let Ok(real) = rig.with_numbers(&numbers) {
                break (parameters.into_iter().zip(values).collect(), real);
            }
        };
        let mut recordings = Vec::new();
        let middle = 0.5 * rig.number("actuator.stroke_m");
        for (test, seed) in moves::FITTED.into_iter().zip((seed..).step_by(1000)) {
            let rig = moves::test(&rig, middle, test)?;
            let file = record(&real.with_test_of(&rig)?, seed)?;
            recordings.push(Recording::of(test.0, &file, &rig)?);
        }
        Ok(Case { model: rig, hidden, recordings })
    }
}

/// How far an estimate is off.
#[derive(Clone, Copy, Debug)]
pub struct Miss {
    /// In standard errors.
    pub standard_errors: f64,
    /// Whether the 95 % interval holds what was hidden.
    pub held: bool,
    /// The standard error, of the hidden value, or of what is plausible where it can be negative.
    pub standard_error: f64,
}

/// One trial.
#[derive(Clone, Debug)]
pub struct Trial {
    /// What was hidden, in the unit of its key, parameter by parameter.
    pub hidden: Vec<(Parameter, f64)>,
    /// What was found.
    pub found: Identification,
}

impl Trial {
    /// Draws values, records the tests on a virtual rig that has them, and fits the file to the records.
    ///
    /// # Errors
    /// When the virtual rig or the fit breaks down.
    pub fn run(seed: u64, hidden: f64, progress: &mut dyn FnMut(&str)) -> Result<Trial> {
        let case = Case::draw(seed, hidden)?;
        let parameters = case.hidden.iter().map(|(parameter, _)| parameter.clone()).collect();
        let found = identify(&case.model, &case.recordings, parameters, Accuracy::default(), progress)?;
        Ok(Trial { hidden: case.hidden, found })
    }

    /// By how much each parameter is missed; None for one that is said to be unseen.
    pub fn misses(&self) -> impl Iterator<Item = (&'static str, Option<Miss>)> {
        self.hidden.iter().map(|(parameter, hidden)| {
            let path = parameter.key.path;
            let estimate = self.found.estimates.iter().find(|estimate| estimate.parameter.key.path == path);
            let miss = estimate.map(|estimate| Miss {
                standard_errors: (estimate.value - hidden) / estimate.standard_error,
                held: (estimate.interval[0]..=estimate.interval[1]).contains(hidden),
                standard_error: estimate.standard_error / parameter.slope(0.0),
            });
            (path, miss)
        })
    }

    /// Whether the search ended at a minimum that leaves noise alone.
    #[must_use]
    pub fn succeeded(&self) -> bool {
        self.found.converged && self.found.fits
    }

    /// The misses in standard errors, in a line.
    #[must_use]
    pub fn summary(&self) -> String {
        let misses = self.misses().map(|(_, miss)| {
            miss.map_or("unseen".to_owned(), |miss| format!("{:+.2}", miss.standard_errors))
        });
        let misses: Vec<String> = misses.collect();
        let end = if self.succeeded() { "" } else { ", no fit" };
        format!("{} after {} runs{end}", misses.join(" "), self.found.runs)
    }
}

/// How often intervals hold what was hidden.
#[derive(Clone, Debug, Default)]
pub struct Coverage {
    /// The misses of each parameter.
    pub parameters: Vec<(&'static str, Vec<Miss>)>,
    /// Trials.
    pub trials: u32,
    /// Parameters that were said to be unseen.
    pub unseen: u32,
    /// Trials whose search did not end at a minimum that leaves noise alone.
    pub failed: u32,
    /// Runs of a transient in all fits.
    pub runs: usize,
}

impl Coverage {
    /// Takes in a trial.
    pub fn count(&mut self, trial: &Trial) {
        self.trials += 1;
        self.runs += trial.found.runs;
        self.failed += u32::from(!trial.succeeded());
        for (path, miss) in trial.misses() {
            let at = self.parameters.iter().position(|(known, _)| *known == path).unwrap_or_else(|| {
                self.parameters.push((path, Vec::new()));
                self.parameters.len() - 1
            });
            match miss {
                Some(miss) => self.parameters[at].1.push(miss),
                None => self.unseen += 1,
            }
        }
    }

    /// Of all parameters.
    #[must_use]
    pub fn pooled(&self) -> Vec<Miss> {
        self.parameters.iter().flat_map(|(_, misses)| misses.iter().copied()).collect()
    }
}

/// The part of the intervals that hold what was hidden.
#[must_use]
pub fn held(misses: &[Miss]) -> f64 {
    misses.iter().filter(|miss| miss.held).count() as f64 / misses.len() as f64
}

/// Root of the mean squared miss, in standard errors.
#[must_use]
pub fn spread(misses: &[Miss]) -> f64 {
    (misses.iter().map(|miss| miss.standard_errors.powi(2)).sum::<f64>() / misses.len() as f64).sqrt()
}

/// A table in Markdown.
impl fmt::Display for Coverage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "| parameter | standard error, mean | 95 % intervals that hold it | misses, standard errors |"
        )?;
        writeln!(f, "|---|---|---|---|")?;
        let mut line = |name: &str, error: &str, misses: &[Miss]| {
            let held = 100.0 * held(misses);
            writeln!(f, "| {name} | {error} | {held:.1} % of {} | {:.2} |", misses.len(), spread(misses))
        };
        for (path, misses) in &self.parameters {
            let mean = misses.iter().map(|miss| miss.standard_error).sum::<f64>() / misses.len() as f64;
            line(path, &format!("{:.4} %", 100.0 * mean), misses)?;
        }
        line("pooled", "", &self.pooled())?;
        let each = self.runs as f64 / f64::from(self.trials);
        writeln!(f)?;
        writeln!(
            f,
            "{} trials; no fit in {}; parameters said to be unseen: {}; {each:.0} runs of a transient a trial.",
            self.trials, self.failed, self.unseen
        )
    }
}

/// The rig file of the trials.
///
/// # Errors
/// When it is not valid, which no release is.
pub fn drive() -> Result<Rig> {
    let text = pneudrive_sim::rig::builtin("servo-b-tuned").unwrap_or_default();
    Ok(Rig::read_with("servo-b-tuned", text, &SETTINGS.map(str::to_owned))?)
}

/// The record of a rig's test on a virtual rig.
fn record(rig: &Rig, seed: u64) -> Result<TargetFile> {
    let virtual_rig = VirtualRig::new(rig.clone(), seed, Pace { fast: true, live: false })?;
    let background = Background::start(virtual_rig, Door::open("tcp:127.0.0.1:0")?);
    let mut client = Client::connect(background.port())?;
    client.download_test(rig)?;
    client.arm()?;
    client.start()?;
    client.follow(&AtomicBool::new(false), |_| {})?;
    let (record, info) = (client.record(|_, _| {})?, client.info()?);
    let parameters = client.parameters()?;
    background.stop()?;
    Ok(TargetFile::new(&record, &info, &parameters))
}
