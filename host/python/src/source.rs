//! What has a transient: a run, a record, a transient, or a path.

use std::path::PathBuf;

use pneudrive_evaluate::transient;
use pneudrive_records::run_folder::StoredRun;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use crate::run::Run;
use crate::target::Target;
use crate::transient::Transient;
use crate::work;

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
