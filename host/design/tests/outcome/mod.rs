//! What becomes of drawn answers.

use pneudrive_design::own_drive::rig_file;
use pneudrive_design::suggestion::suggestion;
use pneudrive_sim::rig::{Key, Problems};
use pneudrive_sim::{Accuracy, Rig, keys, run};

use crate::drawn::answers;

/// What became of answers.
#[derive(Debug, PartialEq)]
pub enum Outcome {
    /// A rig whose test runs to its end.
    Runs,
    /// Refused, with answers beside them that make a rig.
    Refused,
    /// Anything else, in words.
    Fails(String),
}

/// Makes a rig of the answers of a seed and runs its test.
pub fn outcome(seed: u64) -> Outcome {
    let answers = answers(seed);
    let text = match rig_file("drawn", &answers) {
        Ok(text) => text,
        Err(wrong) => {
            return match suggestion("drawn", &answers) {
                Some(_) => Outcome::Refused,
                None => Outcome::Fails(format!("nothing instead of {wrong:?}")),
            };
        }
    };
    let rig = match Rig::read("drawn", &text).and_then(|rig| with_least_dead_volume(&rig).map(|_| rig)) {
        Ok(rig) => rig,
        Err(problems) => return Outcome::Fails(format!("{answers:?}: {problems}")),
    };
    match run(&rig, Accuracy::of(&rig)) {
        Ok(_) => Outcome::Runs,
        Err(error) => Outcome::Fails(format!("{answers:?}: {error}")),
    }
}

/// The rig with the shortest dead volumes and the highest supply pressure of its ranges, as draws may have them.
fn with_least_dead_volume(rig: &Rig) -> Result<Rig, Problems> {
    let ends: [(&'static Key, usize); 3] = [
        (&keys::actuator::RESIDUAL_VOLUME_1_M3, 0),
        (&keys::actuator::RESIDUAL_VOLUME_2_M3, 0),
        (&keys::supply::PRESSURE_PA, 1),
    ];
    let end = |(key, i): (&'static Key, usize)| rig.origin(key).range.map(|range| (key.path, range[i]));
    let numbers: Vec<(&str, f64)> = ends.into_iter().filter_map(end).collect();
    rig.with_numbers(&numbers)
}
