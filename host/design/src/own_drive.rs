//! The rig file of a drive of one's own, from the answers to [`crate::question::QUESTIONS`].
//!
//! Each value is given, computed, typical or unknown, and says so. An unknown one has a range, a place in it to begin with,
//! and the test that finds it.

mod air;
mod behind;
mod cylinder;
mod gains;
mod holding;
mod load;
mod sensing;
mod test;
mod valve;

use pneudrive_sim::component::controller::Law;
use pneudrive_sim::key::Choice;
use pneudrive_sim::{Rig, keys};

use crate::breakaway::Breakaway;
use crate::question::{AnswerProblem, Answers};
use crate::rig_file::{Number, RigFile};

pub(crate) use cylinder::Cylinder;
use sensing::Encoder;

/// Stroke per count of an encoder that nobody has described, mm.
pub(crate) const RESOLUTION_MM: f64 = 0.01;

/// The question of the control law.
const LAW: &str = "law";

/// Sample period of a controller that nobody has chosen, s.
pub(crate) const PERIOD_S: f64 = 1e-3;

/// The rig file.
///
/// # Errors
/// Everything that is wrong with the answers, each at its question.
pub fn rig_file(name: &str, answers: &Answers) -> Result<String, Vec<AnswerProblem>> {
    match law_of(answers).map_err(|problem| vec![problem])? {
        Some(law) => with_law(name, answers, law, "given"),
        None => with_law(name, answers, Law::Cascade, "a model of the drive, by the figures of this file")
            .or_else(|wrong| with_law(name, answers, Law::GainProfile, &by_gains(&wrong))),
    }
}

/// Why a drive got gains, by what is wrong with it for the law that positions.
fn by_gains(wrong: &[AnswerProblem]) -> String {
    let why = needs(wrong).unwrap_or("the cascade has no model of this drive");
    format!("{why}; `pneudrive tune` finds the gains")
}

/// What a drive lacks for the law that positions.
fn needs(wrong: &[AnswerProblem]) -> Option<&str> {
    let refusal = wrong.iter().find(|problem| problem.question == LAW)?;
    // The message begins with the default answer, which the user has not given.
    let (_, words) = refusal.message.split_once(keys::controller::LAW.path)?;
    Some(words.trim())
}

/// The control law that was asked for.
fn law_of(answers: &Answers) -> Result<Option<Law>, AnswerProblem> {
    let Some(word) = answers.text(LAW) else { return Ok(None) };
    let known = Law::of_word(word).filter(|law| [Law::Cascade, Law::GainProfile].contains(law));
    let refusal = || {
        let message = format!(
            "must be \"cascade\" or \"gain-profile\", is \"{word}\"; the others have no gains to begin with"
        );
        AnswerProblem::new(LAW, message).or(Law::GainProfile.word())
    };
    known.map(Some).ok_or_else(refusal)
}

fn with_law(name: &str, answers: &Answers, law: Law, why: &str) -> Result<String, Vec<AnswerProblem>> {
    let mut file = RigFile::new(&about(name, answers), name);
    let mut wrong = Vec::new();
    let mut keep = |part: Result<(), AnswerProblem>| wrong.extend(part.err());
    keep(air::write(&mut file, answers));
    match Cylinder::of(answers) {
        Ok(cylinder) => {
            keep(cylinder.write(&mut file));
            keep(load::write(&mut file, answers, &cylinder));
            keep(holding::check(answers, &cylinder));
            match Encoder::of(answers, &cylinder) {
                Ok(encoder) => {
                    encoder.write(&mut file, answers);
                    keep(test::write(&mut file, answers, &cylinder, &encoder));
                }
                Err(refusal) => keep(Err(refusal)),
            }
            if law == Law::GainProfile {
                keep(gains::write(&mut file, answers, &cylinder));
            }
        }
        Err(refusal) => keep(Err(refusal)),
    }
    keep(valve::write(&mut file, answers));
    keep(sensing::write_pressures(&mut file, answers));
    keep(sampling(&mut file, answers));
    file.word(&keys::controller::LAW, law, why);
    if wrong.is_empty() {
        match Rig::read(name, &file.to_toml()) {
            Ok(rig) => no_motion(&mut file, &rig),
            Err(problems) => {
                wrong = problems.0.iter().map(|problem| behind::refusal(answers, problem)).collect();
            }
        }
    }
    let text = file.to_toml();
    // Two parts of the file may need the same answer.
    let mut named = Vec::new();
    wrong.retain(|refusal: &AnswerProblem| {
        let first = !named.contains(&refusal.question);
        named.push(refusal.question);
        first
    });
    if wrong.is_empty() { Ok(text) } else { Err(wrong) }
}

/// Remarks for the user: on answers that were read in one of several ways, and on what a drive lacks for the law that positions.
#[must_use]
pub fn remarks(answers: &Answers) -> Vec<String> {
    valve::remark(answers).into_iter().chain(law_remark(answers)).collect()
}

/// What the drive lacks for the law that positions, where nobody has chosen one.
fn law_remark(answers: &Answers) -> Option<String> {
    if law_of(answers).ok()?.is_some() {
        return None;
    }
    let wrong = with_law("own", answers, Law::Cascade, "").err()?;
    let needs = needs(&wrong)?;
    Some(format!(
        "{needs}; so the drive gets the law \"gain-profile\", whose gains are to be tuned and which ends some tenths of a millimetre off its target"
    ))
}

fn about(name: &str, answers: &Answers) -> Vec<String> {
    let given: Vec<String> = answers.given().map(|(question, text)| format!("{question} {text}")).collect();
    [
        format!("{name}, by `pneudrive rig new`: {}.", given.join(", ")),
        "given: by a data sheet or by you. computed, typical: `from` says how. unknown: somewhere from low to high.".to_owned(),
        "`pneudrive rig show FILE --resolved` shows every value, `pneudrive rig explain KEY` what a key means,".to_owned(),
        "`pneudrive identify FILE --plan PORT` runs the tests that find what is unknown, and fits it.".to_owned(),
    ]
    .to_vec()
}

fn sampling(file: &mut RigFile, answers: &Answers) -> Result<(), AnswerProblem> {
    let period = match answers.number("period")? {
        Some(s) => Number::given(s, answers.text("period").unwrap_or_default()),
        None => Number::typical(PERIOD_S, [5e-4, 2e-3], "yours to choose"),
    };
    file.number(&keys::controller::PERIOD_S, &period);
    file.number(
        &keys::controller::DELAY_S,
        &period.map(|s| (0.4 * s * 1e6).round() / 1e6, "two fifths of the period"),
    );
    Ok(())
}

/// The time of a standing load before it trips, where its default is too short for the pressure that breaks the load away.
fn no_motion(file: &mut RigFile, rig: &Rig) {
    let default = rig.get(&keys::safety::NO_MOTION_S);
    let Some(time) = Breakaway::of(rig).map(|breakaway| breakaway.no_motion_s()) else { return };
    if time > default {
        let from = "twice the time of the air until the load breaks away, and 0.25 s; at most 10 s";
        file.number(&keys::safety::NO_MOTION_S, &Number::computed((1e3 * time).ceil() / 1e3, from));
    }
}

#[cfg(test)]
mod tests;
