//! Columns of numbers by name, as NumPy arrays: what runs, records, streams and sweeps have in common.
//!
//! The columns are gathered at the first look, a vector each, which becomes an array without a copy. Arrays are
//! read-only, as one array serves everybody who asks.

use numpy::{Element, PyArray1};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyIterator, PyList, PyString};

/// A column.
pub enum Column {
    /// Real numbers.
    Float(Vec<f64>),
    /// Whole numbers.
    Int(Vec<i32>),
    /// Wider whole numbers.
    Long(Vec<i64>),
    /// Texts.
    Text(Vec<String>),
}

impl Column {
    /// As an array, or a list of texts.
    pub fn into_python(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        match self {
            Column::Float(values) => array(py, values),
            Column::Int(values) => array(py, values),
            Column::Long(values) => array(py, values),
            Column::Text(values) => Ok(PyList::new(py, values)?.into_any()),
        }
    }
}

/// A read-only array in the memory of a vector.
pub fn array<T: Element>(py: Python<'_>, values: Vec<T>) -> PyResult<Bound<'_, PyAny>> {
    let array = PyArray1::from_vec(py, values).into_any();
    array.getattr("flags")?.setattr("writeable", false)?;
    Ok(array)
}

/// Columns with their names.
pub type Columns = Vec<(String, Column)>;

/// Columns by name: arrays over one index.
#[pyclass(frozen, subclass, mapping, module = "pneudrive")]
pub struct Channels {
    gather: Box<dyn Fn() -> Columns + Send + Sync>,
    gathered: PyOnceLock<Py<PyDict>>,
}

impl Channels {
    /// Those that `gather` makes.
    pub fn new(gather: impl Fn() -> Columns + Send + Sync + 'static) -> Channels {
        Channels { gather: Box::new(gather), gathered: PyOnceLock::new() }
    }

    /// All of them.
    fn all<'py>(&self, py: Python<'py>) -> PyResult<&Bound<'py, PyDict>> {
        let gather = || {
            let dict = PyDict::new(py);
            for (name, column) in py.detach(|| (self.gather)()) {
                dict.set_item(name, column.into_python(py)?)?;
            }
            PyResult::Ok(dict.unbind())
        };
        self.gathered.get_or_try_init(py, gather).map(|dict| dict.bind(py))
    }

    fn frame<'py>(&self, py: Python<'py>, function: &str) -> PyResult<Bound<'py, PyAny>> {
        py.import("pneudrive.frames")?.call_method1(function, (self.all(py)?,))
    }

    /// As an `xarray.Dataset` over these columns.
    pub fn over<'py>(&self, py: Python<'py>, axes: Vec<String>) -> PyResult<Bound<'py, PyAny>> {
        py.import("pneudrive.frames")?.call_method1("to_xarray", (self.all(py)?, axes))
    }
}

#[pymethods]
impl Channels {
    /// Returns a column by its name.
    fn __getitem__<'py>(&self, py: Python<'py>, name: &Bound<'py, PyString>) -> PyResult<Bound<'py, PyAny>> {
        let all = self.all(py)?;
        all.get_item(name)?.ok_or_else(|| {
            let names: Vec<String> = all.keys().iter().map(|name| name.to_string()).collect();
            PyKeyError::new_err(format!("there is no column {name}; there are {}", names.join(", ")))
        })
    }

    fn __len__(&self, py: Python<'_>) -> PyResult<usize> {
        Ok(self.all(py)?.len())
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyIterator>> {
        self.all(py)?.try_iter()
    }

    fn __contains__(&self, py: Python<'_>, name: &Bound<'_, PyAny>) -> PyResult<bool> {
        self.all(py)?.contains(name)
    }

    /// The names of the columns, in order.
    fn keys(&self, py: Python<'_>) -> PyResult<Py<PyList>> {
        Ok(self.all(py)?.keys().unbind())
    }

    /// The columns, in order.
    fn values(&self, py: Python<'_>) -> PyResult<Py<PyList>> {
        Ok(self.all(py)?.values().unbind())
    }

    /// Pairs of name and column, in order.
    fn items(&self, py: Python<'_>) -> PyResult<Py<PyList>> {
        Ok(self.all(py)?.items().unbind())
    }

    /// The columns as a `pandas.DataFrame`, one row per instant; `index` names the column that becomes its index, such as "time_s".
    #[pyo3(signature = (*, index=None))]
    fn to_pandas<'py>(&self, py: Python<'py>, index: Option<&str>) -> PyResult<Bound<'py, PyAny>> {
        let frame = self.frame(py, "to_pandas")?;
        match index {
            None => Ok(frame),
            Some(name) => frame.call_method1("set_index", (name,)),
        }
    }

    /// The columns as a `polars.DataFrame`, one row per instant.
    fn to_polars<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.frame(py, "to_polars")
    }

    /// The columns as a `pyarrow.Table`, one row per instant.
    fn to_arrow<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.frame(py, "to_arrow")
    }
}
