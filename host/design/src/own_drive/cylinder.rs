//! The cylinder with the tubes to it.

use std::f64::consts::PI;

use pneudrive_sim::component::actuator::ActuatorKind;
use pneudrive_sim::component::tubing;
use pneudrive_sim::keys;

use crate::parts::{self, Family, Part};
use crate::question::{AnswerProblem, Answers};
use crate::rig_file::{Number, RigFile};

/// A cylinder, SI.
pub(crate) struct Cylinder {
    part: Option<Part>,
    pub bore: Number,
    pub rod: Number,
    pub stroke: f64,
    stroke_text: String,
    tube: Option<Tube>,
}

struct Tube {
    bore_mm: Number,
    length: f64,
}

impl Cylinder {
    /// The cylinder of the answers.
    pub fn of(answers: &Answers) -> Result<Cylinder, AnswerProblem> {
        let part = part_of(answers, "cylinder", Family::Cylinder)?;
        let bore = dimension(answers, "bore", part.as_ref(), "bore", "m")?;
        let rod = dimension(answers, "rod", part.as_ref(), "rod", "m")?;
        if rod.value >= bore.value {
            let message = format!(
                "the rod of {} mm is not thinner than the bore of {} mm: are they swapped?",
                1e3 * rod.value,
                1e3 * bore.value
            );
            return Err(AnswerProblem::new("rod", message).or(format!("{} mm", 400.0 * bore.value)));
        }
        let stroke = answers.required("stroke")?;
        let stroke_text = answers.text("stroke").unwrap_or_default().to_owned();
        Ok(Cylinder { tube: Tube::of(answers)?, part, bore, rod, stroke, stroke_text })
    }

    /// Areas of chambers 1 and 2, m^2.
    pub fn areas(&self) -> [f64; 2] {
        let circle = |diameter: f64| PI / 4.0 * diameter * diameter;
        [circle(self.bore.value), circle(self.bore.value) - circle(self.rod.value)]
    }

    /// The mass of piston and rod, kg, if the catalogue has it.
    pub fn moving_mass(&self) -> Option<[f64; 2]> {
        let part = self.part.as_ref()?;
        let base = part.figure("moving_mass_base")?.range_in("kg").ok()??;
        let per_metre = part.figure("moving_mass_per_metre")?.value_in("kg/m").ok()?;
        Some(base.map(|base| base + per_metre * self.stroke))
    }

    /// Writes actuator and tubing.
    pub fn write(&self, file: &mut RigFile) -> Result<(), AnswerProblem> {
        let rodless = self.rod.value == 0.0;
        let (model, why) = match rodless {
            true => (ActuatorKind::Symmetric, "rodless"),
            false => (ActuatorKind::Asymmetric, "a rod on one side"),
        };
        file.word(&keys::actuator::MODEL, model, why);
        file.number(&keys::actuator::BORE_M, &self.bore);
        file.number(&keys::actuator::ROD_DIAMETER_M, &self.rod);
        file.number(&keys::actuator::STROKE_M, &Number::given(self.stroke, &self.stroke_text));
        for (key, area) in [&keys::actuator::RESIDUAL_VOLUME_1_M3, &keys::actuator::RESIDUAL_VOLUME_2_M3]
            .into_iter()
            .zip(self.areas())
        {
            file.number(key, &self.residual_volume(area));
        }
        self.write_tubing(file);
        Ok(())
    }

    /// Dead volume of a chamber and its tube, m^3.
    fn residual_volume(&self, area: f64) -> Number {
        let tube = self.tube.as_ref().map_or(0.0, Tube::volume);
        let length = typical("residual_length", "m");
        let from = "piston area times 4.7 to 15 mm, and the tube; `identify --plan` finds it";
        Number::unknown(length.value, length.range.unwrap_or_default(), "").map(|m| area * m + tube, from)
    }

    fn write_tubing(&self, file: &mut RigFile) {
        let Some(tube) = &self.tube else {
            file.word(&keys::tubing::MODEL, tubing::TubingKind::None, "the valve sits on the cylinder");
            return;
        };
        file.word(
            &keys::tubing::MODEL,
            tubing::TubingKind::Analytical,
            "a pipe with friction, by its length and bore",
        );
        file.number(&keys::tubing::DIAMETER_MM, &tube.bore_mm);
        file.number(&keys::tubing::LENGTH_M, &Number::given(tube.length, ""));
        let friction = Number::typical(0.005, [0.003, 0.008], "turbulent flow in a smooth tube (Fanning)");
        file.number(&keys::tubing::FRICTION_FACTOR, &friction);
    }
}

impl Tube {
    /// The tube of the answers; None if the valve sits on the cylinder.
    fn of(answers: &Answers) -> Result<Option<Tube>, AnswerProblem> {
        let part = part_of(answers, "tube", Family::Tube)?;
        let length = answers.number("tube-length")?.unwrap_or(0.0);
        if length > 100.0 {
            let message = format!(
                "{length} m is no tube between a valve and a cylinder: 100 m is the longest that counts as one restriction"
            );
            return Err(AnswerProblem::new("tube-length", message));
        }
        if length == 0.0 {
            let given = ["tube", "tube-bore"].into_iter().find(|name| answers.text(name).is_some());
            return match given {
                Some(question) => {
                    Err(AnswerProblem::new(question, "how long is it? Give --tube-length, such as \"1 m\""))
                }
                None => Ok(None),
            };
        }
        let bore_mm = dimension(answers, "tube-bore", part.as_ref(), "inner_diameter", "mm")?;
        Ok(Some(Tube { bore_mm, length }))
    }

    /// Volume of the tube, m^3.
    fn volume(&self) -> f64 {
        let bore = 1e-3 * self.bore_mm.value;
        PI / 4.0 * bore * bore * self.length
    }
}

/// The part of the catalogue that an answer names.
pub(crate) fn part_of(
    answers: &Answers,
    question: &'static str,
    family: Family,
) -> Result<Option<Part>, AnswerProblem> {
    let refuse = |message| AnswerProblem::new(question, message);
    answers.text(question).map(|name| parts::find(family, name).map_err(refuse)).transpose()
}

/// A required figure: the answer to a question, or a figure of a part.
pub(crate) fn dimension(
    answers: &Answers,
    question: &'static str,
    part: Option<&Part>,
    figure: &str,
    unit: &str,
) -> Result<Number, AnswerProblem> {
    if let Some(value) = answers.number(question)? {
        return Ok(Number::given(value, answers.text(question).unwrap_or_default()));
    }
    let Some(part) = part else { return answers.required(question).map(|value| Number::given(value, "")) };
    let found = part.figure(figure).and_then(|figure| Some((figure.value_in(unit).ok()?, &figure.basis)));
    let missing = || AnswerProblem::new(question, format!("{} has no {figure}: give it", part.name));
    let (value, basis) = found.ok_or_else(missing)?;
    Ok(Number::given(value, format!("{}: {basis}", part.name)))
}

/// A typical value of the catalogue: in the middle of its range, by ratios where that begins above zero.
pub(crate) fn typical(name: &str, unit: &str) -> Number {
    let found = parts::typical(name).and_then(|figure| figure.range_in(unit).ok().flatten());
    let [low, high] = found.unwrap_or_else(|| panic!("the catalogue has no typical {name} in {unit}"));
    middle([low, high], "")
}

/// The middle of a range, by ratios where it begins above zero.
pub(crate) fn middle([low, high]: [f64; 2], from: &str) -> Number {
    let value = if low > 0.0 { (low * high).sqrt() } else { (low + high) / 2.0 };
    Number::unknown(value, [low, high], from)
}
