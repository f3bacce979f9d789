//! Six drives of the catalogue on which control laws are compared: 20 to 63 mm of bore, 1 to 30 kg, level and vertical, all with
//! an encoder of 10 um and a sample period of 1 ms.

use pneudrive_sim::component::controller::Law;

use crate::own_drive::rig_file;
use crate::question::{Answers, question_of};

/// The answers of a drive, each by the name of its question.
type NamedAnswers = &'static [(&'static str, &'static str)];

/// Each drive by its name: bore and stroke in mm, `up` where the rod lifts the load.
pub static SIX_DRIVES: [(&str, NamedAnswers); 6] = [
    (
        "20x150",
        &[
            ("cylinder", "iso-6432-20"),
            ("stroke", "150 mm"),
            ("mass", "1 kg"),
            ("valve", "proportional-5-3-100"),
        ],
    ),
    (
        "32x250",
        &[
            ("cylinder", "iso-15552-32"),
            ("stroke", "250 mm"),
            ("mass", "8 kg"),
            ("valve", "proportional-5-3-350"),
        ],
    ),
    (
        "32x250-up",
        &[
            ("cylinder", "iso-15552-32"),
            ("stroke", "250 mm"),
            ("mass", "8 kg"),
            ("valve", "proportional-5-3-350"),
            ("incline", "90 deg"),
        ],
    ),
    (
        "50x400",
        &[
            ("cylinder", "iso-15552-50"),
            ("stroke", "400 mm"),
            ("mass", "20 kg"),
            ("valve", "proportional-5-3-700"),
        ],
    ),
    (
        "63x600",
        &[
            ("cylinder", "iso-15552-63"),
            ("stroke", "600 mm"),
            ("mass", "25 kg"),
            ("valve", "proportional-5-3-1400"),
        ],
    ),
    (
        "63x400-up",
        &[
            ("cylinder", "iso-15552-63"),
            ("stroke", "400 mm"),
            ("mass", "30 kg"),
            ("valve", "proportional-5-3-1400"),
            ("incline", "90 deg"),
        ],
    ),
];

/// The rig file of one of the drives with the gain profile, as `rig new` writes it; None for another name. The file has gains for
/// that law; another one is a setting.
///
/// # Panics
/// When the answers make no rig: a slip in the list.
#[must_use]
pub fn rig_file_of(name: &str) -> Option<String> {
    let (name, given) = SIX_DRIVES.iter().find(|(drive, _)| *drive == name)?;
    let mut answers = Answers::default();
    let common = [("resolution", "10 um"), ("period", "1 ms"), ("law", Law::GainProfile.word())];
    for (question, text) in given.iter().chain(&common) {
        let question = question_of(question).unwrap_or_else(|| panic!("no question {question}"));
        answers.answer(question, text);
    }
    Some(rig_file(name, &answers).unwrap_or_else(|wrong| panic!("{name}: {wrong:?}")))
}

#[cfg(test)]
mod tests {
    use pneudrive_sim::{Rig, keys};

    use super::*;

    #[test]
    fn all_six_are_rigs_of_the_sizes_that_are_promised() {
        let rigs = SIX_DRIVES.map(|(name, _)| {
            let text = rig_file_of(name).expect("one of the six");
            Rig::read(name, &text).unwrap_or_else(|problems| panic!("{problems}"))
        });
        for rig in &rigs {
            assert_eq!(rig.get(&keys::encoder::MM_PER_COUNT), 0.01);
            assert_eq!(rig.get(&keys::controller::PERIOD_S), 1e-3);
        }
        let of = |path: &str| rigs.each_ref().map(|rig| rig.number_at(path).expect("a number"));
        let ends = |values: [f64; 6]| {
            values
                .into_iter()
                .fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], x| [low.min(x), high.max(x)])
        };
        assert_eq!(ends(of("actuator.bore_m")), [0.02, 0.063]);
        // Piston and rod come on top of the mass that is asked for.
        let [lightest, heaviest] = ends(of("load.mass_kg"));
        assert!((1.0..1.5).contains(&lightest) && (30.0..33.0).contains(&heaviest), "{lightest} {heaviest}");
        assert_eq!(of("load.incline_deg").iter().filter(|degrees| **degrees == 90.0).count(), 2);
    }

    #[test]
    fn another_name_is_none_of_them() {
        assert_eq!(rig_file_of("servo-b"), None);
    }
}
