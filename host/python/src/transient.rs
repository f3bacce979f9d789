//! `Transient`: channels in engineering units, wherever they come from; and how far two of them are apart.

use std::path::PathBuf;

use anyhow::{Context, bail};
use pneudrive_analysis::alignment::{best_shift, first_move};
use pneudrive_analysis::deviation::{self, WithinBand, deviations};
use pneudrive_analysis::transient::{self, CHANNELS};
use pneudrive_records::run_folder::StoredRun;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::channels::{Channels, Column, Columns};
use crate::run::Run;
use crate::target::Target;
use crate::work;

/// Channels in mm, kPa and counts over time.
#[pyclass(frozen, extends = Channels, mapping, module = "pneudrive")]
pub struct Transient {
    transient: transient::Transient,
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

    /// Where it comes from.
    #[getter]
    fn name(&self) -> &str {
        &self.transient.name
    }

    /// What its test is called.
    #[getter]
    fn test(&self) -> &str {
        &self.transient.test
    }

    /// Times before and after each place where samples are missing, s.
    #[getter]
    fn gaps(&self) -> Vec<(f64, f64)> {
        self.transient.gaps.iter().map(|[before, after]| (*before, *after)).collect()
    }

    /// Time between two samples, s.
    #[getter]
    fn period_s(&self) -> f64 {
        self.transient.period_s()
    }

    fn __repr__(&self) -> String {
        format!("<Transient {}: {} samples>", self.transient.name, self.transient.time.len())
    }
}

/// What has a transient: a run, a record, a transient, or the path of one.
pub enum Source {
    /// A simulated run.
    Run(Py<Run>),
    /// A record.
    Target(Py<Target>),
    /// A transient.
    Transient(Py<Transient>),
    /// A TARGET file, a streamed run or a run folder.
    Path(PathBuf),
}

impl<'a, 'py> FromPyObject<'a, 'py> for Source {
    type Error = PyErr;

    fn extract(what: Borrowed<'a, 'py, PyAny>) -> PyResult<Source> {
        if let Ok(run) = what.cast::<Run>() {
            Ok(Source::Run(run.to_owned().unbind()))
        } else if let Ok(target) = what.cast::<Target>() {
            Ok(Source::Target(target.to_owned().unbind()))
        } else if let Ok(transient) = what.cast::<Transient>() {
            Ok(Source::Transient(transient.to_owned().unbind()))
        } else if let Ok(path) = what.extract::<PathBuf>() {
            Ok(Source::Path(path))
        } else {
            let kind = what.get_type().name()?;
            Err(PyTypeError::new_err(format!(
                "a transient is a Run, a Target, a Transient or a path, not {kind}"
            )))
        }
    }
}

impl Source {
    /// The transient.
    ///
    /// # Errors
    /// When a file cannot be read, or lacks a scale.
    pub fn transient(&self) -> PyResult<transient::Transient> {
        match self {
            Source::Run(run) => {
                let run = run.get();
                let stored = StoredRun::of_judged(&run.rig().rig, run.judged());
                Ok(transient::Transient::of_run(run.rig().rig.name(), &stored))
            }
            Source::Target(target) => work::at_once(|| target.get().transient()),
            Source::Transient(transient) => Ok(transient.get().transient.clone()),
            Source::Path(path) => work::at_once(|| transient::Transient::read(path)),
        }
    }

    /// The folder of a run.
    pub fn folder(&self) -> Option<PathBuf> {
        match self {
            Source::Path(path) => Some(path.clone()).filter(|path| path.is_dir()),
            _ => None,
        }
    }
}

/// How far a channel of one transient is from that of another.
#[pyclass(frozen, get_all, module = "pneudrive")]
pub struct Deviation {
    /// Name of the channel.
    channel: &'static str,
    /// Its unit.
    unit: &'static str,
    /// Instants that were compared.
    samples: usize,
    /// Mean difference.
    mean: f64,
    /// Standard deviation of the difference.
    standard_deviation: f64,
    /// Mean of the squared difference.
    mean_square: f64,
    /// Largest difference.
    largest: f64,
    /// Root of the mean square as a fraction of the reference's range; NaN for a constant channel.
    fraction_of_range: f64,
    /// Fraction of the samples that lie in the band of a run and its neighbours; None without neighbours.
    inside_band: Option<f64>,
    /// Root of the mean square of the distance to that band, 0 inside; None without neighbours.
    rms_beyond_band: Option<f64>,
}

impl From<&deviation::Deviation> for Deviation {
    fn from(of: &deviation::Deviation) -> Deviation {
        let within: Option<WithinBand> = of.within_band;
        Deviation {
            channel: of.channel,
            unit: of.unit,
            samples: of.samples,
            mean: of.mean,
            standard_deviation: of.standard_deviation,
            mean_square: of.mean_square,
            largest: of.largest,
            fraction_of_range: of.fraction_of_range,
            inside_band: within.map(|within| within.inside),
            rms_beyond_band: within.map(|within| within.beyond),
        }
    }
}

#[pymethods]
impl Deviation {
    fn __repr__(&self) -> String {
        let Deviation { channel, unit, mean, standard_deviation, largest, .. } = self;
        format!(
            "<Deviation {channel}, {unit}: mean {mean:.4}, std {standard_deviation:.4}, largest {largest:.4}>"
        )
    }
}

/// The deviations of others from a reference.
#[pyclass(frozen, get_all, module = "pneudrive")]
pub struct Overlay {
    /// The transients as they were compared, the reference first.
    transients: Vec<Py<Transient>>,
    /// The deviations of each of the others from the reference, channel by channel.
    deviations: Vec<Vec<Py<Deviation>>>,
    /// How far each of the others was shifted, s.
    shifts_s: Vec<f64>,
    /// The deviations as tables of text.
    text: String,
}

#[pymethods]
impl Overlay {
    fn __str__(&self) -> &str {
        &self.text
    }

    fn __repr__(&self) -> String {
        format!("<Overlay of {} transients>", self.transients.len())
    }

    /// Draws the transients on the same axes; returns a matplotlib figure.
    #[pyo3(signature = (channels=None))]
    fn plot<'py>(&self, py: Python<'py>, channels: Option<Vec<String>>) -> PyResult<Bound<'py, PyAny>> {
        let transients: Vec<_> = self.transients.iter().map(|one| one.clone_ref(py)).collect();
        py.import("pneudrive.plot")?.call_method1("transients", (transients, channels))
    }
}

/// Compares transients with a reference, channel by channel, at the instants that both cover. `align` moves them in
/// time: "start" not at all, "move" by their first moves, "correlation" to where the positions agree best.
#[pyfunction]
#[pyo3(signature = (reference, *others, align="start"))]
pub fn overlay(py: Python<'_>, reference: Source, others: Vec<Source>, align: &str) -> PyResult<Overlay> {
    if !["start", "move", "correlation"].contains(&align) {
        let text = format!("align must be \"start\", \"move\" or \"correlation\", is \"{align}\"");
        return Err(PyValueError::new_err(text));
    }
    if others.is_empty() {
        return Err(PyTypeError::new_err(
            "there is nothing to compare the reference with; give another transient",
        ));
    }
    let reference = reference.transient()?;
    let mut result =
        Overlay { transients: Vec::new(), deviations: Vec::new(), shifts_s: Vec::new(), text: String::new() };
    result.transients.push(Transient::of(py, reference.clone())?);
    for other in others {
        let mut other = other.transient()?;
        let shift = work::at_once(|| shift(align, &reference, &other))?;
        other.shift(shift);
        let found = work::at_once(|| compared(&reference, &other))?;
        let heading = format!("deviation of {} from {}", other.name, reference.name);
        let table = deviation::table(&heading, &found);
        result.text += &format!("{heading}\n{}", table.to_text());
        let found = found.iter().map(|one| Py::new(py, Deviation::from(one)));
        result.deviations.push(found.collect::<PyResult<_>>()?);
        result.shifts_s.push(shift);
        result.transients.push(Transient::of(py, other)?);
    }
    Ok(result)
}

fn compared(
    reference: &transient::Transient,
    other: &transient::Transient,
) -> anyhow::Result<Vec<deviation::Deviation>> {
    let found = deviations(reference, other);
    if found.is_empty() {
        bail!("{} and {} have no time in common", reference.name, other.name);
    }
    Ok(found)
}

/// How far `other` has to be shifted, s.
fn shift(align: &str, reference: &transient::Transient, other: &transient::Transient) -> anyhow::Result<f64> {
    let move_of = |of: &transient::Transient| {
        first_move(of).with_context(|| format!("{} has no move to align by", of.name))
    };
    match align {
        "move" => Ok(move_of(reference)? - move_of(other)?),
        "correlation" => best_shift(reference, other).with_context(|| {
            format!("{} and {} have too little time in common to align", reference.name, other.name)
        }),
        _ => Ok(0.0),
    }
}
