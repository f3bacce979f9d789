//! The answer behind a key of the rig file.

use pneudrive_sim::keys;
use pneudrive_sim::rig::Problem;

use crate::question::{AnswerProblem, Answers};

/// How keys begin, and the questions that decide them.
const BEHIND: &[(&str, &[&str])] = &[
    (keys::actuator::STROKE_M.key.path, &["stroke"]),
    (keys::actuator::ROD_DIAMETER_M.key.path, &["rod", "cylinder"]),
    ("actuator.", &["bore", "cylinder"]),
    (keys::load::MASS_KG.key.path, &["mass"]),
    (keys::load::INCLINE_DEG.key.path, &["incline"]),
    (keys::load::CONSTANT_FORCE_N.key.path, &["force"]),
    ("load.coulomb", &["friction", "bore", "cylinder"]),
    ("load.static", &["breakaway", "friction", "bore", "cylinder"]),
    ("load.", &["bore", "cylinder"]),
    (keys::valve::UNDERLAP_MM.key.path, &["overlap", "valve"]),
    (keys::iso6358::CRITICAL_RATIO.key.path, &["critical-ratio", "valve"]),
    (keys::flow_map::FLOW_MAP.key.path, &["flow-map"]),
    ("valve.", &["conductance", "flow", "kv", "cv", "flow-map", "valve"]),
    (keys::hysteresis::HYSTERESIS_PERCENT.key.path, &["hysteresis", "valve"]),
    ("operator.", &["bandwidth", "valve"]),
    (keys::tubing::LENGTH_M.key.path, &["tube-length"]),
    ("tubing.", &["tube-bore", "tube"]),
    ("supply.", &["supply"]),
    ("sensors.", &["pressure-sensors", "supply"]),
    ("encoder.", &["encoder", "resolution"]),
    (keys::controller::LAW.key.path, &["law"]),
    ("controller.", &["period"]),
    (keys::test::TOLERANCE_MM.key.path, &["tolerance-mm"]),
    ("test.pressure", &["supply"]),
];

/// The first of the questions behind a key that was answered, or the last of them; the stroke for a key without one.
fn question(answers: &Answers, key: &str) -> &'static str {
    let questions =
        BEHIND.iter().find(|(start, _)| key.starts_with(start)).map_or(&["stroke"][..], |(_, all)| all);
    let answered = questions.iter().find(|question| answers.text(question).is_some());
    answered.or(questions.last()).expect("no entry is empty")
}

/// The problem of a rig, reported at the answer that causes it.
pub(super) fn refusal(answers: &Answers, problem: &Problem) -> AnswerProblem {
    let question = question(answers, &problem.key);
    let answer = answers.text(question).map_or_else(|| "left out".to_owned(), |text| format!("\"{text}\""));
    AnswerProblem::new(question, format!("{answer} makes no rig, as {} {}", problem.key, problem.message))
}

#[cfg(test)]
mod tests {
    use pneudrive_sim::rig::all_keys;

    use super::*;
    use crate::question::question_of;

    #[test]
    fn every_entry_stands_for_keys_and_questions_that_there_are() {
        for (start, questions) in BEHIND {
            assert!(all_keys().any(|key| key.path.starts_with(start)), "{start}");
            assert!(
                !questions.is_empty() && questions.iter().all(|name| question_of(name).is_some()),
                "{start}"
            );
        }
    }
}
