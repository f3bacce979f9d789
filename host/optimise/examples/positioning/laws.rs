//! The laws that are compared, and a drive under each of them.

use std::collections::BTreeMap;

use anyhow::{Context, Result};
use pneudrive_design::six_drives::rig_file_of;
use pneudrive_evaluate::cancel::CancelToken;
use pneudrive_optimise::positioning::draw::TOLERANCE;
use pneudrive_optimise::positioning::usual_step_mm;
use pneudrive_optimise::tuning::search::Budget;
use pneudrive_optimise::tuning::{Goal, Task, tune};
use pneudrive_sim::rigfile::builtin;
use pneudrive_sim::{Rig, keys};

/// A control law with gains.
pub struct Law {
    pub name: &'static str,
    word: &'static str,
    /// Whether `tune` looks for its gains; otherwise they are those of the rig file.
    tuned: bool,
    /// The integral time that is added to tuned gains, s.
    integral_s: Option<f64>,
}

/// A new law is a line here.
pub const LAWS: [Law; 5] = [
    Law { name: "gain profile", word: "gain-profile", tuned: false, integral_s: None },
    Law { name: "gain profile, tuned", word: "gain-profile", tuned: true, integral_s: None },
    Law { name: "P-D, tuned", word: "pid", tuned: true, integral_s: None },
    Law { name: "PI-D, tuned", word: "pid", tuned: true, integral_s: Some(0.5) },
    Law { name: "cascade", word: "cascade", tuned: false, integral_s: None },
];

/// The search that `rig new` proposes: within 1 mm, as no law that is tuned here ends within 0.05 mm often enough to be
/// guided by that.
const SETTLED_MM: f64 = 1.0;
const TIME_S: f64 = 1.5;
const BUDGET: Budget = Budget { population: 16, generations: 10, seed: 1 };

/// The text of a rig file.
fn text_of(name: &str) -> Result<String> {
    let of_list = rig_file_of(name).or_else(|| builtin(name).map(str::to_owned));
    of_list.map_or_else(|| std::fs::read_to_string(name).with_context(|| name.to_owned()), Ok)
}

/// A drive, and the gains that have been found for it, by the word of their law.
pub struct Drive<'a> {
    pub name: &'a str,
    text: String,
    settings: &'a [String],
    /// The usual step on it.
    pub step_mm: f64,
    found: BTreeMap<&'static str, Vec<String>>,
}

impl<'a> Drive<'a> {
    /// A drive of the catalogue, a built-in rig or a rig file, with these settings.
    pub fn read(name: &'a str, settings: &'a [String]) -> Result<Drive<'a>> {
        let text = text_of(name)?;
        let step_mm = usual_step_mm(&Rig::read_with(name, &text, settings)?);
        Ok(Drive { name, text, settings, step_mm, found: BTreeMap::new() })
    }

    /// The drive under a law.
    pub fn under(&mut self, law: &Law) -> Result<Rig> {
        let word = format!("{}={}", keys::controller::LAW.path, law.word);
        let mut settings: Vec<String> = self.settings.iter().cloned().chain([word]).collect();
        if law.tuned {
            let gains = self.gains(law.word, &settings)?;
            settings.extend(gains);
        }
        let rig = Rig::read_with(self.name, &self.text, &settings)?;
        Ok(match law.integral_s {
            Some(time_s) => rig.with_settings(&[integral(&rig, time_s)])?,
            None => rig,
        })
    }

    /// The gains that `tune` finds, once for each law.
    fn gains(&mut self, law: &'static str, settings: &[String]) -> Result<Vec<String>> {
        if let Some(found) = self.found.get(law) {
            return Ok(found.clone());
        }
        let task = Task {
            source: (self.name.to_owned(), self.text.clone()),
            settings: settings.to_vec(),
            fixed: Vec::new(),
            goal: Goal {
                step_mm: self.step_mm,
                settled_mm: SETTLED_MM,
                overshoot_percent: 1.0,
                time_s: TIME_S,
            },
            spread: TOLERANCE,
            between_mm: [None, None],
            draws: 0,
            budget: BUDGET,
        };
        let found = tune(&task, |_| {}, CancelToken::NEVER)?.after.settings;
        eprintln!("{}, {law}: {}", self.name, found.join(" "));
        self.found.insert(law, found.clone());
        Ok(found)
    }
}

/// Ki = 256 Kp T/T_I.
fn integral(rig: &Rig, time_s: f64) -> String {
    let proportional = rig.get(&keys::controller::PROPORTIONAL_GAIN) as f64;
    let gain =
        (256.0 * proportional * rig.get(&keys::controller::PERIOD_S) / time_s).round().clamp(1.0, 65_535.0);
    format!("{}={gain}", keys::controller::INTEGRAL_GAIN.path)
}
