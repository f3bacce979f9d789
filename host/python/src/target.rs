//! `Target`: a recorded transient as a rig has it, in integers.

use std::path::{Path, PathBuf};

use pneudrive_evaluate::transient;
use pneudrive_protocol::RecordedSample;
use pneudrive_records::target::TargetFile;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::channels::{Channels, Column, Columns};
use crate::transient::Transient;
use crate::work;

/// A TARGET file or a streamed run.
#[pyclass(frozen, extends = Channels, mapping, module = "pneudrive")]
pub struct Target {
    /// Its name, for messages.
    pub name: String,
    /// The file.
    pub file: TargetFile,
}

impl Target {
    /// With its columns.
    pub fn of(py: Python<'_>, name: String, file: TargetFile) -> PyResult<Py<Target>> {
        let columns_of = file.clone();
        Py::new(py, (Target { name, file }, Channels::new(move || columns(&columns_of))))
    }

    /// In engineering units.
    pub fn transient(&self) -> anyhow::Result<transient::Transient> {
        transient::Transient::of_target(&self.name, &self.file)
    }
}

/// The columns of the file. A pressure that was not measured is NaN.
fn columns(file: &TargetFile) -> Columns {
    let samples = &file.samples;
    let pressure = |name: &str, of: fn(&RecordedSample) -> i16| {
        let values = samples.iter().map(|(_, sample)| of(sample));
        let column = match file.is_unknown(name) {
            true => Column::Float(values.map(|_| f64::NAN).collect()),
            false => Column::Int(values.map(i32::from).collect()),
        };
        (format!("{name}_raw"), column)
    };
    let column = |name: &str, of: fn(&RecordedSample) -> i32| {
        (name.to_owned(), Column::Int(samples.iter().map(|(_, sample)| of(sample)).collect()))
    };
    vec![
        ("index".to_owned(), Column::Int(samples.iter().map(|(index, _)| *index).collect())),
        column("position_counts", |sample| sample.position),
        pressure("pressure_1", |sample| sample.pressure_1),
        pressure("pressure_2", |sample| sample.pressure_2),
        column("command_counts", |sample| sample.command.into()),
        column("error_counts", |sample| sample.error.into()),
        column("spool_raw", |sample| sample.spool.into()),
    ]
}

/// What a file is called in messages.
pub fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

#[pymethods]
impl Target {
    /// Reads a TARGET file or a streamed run.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Py<Target>> {
        let file = work::at_once(|| TargetFile::read(&path))?;
        Target::of(py, name_of(&path), file)
    }

    /// The name of the file.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// The lines of the header by key.
    #[getter]
    fn header<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (key, value) in &self.file.header {
            dict.set_item(key, value)?;
        }
        Ok(dict)
    }

    /// Returns the channels in mm, kPa and counts over time.
    #[pyo3(name = "transient")]
    fn to_transient(&self, py: Python<'_>) -> PyResult<Py<Transient>> {
        Transient::of(py, work::at_once(|| self.transient())?)
    }

    /// Writes the file into a folder under the next free number, TARGET01.DAT, TARGET02.DAT, ..., and returns its path.
    fn save_next(&self, folder: PathBuf) -> PyResult<PathBuf> {
        work::at_once(|| self.file.write_next(&folder))
    }

    /// Draws the channels and returns a matplotlib figure.
    #[pyo3(signature = (channels=None))]
    fn plot<'py>(&self, py: Python<'py>, channels: Option<Vec<String>>) -> PyResult<Bound<'py, PyAny>> {
        py.import("pneudrive.plot")?.call_method1("transients", ([self.to_transient(py)?], channels))
    }

    fn __repr__(&self) -> String {
        format!("<Target {}: {} samples>", self.name, self.file.samples.len())
    }
}
