//! One point of a sweep: its run, and its row in the result.

use std::any::Any;
use std::fmt::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};

use pneudrive_sim::{Rig, run};

use super::Sweep;
use crate::evaluation::moves_of_run;
use crate::words::fault_name;

/// A line of the result.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Number of the point, from 0.
    pub point: usize,
    /// Level of each axis.
    pub levels: Vec<String>,
    /// Value of each metric, if there is one.
    pub metrics: Vec<Option<f64>>,
    /// Name of the fault that ended the run, or "".
    pub fault: String,
    /// Why there is no run, or "".
    pub failure: String,
}

impl Row {
    /// As a line of CSV, without its end. Numbers are written so that they read back in every bit.
    #[must_use]
    pub fn to_csv(&self) -> String {
        let mut line = self.point.to_string();
        for level in &self.levels {
            let _ = write!(line, ",{level}");
        }
        for value in &self.metrics {
            let cell = value.map_or_else(String::new, |value| format!("{value:?}"));
            let _ = write!(line, ",{cell}");
        }
        let plain = !self.failure.contains([',', '"']);
        let failure =
            if plain { self.failure.clone() } else { format!("\"{}\"", self.failure.replace('"', "\"\"")) };
        let _ = write!(line, ",{},{failure}", self.fault);
        line
    }

    /// A line of a sweep's result; None if it is none.
    #[must_use]
    pub fn of_csv(sweep: &Sweep, line: &str) -> Option<Row> {
        let (axes, metrics) = (sweep.axes.len(), sweep.metrics.len());
        let cells: Vec<&str> = line.splitn(axes + metrics + 3, ',').collect();
        let [point, values @ .., fault, failure] = cells.as_slice() else { return None };
        let value = |cell: &&str| if cell.is_empty() { Some(None) } else { cell.parse().ok().map(Some) };
        let quoted = failure.strip_prefix('"').and_then(|text| text.strip_suffix('"'));
        Some(Row {
            point: point.parse().ok().filter(|point| *point < sweep.points())?,
            levels: values.get(..axes)?.iter().map(|level| (*level).to_owned()).collect(),
            metrics: values.get(axes..axes + metrics)?.iter().map(value).collect::<Option<_>>()?,
            fault: (*fault).to_owned(),
            failure: quoted.map_or_else(|| (*failure).to_owned(), |text| text.replace("\"\"", "\"")),
        })
    }
}

/// Runs a point. Whatever goes wrong stands in its row.
#[must_use]
pub fn run_point(sweep: &Sweep, point: usize) -> Row {
    let found =
        catch_unwind(AssertUnwindSafe(|| measured(sweep, point))).unwrap_or_else(|panic| Err(told(&*panic)));
    let (metrics, fault, failure) = match found {
        Ok((metrics, fault)) => (metrics, fault, String::new()),
        Err(failure) => (vec![None; sweep.metrics.len()], String::new(), failure.replace('\n', "; ")),
    };
    let levels = sweep.levels(point).into_iter().map(str::to_owned).collect();
    Row { point, levels, metrics, fault, failure }
}

/// The metrics of a point, and the name of its fault.
fn measured(sweep: &Sweep, point: usize) -> Result<(Vec<Option<f64>>, String), String> {
    let source = &sweep.rig_source;
    let rig = Rig::read_with(&source.name, &source.text, &sweep.settings_of(point));
    let rig = rig.map_err(|problems| problems.to_string())?;
    let run = run(&rig, sweep.accuracy_for(&rig)).map_err(|error| error.to_string())?;
    let moves = moves_of_run(&rig, &run, sweep.settled_mm);
    let values = sweep.metrics.iter().map(|metric| metric.value(&moves, sweep.settled_mm));
    let fault = run.fault.map_or("", |(fault, _)| fault_name(fault));
    Ok((values.collect::<Result<_, _>>()?, fault.to_owned()))
}

/// What a run that broke down has said.
fn told(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
    format!("the simulator broke down: {}", text.unwrap_or("it does not say why"))
}
