//! The moving mass and the forces on it.

use pneudrive_sim::keys;

use super::air::supply;
use super::cylinder::{Cylinder, middle, typical};
use super::holding::{mass, standing_force};
use crate::question::{AnswerProblem, Answers};
use crate::rig_file::{Number, RigFile};

/// Pressure difference for which friction is stated as a part of the piston's force, Pa.
const GIVEN_AT: f64 = 6e5;

/// Stiffness of a stop that nobody has described, N/m.
const STOP_STIFFNESS: f64 = 1e6;
/// How far the piston's whole force may press a stop in, m: less than half of the shortest dead volume.
const GIVES_WAY: f64 = 2e-3;

pub(super) fn write(file: &mut RigFile, answers: &Answers, cylinder: &Cylinder) -> Result<(), AnswerProblem> {
    file.number(&keys::load::MASS_KG, &mass(answers, cylinder)?);
    if let Some(angle) = answers.number("incline")? {
        file.number(
            &keys::load::INCLINE_DEG,
            &Number::given(angle, answers.text("incline").unwrap_or_default()),
        );
    }
    if let Some(force) = answers.number("force")? {
        file.number(
            &keys::load::CONSTANT_FORCE_N,
            &Number::given(force, answers.text("force").unwrap_or_default()),
        );
    }
    let [running, breakaway] = friction(answers, cylinder)?;
    file.number(&keys::friction::COULOMB_EXTEND_N, &running);
    file.number(&keys::friction::COULOMB_RETRACT_N, &running);
    file.number(&keys::friction::STATIC_EXTEND_N, &breakaway);
    file.number(&keys::friction::STATIC_RETRACT_N, &breakaway);
    let viscous = typical("viscous_friction", "N s/m");
    let from = "two published drives have 11.6 and 30 N s/m; `identify --plan` finds it";
    file.number(&keys::load::VISCOUS_N_S_PER_M, &Number { from: from.to_owned(), ..viscous });
    stops(file, answers, cylinder)
}

/// Stiffer stops where the usual ones would let a piston take up its dead volume.
fn stops(file: &mut RigFile, answers: &Answers, cylinder: &Cylinder) -> Result<(), AnswerProblem> {
    let pressed = cylinder.areas()[0] * supply(answers)?.highest() + standing_force(answers, cylinder)?.abs();
    let stiffness = pressed / GIVES_WAY;
    if stiffness > STOP_STIFFNESS {
        let from = "gives way by 2 mm under the piston's largest force and the load";
        file.number(&keys::stop::STOP_STIFFNESS_N_PER_M, &Number::computed(stiffness, from));
    }
    Ok(())
}

/// Running friction and that at which it breaks away, N.
fn friction(answers: &Answers, cylinder: &Cylinder) -> Result<[Number; 2], AnswerProblem> {
    let force = cylinder.areas()[0] * GIVEN_AT;
    let running = match answers.number("friction")? {
        Some(force) => Number::given(force, answers.text("friction").unwrap_or_default()),
        None => typical("running_friction_fraction", "%").map(
            |percent| 1e-2 * percent * force,
            "1 to 25 % of the piston's force at 6 bar; `identify --plan` finds it",
        ),
    };
    let breakaway = match answers.number("breakaway")? {
        Some(force) if force < running.value && answers.text("friction").is_some() => {
            let message = format!("{force} N is below the running friction of {} N", running.value);
            return Err(AnswerProblem::new("breakaway", message));
        }
        Some(force) => Number::given(force, answers.text("breakaway").unwrap_or_default()),
        None => {
            let ratio = typical("breakaway_over_running", "");
            let [low, high] = ratio.range.unwrap_or_default();
            let [least, most] = running.range.unwrap_or([running.value; 2]);
            let from = "1.25 to 3.3 times the running friction; `identify --plan` finds it";
            Number { value: ratio.value * running.value, ..middle([low * least, high * most], from) }
        }
    };
    // Friction that is only guessed stays below a break-away force that is known.
    let below = |end: f64| end.min(breakaway.value);
    let running =
        Number { value: below(running.value), range: running.range.map(|ends| ends.map(below)), ..running };
    Ok([running, breakaway])
}
