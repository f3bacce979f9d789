//! What a transient tells about its moves, as Python has it.

use pneudrive_evaluate::evaluation::{self, remarks, table};
use pyo3::exceptions::PyAttributeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::Value as Json;

use crate::values;

/// A figure of a move, with its range over the runs.
#[pyclass(frozen, get_all, module = "pneudrive")]
pub struct Figure {
    /// The figure of the run or the record itself; None if it does not show it.
    value: Option<f64>,
    /// The smallest figure over the run and its perturbed runs; None without perturbed runs.
    least: Option<f64>,
    /// The largest figure over them; None without perturbed runs.
    most: Option<f64>,
    /// The number of runs that do not show the figure.
    runs_without: u64,
    /// The number of runs.
    runs: usize,
}

#[pymethods]
impl Figure {
    fn __repr__(&self) -> String {
        let word =
            |value: Option<f64>| value.map_or_else(|| "none".to_owned(), |value| format!("{value:.6}"));
        let range = match (self.least, self.most) {
            (Some(least), Some(most)) => format!(", {least:.6} to {most:.6} in {} runs", self.runs),
            _ => String::new(),
        };
        let without = if self.runs_without > 0 && self.runs > 1 {
            format!(", none in {} of them", self.runs_without)
        } else {
            String::new()
        };
        format!("<Figure {}{range}{without}>", word(self.value))
    }

    /// Returns the value; raises an error if there is none.
    fn __float__(&self) -> PyResult<f64> {
        self.value
            .ok_or_else(|| pyo3::exceptions::PyValueError::new_err("the move does not show this figure"))
    }
}

/// A move and its figures.
#[pyclass(frozen, module = "pneudrive")]
pub struct Move {
    number: usize,
    runs: usize,
    figures: Json,
}

impl Move {
    fn figure(&self, name: &str) -> Option<Figure> {
        let figure = &self.figures[name];
        let number = |name: &str| figure[name].as_f64();
        let of_members = |name: &str| number(name).filter(|_| self.runs > 1);
        Some(Figure {
            value: number("value"),
            least: of_members("least"),
            most: of_members("most"),
            runs_without: figure.get("runs_without")?.as_u64()?,
            runs: self.runs,
        })
    }

    fn names(&self) -> impl Iterator<Item = &String> {
        let figures = self.figures.as_object().into_iter().flatten();
        figures.filter(|(_, figure)| figure.get("runs_without").is_some()).map(|(name, _)| name)
    }
}

#[pymethods]
impl Move {
    /// The number of the move: 1 for the first move of the test.
    #[getter]
    fn number(&self) -> usize {
        self.number
    }

    /// The number of runs that end at rest ("none"), in a limit cycle ("sustained"), or undecided ("undecided").
    #[getter]
    fn limit_cycle_runs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        values::json_to_python(py, &self.figures["limit_cycle_runs"])
    }

    fn __getattr__(&self, name: &str) -> PyResult<Figure> {
        self.figure(name).ok_or_else(|| {
            let names: Vec<&str> = self.names().map(String::as_str).collect();
            PyAttributeError::new_err(format!("a move has no figure {name}; it has {}", names.join(", ")))
        })
    }

    fn __dir__(&self) -> Vec<String> {
        let own = ["number", "limit_cycle_runs", "to_dict"].map(str::to_owned);
        own.into_iter().chain(self.names().cloned()).collect()
    }

    /// The value of each figure by name; None if the move does not show it.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        dict.set_item("number", self.number)?;
        for name in self.names() {
            dict.set_item(name, self.figures[name]["value"].as_f64())?;
        }
        Ok(dict)
    }

    fn __repr__(&self) -> String {
        let word = |name: &str| match self.figures[name]["value"].as_f64() {
            Some(value) => format!("{value:.4}"),
            None => "none".to_owned(),
        };
        let [to, settled, overshoot] = ["to_mm", "settled_s", "overshoot_mm"].map(word);
        format!("<Move {} to {to} mm: settled_s {settled}, overshoot_mm {overshoot}>", self.number)
    }
}

/// The moves of a run and its perturbed runs, the run's own first.
pub fn of_runs(runs: &[Vec<evaluation::Move>]) -> Vec<Move> {
    let Json::Array(moves) = evaluation::to_json(runs) else { return Vec::new() };
    let own = runs.first().into_iter().flatten().map(|one| one.number);
    let runs = runs.len();
    own.zip(moves).map(|(number, figures)| Move { number, runs, figures }).collect()
}

/// The moves of a transient with their figures.
#[pyclass(frozen, get_all, module = "pneudrive")]
pub struct Evaluation {
    /// The moves, in order.
    moves: Vec<Py<Move>>,
    /// Remarks on the moves, one sentence each.
    remarks: Vec<String>,
    /// The number of runs behind the figures: the run and its perturbed runs, or 1.
    runs: usize,
    /// The figures as a table of text.
    text: String,
}

#[pymethods]
impl Evaluation {
    fn __str__(&self) -> String {
        format!(
            "{}{}",
            self.text,
            self.remarks.iter().map(|remark| format!("{remark}\n")).collect::<String>()
        )
    }

    fn __repr__(&self) -> String {
        format!("<Evaluation of {} moves over {} runs>", self.moves.len(), self.runs)
    }
}

impl Evaluation {
    /// Of the moves of a run and its perturbed runs.
    pub fn of(py: Python<'_>, runs: &[Vec<evaluation::Move>], tolerance_mm: f64) -> PyResult<Evaluation> {
        let table = table(runs, tolerance_mm);
        Ok(Evaluation {
            moves: of_runs(runs).into_iter().map(|one| Py::new(py, one)).collect::<PyResult<_>>()?,
            remarks: remarks(runs),
            runs: runs.len(),
            text: format!("{}\n{}", table.heading, table.to_text()),
        })
    }
}
