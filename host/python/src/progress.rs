//! What is called with progress: the caller's own function, a bar, or nothing.

use pyo3::prelude::*;
use pyo3::types::PyBool;

/// The function for `progress`: a function is called with what is done and what is to do; True asks for a bar, False
/// for nothing. None asks for a bar where somebody looks: at a terminal and in a notebook.
pub fn of(py: Python<'_>, progress: Option<Py<PyAny>>, what: &str) -> PyResult<Option<Py<PyAny>>> {
    if let Some(progress) = &progress
        && !progress.bind(py).is_instance_of::<PyBool>()
    {
        return Ok(Some(progress.clone_ref(py)));
    }
    let bar = py.import("pneudrive.progress")?.call_method1("bar", (what, progress))?;
    Ok(if bar.is_none() { None } else { Some(bar.unbind()) })
}
