//! Models of other complexity (8.3), on servo-drive B.

use super::super::outcome::formatted;
use super::super::{Finding, Outcome, Statement, Study};
use super::drives::{LONG_STEPS, LONG_STEPS_TIME, drive};
use super::growth::{SAME_MM, grows};
use pneudrive_evaluate::transient::{POSITION, PRESSURES};

pub(super) const CONTINUOUS: Study = Study {
    name: "continuous",
    section: "8.3.1",
    about: "A continuous controller in place of the sampled one",
    variants: &[
        drive("sampled", &[LONG_STEPS, LONG_STEPS_TIME]),
        drive("continuous, in SI", &[LONG_STEPS, LONG_STEPS_TIME, MODEL, SI[0], SI[1]]),
        drive("continuous, in counts", &[LONG_STEPS, LONG_STEPS_TIME, MODEL]),
    ],
    statements: &[
        Statement {
            thesis: "The continuous system shows more vibration.",
            judge: |runs| {
                let more = grows(runs[0].swing_mm(), runs[1].swing_mm(), SAME_MM);
                Finding::decided(more, format!("{}; {}", runs[0].rest(), runs[1].rest()))
            },
        },
        Statement {
            thesis: "It does so because the position feedback is updated continuously.",
            judge: |runs| {
                let more = grows(runs[0].swing_mm(), runs[2].swing_mm(), SAME_MM);
                let units = "with velocity and acceleration in the units of the sampled law";
                Finding::decided(more, format!("{units} {}; {}", runs[2].rest(), runs[0].rest()))
            },
        },
        Statement {
            thesis: "Its position deviates much: it does not represent the digital controller.",
            judge: |runs| {
                let share = runs[0].deviation(&runs[1], POSITION);
                let shows = format!("the positions are {:.1} % of their range apart (rms)", 100.0 * share);
                Finding::new(share > 0.05, shows)
            },
        },
        Statement {
            thesis: "It takes a fifth of the simulation time.",
            judge: |runs| {
                let share = evaluations(runs);
                let shows =
                    format!("it takes {:.0} % of the sampled one's evaluations of the model", 100.0 * share);
                Finding::new(share <= 0.2, shows)
            },
        },
    ],
};

const MODEL: &str = "controller.model=\"continuous\"";

/// The current velocity and acceleration are fed back (6.3.3), in m/s and m/s^2. The model has the units of the
/// sampled law, 539.4 to the m/s and 2.104 to the m/s^2: 1500/539.4 and 4000/2.104.
const SI: [&str; 2] = ["controller.velocity_gain=3", "controller.acceleration_gain=1901"];

/// The figures of the second run, as a share of the first one's.
fn evaluations(runs: &[Outcome]) -> f64 {
    runs[1].evaluations as f64 / runs[0].evaluations as f64
}

pub(super) const EMPIRICAL_OPERATOR: Study = Study {
    name: "empirical-operator",
    section: "8.3.2",
    about: "The empirical solenoid in place of the analytical one",
    variants: &[
        drive("analytical", &[LONG_STEPS, LONG_STEPS_TIME]),
        drive(
            "empirical",
            &[
                LONG_STEPS,
                LONG_STEPS_TIME,
                "operator.model=\"solenoid-empirical\"",
                "operator.damping_per_s=500",
            ],
        ),
    ],
    statements: &[
        Statement {
            thesis: "The frequency of vibration deviates in the position, from the rig's.",
            judge: |runs| Finding::open(format!("{}; {}", runs[0].rest(), runs[1].rest())),
        },
        Statement {
            thesis: "The pressures agree remarkably, with the rig's.",
            judge: |runs| {
                let [p1, p2] = PRESSURES.map(|channel| 100.0 * runs[0].deviation(&runs[1], channel));
                Finding::open(format!(
                    "those of the two models are {p1:.0} % and {p2:.0} % of their range apart (rms)"
                ))
            },
        },
        Statement {
            thesis: "It takes less simulation time than the analytical one.",
            judge: |runs| {
                let share = evaluations(runs);
                let shows = format!("it takes {:.0} % of its evaluations of the model", 100.0 * share);
                Finding::new(share < 1.0, shows)
            },
        },
    ],
};

pub(super) const LEAKAGE: Study = Study {
    name: "leakage",
    section: "8.3.3",
    about: "Air that leaks past the piston",
    variants: &[
        drive("tight", &[LONG_STEPS, LONG_STEPS_TIME]),
        drive("leaking", &[LONG_STEPS, LONG_STEPS_TIME, LEAKING]),
    ],
    statements: &[
        Statement {
            thesis: "The drive is slightly less stable than without leakage.",
            judge: |runs| {
                let more = grows(runs[0].swing_mm(), runs[1].swing_mm(), SAME_MM);
                Finding::decided(more, format!("{}; {}", runs[0].rest(), runs[1].rest()))
            },
        },
        Statement {
            thesis: "The cylinder moves slower as it extends or retracts.",
            judge: |runs| {
                let [tight, leaking] = [&runs[0], &runs[1]].map(Outcome::rise_s);
                let shows = format!(
                    "the mean rise time is {} for {}",
                    formatted(leaking, 4, "s"),
                    formatted(tight, 4, "s")
                );
                Finding::decided(grows(tight, leaking, 0.0), shows)
            },
        },
        Statement {
            thesis: "Deviations are larger during extending and retracting.",
            judge: |runs| {
                let [tight, leaking] = [&runs[0], &runs[1]].map(Outcome::lag_mm);
                let [one, other] = [leaking, tight].map(|lag| formatted(lag, 3, "mm"));
                let shows =
                    format!("for half a second after a step it is {one} off in the mean, tight {other}");
                Finding::decided(grows(tight, leaking, 0.0), shows)
            },
        },
    ],
};

/// Egli's passage (6.1.2.2) with the clearance of 1e-5 m.
const LEAKING: &str = "actuator.leakage=\"adiabatic\"";
