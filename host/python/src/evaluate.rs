//! `evaluate`: what a transient tells about its moves.

use anyhow::bail;
use pneudrive_evaluate::cancel::CancelToken;
use pneudrive_evaluate::evaluation::{
    Chambers, Motion, moves, refuse_other_rig, tolerance_mm as own_tolerance_mm,
};
use pneudrive_evaluate::transient::Transient;
use pneudrive_optimise::ensemble::run_ensemble;
use pneudrive_records::run_folder::{StoredRun, rig_of};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::moves::Evaluation;
use crate::rig::RigOrSource;
use crate::run::Run;
use crate::source::Source;
use crate::{progress, work};

/// What lies between two times of a transient, without a gap.
fn part(transient: &Transient, within: [Option<f64>; 2]) -> anyhow::Result<Transient> {
    let part = transient.between(within[0].unwrap_or(f64::NEG_INFINITY), within[1].unwrap_or(f64::INFINITY));
    if part.time.len() < 2 {
        bail!("{} has fewer than two samples there", transient.name);
    }
    match part.gaps.first() {
        Some([before, after]) => bail!(
            "{}: samples are missing between {before:.4} s and {after:.4} s; choose an interval without a gap by from_s and to_s",
            part.name
        ),
        None => Ok(part),
    }
}

/// Evaluates the moves of a run, a record or a file. The perturbed runs of a run are repeated, so that every figure has a range.
#[pyfunction]
#[pyo3(signature = (transient, /, *, rig=None, tolerance_mm=None, from_s=None, to_s=None, progress=None))]
pub fn evaluate(
    py: Python<'_>,
    transient: Source,
    rig: Option<RigOrSource>,
    tolerance_mm: Option<f64>,
    from_s: Option<f64>,
    to_s: Option<f64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Evaluation> {
    if let Some(wrong) = tolerance_mm.filter(|mm| mm.is_nan() || *mm <= 0.0) {
        return Err(PyValueError::new_err(format!("tolerance_mm must be more than 0, is {wrong}")));
    }
    let settled = |rig: Option<&pneudrive_sim::Rig>| tolerance_mm.unwrap_or_else(|| own_tolerance_mm(rig));
    let within = [from_s, to_s];
    if let Source::Run(run) = &transient {
        let tolerance_mm = settled(Some(&run.get().rig().rig));
        return of_run(py, run.get(), within, tolerance_mm, progress);
    }
    let folder = transient.folder();
    let transient = transient.transient()?;
    let (runs, tolerance_mm) = work::at_once(|| {
        let rig = match (rig, &folder) {
            (Some(rig), _) => Some(rig.0.rig),
            (None, Some(folder)) => rig_of(folder).ok(),
            (None, None) => None,
        };
        if let Some(rig) = rig.as_ref().filter(|_| folder.is_none()) {
            refuse_other_rig(&transient, rig)?;
        }
        let part = part(&transient, within)?;
        let (chambers, tolerance_mm) = (rig.as_ref().map(Chambers::of), settled(rig.as_ref()));
        Ok((vec![moves(&part, &Motion::of(&part), chambers.as_ref(), tolerance_mm)], tolerance_mm))
    })?;
    Evaluation::of(py, &runs, tolerance_mm)
}

fn of_run(
    py: Python<'_>,
    run: &Run,
    within: [Option<f64>; 2],
    tolerance_mm: f64,
    progress: Option<Py<PyAny>>,
) -> PyResult<Evaluation> {
    let (rig, judged) = (&run.rig().rig, run.judged());
    let measure = |rig: &pneudrive_sim::Rig, run: &pneudrive_sim::Run| {
        let part = part(&Transient::of_run(rig.name(), &StoredRun::of(rig, run)), within)?;
        Ok(moves(&part, &Motion::of(&part), Some(&Chambers::of(rig)), tolerance_mm))
    };
    let runs = if judged.spacing.runs == 1 {
        work::at_once(|| Ok(vec![measure(rig, &judged.run)?]))?
    } else {
        let bar = progress::of(py, progress, "evaluating")?;
        let (accuracy, spacing) = (judged.accuracy, judged.spacing);
        work::run(py, bar, |meter| {
            let tell = |done, all| meter.at(done, all);
            let ensemble = work::pool(None)?
                .install(|| run_ensemble(rig, accuracy, spacing, measure, tell, CancelToken::NEVER))?;
            ensemble.measured.into_iter().collect::<anyhow::Result<Vec<_>>>()
        })?
    };
    Evaluation::of(py, &runs, tolerance_mm)
}
