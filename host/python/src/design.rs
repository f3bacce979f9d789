//! `Rig.new`: a rig from figures of data sheets, as `pneudrive rig new` makes it.

use pneudrive_design::own_drive::{remarks, rig_file};
use pneudrive_design::question::{AnswerProblem, Answers, QUESTIONS};
use pneudrive_design::suggestion::{changed, suggestion};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::RigError;
use crate::rig::Rig;
use crate::work;

/// Names of questions as keywords.
fn keyword(name: &str) -> String {
    name.replace('-', "_")
}

/// The answers of keywords, each a text with its unit, or a plain number.
fn answers_of(given: &Bound<'_, PyDict>) -> PyResult<Answers> {
    let mut answers = Answers::default();
    for (name, value) in given {
        let name: String = name.extract()?;
        let question = QUESTIONS.iter().find(|question| keyword(question.name) == name).ok_or_else(|| {
            let known: Vec<String> = QUESTIONS.iter().map(|question| keyword(question.name)).collect();
            PyTypeError::new_err(format!("{name} is no figure of a drive; there are {}", known.join(", ")))
        })?;
        if !value.is_none() {
            answers.answer(question, &value.str()?.to_string());
        }
    }
    Ok(answers)
}

/// Everything that is wrong with the answers, and others that make a rig.
fn refusal(name: &str, answers: &Answers, wrong: &[AnswerProblem]) -> PyErr {
    let lines = wrong.iter().map(|one| format!("{}: {}", keyword(one.question), one.message));
    let call = |others: Answers| {
        let changed = changed(answers, &others).join(", ");
        let answers = others.given().map(|(question, text)| format!(", {}={text:?}", keyword(question)));
        format!("this works: Rig.new({name:?}{})\n  with {changed}", answers.collect::<String>())
    };
    let text = lines.chain(suggestion(name, answers).map(call)).collect::<Vec<_>>().join("\n");
    let part =
        |one: &AnswerProblem| (name.to_owned(), None::<usize>, keyword(one.question), one.message.clone());
    RigError::new_err((text, wrong.iter().map(part).collect::<Vec<_>>()))
}

#[pymethods]
impl Rig {
    /// Makes a rig from data-sheet figures: `Rig.new("press", bore="32 mm", stroke="250 mm", mass="8 kg", flow="350 l/min")`.
    /// `questions()` lists the figures. A figure that is left out gets a usual value, which the rig marks as such.
    #[staticmethod]
    #[pyo3(name = "new", signature = (name, /, **answers))]
    fn of_data_sheets(name: &str, answers: Option<&Bound<'_, PyDict>>) -> PyResult<Rig> {
        let answers = answers.map_or_else(|| Ok(Answers::default()), answers_of)?;
        let made = work::at_once(|| Ok(rig_file(name, &answers)))?;
        let text = made.map_err(|wrong| refusal(name, &answers, &wrong))?;
        remarks(&answers).iter().for_each(|remark| log::info!("{remark}"));
        Rig::read((name.to_owned(), text), Vec::new())
    }
}

/// The figures that `Rig.new` takes: the name of each, the question, an example, and the value without an answer ("": an answer
/// is required).
#[pyfunction]
pub fn questions(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    let one = |question: &pneudrive_design::question::Question| {
        let dict = PyDict::new(py);
        dict.set_item("name", keyword(question.name))?;
        dict.set_item("question", question.prompt)?;
        dict.set_item("example", question.example)?;
        dict.set_item("without", question.without)?;
        Ok(dict)
    };
    QUESTIONS.iter().map(one).collect()
}
