//! Supply and surroundings.

use pneudrive_sim::keys;

use crate::question::{AnswerProblem, Answers};
use crate::rig_file::{Number, RigFile};

/// Absolute pressure of the surroundings at sea level, and between 600 m and a storm's high, Pa.
pub(super) const SURROUNDINGS: (f64, [f64; 2]) = (101_325.0, [94_000.0, 104_500.0]);

/// Air in a hall, K.
const AIR: (f64, [f64; 2]) = (293.15, [283.15, 303.15]);

/// Writes supply and exhaust.
pub(super) fn write(file: &mut RigFile, answers: &Answers) -> Result<(), AnswerProblem> {
    let surroundings = Number::typical(SURROUNDINGS.0, SURROUNDINGS.1, "sea level; a barometer tells");
    let temperature = Number::typical(AIR.0, AIR.1, "a hall; a thermometer tells");
    file.number(&keys::exhaust::PRESSURE_PA, &surroundings);
    file.number(&keys::exhaust::TEMPERATURE_K, &temperature);
    file.number(&keys::supply::TEMPERATURE_K, &temperature);
    file.number(&keys::supply::PRESSURE_PA, &supply(answers)?);
    Ok(())
}

/// The supply pressure, absolute.
pub(super) fn supply(answers: &Answers) -> Result<Number, AnswerProblem> {
    let absolute = |gauge: f64| gauge + SURROUNDINGS.0;
    let Some(reading) = answers.reading("supply")? else {
        return Ok(Number::typical(absolute(6e5), [absolute(5e5), absolute(7e5)], "6 bar(g); a gauge tells"));
    };
    let text = answers.text("supply").unwrap_or_default();
    let refuse = |message: String| AnswerProblem::new("supply", message);
    if !reading.says_from_where {
        return Err(refuse(format!(
            "\"{text}\" may be gauge or absolute: write \"{text}(g)\" or \"{text}(a)\""
        ))
        .or(format!("{text}(g)")));
    }
    let value = if reading.gauge { absolute(reading.value) } else { reading.value };
    if value < 1.5 * SURROUNDINGS.0 {
        let kind = if reading.gauge { "gauge" } else { "absolute" };
        return Err(refuse(format!("\"{text}\" leaves next to no pressure to move with: is it {kind}?")));
    }
    let from = if reading.gauge { format!("{text} over exhaust.pressure_pa") } else { text.to_owned() };
    Ok(Number::given(value, from))
}
