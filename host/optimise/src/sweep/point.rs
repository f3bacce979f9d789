//! One point of a sweep: its run, and its row in the result.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

use pneudrive_records::judged::Spacing;
use pneudrive_records::words::fault_name;
use pneudrive_sim::rig::Problems;
use pneudrive_sim::rigfile::RigFile;
use pneudrive_sim::{Rig, Run};

use super::{Metric, Sweep};
use crate::ensemble::{Ensemble, run_ensemble};
use crate::runners::Runners;
use pneudrive_evaluate::cancel::CancelToken;
use pneudrive_evaluate::evaluation::{Move, moves_of_run, tolerance_mm};
use pneudrive_evaluate::range::Range;

/// A line of the result.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Number of the point, from 0.
    pub point: usize,
    /// Level of each axis.
    pub levels: Vec<String>,
    /// Value of each metric, if there is one.
    pub metrics: Vec<Option<f64>>,
    /// Least and most of each metric over an ensemble, if every run has a value; empty without an ensemble.
    pub ends: Vec<Option<[f64; 2]>>,
    /// Whether the point has converged; None of a draw, and of one without a run.
    pub converged: Option<bool>,
    /// Name of the fault that ended the run, or "".
    pub fault: String,
    /// Why there is no run, or "".
    pub failure: String,
}

impl Row {
    /// As a line of CSV, without its end. Numbers are written so that they read back in every bit.
    #[must_use]
    pub fn to_csv(&self, sweep: &Sweep) -> String {
        let number = |value: f64| format!("{value:?}");
        let one = |value: &Option<f64>| value.map_or_else(String::new, number);
        let two = |ends: &Option<[f64; 2]>| ends.map_or_else(Default::default, |ends| ends.map(number));
        let converged =
            (!sweep.is_drawn()).then(|| self.converged.map_or("", |yes| if yes { YES } else { NO }));
        let plain = !self.failure.contains([',', '"']);
        let failure =
            if plain { self.failure.clone() } else { format!("\"{}\"", self.failure.replace('"', "\"\"")) };
        let cells = self.levels.iter().cloned().chain(self.metrics.iter().map(one));
        let cells = cells.chain(self.ends.iter().flat_map(two)).chain(converged.map(str::to_owned));
        let cells = cells.chain([self.fault.clone(), failure]);
        cells.fold(self.point.to_string(), |line, cell| line + "," + &cell)
    }

    /// A line of a sweep's result; None if it is malformed.
    #[must_use]
    pub fn of_csv(sweep: &Sweep, line: &str) -> Option<Row> {
        let count = sweep.axes.len() + sweep.figure_columns().len();
        let cells: Vec<&str> = line.splitn(count + 3, ',').collect();
        let [point, values @ .., fault, failure] = cells.as_slice() else { return None };
        let (levels, figures) = values.split_at_checked(sweep.axes.len())?;
        let (metrics, figures) = figures.split_at_checked(sweep.metrics.len())?;
        let (ends, converged) = figures.split_at_checked(figures.len() - usize::from(!sweep.is_drawn()))?;
        let one = |cell: &str| if cell.is_empty() { Some(None) } else { cell.parse().ok().map(Some) };
        let two =
            |cells: &[&str]| Some(one(cells[0])?.zip(one(cells[1])?).map(|(least, most)| [least, most]));
        let quoted = failure.strip_prefix('"').and_then(|text| text.strip_suffix('"'));
        Some(Row {
            point: point.parse().ok().filter(|point| *point < sweep.points())?,
            levels: levels.iter().map(|level| (*level).to_owned()).collect(),
            metrics: metrics.iter().map(|cell| one(cell)).collect::<Option<_>>()?,
            ends: ends.chunks_exact(2).map(two).collect::<Option<_>>()?,
            converged: converged.first().filter(|cell| !cell.is_empty()).map(|cell| *cell == YES),
            fault: (*fault).to_owned(),
            failure: quoted.map_or_else(|| (*failure).to_owned(), |text| text.replace("\"\"", "\"")),
        })
    }

    /// The row of a point that has no run.
    fn failed(sweep: &Sweep, point: usize, failure: &str) -> Row {
        Row {
            point,
            levels: sweep.levels(point).into_iter().map(str::to_owned).collect(),
            metrics: vec![None; sweep.metrics.len()],
            ends: vec![None; if sweep.ensemble > 1 { sweep.metrics.len() } else { 0 }],
            converged: None,
            fault: String::new(),
            failure: failure.replace('\n', "; "),
        }
    }
}

/// A point that has converged, in the result.
const YES: &str = "yes";

/// And one that is not.
const NO: &str = "no";

/// The points of a sweep, which have the file of their rig in common.
#[derive(Debug)]
pub struct Points<'a> {
    sweep: &'a Sweep,
    file: RigFile,
    runners: Runners,
}

impl Points<'_> {
    /// Of a sweep. Its rig file is read once.
    #[must_use]
    pub fn of(sweep: &Sweep) -> Points<'_> {
        let file = RigFile::read(&sweep.rig_source.name, &sweep.rig_source.text);
        Points { sweep, file, runners: Runners::default() }
    }

    /// Runs a point. Its row records any failure.
    #[must_use]
    pub fn run(&self, point: usize) -> Row {
        let run = || {
            let rig = self.rig(point).map_err(|problems| problems.to_string())?;
            self.measured(point, &rig)
        };
        let found = catch_unwind(AssertUnwindSafe(run)).unwrap_or_else(|panic| Err(told(&*panic)));
        found.unwrap_or_else(|failure| Row::failed(self.sweep, point, &failure))
    }

    /// What is drawn, the controller does not know.
    fn rig(&self, point: usize) -> Result<Rig, Problems> {
        let [varied, drawn] = self.sweep.settings_of(point);
        self.file.with(&varied)?.with_plant(&drawn)
    }

    fn measured(&self, point: usize, rig: &Rig) -> Result<Row, String> {
        let (sweep, accuracy) = (self.sweep, self.sweep.accuracy_for(rig));
        if sweep.is_drawn() {
            let row = |run: &Run| row(sweep, point, rig, run, &[moves_of_run(rig, run)]);
            return self.runners.run(rig, accuracy, row).unwrap_or_else(|error| Err(error.to_string()));
        }
        let spacing = Spacing { runs: sweep.ensemble, ..Spacing::default() };
        let ensemble = run_ensemble(rig, accuracy, spacing, moves_of_run, |_, _| {}, CancelToken::NEVER);
        let Ensemble { nominal, measured } = ensemble.map_err(|error| format!("{error:#}"))?;
        let row = row(sweep, point, rig, &nominal.run, &measured)?;
        let of_member =
            nominal.lost.tripped.first().map(|fault| format!("{} of a perturbed run", fault_name(*fault)));
        Ok(Row {
            converged: Some(nominal.convergence.is_converged()),
            fault: if row.fault.is_empty() { of_member.unwrap_or_default() } else { row.fault },
            failure: nominal
                .lost
                .failed
                .first()
                .map_or_else(String::new, |why| format!("a perturbed run: {why}")),
            ..row
        })
    }
}

/// The row of a run; `moves` has its own, and then those of its perturbed runs.
fn row(sweep: &Sweep, point: usize, rig: &Rig, run: &Run, moves: &[Vec<Move>]) -> Result<Row, String> {
    let over_runs = |metric: &Metric| -> Result<Range, String> {
        let values = moves.iter().map(|moves| metric.value(moves, tolerance_mm(Some(rig))));
        Ok(Range::of(&values.collect::<Result<Vec<_>, _>>()?))
    };
    let ranges: Vec<Range> = sweep.metrics.iter().map(over_runs).collect::<Result<_, _>>()?;
    let ends = ranges.iter().map(|range| range.ends.filter(|_| range.lacking == 0));
    Ok(Row {
        metrics: ranges.iter().map(|range| range.value).collect(),
        ends: if sweep.ensemble > 1 { ends.collect() } else { Vec::new() },
        fault: run.fault.map_or("", |(fault, _)| fault_name(fault)).to_owned(),
        ..Row::failed(sweep, point, "")
    })
}

/// The message of a run that panicked.
fn told(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
    format!("the simulator panicked: {}", text.unwrap_or("no reason given"))
}
