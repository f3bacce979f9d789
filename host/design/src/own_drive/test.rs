//! A step from a quarter of the stroke to three quarters, for a first look.

use pneudrive_sim::keys;

use super::air::supply;
use super::holding;
use super::{Cylinder, Encoder};
use crate::question::{AnswerProblem, Answers};
use crate::rig_file::{Number, RigFile};

/// When the step comes, and how long the test lasts, s.
const STEP_S: f64 = 0.2;
const DURATION_S: f64 = 2.2;

pub(super) fn write(
    file: &mut RigFile,
    answers: &Answers,
    cylinder: &Cylinder,
    encoder: &Encoder,
) -> Result<(), AnswerProblem> {
    // In whole micrometres.
    let ends_mm = [0.25, 0.75].map(|part| (part * cylinder.stroke * 1e6).round() / 1e3);
    let [from, to] = ends_mm.map(|mm| (mm / encoder.mm_per_count).round());
    file.text(
        &keys::test::MOVES_MM,
        format!("[[0.0, {}], [{STEP_S}, {}]]", ends_mm[0], ends_mm[1]),
        &format!("mm: a quarter of the stroke, then three quarters; {from} and {to} counts"),
    );
    file.number(&keys::test::DURATION_S, &Number::computed(DURATION_S, "two seconds from the step on"));
    let (middle_mm, words) = encoder.middle(from);
    let position = Number::computed(middle_mm * 1e-3, format!("a quarter of the stroke, {words}"));
    file.number(&keys::test::POSITION_M, &position);
    if let Some(mm) = answers.number("tolerance-mm")? {
        file.number(&keys::test::TOLERANCE_MM, &Number::given(mm, "settled within this distance"));
    }
    file.number(&keys::test::PRESSURE_2_PA, &pressure_2(answers, cylinder)?);
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
