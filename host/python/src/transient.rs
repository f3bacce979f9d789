//! `Transient`: channels in engineering units, wherever they come from.

use std::path::PathBuf;

use pneudrive_evaluate::transient::{self, CHANNELS};
use pyo3::prelude::*;

use crate::channels::{Channels, Column, Columns};
use crate::work;

/// Channels in mm, kPa and counts over time.
#[pyclass(frozen, extends = Channels, mapping, module = "pneudrive")]
pub struct Transient {
    /// The channels.
    pub transient: transient::Transient,
}

impl Transient {
    /// With its columns.
    pub fn of(py: Python<'_>, transient: transient::Transient) -> PyResult<Py<Transient>> {
        let own = transient.clone();
        Py::new(py, (Transient { transient }, Channels::new(move || columns(&own))))
    }
}

fn columns(transient: &transient::Transient) -> Columns {
    let names =
        CHANNELS.iter().map(|(name, unit)| format!("{}_{}", name.replace(' ', "_"), unit.to_lowercase()));
    let channels = names.zip(transient.channels.iter().cloned().map(Column::Float));
    let time = ("time_s".to_owned(), Column::Float(transient.time.clone()));
    std::iter::once(time).chain(channels).collect()
}

#[pymethods]
impl Transient {
    /// Reads a TARGET file, a streamed run or a run folder.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Py<Transient>> {
        let read = work::at_once(|| transient::Transient::read(&path))?;
        Transient::of(py, read)
    }

    /// The origin of the transient.
    #[getter]
    fn name(&self) -> &str {
        &self.transient.name
    }

    /// The name of the test.
    #[getter]
    fn test(&self) -> &str {
        &self.transient.test
    }

    /// The times of the samples before and after each gap, s.
    #[getter]
    fn gaps(&self) -> Vec<(f64, f64)> {
        self.transient.gaps.iter().map(|[before, after]| (*before, *after)).collect()
    }

    /// The sample period, s.
    #[getter]
    fn period_s(&self) -> f64 {
        self.transient.period_s()
    }

    fn __repr__(&self) -> String {
        format!("<Transient {}: {} samples>", self.transient.name, self.transient.time.len())
    }
}
