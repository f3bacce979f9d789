//! A step from a quarter of the stroke to three quarters, for a first look.

use pneudrive_sim::keys;

use super::air::supply;
use super::holding;
use super::{Cylinder, RESOLUTION_MM};
use crate::question::{AnswerProblem, Answers};
use crate::rig_file::{Number, RigFile};

/// When the step comes, and how long the test lasts, s.
const STEP_S: f64 = 0.2;
const DURATION_S: f64 = 2.2;

pub(super) fn write(file: &mut RigFile, answers: &Answers, cylinder: &Cylinder) -> Result<(), AnswerProblem> {
    let per_count = answers.number("resolution")?.unwrap_or(RESOLUTION_MM);
    let counts = |part: f64| (part * cylinder.stroke * 1e3 / per_count).round();
    let [from, to] = [0.25, 0.75].map(counts);
    file.text(
        &keys::test::MOVES,
        format!("[[0.0, {from}], [{STEP_S}, {to}]]"),
        "counts: a quarter of the stroke, then three quarters",
    );
    file.number(&keys::test::DURATION_S, &Number::computed(DURATION_S, "two seconds from the step on"));
    let position = (from + 0.5) * per_count * 1e-3;
    file.number(
        &keys::test::POSITION_M,
        &Number::computed(position, "a quarter of the stroke, half a count on"),
    );
    file.number(&keys::test::PRESSURE_2_PA, &pressure_2(answers, cylinder)?);
    let largest =
        supply(answers)?.map(|supply| (supply * 1.2e-5).ceil() * 1e5, "above the supply, in whole bar");
    file.number(&keys::sensors::PRESSURE_MAX_PA, &largest);
    Ok(())
}

/// The pressure of chamber 2 that stands in most drives, as a part of the supply's.
const MEAN_PRESSURE: f64 = 0.6;
/// The largest part of the supply pressure at which chamber 1 begins under a load that asks for more of it.
const HIGHEST: f64 = 0.9;

/// Three fifths of the supply; where chamber 1 cannot balance that with the load, as near to it as it can.
fn pressure_2(answers: &Answers, cylinder: &Cylinder) -> Result<Number, AnswerProblem> {
    let [outside, supply] = [holding::OUTSIDE, supply(answers)?.value];
    let balance = holding::Balance::of(answers, cylinder)?;
    let usual = MEAN_PRESSURE * supply;
    if (outside..=supply).contains(&balance.pressure_1(usual)) {
        let from = "three fifths of the supply; chamber 1 balances it";
        return Ok(self::supply(answers)?.map(|supply| MEAN_PRESSURE * supply, from));
    }
    let [low, high] = [outside, HIGHEST * supply].map(|pressure_1| balance.pressure_2(pressure_1));
    let from = "as near to three fifths of the supply as chamber 1 can balance it with the load";
    Ok(Number::computed(usual.clamp(low, high).clamp(outside, supply), from))
}
