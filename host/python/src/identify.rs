//! `identify`: parameters of a rig from recorded transients, with their intervals.

use std::path::PathBuf;

use pneudrive_evaluate::cancel::CancelToken;
use pneudrive_identify::parameter::{Parameter, usual};
use pneudrive_identify::recording::Recording;
use pneudrive_identify::report;
use pneudrive_records::target::TargetFile;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::Value as Json;

use crate::errors::{NotBorneOut, OrRaise};
use crate::rig::{Rig, RigOrSource};
use crate::target::{Target, name_of};
use crate::{values, work};

/// A TARGET file that was read, or the path of one.
#[derive(FromPyObject)]
pub enum Record {
    /// Read.
    Read(Py<Target>),
    /// Its path.
    Path(PathBuf),
}

impl Record {
    fn recording(&self, rig: &pneudrive_sim::Rig) -> anyhow::Result<Recording> {
        match self {
            Record::Read(target) => Recording::of(&target.get().name, &target.get().file, rig),
            Record::Path(path) => Recording::of(&name_of(path), &TargetFile::read(path)?, rig),
        }
    }
}

/// The estimate of a parameter.
#[pyclass(frozen, get_all, module = "pneudrive")]
pub struct Estimate {
    /// The key, such as "load.mass_kg".
    key: String,
    /// The unit of the values.
    unit: String,
    /// The value of the rig file, in `unit`.
    file: f64,
    /// The estimated value, in `unit`.
    value: f64,
    /// The standard error of `value`, in `unit`.
    standard_error: f64,
    /// The ends of the interval, in `unit`.
    interval: (f64, f64),
    /// Whether `interval` is a 95 % interval: only if the model explains the data.
    is_95_percent: bool,
    /// Keys whose assumed values determine the interval more than the data do.
    rests_on: Vec<String>,
}

impl Estimate {
    fn of(json: &Json) -> Estimate {
        let number = |name: &str| json[name].as_f64().unwrap_or(f64::NAN);
        let text = |name: &str| json[name].as_str().unwrap_or_default().to_owned();
        let end = |place: usize| json["interval"][place].as_f64().unwrap_or(f64::NAN);
        let rests_on = json["rests_on"].as_array().into_iter().flatten();
        Estimate {
            key: text("key"),
            unit: text("unit"),
            file: number("file"),
            value: number("estimate"),
            standard_error: number("standard_error"),
            interval: (end(0), end(1)),
            is_95_percent: !json["interval_95"].is_null(),
            rests_on: rests_on.filter_map(|share| share["key"].as_str()).map(str::to_owned).collect(),
        }
    }
}

#[pymethods]
impl Estimate {
    fn __repr__(&self) -> String {
        let Estimate { key, value, interval: (low, high), .. } = self;
        let interval = if self.is_95_percent { "95 % interval" } else { "interval, not of 95 %" };
        format!("<Estimate {key} = {value:.6} ({interval} {low:.6} to {high:.6})>")
    }
}

/// The result of an identification.
#[pyclass(frozen, module = "pneudrive")]
pub struct Identification {
    rig: Rig,
    found: pneudrive_identify::Identification,
    numbers: Json,
}

/// Fits keys of a rig to recorded transients; without `fit`, those that are usually unknown. Progress messages go to
/// the logger `pneudrive`.
#[pyfunction]
#[pyo3(signature = (rig, targets, /, *, fit=None, tolerance=None, method=None))]
pub fn identify(
    py: Python<'_>,
    rig: RigOrSource,
    targets: Vec<Record>,
    fit: Option<Vec<String>>,
    tolerance: Option<f64>,
    method: Option<&str>,
) -> PyResult<Identification> {
    let rig = rig.0;
    rig.file()?;
    let accuracy = rig.accuracy(tolerance, method)?;
    let (found, numbers) = work::run(py, None, |meter| {
        let parameters = match &fit {
            None => usual(&rig.rig),
            Some(keys) => {
                keys.iter().map(|key| Parameter::of(&rig.rig, key)).collect::<anyhow::Result<_>>()?
            }
        };
        let recordings = targets.iter().map(|target| target.recording(&rig.rig));
        let recordings = recordings.collect::<anyhow::Result<Vec<_>>>()?;
        let mut tell = |line: &str| {
            log::info!("{line}");
            meter.at(0, 0);
        };
        let fit = || {
            pneudrive_identify::identify(
                &rig.rig,
                &recordings,
                parameters,
                accuracy,
                &mut tell,
                CancelToken::NEVER,
            )
        };
        let found = work::pool(None)?.install(fit)?;
        let numbers = report::to_json(&found, &recordings);
        Ok((found, numbers))
    })?;
    Ok(Identification { rig, found, numbers })
}

#[pymethods]
impl Identification {
    /// Whether the search converged and the residuals are noise.
    #[getter]
    fn fits(&self) -> bool {
        self.found.fits
    }

    /// The estimates of the parameters that the data show.
    #[getter]
    fn estimates(&self) -> Vec<Estimate> {
        self.numbers["parameters"].as_array().into_iter().flatten().map(Estimate::of).collect()
    }

    /// The keys of the parameters that the data do not show.
    #[getter]
    fn unseen(&self) -> Vec<&'static str> {
        self.found.unidentifiable.iter().map(|one| one.parameter.key.path).collect()
    }

    /// Returns the rig with the estimated values.
    ///
    /// A model that does not explain the transients raises `NotBorneOut`, unless `despite_misfit`.
    #[pyo3(signature = (*, despite_misfit=false))]
    fn fitted(&self, despite_misfit: bool) -> PyResult<Rig> {
        if !self.found.fits && !despite_misfit {
            let name = self.rig.rig.name();
            let why = match self.found.spectrum.is_testable() {
                true => format!("the model of {name} does not explain the transients"),
                false => format!("the transients have too few samples to judge the model of {name} by"),
            };
            return Err(NotBorneOut::new_err(format!(
                "{why}; despite_misfit=True gives the rig nevertheless"
            )));
        }
        let (text, settings) = self.rig.file()?;
        let text = report::fitted(text, settings, &self.found).or_raise()?;
        Rig::read((self.rig.source.0.clone(), text), Vec::new())
    }

    /// Notes to read before the numbers are used, one sentence each.
    #[getter]
    fn notes(&self) -> Vec<String> {
        report::notes(&self.found)
    }

    /// All numbers, as in identification.json.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        Ok(values::json_to_python(py, &self.numbers)?.cast_into()?)
    }

    fn __str__(&self) -> String {
        let tables = report::tables(&self.found);
        let tables = tables.iter().map(|table| format!("{}\n{}\n", table.heading, table.to_text()));
        tables.collect::<String>() + &self.notes().join("\n")
    }

    fn __repr__(&self) -> String {
        let fits = if self.found.fits { "fits" } else { "does not fit" };
        format!(
            "<Identification of {}: {fits}, {} estimates>",
            self.rig.rig.name(),
            self.found.estimates.len()
        )
    }
}
