//! `Rig.characterise`: a component of a rig on the bench, as `pneudrive characterise` tests it.

use pneudrive_thesis::characteristics::{self, CURVES, Reading, Unfit};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyAny;

use crate::channels::Column;
use crate::errors::{self, PneudriveError};
use crate::rig::Rig;
use crate::work;

/// A bench test of a component: curves over one axis, and figures read from them.
#[pyclass(frozen, module = "pneudrive")]
pub struct Characteristic {
    about: &'static str,
    found: characteristics::Characteristic,
}

/// A curve of a bench test.
#[pyclass(frozen, module = "pneudrive")]
pub struct Curve {
    /// The name and the unit of the y axis.
    #[pyo3(get)]
    graph: &'static str,
    /// The name.
    #[pyo3(get)]
    name: String,
    points: [Vec<f64>; 2],
}

/// A figure read from curves.
#[pyclass(frozen, get_all, module = "pneudrive")]
pub struct CurveFigure {
    /// The name.
    name: String,
    /// The value, in `unit`; None if the searched range does not contain it.
    value: Option<f64>,
    /// The largest deviation of the true value from `value`, in `unit`; None if the equations give the value exactly.
    within: Option<f64>,
    /// The unit of `value` and `within`.
    unit: &'static str,
}

#[pymethods]
impl Curve {
    /// The x values, in the unit of `Characteristic.across`.
    #[getter]
    fn x<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Column::Float(self.points[0].clone()).into_python(py)
    }

    /// The y values, in the unit of `graph`; NaN where there is none.
    #[getter]
    fn y<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Column::Float(self.points[1].clone()).into_python(py)
    }

    fn __repr__(&self) -> String {
        format!("<Curve {}: {} points>", self.name, self.points[0].len())
    }
}

#[pymethods]
impl CurveFigure {
    fn __repr__(&self) -> String {
        let within = self.within.map_or_else(String::new, |within| format!(" +- {within:.2}"));
        let value = self.value.map_or_else(|| "not seen".to_owned(), |value| format!("{value:.4}{within}"));
        format!("<CurveFigure {} = {}>", self.name, format!("{value} {}", self.unit).trim_end())
    }
}

#[pymethods]
impl Characteristic {
    /// A description of the test, with its section in the thesis.
    #[getter]
    fn about(&self) -> &str {
        self.about
    }

    /// Notes on how the test was done, one sentence each.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.found.notes.clone()
    }

    /// The name and the unit of the x axis.
    #[getter]
    fn across(&self) -> &str {
        self.found.across
    }

    /// Whether the x axis is logarithmic.
    #[getter]
    fn logarithmic(&self) -> bool {
        self.found.logarithmic
    }

    /// The curves.
    #[getter]
    fn curves(&self) -> Vec<Curve> {
        let of = |graph: &characteristics::Graph| {
            let title = graph.title;
            let curve = move |series: &pneudrive_report::Curve| Curve {
                graph: title,
                name: series.name.clone(),
                points: [series.x.clone(), series.y.clone()],
            };
            graph.series.iter().map(curve).collect::<Vec<_>>()
        };
        self.found.graphs.iter().flat_map(of).collect()
    }

    /// The figures.
    #[getter]
    fn figures(&self) -> Vec<CurveFigure> {
        let of = |figure: &characteristics::Figure| CurveFigure {
            name: figure.name.clone(),
            value: figure.value(),
            within: match figure.reading {
                Reading::Read { within, .. } => Some(within),
                _ => None,
            },
            unit: figure.unit,
        };
        self.found.figures.iter().map(of).collect()
    }

    /// Draws the curves and returns a matplotlib figure.
    fn plot<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("pneudrive.plot")?.call_method1("characteristic", (slf,))
    }

    fn __repr__(&self) -> String {
        format!("<Characteristic {}>", self.about)
    }
}

#[pymethods]
impl Rig {
    /// Tests a component on a simulated bench, as `pneudrive characterise` does: "nominal-flow", "friction" and so on.
    #[pyo3(signature = (curve, /))]
    fn characterise(&self, py: Python<'_>, curve: &str) -> PyResult<Characteristic> {
        let wanted = CURVES.iter().find(|one| one.name == curve).ok_or_else(|| {
            let known: Vec<&str> = CURVES.iter().map(|one| one.name).collect();
            PyValueError::new_err(format!("there is no curve \"{curve}\"; there are {}", known.join(", ")))
        })?;
        match work::run(py, None, |_| Ok((wanted.measure)(&self.rig)))? {
            Ok(found) => Ok(Characteristic { about: wanted.about, found }),
            Err(Unfit::Integration(error)) => Err(errors::of(&error.into())),
            Err(lacks) => {
                Err(PneudriveError::new_err(format!("{} has no {curve}: {lacks}", self.rig.name())))
            }
        }
    }
}
