//! `Rig.simulate` and `Run`: a simulated transient, and how far it can be trusted.

use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use anyhow::Result;
use pneudrive_controller::Observation;
use pneudrive_evaluate::cancel::CancelToken;
use pneudrive_evaluate::evaluation::{Move as Measured, moves_of_run, table, to_json, tolerance_mm};
use pneudrive_evaluate::{report, transient};
use pneudrive_optimise::ensemble::run_ensemble;
use pneudrive_records::band::CHANNELS;
use pneudrive_records::judged::{FailedMembers, Judged, Spacing};
use pneudrive_records::run_folder::{self, Existing, Numbered, StoredRun};
use pneudrive_records::units::lacks_pressures;
use pneudrive_records::words;
use pneudrive_report::{Library, Page};
use pneudrive_sim::trace::{EXTRAS, Extra};
use pneudrive_sim::{Accuracy, Convergence, Recording, run_recorded};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::channels::{Channels, Column, Columns, array};
use crate::moves::{Evaluation, Move, of_runs};
use crate::rig::Rig;
use crate::transient::Transient;
use crate::{progress, work};

/// A simulated run.
#[pyclass(frozen, extends = Channels, mapping, module = "pneudrive")]
pub struct Run {
    rig: Rig,
    judged: Arc<Judged>,
    /// Whether it was asked if the run has converged.
    is_judged: bool,
    moves: OnceLock<Vec<Vec<Measured>>>,
}

impl Run {
    /// Its rig.
    pub fn rig(&self) -> &Rig {
        &self.rig
    }

    /// The run, and what is known of it.
    pub fn judged(&self) -> &Judged {
        &self.judged
    }

    fn measured(&self) -> &[Vec<Measured>] {
        self.moves.get_or_init(|| vec![moves_of_run(&self.rig.rig, &self.judged.run)])
    }

    fn stored(&self) -> StoredRun {
        StoredRun::of_judged(&self.rig.rig, &self.judged)
    }

    fn notes(&self) -> Vec<String> {
        if self.is_judged {
            return words::run(&self.rig.rig, &self.judged);
        }
        vec![
            words::summary(&self.rig.rig, &self.judged.run),
            "one run, and nobody asked whether it has converged: its integration error may have changed an encoder count"
                .to_owned(),
        ]
    }

    fn page(&self) -> Page {
        let transient = transient::Transient::of_run("simulated", &self.stored());
        let tables = vec![table(self.measured(), tolerance_mm(Some(&self.rig.rig)))];
        report::page(&format!("{}, simulated", self.rig.rig.name()), self.notes(), &[transient], tables)
    }
}

/// How a run is to be simulated.
struct Plan {
    accuracy: Accuracy,
    spacing: Spacing,
    check_convergence: bool,
    columns: Vec<&'static Extra>,
}

impl Plan {
    /// A run with `ensemble` - 1 perturbed runs, and these columns of the air inside the valve.
    ///
    /// # Errors
    /// `ValueError` of a number or a column that there is not.
    fn new(
        accuracy: Accuracy,
        ensemble: usize,
        check_convergence: bool,
        columns: &[String],
    ) -> PyResult<Plan> {
        if !(1..=1000).contains(&ensemble) {
            return Err(PyValueError::new_err(format!(
                "ensemble must be between 1 and 1000 runs, is {ensemble}"
            )));
        }
        let spacing = Spacing { runs: ensemble, ..Spacing::default() };
        Ok(Plan {
            accuracy,
            spacing,
            check_convergence: check_convergence || ensemble > 1,
            columns: columns_named(columns)?,
        })
    }

    fn is_alone(&self) -> bool {
        self.spacing.runs == 1 && !self.check_convergence
    }

    fn recording(&self) -> Recording {
        Recording { valve: !self.columns.is_empty() }
    }
}

/// The run alone.
fn alone(rig: &pneudrive_sim::Rig, plan: Plan, tell: &mut dyn FnMut(u64, u64)) -> Result<Judged> {
    let Plan { accuracy, spacing, .. } = plan;
    let run = run_recorded(rig, accuracy, plan.recording(), |done, all| tell(done.into(), all.into()))?;
    let (convergence, band, lost) = (Convergence::UNKNOWN, None, FailedMembers::default());
    let columns = [Extra::of_rig(rig), plan.columns].concat();
    Ok(Judged { run, accuracy, convergence, band, spacing, lost, columns })
}

/// The run, and what was measured of it and its perturbed runs.
fn with_ensemble(
    rig: &pneudrive_sim::Rig,
    plan: Plan,
    meter: &work::Meter,
) -> Result<(Judged, Vec<Vec<Measured>>)> {
    let tell = |done, all| meter.at(done, all);
    let pool = work::pool(None)?;
    let ensemble = pool
        .install(|| run_ensemble(rig, plan.accuracy, plan.spacing, moves_of_run, tell, CancelToken::NEVER))?;
    let mut judged = ensemble.nominal;
    if plan.recording().valve {
        // The same run again, now with the state of the valve at every row.
        judged.run = run_recorded(rig, plan.accuracy, plan.recording(), |_, _| {})?;
        judged.columns.extend(plan.columns);
    }
    Ok((judged, ensemble.measured))
}

fn columns_named(names: &[String]) -> PyResult<Vec<&'static Extra>> {
    let of_valve = || EXTRAS.iter().filter(|extra| extra.is_of_valve());
    let known = || of_valve().map(|extra| extra.name).collect::<Vec<_>>().join(", ");
    let named = |name: &String| {
        let missing = || PyValueError::new_err(format!("columns: there is no {name}; there are {}", known()));
        of_valve().find(|extra| extra.name == name).ok_or_else(missing)
    };
    names.iter().map(named).collect()
}

/// Runs the test of a rig.
fn simulate(py: Python<'_>, rig: &Rig, plan: Plan, progress: Option<Py<PyAny>>) -> PyResult<Py<Run>> {
    let is_judged = !plan.is_alone();
    let bar = progress::of(py, progress, "simulating")?;
    let (judged, moves) = if is_judged {
        let (judged, moves) = work::run(py, bar, |meter| with_ensemble(&rig.rig, plan, meter))?;
        (judged, OnceLock::from(moves))
    } else {
        (work::run_here(py, bar, |tell| alone(&rig.rig, plan, tell))?, OnceLock::new())
    };
    let judged = Arc::new(judged);
    let channels = channels(rig, &judged);
    Py::new(py, (Run { rig: rig.clone(), judged, is_judged, moves }, channels))
}

#[pymethods]
impl Rig {
    /// Simulates the test. `ensemble` is the number of runs: the run itself and its perturbed runs, whose mass and starting
    /// position differ very slightly; figures are ranges over them. `check_convergence` checks whether the integration error
    /// could change an encoder count. `columns` adds columns of the air inside the valve. The interpreter's lock is released.
    #[pyo3(signature = (*, ensemble=8, check_convergence=true, columns=Vec::new(), tolerance=None, method=None, progress=None))]
    #[expect(clippy::too_many_arguments, reason = "they are keywords in Python")]
    fn simulate(
        &self,
        py: Python<'_>,
        ensemble: usize,
        check_convergence: bool,
        columns: Vec<String>,
        tolerance: Option<f64>,
        method: Option<&str>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Py<Run>> {
        let accuracy = self.accuracy(tolerance, method)?;
        let plan = Plan::new(accuracy, ensemble, check_convergence, &columns)?;
        simulate(py, self, plan, progress)
    }
}

/// The columns of trace.csv.
fn channels(rig: &Rig, judged: &Arc<Judged>) -> Channels {
    let (rig, judged) = (rig.rig.clone(), Arc::clone(judged));
    Channels::new(move || {
        let columns = StoredRun::of_judged(&rig, &judged).into_columns();
        columns.map(|(name, values)| (name.to_owned(), Column::Float(values))).collect()
    })
}

/// The convergence of a run: whether its transient could depend on the integration error.
#[pyclass(frozen, get_all, module = "pneudrive")]
pub struct Converged {
    /// Whether the run shows the exact transient.
    is_converged: bool,
    /// The time from which the exact transient may differ, s; None for a run that has converged.
    unconverged_from_s: Option<f64>,
    /// The largest estimated error of the positions of the run, m.
    error_m: f64,
    /// The smallest distance of a sampled position from the edge of its count, m; None without an encoder in the loop.
    closest_edge_m: Option<f64>,
    /// The result in words.
    text: String,
}

#[pymethods]
impl Converged {
    fn __bool__(&self) -> bool {
        self.is_converged
    }

    fn __str__(&self) -> &str {
        &self.text
    }

    fn __repr__(&self) -> String {
        format!("<Converged: {}>", self.text)
    }
}

/// The fault that ended the control of a run.
#[pyclass(frozen, get_all, module = "pneudrive")]
pub struct Trip {
    /// The name of the fault, such as "position-outside".
    fault: &'static str,
    /// The meaning of the fault and its remedy.
    meaning: &'static str,
    /// The number of the sample at which the drive tripped.
    sample: u32,
}

#[pymethods]
impl Trip {
    fn __repr__(&self) -> String {
        format!("<Trip at sample {}: {} ({})>", self.sample, self.fault, self.meaning)
    }
}

#[pymethods]
impl Run {
    /// The rig that was run.
    #[getter(rig)]
    fn its_rig(&self) -> Rig {
        self.rig.clone()
    }

    /// The convergence of the run; None if it was not checked.
    #[getter]
    fn convergence(&self) -> Option<Converged> {
        let convergence = &self.judged.convergence;
        self.is_judged.then(|| Converged {
            is_converged: convergence.is_converged(),
            unconverged_from_s: convergence.unconverged_from_s,
            error_m: convergence.error_m,
            closest_edge_m: convergence.closest_edge.map(|edge| edge.distance_m),
            text: words::convergence(convergence),
        })
    }

    /// The fault that ended the control; None without one.
    #[getter]
    fn trip(&self) -> Option<Trip> {
        let trip = |(fault, sample): (pneudrive_controller::Fault, u32)| Trip {
            fault: words::fault_name(fault),
            meaning: words::fault_meaning(fault.code()),
            sample,
        };
        self.judged.run.fault.map(trip)
    }

    /// The number of runs behind the figures: the run and its perturbed runs.
    #[getter]
    fn ensemble(&self) -> usize {
        self.measured().len()
    }

    /// The moves, with figures as ranges over the run and its perturbed runs.
    #[getter]
    fn moves(&self) -> Vec<Move> {
        of_runs(self.measured())
    }

    /// Notes on the run, one sentence each.
    #[getter(notes)]
    fn its_notes(&self) -> Vec<String> {
        self.notes()
    }

    /// The number of integrator steps.
    #[getter]
    fn steps(&self) -> u64 {
        self.judged.run.work.integrator.n_steps
    }

    /// The lowest and highest values over the run and its perturbed runs, at the run's own instants: a pair of arrays for each
    /// channel, in its unit. Empty without perturbed runs.
    #[getter]
    fn band<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        if let Some(band) = &self.judged.band {
            for ((name, low), high) in CHANNELS.iter().zip(&band.low).zip(&band.high) {
                dict.set_item(name, (array(py, low.clone())?, array(py, high.clone())?))?;
            }
        }
        Ok(dict)
    }

    /// The controller's integers, one row per sample, which every execution level repeats bit for bit. A pressure that the rig does
    /// not measure is NaN.
    #[getter]
    fn samples(&self, py: Python<'_>) -> PyResult<Py<Channels>> {
        let judged = Arc::clone(&self.judged);
        let measures_pressures = !lacks_pressures(&self.rig.rig.parameters());
        Py::new(py, Channels::new(move || integers(&judged.run.observations, measures_pressures)))
    }

    /// The channels in mm, kPa and counts over time.
    fn transient(&self, py: Python<'_>) -> PyResult<Py<Transient>> {
        Transient::of(py, transient::Transient::of_run(self.rig.rig.name(), &self.stored()))
    }

    /// Writes a run folder, as `pneudrive simulate` does: trace.csv, run.json, report.html and, with perturbed runs,
    /// band.csv. A run of another rig is replaced only with `overwrite`. Returns the number of the run.
    #[pyo3(signature = (folder, *, overwrite=false))]
    fn save(&self, py: Python<'_>, folder: PathBuf, overwrite: bool) -> PyResult<u64> {
        if !self.is_judged {
            return Err(PyValueError::new_err(
                "a run folder tells whether its run has converged; simulate with check_convergence=True",
            ));
        }
        let existing = if overwrite { Existing::Overwrite } else { Existing::Keep };
        work::run(py, None, |_| {
            std::fs::create_dir_all(&folder)?;
            run_folder::refuse_other_rig(&folder, &self.rig.rig, existing)?;
            let page = self.page();
            let pieces =
                |mark: &str, run: &Numbered| page.of_run(run).text_in(&folder, mark, Library::Linked);
            let moves = to_json(self.measured());
            run_folder::write(&folder, &self.rig.rig, &self.judged, moves, Some(&pieces), existing)
        })
    }

    /// Draws position, pressures, spool and command, and returns a matplotlib figure.
    #[pyo3(signature = (channels=None))]
    fn plot<'py>(slf: Bound<'py, Run>, channels: Option<Vec<String>>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("pneudrive.plot")?.call_method1("run", (&slf, channels))
    }

    fn __str__(&self, py: Python<'_>) -> PyResult<String> {
        let evaluation =
            Py::new(py, Evaluation::of(py, self.measured(), tolerance_mm(Some(&self.rig.rig)))?)?;
        Ok(self.notes().join("\n") + "\n" + &evaluation.bind(py).str()?.to_string())
    }

    fn __repr__(&self) -> String {
        format!("<Run {}>", words::summary(&self.rig.rig, &self.judged.run))
    }
}

/// Columns of what the controller saw and made of it. A pressure that was not measured is NaN.
fn integers(observations: &[Observation], measures_pressures: bool) -> Columns {
    let column = |name: &str, of: fn(&Observation) -> i32| {
        (name.to_owned(), Column::Int(observations.iter().map(of).collect()))
    };
    let long = |name: &str, of: fn(&Observation) -> i64| {
        (name.to_owned(), Column::Long(observations.iter().map(of).collect()))
    };
    let pressure = |name: &str, of: fn(&Observation) -> i32| match measures_pressures {
        true => column(name, of),
        false => (name.to_owned(), Column::Float(vec![f64::NAN; observations.len()])),
    };
    vec![
        long("index", |seen| seen.index.into()),
        column("setpoint_counts", |seen| seen.setpoint),
        column("position_counts", |seen| seen.position),
        column("error_counts", |seen| seen.error),
        column("command_counts", |seen| seen.command.into()),
        long("velocity", |seen| seen.velocity),
        long("acceleration", |seen| seen.acceleration),
        pressure("pressure_1_raw", |seen| seen.pressure_1.into()),
        pressure("pressure_2_raw", |seen| seen.pressure_2.into()),
        column("spool_raw", |seen| seen.spool.into()),
    ]
}
