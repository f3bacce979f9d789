//! `sweep`: many runs of one rig on all processors.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use pneudrive_optimise::sweep::{Source, Sweep};
use pneudrive_records::rig_source::rig_text;
use pneudrive_sim::rigfile::builtin;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping};

use crate::errors::of_problems;
use crate::points::{SentPoints, run_points};
use crate::rig::{Rig, RigOrSource, VALUES};
use crate::swept::SweepResult;
use crate::{progress, values, work};

/// What a sweep in Python is made of beside its rig.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Parts<'py> {
    vary: Option<Bound<'py, PyMapping>>,
    metrics: Option<Bound<'py, PyMapping>>,
    draw: Option<Bound<'py, PyMapping>>,
    objective: Option<Bound<'py, PyMapping>>,
    constraints: Option<Bound<'py, PyMapping>>,
    ensemble: Option<usize>,
    settled_mm: Option<f64>,
    tolerance: Option<f64>,
}

impl Parts<'_> {
    /// The file of the sweep, which names its rig.
    fn text(&self, rig: &str) -> PyResult<String> {
        let mut text = format!("rig = {}\n", toml_edit::Value::from(rig));
        for (key, value) in [("settled_mm", self.settled_mm), ("tolerance", self.tolerance)] {
            text += &value
                .map_or_else(String::new, |value| format!("{key} = {}\n", toml_edit::Value::from(value)));
        }
        text += &self.ensemble.map_or_else(String::new, |runs| format!("ensemble = {runs}\n"));
        for (name, table) in [
            ("vary", &self.vary),
            ("draw", &self.draw),
            ("metrics", &self.metrics),
            ("objective", &self.objective),
            ("constraints", &self.constraints),
        ] {
            if let Some(table) = table {
                text += &format!("\n[{name}]\n{}", entries(table)?);
            }
        }
        Ok(text)
    }
}

/// The entries of a table, a line each.
fn entries(table: &Bound<'_, PyMapping>) -> PyResult<String> {
    let line = |item: Bound<'_, PyAny>| {
        let (key, value): (String, Bound<'_, PyAny>) = item.extract()?;
        let (key, value) = (
            key.replacen("__", ".", 1),
            values::to_toml(&value)
                .map_err(|error| PyTypeError::new_err(format!("{key}: {}", error.value(value.py()))))?,
        );
        Ok(format!("{key} = {value}\n"))
    };
    table.items()?.iter().map(line).collect()
}

/// The sweep of a file; the rig that it names is built in, or beside it.
fn read_file(path: &Path) -> Result<Sweep> {
    let text = std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    let beside = |rig: &str| {
        let place = path.parent().unwrap_or(Path::new("")).join(rig);
        let rig = if builtin(rig).is_some() { rig.to_owned() } else { place.display().to_string() };
        let (name, text) = rig_text(&rig)?;
        Ok(Source { name, text })
    };
    Ok(Sweep::read(Source { name: path.display().to_string(), text }, beside)?)
}

/// The sweep of a rig and what varies.
fn of_rig(rig: &Rig, parts: &Parts<'_>) -> PyResult<Sweep> {
    let source = Source { name: rig.source.0.clone(), text: rig.text()? };
    let text = parts.text(&source.name)?;
    let sweep = Sweep::read(Source { name: VALUES.to_owned(), text }, |_| Ok(source.clone()));
    sweep.map_err(|mut problems| {
        // The user has not written this text, so its line numbers mean nothing.
        problems.0.iter_mut().for_each(|problem| problem.line = None);
        of_problems(&problems)
    })
}

/// Runs the sweep of a file, or of a rig with varied keys and collected figures. The tables are those of a sweep file
/// (docs/reference/commands.md, `pneudrive help sweep`), and the result does not depend on the number of threads. With a `client`
/// of Dask, the workers of its cluster run it.
#[pyfunction]
#[pyo3(signature = (what, /, *, threads=None, client=None, progress=None, **parts))]
pub fn sweep(
    py: Python<'_>,
    what: &Bound<'_, PyAny>,
    threads: Option<NonZeroUsize>,
    client: Option<&Bound<'_, PyAny>>,
    progress: Option<Py<PyAny>>,
    parts: Option<&Bound<'_, PyDict>>,
) -> PyResult<Py<SweepResult>> {
    let sweep = match parts {
        None => {
            let path = what.extract::<PathBuf>().map_err(|_| {
                PyTypeError::new_err("a sweep is a file, or a rig with vary={...} and metrics={...}")
            })?;
            work::at_once(|| read_file(&path))?
        }
        Some(parts) => of_rig(&what.extract::<RigOrSource>()?.0, &parts_of(parts)?)?,
    };
    let bar = progress::of(py, progress, "sweeping")?;
    if let Some(client) = client {
        if threads.is_some() {
            return Err(PyTypeError::new_err(
                "threads are those of the client's workers; give only one of them",
            ));
        }
        let result =
            py.import("pneudrive.cluster")?.call_method1("sweep", (SentPoints { sweep }, client, bar))?;
        return Ok(result.cast_into::<SweepResult>()?.unbind());
    }
    let all: Vec<usize> = (0..sweep.points()).collect();
    let rows = work::run(py, bar, |meter| run_points(&sweep, &all, threads, meter))?;
    SweepResult::of(py, sweep, rows)
}

/// The keywords of a sweep.
fn parts_of<'py>(given: &Bound<'py, PyDict>) -> PyResult<Parts<'py>> {
    const NAMES: [&str; 8] =
        ["vary", "metrics", "draw", "objective", "constraints", "ensemble", "settled_mm", "tolerance"];
    let parts = given.copy()?;
    for name in parts.keys() {
        let name: String = name.extract()?;
        if !NAMES.contains(&name.as_str()) {
            let known = NAMES.join(", ");
            return Err(PyTypeError::new_err(format!(
                "a sweep has no {name}; it has {known}, threads, client and progress"
            )));
        }
    }
    for name in NAMES {
        if !parts.contains(name)? {
            parts.set_item(name, given.py().None())?;
        }
    }
    parts.extract()
}
