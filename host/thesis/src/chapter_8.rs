//! Chapter 8 of the thesis: the application studies, and the few numbers in its text.

use std::f64::consts::TAU;

use anyhow::{Result, ensure};
use pneudrive_sim::keys;

use super::drives::rig;
use super::study_exhibit::of_study;
use super::{Entry, Exhibit, Experiment, Measured, Reading};

const NONE: &[Entry] = &[];

/// Its exhibits, in its order.
pub(super) const EXHIBITS: [&[Exhibit]; 1] = [&[
    Exhibit {
        about: "A softer spring in the valve",
        lost: "both responses",
        why: "The thesis says that the softer spring makes the drive vibrate. With a Coulomb friction of the spool of 2 N ours vibrates with its own spring already, and the softer one lets the dither move the spool by 1/0.6 as much, which breaks stiction: it calms the drive. With 3.35 N, the static friction that was measured, the dither does not free the spool, and the softer spring does as the thesis says. This speaks for the larger friction, the harmonics of 7.1.2.3 for the smaller.",
        takes_s: 5.3,
        ..of_study("soft-spring", "8.1", "Fig. 8.1", NONE)
    },
    Exhibit {
        about: "An impulse in place of steps",
        lost: "both responses",
        why: "Size and length of the impulse are not printed. Most starts are calm after it or vibrate without it, too.",
        takes_s: 2.4,
        ..of_study("impulse", "8.2.1", "Fig. 8.2", NONE)
    },
    Exhibit {
        about: "Less gain of the amplifier",
        lost: "both responses",
        why: "By how much the gain was reduced is not printed. The mid-range current stays, so the null moves with the gain; less than half of it leaves no null within the range of the converter.",
        takes_s: 4.4,
        ..of_study("reduced-gain", "8.2.2", "Fig. 8.3", NONE)
    },
    Exhibit {
        about: "Learning the null of the valve",
        takes_s: 2.8,
        ..of_study("null-learning", "8.2.3", "", NONE)
    },
    Exhibit {
        about: "Steps of shorter duration",
        lost: "both responses",
        takes_s: 1.9,
        ..of_study("step-time", "8.2.4", "Fig. 8.4", NONE)
    },
    Exhibit {
        about: "A bug of the control software",
        lost: "both responses",
        why: "What the gain routine gave in place of a negative gain is not printed. To the letter it gave none; then negative errors are not answered, and the command jumps less than without the bug. With the error taken as positive it jumps by up to 1965 counts, depending on the start.",
        takes_s: 1.4,
        ..of_study("positive-gain", "8.2.5", "Fig. 8.5", NONE)
    },
    Exhibit {
        about: "A continuous controller",
        lost: "both responses",
        why: "The thesis's discrete system was slow, as its package restarted at each interrupt. Ours steps from sample to sample, and in the continuous loop each change of the profile's index and each kink of the amplifier is an event: it takes more, not less. Its transient differs from the sampled one's, by less than the 5 % that we call much.",
        takes_s: 11.1,
        ..of_study("continuous", "8.3.1", "Fig. 8.6", NONE)
    },
    Exhibit {
        about: "The empirical valve operator",
        lost: "both responses",
        why: "The empirical operator is the smaller model, but the drive swings by more with it, and a drive that moves costs more than one that rests.",
        takes_s: 2.9,
        ..of_study("empirical-operator", "8.3.2", "Fig. 8.7", NONE)
    },
    Exhibit {
        section: "8.3.2",
        place: "text",
        about: "The natural frequency of the empirical operator",
        lost: "",
        commands: &[
            "pneudrive characterise servo-b frequency-response --set 'operator.model=\"solenoid-empirical\"' --out DIR",
        ],
        entries: &[Entry::number(
            "frequency",
            "K_s = 36000 corresponds to",
            ["30", "Hz"],
            0.5,
            "half of its last digit",
        )],
        why: "",
        experiment: Experiment::Own(natural_frequency),
        takes_s: 0.01,
    },
    Exhibit {
        about: "Air that leaks past the piston",
        lost: "both responses",
        why: "Gap and coefficients of the leak are not printed; ours has the passage of App. VII with a clearance of 0.01 mm. With the 0.1 mm of C(57) the drive ends 4 to 6 mm off its setpoints.",
        takes_s: 2.5,
        ..of_study("leakage", "8.3.3", "Fig. 8.9", NONE)
    },
]];

/// K_s of the empirical operator as its frequency, undamped.
fn natural_frequency() -> Result<Measured> {
    let k_s = rig("servo-b-thesis", &["operator.model=\"solenoid-empirical\""])?
        .get(&keys::empirical::STIFFNESS_PER_MASS_PER_S2);
    ensure!(k_s > 0.0, "the operator has no stiffness");
    Ok(Measured {
        readings: vec![Reading::exact("frequency", k_s.sqrt() / TAU, 1, "C(50)")],
        ..Measured::default()
    })
}
