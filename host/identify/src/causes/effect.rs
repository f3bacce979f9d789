//! An effect that a rig file may lack, and how the file comes to have it.

use pneudrive_sim::Rig;

use super::super::model::FittedModel;

/// An effect that may be the cause of a misfit.
#[derive(Clone, Copy, Debug)]
pub struct Effect {
    /// The effect in words.
    pub name: &'static str,
    /// How a rig file has it.
    pub change: Change,
    /// How to measure it without a fit.
    pub measure: &'static str,
}

/// How a rig file comes to have an effect.
#[derive(Clone, Copy, Debug)]
pub enum Change {
    /// A number.
    Number {
        /// Its key.
        path: &'static str,
        /// The choice without which it does nothing.
        with: Option<Choice>,
        /// Its usual size, in the unit of the key.
        size: f64,
        /// The smallest size that can be distinguished from none, in the unit of the key.
        least: f64,
    },
    /// An error of calibration among the unknowns, with this key: freed from its tolerance.
    Calibration(&'static str),
    /// A switch that is turned.
    Switch(&'static str),
    /// The other word of a choice.
    Word(Choice),
}

/// A choice by which a rig file has an effect.
#[derive(Clone, Copy, Debug)]
pub struct Choice {
    /// Its key.
    pub path: &'static str,
    /// The word that has the effect.
    pub word: &'static str,
    /// The word for no such effect; any other word is another model, which the effect does not replace.
    pub none: &'static str,
}

impl Choice {
    /// The setting that makes the choice.
    fn setting(&self) -> String {
        format!("{}={}", self.path, self.word)
    }

    /// Whether a rig has the word, or the one for no effect.
    fn is_open(&self, rig: &Rig) -> bool {
        rig.word_at(self.path).is_some_and(|word| [self.word, self.none].contains(&word))
    }
}

impl Effect {
    /// The rig of a model with a part of the usual size of the effect; None where it is no valid rig, has the effect
    /// fitted, or has no use for it.
    pub(super) fn rig(&self, model: &FittedModel, part: f64) -> Option<Rig> {
        let rig = &model.rig;
        let fitted = |path: &str| model.parameters.iter().any(|parameter| parameter.key.path == path);
        match self.change {
            Change::Number { path, .. } if fitted(path) => None,
            Change::Number { with: Some(choice), .. } if !choice.is_open(rig) => None,
            Change::Number { path, with, size, least } => {
                let settings: Vec<String> = with.iter().map(Choice::setting).collect();
                let rig = rig.with_settings(&settings).ok()?;
                let start = rig.number_at(path)?;
                let value = start + part * size;
                let possible = value >= start.min(least);
                possible.then(|| rig.with_numbers(&[(path, value.max(least))]).ok())?
            }
            Change::Calibration(path) => model.place_of_error(path).map(|_| rig.clone()),
            Change::Switch(path) => {
                let turned = !rig.switch_at(path)?;
                rig.with_settings(&[format!("{path}={turned}")]).ok()
            }
            Change::Word(choice) if rig.word_at(choice.path) == Some(choice.none) => {
                rig.with_settings(&[choice.setting()]).ok()
            }
            Change::Word(_) => None,
        }
    }

    /// The settings by which a rig file has the effect as it was found in `rig`.
    pub(super) fn setting(&self, rig: &Rig, value: Option<f64>) -> String {
        match self.change {
            Change::Number { path, with, .. } => {
                let number = format!("{path}={:.4}", Shortest(value.unwrap_or(0.0)));
                with.iter().map(Choice::setting).chain([number]).collect::<Vec<_>>().join(" ")
            }
            Change::Calibration(path) => format!("{path}={:.4}", Shortest(value.unwrap_or(0.0))),
            Change::Switch(path) => format!("{path}={}", rig.switch_at(path).unwrap_or_default()),
            Change::Word(choice) => choice.setting(),
        }
    }
}

/// A number with as many significant digits as its precision.
struct Shortest(f64);

impl std::fmt::Display for Shortest {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let digits = f.precision().unwrap_or(4).saturating_sub(1);
        let rounded: f64 = format!("{:.digits$e}", self.0).parse().unwrap_or(self.0);
        write!(f, "{rounded}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_a_setting_are_short() {
        assert_eq!(format!("{:.4} {:.4}", Shortest(1.234_56e-9), Shortest(-40.0)), "0.000000001235 -40");
    }
}
