//! A step from a quarter of the stroke to three quarters, for a first look.

use pneudrive_sim::keys;

use super::air::supply;
use super::{Cylinder, RESOLUTION_MM};
use crate::question::{Answers, Refusal};
use crate::rig_file::{Number, RigFile};

/// When the step comes, and how long the test lasts, s.
const STEP_S: f64 = 0.2;
const DURATION_S: f64 = 2.2;

pub(super) fn write(file: &mut RigFile, answers: &Answers, cylinder: &Cylinder) -> Result<(), Refusal> {
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
    let pressure =
        supply(answers)?.map(|supply| 0.6 * supply, "three fifths of the supply; chamber 1 balances it");
    file.number(&keys::test::PRESSURE_2_PA, &pressure);
    let largest =
        supply(answers)?.map(|supply| (supply * 1.2e-5).ceil() * 1e5, "above the supply, in whole bar");
    file.number(&keys::sensors::PRESSURE_MAX_PA, &largest);
    Ok(())
}
