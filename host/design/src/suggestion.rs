//! Answers that make a rig, near to some that make none.

use crate::own_drive::rig_file;
use crate::question::{AnswerProblem, Answers, QUESTIONS, question_of};

/// The same answers with each refused one replaced by the proposal of its refusal, left out, or replaced by the
/// example of its question, whichever works first. None if nothing of this makes a rig.
#[must_use]
pub fn suggestion(name: &str, answers: &Answers) -> Option<Answers> {
    let mut answers = answers.clone();
    for _ in QUESTIONS {
        let Err(wrong) = rig_file(name, &answers) else { return Some(answers) };
        answers = without(name, &answers, wrong.first()?)?;
    }
    rig_file(name, &answers).is_ok().then_some(answers)
}

/// Answers to which one refusal no longer applies.
fn without(name: &str, answers: &Answers, refusal: &AnswerProblem) -> Option<Answers> {
    let question = question_of(refusal.question)?;
    let with_unit = answers.text(question.name).and_then(|text| with_unit_of(question.example, text));
    let proposals = [refusal.instead.as_deref(), with_unit.as_deref(), Some(""), Some(question.example)];
    proposals.into_iter().flatten().find_map(|text| {
        let mut other = answers.clone();
        other.answer(question, text);
        let wrong = rig_file(name, &other).err().unwrap_or_default();
        wrong.iter().all(|still| still.question != question.name).then_some(other)
    })
}

/// A number alone, with the unit that the example has behind its own: "12" and "8 kg" give "12 kg".
fn with_unit_of(example: &str, text: &str) -> Option<String> {
    let (_, unit) = example.split_once(' ')?;
    text.trim().parse::<f64>().is_ok().then(|| format!("{} {unit}", text.trim()))
}

/// Which answers a suggestion has in place of those given, in words: `mass: "8 kg" in place of "-12 kg"`.
#[must_use]
pub fn changed(given: &Answers, suggested: &Answers) -> Vec<String> {
    fn answer<'a>(answers: &'a Answers, name: &str) -> Option<&'a str> {
        answers.text(name).filter(|text| !text.is_empty())
    }
    let change = |name: &str| match (answer(given, name), answer(suggested, name)) {
        (before, after) if before == after => None,
        (Some(before), Some(after)) => Some(format!("{name} {after:?} in place of {before:?}")),
        (None, Some(after)) => Some(format!("{name} {after:?}")),
        (before, None) => before.map(|before| format!("no {name} in place of {before:?}")),
    };
    QUESTIONS.iter().filter_map(|question| change(question.name)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missing_and_what_is_wrong_become_answers_that_make_a_rig() {
        for given in [
            &[][..],
            &[("cylinder", "iso-15552-33"), ("mass", "8"), ("valve", "proportional-5-3-350")],
            &[("bore", "10 mm"), ("rod", "12 mm"), ("stroke", "250 mm"), ("flow", "350"), ("kv", "0.3")],
            &[("cylinder", "iso-15552-32"), ("incline", "90 deg"), ("mass", "400 kg"), ("supply", "6 bar")],
            &[("cylinder", "iso-6432-16"), ("force", "2 kN"), ("stroke", "30 m"), ("resolution", "1 m")],
        ] {
            let given = Answers::of(given);
            let suggestion = suggestion("own", &given).unwrap_or_else(|| panic!("{given:?}"));
            assert!(rig_file("own", &suggestion).is_ok(), "{suggestion:?}");
        }
    }

    /// A rig that is pasted without a look at what it has in place of the data sheet's would be another machine.
    #[test]
    fn a_number_keeps_its_value_and_what_is_changed_is_named() {
        let given = [
            ("cylinder", "iso-15552-32"),
            ("stroke", "250 mm"),
            ("mass", "12"),
            ("incline", "-90"),
            ("flow", "700 l/min at 6 bar"),
        ];
        let given = Answers::of(&given);
        let suggested = suggestion("own", &given).expect("a rig");
        assert_eq!([suggested.text("mass"), suggested.text("incline")], [Some("12 kg"), Some("-90 deg")]);
        let changed = changed(&given, &suggested);
        assert!(changed.iter().any(|one| one.contains("in place of \"700 l/min at 6 bar\"")), "{changed:?}");
        assert_eq!(changed.len(), 3, "{changed:?}");
    }

    #[test]
    fn answers_that_make_a_rig_stay_as_they_are() {
        let given = [
            ("cylinder", "iso-15552-32"),
            ("stroke", "250 mm"),
            ("mass", "8 kg"),
            ("valve", "proportional-5-3-350"),
        ];
        let suggestion = suggestion("own", &Answers::of(&given)).expect("a rig");
        assert!(given.iter().all(|(name, text)| suggestion.text(name) == Some(text)));
        assert_eq!(suggestion.given().count(), given.len());
    }
}
