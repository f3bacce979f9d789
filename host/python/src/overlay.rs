//! `overlay`: how far transients are from a reference.

use anyhow::{Context, bail};
use pneudrive_evaluate::alignment::{best_shift, first_move};
use pneudrive_evaluate::deviation::{self, WithinBand, deviations};
use pneudrive_evaluate::transient;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::source::Source;
use crate::transient::Transient;
use crate::work;

/// The deviation of a channel of one transient from the same channel of another.
#[pyclass(frozen, get_all, module = "pneudrive")]
pub struct Deviation {
    /// The name of the channel.
    channel: &'static str,
    /// The unit of the channel.
    unit: &'static str,
    /// The number of compared instants.
    samples: usize,
    /// The mean difference, in `unit`.
    mean: f64,
    /// The standard deviation of the difference, in `unit`.
    standard_deviation: f64,
    /// The mean squared difference, in the square of `unit`.
    mean_square: f64,
    /// The largest difference, in `unit`.
    largest: f64,
    /// The root mean square as a fraction of the reference's range; NaN for a constant channel.
    fraction_of_range: f64,
    /// The fraction of the samples within the band of a run and its perturbed runs; None without perturbed runs.
    inside_band: Option<f64>,
    /// The root mean square of the distance to that band, in `unit`, 0 inside; None without perturbed runs.
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

/// The deviations of transients from a reference.
#[pyclass(frozen, get_all, module = "pneudrive")]
pub struct Overlay {
    /// The compared transients, the reference first.
    transients: Vec<Py<Transient>>,
    /// The deviations of each of the others from the reference, channel by channel.
    deviations: Vec<Vec<Py<Deviation>>>,
    /// The time shift of each of the others, s.
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

    /// Draws the transients on the same axes and returns a matplotlib figure.
    #[pyo3(signature = (channels=None))]
    fn plot<'py>(&self, py: Python<'py>, channels: Option<Vec<String>>) -> PyResult<Bound<'py, PyAny>> {
        let transients: Vec<_> = self.transients.iter().map(|one| one.clone_ref(py)).collect();
        py.import("pneudrive.plot")?.call_method1("transients", (transients, channels))
    }
}

/// Compares transients with a reference, channel by channel, at the instants that both cover. `align` shifts them in
/// time: "start" not at all, "move" to align their first moves, "correlation" for the best agreement of the positions.
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
        other.error_in_counts_of(reference.mm_per_count);
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
