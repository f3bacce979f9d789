//! `tune`: gains for a step, judged on draws that the search has not seen.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use pneudrive_evaluate::cancel::CancelToken;
use pneudrive_evaluate::evaluation::tolerance_mm;
use pneudrive_optimise::tuning::search::Budget;
use pneudrive_optimise::tuning::{self, Behaviour, Goal, Proportion, Relative, Task, report};
use pneudrive_records::own_file::{GENERATOR, make_writable, refuse_to_replace};
use pneudrive_records::whole_file::put;
use pneudrive_report::Library;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::OrRaise;
use crate::rig::{Rig, RigOrSource};
use crate::{progress, values, work};

/// The share of draws that meet a goal.
#[pyclass(frozen, get_all, module = "pneudrive")]
pub struct Share {
    /// The number of draws that meet the goal.
    met: usize,
    /// The number of draws.
    of: usize,
    /// The ends of the 95 % interval of the share in the whole population, 0 to 1.
    interval: (f64, f64),
}

impl From<Proportion> for Share {
    fn from(of: Proportion) -> Share {
        let [low, high] = of.interval();
        Share { met: of.met, of: of.of, interval: (low, high) }
    }
}

#[pymethods]
impl Share {
    fn __repr__(&self) -> String {
        format!("<Share {}>", Proportion { met: self.met, of: self.of })
    }
}

/// The result of a tuning: gains and how well they meet the goal.
#[pyclass(frozen, module = "pneudrive")]
pub struct Tuned {
    task: Task,
    tuned: tuning::Tuned,
    rig: Rig,
}

/// The numbers of a tuning, with the command's defaults.
struct Numbers<'a, 'py>(Option<&'a Bound<'py, PyDict>>);

impl Numbers<'_, '_> {
    const NAMES: [&'static str; 14] = [
        "step_mm",
        "tolerance_mm",
        "overshoot_percent",
        "time_s",
        "load",
        "friction",
        "supply",
        "valve",
        "lowest_mm",
        "highest_mm",
        "draws",
        "population",
        "generations",
        "seed",
    ];

    fn check(&self) -> PyResult<()> {
        for name in self.0.into_iter().flat_map(|given| given.keys()) {
            let name: String = name.extract()?;
            if !Numbers::NAMES.contains(&name.as_str()) {
                let known = Numbers::NAMES.join(", ");
                return Err(PyTypeError::new_err(format!(
                    "a tuning has no {name}; it has {known}, fix and threads"
                )));
            }
        }
        Ok(())
    }

    fn given<T: for<'a, 'py> FromPyObject<'a, 'py>>(&self, name: &str) -> PyResult<Option<T>> {
        let Some(value) = self.0.map_or(Ok(None), |given| given.get_item(name))? else { return Ok(None) };
        let read = value.extract::<T>();
        read.map(Some).map_err(|_| PyTypeError::new_err(format!("{name} cannot be {value}")))
    }

    fn number(&self, name: &str, usual: f64, range: [f64; 2]) -> PyResult<f64> {
        let value = self.given(name)?.unwrap_or(usual);
        let [low, high] = range;
        if (low..=high).contains(&value) {
            return Ok(value);
        }
        Err(PyValueError::new_err(format!("{name} must be between {low} and {high}, is {value}")))
    }

    fn count(&self, name: &str, usual: usize, least: usize) -> PyResult<usize> {
        let value = self.given(name)?.unwrap_or(usual);
        if (least..=10_000).contains(&value) {
            return Ok(value);
        }
        Err(PyValueError::new_err(format!("{name} must be between {least} and 10000, is {value}")))
    }

    fn position(&self, name: &str) -> PyResult<Option<f64>> {
        match self.given::<f64>(name)? {
            None => Ok(None),
            Some(_) => self.number(name, 0.0, [0.0, f64::MAX]).map(Some),
        }
    }
}

/// The smallest size that is more than 0.
const ABOVE_0: f64 = f64::MIN_POSITIVE;

fn task(rig: &Rig, fixed: Vec<String>, numbers: &Numbers<'_, '_>) -> PyResult<Task> {
    numbers.check()?;
    let (text, settings) = rig.file()?;
    let [population, generations] = Budget::usual(&rig.rig);
    let size = |name: &str, usual: f64| numbers.number(name, usual, [ABOVE_0, f64::MAX]);
    let share = |name: &str, usual: f64| numbers.number(name, usual, [0.0, 0.9]);
    Ok(Task {
        source: (rig.source.0.clone(), text.to_owned()),
        settings: settings.to_vec(),
        fixed,
        goal: Goal {
            step_mm: size("step_mm", 60.0)?,
            settled_mm: size("tolerance_mm", tolerance_mm(Some(&rig.rig)))?,
            overshoot_percent: size("overshoot_percent", 1.0)?,
            // In whole milliseconds.
            time_s: (1e3 * numbers.number("time_s", 1.5, [0.1, 100.0])?).round() / 1e3,
        },
        spread: Relative {
            load: share("load", 0.3)?,
            friction: share("friction", 0.3)?,
            supply: share("supply", 0.0)?,
            valve: share("valve", 0.0)?,
        },
        between_mm: [numbers.position("lowest_mm")?, numbers.position("highest_mm")?],
        draws: numbers.count("draws", 60, 1)?,
        budget: Budget {
            population: numbers.count("population", population, 2)?,
            generations: numbers.count("generations", generations, 0)?,
            seed: numbers.given("seed")?.unwrap_or(1),
        },
    })
}

/// The keys that are held: a list of keys that keep the rig's values, or a dict of keys and values.
fn fixed(rig: &Rig, fix: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<String>> {
    let Some(fix) = fix else { return Ok(Vec::new()) };
    if let Ok(fix) = fix.cast::<PyDict>() {
        return fix.iter().map(|(key, value)| values::setting(&key.extract::<String>()?, &value)).collect();
    }
    let own = |key: String| rig.rig.value(&key).map_or_else(|| key.clone(), |value| format!("{key}={value}"));
    Ok(fix.extract::<Vec<String>>()?.into_iter().map(own).collect())
}

/// Searches for gains with which a step settles over a spread of load, friction and supply. Sizes have the names of the
/// command's options: step_mm, tolerance_mm, overshoot_percent, time_s; load, friction, supply, valve as fractions; lowest_mm,
/// highest_mm; draws, population, generations (0: judge the gains of the rig), seed.
#[pyfunction]
#[pyo3(signature = (rig, /, *, fix=None, threads=None, progress=None, **numbers))]
pub fn tune(
    py: Python<'_>,
    rig: RigOrSource,
    fix: Option<&Bound<'_, PyAny>>,
    threads: Option<NonZeroUsize>,
    progress: Option<Py<PyAny>>,
    numbers: Option<&Bound<'_, PyDict>>,
) -> PyResult<Tuned> {
    let task = task(&rig.0, fixed(&rig.0, fix)?, &Numbers(numbers))?;
    let bar = progress::of(py, progress, "tuning")?;
    let tuned = work::run(py, bar, |meter| {
        let all = task.max_runs()? as u64;
        let (mut before, mut stage) = (0, None);
        let tell = |at: tuning::Progress| {
            // Runs of the stages before, and of this one.
            if let Some((former, runs)) = stage.replace((at.stage, at.all as u64))
                && former != at.stage
            {
                before += runs;
            }
            meter.at((before + at.done as u64).min(all), all);
        };
        let tuned = work::pool(threads)?.install(|| tuning::tune(&task, tell, CancelToken::NEVER))?;
        meter.at(all, all);
        Ok(tuned)
    })?;
    let text = report::rig_file(&task, &tuned).or_raise()?;
    let rig = Rig::read((rig.0.source.0, text), Vec::new())?;
    Ok(Tuned { task, tuned, rig })
}

#[pymethods]
impl Tuned {
    /// The rig with the gains found.
    #[getter]
    fn rig(&self) -> Rig {
        self.rig.clone()
    }

    /// The gains found, as `key=value`; empty: those of the rig.
    #[getter]
    fn settings(&self) -> Vec<String> {
        self.tuned.after.settings.clone()
    }

    /// The share of fresh draws that meet the goal.
    #[getter]
    fn met(&self) -> Share {
        self.tuned.after.met(&self.task.goal).into()
    }

    /// The same share with the original gains of the rig.
    #[getter]
    fn met_before(&self) -> Share {
        self.tuned.before.met(&self.task.goal).into()
    }

    /// The total number of runs.
    #[getter]
    fn runs(&self) -> usize {
        self.tuned.runs
    }

    /// Notes on the result, one sentence each.
    #[getter]
    fn notes(&self) -> Vec<String> {
        report::notes(&self.task, &self.tuned)
    }

    /// Writes tuned.toml and tune.html into a folder.
    fn save(&self, py: Python<'_>, folder: PathBuf) -> PyResult<()> {
        let [page, rig] = ["tune.html", "tuned.toml"].map(|name| folder.join(name));
        work::run(py, None, |_| {
            make_writable(&folder)?;
            refuse_to_replace(&page, GENERATOR)?;
            refuse_to_replace(&rig, report::MARK)?;
            let behaviour = Behaviour::of(&self.task, &self.tuned, |_| {}, CancelToken::NEVER)?;
            report::write_page(&self.task, &self.tuned, &behaviour, &page, Library::Linked)?;
            put(&rig, &report::rig_file(&self.task, &self.tuned)?)
        })
    }

    fn __str__(&self) -> String {
        self.notes().join("\n")
    }

    fn __repr__(&self) -> String {
        format!("<Tuned {}: {}>", self.rig.rig.name(), report::verdict(&self.task, &self.tuned))
    }
}
