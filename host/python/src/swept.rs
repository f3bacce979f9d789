//! `SweepResult`: what became of the points of a sweep.

use std::path::PathBuf;
use std::sync::Arc;

use anyhow::{Result, bail};
use pneudrive_optimise::sweep::{HEADER_END, Row, Source, Sweep, report};
use pneudrive_records::own_file::{GENERATOR, refuse_to_replace};
use pneudrive_records::whole_file::put;
use pneudrive_report::Library;
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;

use crate::channels::{Channels, Column, Columns};
use crate::errors::OrRaise;
use crate::rig::Rig;
use crate::work;

/// Refuses a result without a single run.
fn refuse_failure(rows: &[Row]) -> Result<()> {
    match rows.iter().find(|row| !row.failure.is_empty()) {
        Some(first) if rows.iter().all(|row| !row.failure.is_empty()) => {
            bail!("every point failed; the first: {}", first.failure)
        }
        _ => Ok(()),
    }
}

/// The result of a sweep: one row per point.
#[pyclass(frozen, extends = Channels, mapping, module = "pneudrive")]
pub struct SweepResult {
    swept: Arc<(Sweep, Vec<Row>)>,
}

impl SweepResult {
    /// Of all points.
    pub fn of(py: Python<'_>, sweep: Sweep, rows: Vec<Row>) -> PyResult<Py<SweepResult>> {
        refuse_failure(&rows).or_raise()?;
        let swept = Arc::new((sweep, rows));
        let shared = Arc::clone(&swept);
        Py::new(py, (SweepResult { swept }, Channels::new(move || columns(&shared.0, &shared.1))))
    }
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
        columns.push(("converged".to_owned(), text(&|row| converged(row))));
    }
    columns.push(("fault".to_owned(), text(&|row| &row.fault)));
    columns.push(("failure".to_owned(), text(&|row| &row.failure)));
    columns
}

/// As the result of a sweep has it.
fn converged(row: &Row) -> &'static str {
    match row.converged {
        Some(true) => "yes",
        Some(false) => "no",
        None => "",
    }
}

#[pymethods]
impl SweepResult {
    /// The number of the allowed point that is best by the objective; None without an objective or an allowed point.
    #[getter]
    fn best(&self) -> Option<usize> {
        let (sweep, rows) = &*self.swept;
        sweep.best(rows).map(|row| row.point)
    }

    /// Whether each point ran to its end and satisfies all constraints.
    #[getter]
    fn allowed(&self) -> Vec<bool> {
        let (sweep, rows) = &*self.swept;
        rows.iter().map(|row| sweep.allows(row)).collect()
    }

    /// Returns the rig of a point.
    fn rig(&self, point: usize) -> PyResult<Rig> {
        let (sweep, rows) = &*self.swept;
        if point >= rows.len() {
            return Err(PyIndexError::new_err(format!(
                "there is no point {point}; there are {}",
                rows.len()
            )));
        }
        let Source { name, text } = sweep.rig_source.clone();
        Rig::read((name, text), sweep.settings_of(point).concat())
    }

    /// The varied quantities that are not drawn, in order.
    #[getter]
    fn axes(&self) -> Vec<String> {
        let axes = self.swept.0.axes.iter().filter(|axis| !axis.drawn);
        axes.map(|axis| axis.name.clone()).collect()
    }

    /// The result as an `xarray.Dataset` over the axes. Drawn values add the dimension `draw` and are variables of it.
    fn to_xarray<'py>(slf: PyRef<'_, SweepResult>, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let mut axes = slf.axes();
        if slf.swept.0.is_drawn() {
            axes.push("draw".to_owned());
        }
        slf.as_super().over(py, axes)
    }

    /// Returns the result as CSV, byte for byte as `pneudrive sweep` writes it.
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
            report::page(sweep, rows).write(&page, Library::Linked)
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
