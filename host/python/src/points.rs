//! `_Points`: the points of a sweep for other processes. The sweep travels as the text of its files, and each point comes
//! back as its line of the result, which reads back in every bit.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;

use anyhow::{Context, Result};
use pneudrive_evaluate::parallel;
use pneudrive_optimise::sweep::point::Points;
use pneudrive_optimise::sweep::{Row, Source, Sweep};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;

use crate::errors::OrRaise;
use crate::swept::SweepResult;
use crate::work;

/// The points of a sweep.
#[pyclass(frozen, sequence, module = "pneudrive._pneudrive", name = "_Points")]
pub struct SentPoints {
    /// The sweep.
    pub sweep: Sweep,
}

type Text = (String, String);

#[pymethods]
impl SentPoints {
    /// Of a sweep file and the file of its rig: the name and the text of each.
    #[new]
    fn new(sweep: Text, rig: Text) -> PyResult<SentPoints> {
        let source = |(name, text): Text| Source { name, text };
        let rig = source(rig);
        let sweep = Sweep::read(source(sweep), |_| Ok(rig.clone())).or_raise()?;
        Ok(SentPoints { sweep })
    }

    fn __reduce__(slf: &Bound<'_, SentPoints>) -> (Py<PyAny>, (Text, Text)) {
        let text = |source: &Source| (source.name.clone(), source.text.clone());
        let sweep = &slf.get().sweep;
        (slf.get_type().into_any().unbind(), (text(&sweep.source), text(&sweep.rig_source)))
    }

    fn __len__(&self) -> usize {
        self.sweep.points()
    }

    /// The same wherever the same points have the same rows.
    #[getter]
    fn identity(&self) -> String {
        format!("{:016x}", self.sweep.identity())
    }

    /// Runs these points on one thread: a line of the result each.
    fn run(&self, py: Python<'_>, points: Vec<usize>) -> PyResult<Vec<String>> {
        if let Some(point) = points.iter().find(|point| **point >= self.sweep.points()) {
            let text = format!("there is no point {point}; there are {}", self.sweep.points());
            return Err(PyIndexError::new_err(text));
        }
        let run = |meter: &work::Meter| run_points(&self.sweep, &points, Some(NonZeroUsize::MIN), meter);
        let rows = work::run(py, None, run)?;
        Ok(rows.iter().map(|row| row.to_csv(&self.sweep)).collect())
    }

    /// The result of all points, from the line of each.
    fn result(&self, py: Python<'_>, lines: Vec<String>) -> PyResult<Py<SweepResult>> {
        let row = |line: &String| {
            Row::of_csv(&self.sweep, line).with_context(|| format!("{line:?} is no row of this sweep"))
        };
        let rows = lines.iter().map(row).collect::<Result<Vec<Row>>>().or_raise()?;
        SweepResult::of(py, self.sweep.clone(), rows)
    }
}

/// Runs these points; their rows are in the order of points.
pub fn run_points(
    sweep: &Sweep,
    points: &[usize],
    threads: Option<NonZeroUsize>,
    meter: &work::Meter,
) -> Result<Vec<Row>> {
    let (all, mut rows) = (points.len() as u64, BTreeMap::new());
    meter.at(0, all);
    let take = |row: Row| {
        rows.insert(row.point, row);
        meter.at(rows.len() as u64, all);
        Ok::<(), anyhow::Error>(())
    };
    let rigs = Points::of(sweep);
    work::pool(threads)?.install(|| parallel::each(points, |point| rigs.run(*point), take))?;
    Ok(rows.into_values().collect())
}
