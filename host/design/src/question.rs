//! The questions for a rig file, about figures in catalogues, and the answers to them.

use std::collections::BTreeMap;

use pneudrive_sim::component::controller::Law;
use pneudrive_sim::rigfile::{Reading, read_quantity};

use crate::flow_answer::StatedFlow;

/// Something that a catalogue or a machine builder knows.
#[derive(Clone, Copy, Debug)]
pub struct Question {
    /// Its option on the command line, such as `bore`.
    pub name: &'static str,
    /// The question, without a mark.
    pub prompt: &'static str,
    /// The unit in which it counts; any unit of the same quantity will do. "" for a plain number, "text" for a word.
    pub unit: &'static str,
    /// An answer to it.
    pub example: &'static str,
    /// The value without an answer; "" if an answer is required.
    pub without: &'static str,
}

const fn question(
    name: &'static str,
    prompt: &'static str,
    unit: &'static str,
    example: &'static str,
    without: &'static str,
) -> Question {
    Question { name, prompt, unit, example, without }
}

/// The questions, in the order in which they are asked.
#[rustfmt::skip]
pub static QUESTIONS: &[Question] = &[
    question("cylinder", "Cylinder of the catalogue", "text", "iso-15552-32", "bore and rod are asked for"),
    question("bore", "Bore of the cylinder", "m", "32 mm", "that of the cylinder"),
    question("rod", "Diameter of its rod; 0 mm for a rodless cylinder", "m", "12 mm", "that of the cylinder"),
    question("stroke", "Stroke", "m", "250 mm", ""),
    question("mass", "Moving mass besides piston and rod", "kg", "8 kg", ""),
    question("incline", "Angle at which extension goes uphill", "deg", "90 deg", "horizontal"),
    question("force", "Constant force in the direction of extension", "N", "-50 N", "none"),
    question("friction", "Running friction of cylinder and guide", "N", "25 N", "unknown, within what is usual"),
    question("breakaway", "Friction at which it breaks away", "N", "40 N", "unknown, within what is usual"),
    question("valve", "Valve of the catalogue", "text", "proportional-5-3-350", "its flow is asked for"),
    question("flow-map", "File with the measured flow of the valve over spool and pressures (CSV)", "text", "bench.csv", "by C and b"),
    question("conductance", "Sonic conductance C of the valve, full open (ISO 6358)", "m3/(s Pa)", "1.4 dm3/(s bar)", "from the nominal flow"),
    question("critical-ratio", "Critical pressure ratio b of the valve (ISO 6358)", "", "0.3", "0.18 to 0.44, as 5/3 spool valves have it"),
    question("flow", "Flow of the valve with the pressures that it holds for", "m3/s", "350 l/min, 6 to 5 bar(g)", "that of the valve"),
    question("kv", "Flow coefficient Kv of the valve (water, m3/h at 1 bar)", "", "0.29", "from the nominal flow"),
    question("cv", "Flow coefficient Cv of the valve (water, US gal/min at 1 psi)", "", "0.34", "from the nominal flow"),
    question("bandwidth", "Critical frequency of the valve's spool, -3 dB", "Hz", "100 Hz", "unknown, within what is usual"),
    question("hysteresis", "Hysteresis of the valve, of the spool's range", "%", "0.4 %", "unknown, within what is usual"),
    question("overlap", "Overlap of the spool to each side, of its travel; negative is underlap", "%", "1 %", "unknown, within what is usual"),
    question("tube", "Tube of the catalogue between valve and cylinder", "text", "nylon-6x4", "its bore is asked for"),
    question("tube-bore", "Inner diameter of the tubes", "mm", "4 mm", "that of the tube"),
    question("tube-length", "Length of each tube between valve and cylinder", "m", "1 m", "the valve sits on the cylinder"),
    question("supply", "Supply pressure, gauge (bar(g)) or absolute (bar(a))", "Pa", "6 bar(g)", "6 bar(g)"),
    question("encoder", "Encoder: incremental, ssi or potentiometer", "text", "ssi", "incremental"),
    question("resolution", "Stroke per count of the encoder, all four edges counted; of a potentiometer the coarsest that will do", "mm", "5 um", "10 um; 12 bits of a potentiometer"),
    question("pressure-sensors", "Range of the pressure sensors, gauge (bar(g)) or absolute (bar(a)), or none", "text", "0 to 10 bar(g)", "a range above the supply"),
    question("tolerance-mm", "Distance from its setpoint within which a move has settled, mm", "", "0.1", "0.05"),
    question("period", "Sample period of the controller", "s", "1 ms", "1 ms"),
    question("law", "Control law: by a model of the drive, or by gains", "text", Law::GainProfile.word(), "cascade where the drive has what it needs, otherwise gain-profile"),
];

/// The question whose answer may have the pressures of the flow.
const FLOW: &str = "flow";

/// The question with a name.
#[must_use]
pub fn question_of(name: &str) -> Option<&'static Question> {
    QUESTIONS.iter().find(|question| question.name == name)
}

/// The problem of an answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AnswerProblem {
    /// The name of the question.
    pub question: &'static str,
    /// The problem and the remedy.
    pub message: String,
    /// The nearest answer without this problem, if one is known.
    pub instead: Option<String>,
}

impl AnswerProblem {
    /// The problem of the answer to a question.
    pub fn new(question: &'static str, message: impl Into<String>) -> AnswerProblem {
        AnswerProblem { question, message: message.into(), instead: None }
    }

    /// The same problem, with an answer that would do.
    #[must_use]
    pub fn or(self, instead: impl Into<String>) -> AnswerProblem {
        AnswerProblem { instead: Some(instead.into()), ..self }
    }
}

impl std::fmt::Display for AnswerProblem {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "--{}: {}", self.question, self.message)
    }
}

/// Answers by the names of their questions, as they were typed.
#[derive(Clone, Debug, Default)]
pub struct Answers(BTreeMap<&'static str, String>);

impl Answers {
    /// Answers a question; an empty text leaves it open.
    pub fn answer(&mut self, question: &'static Question, text: &str) {
        if text.trim().is_empty() {
            self.0.remove(question.name);
        } else {
            self.0.insert(question.name, text.trim().to_owned());
        }
    }

    /// The typed answers, each after the name of its question, in the order of the questions.
    pub fn given(&self) -> impl Iterator<Item = (&'static str, &str)> {
        QUESTIONS.iter().filter_map(|question| Some((question.name, self.text(question.name)?)))
    }

    /// An answer as it was typed.
    #[must_use]
    pub fn text(&self, name: &str) -> Option<&str> {
        self.0.get(name).map(String::as_str)
    }

    /// An answer as a number in the unit of its question; a plain number where that has none.
    ///
    /// # Errors
    /// When it is not one.
    ///
    /// # Panics
    /// When there is no such question: a slip in the program.
    pub fn reading(&self, name: &str) -> Result<Option<Reading>, AnswerProblem> {
        let question = question_of(name).unwrap_or_else(|| panic!("no question {name}"));
        let Some(text) = self.text(name) else { return Ok(None) };
        let refuse = |message| AnswerProblem::new(question.name, message);
        if question.name == FLOW {
            let flow = StatedFlow::read(text).map_err(refuse)?.flow;
            return Ok(Some(Reading::plain(flow)));
        }
        read_quantity(text, question.unit).map(Some).map_err(refuse)
    }

    /// The same where it cannot be a gauge pressure.
    ///
    /// # Errors
    /// As [`Answers::reading`].
    pub fn number(&self, name: &str) -> Result<Option<f64>, AnswerProblem> {
        Ok(self.reading(name)?.map(|reading| reading.value))
    }

    /// The same where there must be an answer.
    ///
    /// # Errors
    /// As [`Answers::reading`], and without an answer.
    pub fn required(&self, name: &'static str) -> Result<f64, AnswerProblem> {
        self.number(name)?.ok_or_else(|| {
            let example = question_of(name).map_or("", |question| question.example);
            AnswerProblem::new(name, format!("is needed, such as \"{example}\"")).or(example)
        })
    }
}

#[cfg(test)]
impl Answers {
    /// These answers, each by the name of its question.
    pub(crate) fn of(given: &[(&str, &str)]) -> Answers {
        let mut answers = Answers::default();
        for (name, text) in given {
            answers.answer(question_of(name).expect("a question"), text);
        }
        answers
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_example_answers_its_question() {
        for question in QUESTIONS.iter().filter(|question| question.unit != "text") {
            let answers = Answers::of(&[(question.name, question.example)]);
            assert!(
                answers.reading(question.name).is_ok_and(|reading| reading.is_some()),
                "{}",
                question.name
            );
        }
    }

    #[test]
    fn names_are_unique() {
        for (i, question) in QUESTIONS.iter().enumerate() {
            assert!(QUESTIONS[..i].iter().all(|other| other.name != question.name), "{}", question.name);
        }
    }

    #[test]
    fn an_answer_without_its_unit_is_refused_with_the_option() {
        let message = Answers::of(&[("bore", "32")]).number("bore").expect_err("no unit").to_string();
        assert!(message.starts_with("--bore: needs a unit"), "{message}");
        let message = Answers::of(&[]).required("stroke").expect_err("none").to_string();
        assert_eq!(message, "--stroke: is needed, such as \"250 mm\"");
    }

    #[test]
    fn an_empty_answer_leaves_the_question_open() {
        assert_eq!(Answers::of(&[("bore", " ")]).number("bore"), Ok(None));
    }
}
