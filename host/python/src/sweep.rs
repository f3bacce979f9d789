//! `sweep`: many runs of one rig on all processors.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, Result, bail};
use pneudrive_analysis::parallel;
use pneudrive_analysis::sweep::point::Points;
use pneudrive_analysis::sweep::{HEADER_END, Row, Source, Sweep, report};
use pneudrive_records::own_file::{GENERATOR, refuse_to_replace};
use pneudrive_records::rig_source::rig_text;
use pneudrive_records::whole_file::put;
use pneudrive_sim::rig::builtin;
use pyo3::exceptions::{PyIndexError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping};

use crate::channels::{Channels, Column, Columns};
use crate::errors::{OrRaise, of_problems};
use crate::rig::{Rig, RigOrSource, VALUES};
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
    let source = Source { name: rig.source.0.clone(), text: rig.text().or_raise()? };
    let text = parts.text(&source.name)?;
    let sweep = Sweep::read(Source { name: VALUES.to_owned(), text }, |_| Ok(source.clone()));
    sweep.map_err(|mut problems| {
        // Lines of a text that nobody has written.
        problems.0.iter_mut().for_each(|problem| problem.line = None);
        of_problems(&problems)
    })
}

/// Runs every point.
fn rows(sweep: &Sweep, threads: Option<NonZeroUsize>, meter: &work::Meter) -> Result<Vec<Row>> {
    let points: Vec<usize> = (0..sweep.points()).collect();
    let (all, mut rows) = (points.len() as u64, BTreeMap::new());
    meter.at(0, all);
    let take = |row: Row| {
        rows.insert(row.point, row);
        meter.at(rows.len() as u64, all);
        Ok::<(), anyhow::Error>(())
    };
    let rigs = Points::of(sweep);
    work::pool(threads)?.install(|| parallel::each(&points, |point| rigs.run(*point), take))?;
    let rows: Vec<Row> = rows.into_values().collect();
    match rows.iter().find(|row| !row.failure.is_empty()) {
        Some(first) if rows.iter().all(|row| !row.failure.is_empty()) => {
            bail!("every point failed; the first: {}", first.failure)
        }
        _ => Ok(rows),
    }
}

/// The result of a sweep: a row a point.
#[pyclass(frozen, extends = Channels, mapping, module = "pneudrive")]
pub struct SweepResult {
    swept: Arc<(Sweep, Vec<Row>)>,
}

/// Runs a sweep: of a file, or of a rig with what varies and what is collected. The tables are those of a sweep file
/// (docs/commands.md, `pneudrive help sweep`), and the result does not depend on the number of threads.
#[pyfunction]
#[pyo3(signature = (what, /, *, threads=None, progress=None, **parts))]
pub fn sweep(
    py: Python<'_>,
    what: &Bound<'_, PyAny>,
    threads: Option<NonZeroUsize>,
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
    let rows = work::run(py, bar, |meter| rows(&sweep, threads, meter))?;
    let swept = Arc::new((sweep, rows));
    let shared = Arc::clone(&swept);
    Py::new(py, (SweepResult { swept }, Channels::new(move || columns(&shared.0, &shared.1))))
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
                "a sweep has no {name}; it has {known}, threads and progress"
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

/// Point, axes, metrics with their ends, and what became of each point. What there is not is NaN, or an empty text.
fn columns(sweep: &Sweep, rows: &[Row]) -> Columns {
    let mut columns =
        vec![("point".to_owned(), Column::Long(rows.iter().map(|row| row.point as i64).collect()))];
    for (place, axis) in sweep.axes.iter().enumerate() {
        let levels = || rows.iter().map(|row| row.levels[place].as_str());
        let numbers: Option<Vec<f64>> = levels().map(|level| level.parse().ok()).collect();
        let column =
            numbers.map_or_else(|| Column::Text(levels().map(str::to_owned).collect()), Column::Float);
        columns.push((axis.name.clone(), column));
    }
    let float = |of: &dyn Fn(&Row) -> Option<f64>| {
        Column::Float(rows.iter().map(|row| of(row).unwrap_or(f64::NAN)).collect())
    };
    for (place, metric) in sweep.metrics.iter().enumerate() {
        columns.push((metric.name.clone(), float(&|row| row.metrics[place])));
        if sweep.ensemble > 1 {
            columns.push((format!("{}_least", metric.name), float(&|row| Some(row.ends[place]?[0]))));
            columns.push((format!("{}_most", metric.name), float(&|row| Some(row.ends[place]?[1]))));
        }
    }
    let text = |of: &dyn Fn(&Row) -> &str| Column::Text(rows.iter().map(|row| of(row).to_owned()).collect());
    if !sweep.is_drawn() {
        columns.push(("decided".to_owned(), text(&|row| decided(row))));
    }
    columns.push(("fault".to_owned(), text(&|row| &row.fault)));
    columns.push(("failure".to_owned(), text(&|row| &row.failure)));
    columns
}

/// As the result of a sweep has it.
fn decided(row: &Row) -> &'static str {
    match row.decided {
        Some(true) => "yes",
        Some(false) => "no",
        None => "",
    }
}

#[pymethods]
impl SweepResult {
    /// The best of the allowed points by the objective: its number; None without an objective, and if none is allowed.
    #[getter]
    fn best(&self) -> Option<usize> {
        let (sweep, rows) = &*self.swept;
        sweep.best(rows).map(|row| row.point)
    }

    /// Whether each point ran to its end and keeps all constraints.
    #[getter]
    fn allowed(&self) -> Vec<bool> {
        let (sweep, rows) = &*self.swept;
        rows.iter().map(|row| sweep.allows(row)).collect()
    }

    /// The rig of a point.
    fn rig(&self, point: usize) -> PyResult<Rig> {
        let (sweep, rows) = &*self.swept;
        if point >= rows.len() {
            return Err(PyIndexError::new_err(format!(
                "there is no point {point}; there are {}",
                rows.len()
            )));
        }
        let Source { name, text } = sweep.rig_source.clone();
        Rig::read((name, text), sweep.settings_of(point))
    }

    /// The result as `pneudrive sweep` writes it, byte for byte.
    fn to_csv(&self) -> String {
        let (sweep, rows) = &*self.swept;
        let lines = std::iter::once(sweep.header()).chain(rows.iter().map(|row| row.to_csv(sweep)));
        lines.map(|line| line + "\n").collect()
    }

    /// Writes sweep.csv and sweep.html into a folder.
    fn save(&self, py: Python<'_>, folder: PathBuf) -> PyResult<()> {
        let (sweep, rows) = &*self.swept;
        let [csv, page] = ["sweep.csv", "sweep.html"].map(|name| folder.join(name));
        work::run(py, None, |_| {
            std::fs::create_dir_all(&folder)?;
            refuse_to_replace(&csv, HEADER_END)?;
            refuse_to_replace(&page, GENERATOR)?;
            put(&csv, &self.to_csv())?;
            report::page(sweep, rows).write(&page)
        })
    }

    fn __str__(&self) -> String {
        let (sweep, rows) = &*self.swept;
        let tables = [report::best(sweep, rows), report::combinations(sweep, rows)];
        let tables = tables.iter().filter(|table| !table.rows.is_empty());
        let tables = tables.map(|table| format!("\n{}\n{}", table.heading, table.to_text()));
        format!("{}\n{}", report::count(sweep, rows), tables.collect::<String>())
    }

    fn __repr__(&self) -> String {
        let (sweep, rows) = &*self.swept;
        format!("<SweepResult {}: {}>", sweep.rig.name(), report::count(sweep, rows))
    }
}
