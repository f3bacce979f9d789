//! `LinearModel`: a plant about a state as a linear system.

use pyo3::prelude::*;
use pyo3::types::{PyIterator, PyTuple};

use crate::channels::array;

/// A plant linearised about a state: x' = rates + A (x - state) + B (u - input), y = output + C (x - state) + D (u - input).
/// Iterated, it gives A, B, C and D.
#[pyclass(frozen, module = "pneudrive")]
pub struct LinearModel(pub pneudrive_sim::LinearModel);

fn matrix<'py>(py: Python<'py>, rows: &[Vec<f64>]) -> PyResult<Bound<'py, PyAny>> {
    let width = rows.first().map_or(0, Vec::len);
    array(py, rows.concat())?.call_method1("reshape", ((rows.len(), width),))
}

fn column<'py>(py: Python<'py>, values: &[f64]) -> PyResult<Bound<'py, PyAny>> {
    array(py, values.to_vec())?.call_method1("reshape", ((values.len(), 1),))
}

#[pymethods]
#[allow(non_snake_case, reason = "the matrices have these names everywhere")]
impl LinearModel {
    /// The names of the states, with their units.
    #[getter]
    fn states(&self) -> Vec<&'static str> {
        self.0.states.clone()
    }

    /// The name of the input.
    #[getter]
    fn inputs(&self) -> [&'static str; 1] {
        ["command_counts"]
    }

    /// The names of the outputs, with their units: those of `Plant.state`.
    #[getter]
    fn outputs(&self) -> Vec<&'static str> {
        self.0.outputs.clone()
    }

    /// The derivatives of the rates by the states: one row per state, in units of the states per s.
    #[getter]
    fn A<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        matrix(py, &self.0.a)
    }

    /// The derivatives of the rates by the input, per count: one column.
    #[getter]
    fn B<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        column(py, &self.0.b)
    }

    /// The derivatives of the outputs by the states: one row per output.
    #[getter]
    fn C<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        matrix(py, &self.0.c)
    }

    /// The derivatives of the outputs by the input, per count: one column.
    #[getter]
    fn D<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        column(py, &self.0.d)
    }

    /// The state of linearisation, in the units of `states`.
    #[getter]
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        array(py, self.0.state.clone())
    }

    /// The rates of the states there, in units of the states per s; zero in an equilibrium.
    #[getter]
    fn rates<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        array(py, self.0.rates.clone())
    }

    /// The command in force there, counts.
    #[getter]
    fn input<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        array(py, vec![self.0.command_counts])
    }

    /// The outputs there, in the units of `outputs`.
    #[getter]
    fn output<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        array(py, self.0.output.clone())
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyIterator>> {
        PyTuple::new(py, [self.A(py)?, self.B(py)?, self.C(py)?, self.D(py)?])?.try_iter()
    }

    fn __repr__(&self) -> String {
        format!("<LinearModel of {}>", self.0.states.join(", "))
    }
}
