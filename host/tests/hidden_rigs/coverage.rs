//! How often intervals hold what was hidden.

use std::fmt;

use pneudrive_optimise::tuning::Proportion;

use super::{Told, Trial};

/// How far an estimate is off.
#[derive(Clone, Copy, Debug)]
pub struct Miss {
    /// In standard errors.
    pub standard_errors: f64,
    /// Whether the 95 % interval holds what was hidden.
    pub held: bool,
    /// The standard error, of the size of the hidden value.
    pub standard_error: f64,
    /// Whether the interval rests on what is assumed more than on the data.
    pub rests_on_assumptions: bool,
}

/// The misses of many trials.
#[derive(Clone, Debug, Default)]
pub struct Coverage {
    /// Those of each parameter, in trials that fit.
    pub parameters: Vec<(String, Vec<Miss>)>,
    /// Trials.
    pub trials: u32,
    /// Plans that ended before there was anything to fit.
    pub ended: u32,
    /// Trials whose model is said not to explain the data.
    pub refused: u32,
    /// Parameters that were said to be unseen, in all trials.
    pub unseen: usize,
    /// Runs of a transient in all fits.
    pub runs: u64,
    /// Seconds that all took.
    pub seconds: f64,
    /// Seconds, and evaluations of the model's equations, of the longest trial whose model is said not to explain the data.
    pub longest_refusal: (f64, u64),
    /// Trials that fit and all of whose intervals hold, and those with one that does not.
    pub all_hold: [u32; 2],
    /// Trials in which the effect that the rig file lacks was named among the causes of a misfit.
    pub named: u32,
    /// The misses in trials whose model is said not to explain the data, of intervals that are widened.
    pub widened: Vec<Miss>,
}

impl Coverage {
    /// Takes in a trial of a rig that has a setting of its own.
    pub fn count_lacking(&mut self, trial: &Trial, lacks: &str) {
        let key = lacks.split(" =").next().unwrap_or(lacks);
        self.named += u32::from(trial.causes.iter().any(|cause| cause.settings.contains(key)));
        self.count(trial);
    }

    /// Intervals that hold what was hidden, or are of a model that is said not to explain the data; a part of all.
    #[must_use]
    pub fn held_or_refused(&self) -> f64 {
        let (pooled, refused) = (self.pooled(), self.widened.len() as f64);
        (held(&pooled) * pooled.len() as f64 + refused) / (pooled.len() as f64 + refused)
    }

    /// Takes in a trial.
    pub fn count(&mut self, trial: &Trial) {
        self.trials += 1;
        self.runs += trial.runs;
        self.seconds += trial.seconds;
        self.unseen += trial.unseen.len();
        if !trial.fits {
            self.refused += 1;
            if trial.seconds > self.longest_refusal.0 {
                self.longest_refusal = (trial.seconds, trial.evaluations);
            }
            self.widened.extend(trial.told.iter().map(Told::miss));
            return;
        }
        let missed = trial.told.iter().filter(|told| !told.holds()).count();
        if let Some(count) = self.all_hold.get_mut(missed) {
            *count += 1;
        }
        for told in &trial.told {
            let at = self.parameters.iter().position(|(known, _)| *known == told.key).unwrap_or_else(|| {
                self.parameters.push((told.key.clone(), Vec::new()));
                self.parameters.len() - 1
            });
            self.parameters[at].1.push(told.miss());
        }
    }

    /// Of all parameters.
    #[must_use]
    pub fn pooled(&self) -> Vec<Miss> {
        self.parameters.iter().flat_map(|(_, misses)| misses.iter().copied()).collect()
    }

    /// Of intervals that rest on the data, or that do not.
    #[must_use]
    pub fn resting(&self, on_assumptions: bool) -> Vec<Miss> {
        let pooled = self.pooled().into_iter();
        pooled.filter(|miss| miss.rests_on_assumptions == on_assumptions).collect()
    }
}

/// How many intervals hold what was hidden.
#[must_use]
pub fn holding(misses: &[Miss]) -> Proportion {
    Proportion { met: misses.iter().filter(|miss| miss.held).count(), of: misses.len() }
}

/// Their part of all.
#[must_use]
pub fn held(misses: &[Miss]) -> f64 {
    holding(misses).met as f64 / misses.len() as f64
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
            "| parameter | standard error, median | 95 % intervals that hold it | misses, standard errors | rest on assumptions |"
        )?;
        writeln!(f, "|---|---|---|---|---|")?;
        for (key, misses) in &self.parameters {
            line(f, key, &median(misses), misses)?;
        }
        for (name, misses) in [
            ("pooled", self.pooled()),
            ("resting on the data", self.resting(false)),
            ("resting on assumptions", self.resting(true)),
            ("not explained, widened by the misfit", self.widened.clone()),
        ] {
            if !misses.is_empty() {
                line(f, name, "", &misses)?;
            }
        }
        if !self.widened.is_empty() {
            self.print_refused(f)?;
        }
        self.print_trials(f)
    }
}

impl Coverage {
    fn print_refused(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f)?;
        writeln!(
            f,
            "{:.1} % of all intervals hold what was hidden or are of a model that is said not to explain the data; of {} such models the cause is named in {}.",
            100.0 * self.held_or_refused(),
            self.refused,
            self.named
        )
    }

    fn print_trials(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let trials = f64::from(self.trials);
        writeln!(f)?;
        writeln!(
            f,
            "{} rigs; {} refused as not explained; {} plans ended before; {:.1} parameters unseen, {:.0} runs of a transient and {:.1} s each.",
            self.trials,
            self.refused,
            self.ended,
            self.unseen as f64 / trials,
            self.runs as f64 / trials,
            self.seconds / trials
        )?;
        let ([all, but_one], (seconds, evaluations)) = (self.all_hold, self.longest_refusal);
        writeln!(
            f,
            "All intervals of a rig hold in {all}, all but one in {but_one} more; the longest refusal took {seconds:.0} s and {:.1} million evaluations.",
            1e-6 * evaluations as f64
        )?;
        let share = |(_, misses): &(String, Vec<Miss>)| held(misses);
        let least = self.parameters.iter().min_by(|a, b| share(a).total_cmp(&share(b)));
        least.map_or(Ok(()), |(key, misses)| {
            writeln!(f, "Least often hold those of {key}: {}.", holding(misses))
        })
    }
}

/// A line of the table.
fn line(f: &mut fmt::Formatter<'_>, name: &str, error: &str, misses: &[Miss]) -> fmt::Result {
    let rest = misses.iter().filter(|miss| miss.rests_on_assumptions).count();
    writeln!(f, "| {name} | {error} | {} | {:.2} | {rest} |", holding(misses), spread(misses))
}

fn median(misses: &[Miss]) -> String {
    let mut errors: Vec<f64> = misses.iter().map(|miss| miss.standard_error).collect();
    errors.sort_by(f64::total_cmp);
    errors.get(errors.len() / 2).map_or(String::new(), |error| format!("{:.3} %", 100.0 * error))
}
