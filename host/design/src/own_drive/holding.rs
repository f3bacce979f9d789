//! The forces against the air of a cylinder, and whether the supply can hold them.
//!
//! ```text
//! F = F_const - M g sin(incline)                       in the direction of extension
//! P_1 A_1 - P_2 A_2 - P_e (A_1 - A_2) + F = 0          the load stands
//! -(P_s - P_e) A_1 <= F <= (P_s - P_e) A_2             the supply can hold it
//! ```

use pneudrive_sim::component::load::GRAVITY;

use super::air::{SURROUNDINGS, supply};
use super::cylinder::Cylinder;
use crate::question::{AnswerProblem, Answers};
use crate::rig_file::Number;

/// P_e, Pa.
pub(super) const OUTSIDE: f64 = SURROUNDINGS.0;

/// The part of the supply's capacity that is proposed if the forces exceed it.
const PROPOSED: f64 = 0.7;

/// The load with piston and rod, kg.
pub(super) fn mass(answers: &Answers, cylinder: &Cylinder) -> Result<Number, AnswerProblem> {
    let load = answers.required("mass")?;
    let text = answers.text("mass").unwrap_or_default();
    Ok(match cylinder.moving_mass() {
        None => Number::given(load, format!("{text}; piston and rod count as part of it")),
        Some([low, high]) => {
            Number::computed(load + (low + high) / 2.0, format!("{text}, and piston and rod of 7850 kg/m3"))
                .within(Some([load + low, load + high]))
        }
    })
}

/// F, N.
pub(super) fn standing_force(answers: &Answers, cylinder: &Cylinder) -> Result<f64, AnswerProblem> {
    let force = answers.number("force")?.unwrap_or(0.0);
    Ok(force - mass(answers, cylinder)?.value * uphill(answers)?)
}

/// The part of gravity in the acceleration of an extending load, m/s^2.
fn uphill(answers: &Answers) -> Result<f64, AnswerProblem> {
    Ok(GRAVITY * answers.number("incline")?.unwrap_or(0.0).to_radians().sin())
}

/// The pressures under which a load stands.
pub(super) struct Balance {
    areas: [f64; 2],
    /// F - P_e (A_1 - A_2), N.
    others: f64,
}

impl Balance {
    /// The forces of the answers.
    pub fn of(answers: &Answers, cylinder: &Cylinder) -> Result<Balance, AnswerProblem> {
        let areas @ [area_1, area_2] = cylinder.areas();
        Ok(Balance { areas, others: standing_force(answers, cylinder)? - OUTSIDE * (area_1 - area_2) })
    }

    /// P_1 beside P_2, Pa.
    pub fn pressure_1(&self, pressure_2: f64) -> f64 {
        (pressure_2 * self.areas[1] - self.others) / self.areas[0]
    }

    /// P_2 beside P_1, Pa.
    pub fn pressure_2(&self, pressure_1: f64) -> f64 {
        (pressure_1 * self.areas[0] + self.others) / self.areas[1]
    }
}

/// Refuses a load that the supply cannot hold, by the answer that asks for most of it.
pub(super) fn check(answers: &Answers, cylinder: &Cylinder) -> Result<(), AnswerProblem> {
    let standing = standing_force(answers, cylinder)?;
    let area = cylinder.areas()[usize::from(standing > 0.0)];
    let held = area * (supply(answers)?.value - OUTSIDE);
    if standing.abs() <= held {
        return Ok(());
    }
    let (direction, force) = (standing.signum(), answers.number("force")?.unwrap_or(0.0));
    let (weight, uphill) = (standing - force, uphill(answers)?);
    let question = if direction * weight > direction * force { "mass" } else { "force" };
    let message = format!(
        "\"{}\" pulls with {:.0} N along the stroke in all, and the supply holds {held:.0} N on this piston: take less, a larger bore, or more supply pressure",
        answers.text(question).unwrap_or_default(),
        standing.abs()
    );
    let left = direction * PROPOSED * held;
    let piston = mass(answers, cylinder)?.value - answers.required("mass")?;
    let instead = match question {
        "mass" => format!("{:.3} kg", ((force - left) / uphill - piston).max(0.0)),
        _ => format!("{:.0} N", left - weight),
    };
    Err(AnswerProblem::new(question, message).or(instead))
}
