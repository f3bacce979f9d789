//! Changes of a part (8.1) and of the conditions of operation (8.2), on servo-drive B.

use super::super::outcome::formatted;
use super::super::steadiness::SEEN_MM;
use super::super::{Finding, Outcome, Statement, Study, Variant};
use super::drives::{LONG_STEPS, LONG_STEPS_TIME, THESIS, drive};
use super::growth::{SAME_MM, grows};
use pneudrive_evaluate::transient::{POSITION, SPOOL};

pub(super) const SOFT_SPRING: Study = Study {
    name: "soft-spring",
    section: "8.1",
    about: "A valve spring of 60 % of the stiffness",
    variants: &[
        drive("own spring", &[LONG_STEPS, LONG_STEPS_TIME]),
        drive("soft spring", &[LONG_STEPS, LONG_STEPS_TIME, SOFT]),
        drive("own spring, 3.35 N", &[LONG_STEPS, LONG_STEPS_TIME, AS_STATIC]),
        drive("soft spring, 3.35 N", &[LONG_STEPS, LONG_STEPS_TIME, AS_STATIC, SOFT]),
    ],
    statements: &[
        Statement {
            thesis: "The drive that is steady with its own spring vibrates persistently with the soft one (Fig. 8.1 against 7.18).",
            judge: |runs| Finding::decided(caused(&runs[0], &runs[1]), both(&runs[0], &runs[1])),
        },
        Statement {
            thesis: "The soft spring makes the system less steady.",
            judge: |runs| {
                let more = grows(runs[0].swing_mm(), runs[1].swing_mm(), SAME_MM);
                Finding::decided(more, both(&runs[0], &runs[1]))
            },
        },
        Statement {
            thesis: "The same, if the Coulomb friction of the spool is as large as the static one that was measured.",
            judge: |runs| {
                let more = grows(runs[2].swing_mm(), runs[3].swing_mm(), SAME_MM);
                Finding::decided(more, both(&runs[2], &runs[3]))
            },
        },
    ],
};

/// The thesis measured the static friction of the spool, 3.35 N, and no other; C(85) is 2 N.
const AS_STATIC: &str = "operator.coulomb_friction_n=3.35";

/// 60 % of C(82).
const SOFT: &str = "operator.spring_n_per_mm=15";

/// Whether a change makes a drive vibrate; None if it also vibrates without the change, which shows nothing.
fn caused(without: &Outcome, with: &Outcome) -> Option<bool> {
    match (without.vibrates()?, with.vibrates()) {
        (true, _) => None,
        (false, vibrates) => vibrates,
    }
}

/// Rests, then has 4096 counts, 49 mm, for 50 ms; its size is not in the thesis.
const REST: &str = "test.moves=[[0.0, 8192]]";
const IMPULSE_OF: &str = "test.impulse=[0.5, 0.05, 4096]";
const REST_TIME: &str = "test.duration_s=5.0";

const SHOCKED: Variant = drive("impulse", &[REST, IMPULSE_OF, REST_TIME]);
const UNDISTURBED: Variant = drive("no impulse", &[REST, REST_TIME]);

pub(super) const IMPULSE: Study = Study {
    name: "impulse",
    section: "8.2.1",
    about: "A strong signal for a short time",
    variants: &[UNDISTURBED, SHOCKED],
    statements: &[
        Statement {
            thesis: "The impulse leaves the system unstable.",
            judge: |runs| Finding::decided(caused(&runs[0], &runs[1]), both(&runs[0], &runs[1])),
        },
        Statement {
            thesis: "The simulated drive becomes stable after five ripples, and reverts to vibration after 1.5 s.",
            judge: |runs| {
                let swings = runs[1].swings(runs[1].last().start_s, 0.4);
                let calm = |swing: &f64| *swing <= SEEN_MM;
                let calm_s = swings.iter().position(calm).map(|window| 0.4 * window as f64);
                let after = swings.iter().skip_while(|swing| !calm(swing));
                let reverts = after.filter(|swing| !calm(swing)).count() > 1;
                let first = formatted(calm_s, 1, "s");
                let shows = format!("it is calm {first} after the impulse; then {}", runs[1].rest());
                Finding::new(calm_s.is_some() && reverts, shows)
            },
        },
    ],
};

pub(super) const REDUCED_GAIN: Study = Study {
    name: "reduced-gain",
    section: "8.2.2",
    about: "The impulse with a lower gain of the valve's amplifier",
    variants: &[
        SHOCKED,
        drive("95 % of the gain", &[REST, IMPULSE_OF, REST_TIME, NINETY_FIVE[0], NINETY_FIVE[1]]),
        drive("90 % of the gain", &[REST, IMPULSE_OF, REST_TIME, NINETY[0], NINETY[1]]),
        drive("80 % of the gain", &[REST, IMPULSE_OF, REST_TIME, EIGHTY[0], EIGHTY[1]]),
    ],
    statements: &[
        Statement {
            thesis: "With the gain coefficient G_s reduced the system becomes stable at steady state.",
            judge: |runs| {
                let shows = runs.iter().map(Outcome::rest).collect::<Vec<_>>().join("; ");
                let vibrates = |run: usize| runs[run].vibrates();
                let stable = match vibrates(0) {
                    Some(true) => vibrates(3).map(|vibrates| !vibrates),
                    _ => None,
                };
                Finding::decided(stable, shows)
            },
        },
        Statement {
            thesis: "The spool then stands slightly off the null of the valve.",
            judge: |runs| {
                let [some, more] = [&runs[2], &runs[3]].map(|run| run.settled(SPOOL));
                let slightly = |off: f64| (0.01..0.1).contains(&off.abs());
                let shows = format!("its mean is {some:.3} mm off the null, at 80 % {more:.3} mm");
                Finding::new(slightly(some) && slightly(more), shows)
            },
        },
        Statement {
            thesis: "There is a steady-state deviation between experiment and simulation.",
            judge: |runs| {
                let errors = runs[1..].iter().map(|run| formatted(run.last().mean_error_mm, 2, "mm"));
                let errors = errors.collect::<Vec<_>>().join(", ");
                Finding::open(format!("the drives are {errors} off the setpoint"))
            },
        },
    ],
};

/// The thesis does not say by how much. The mid-range current stays as the gain falls, so the force at a null command
/// falls below the preload: X_b = 1 mm of (6.33) stays, and the null is (1 - g)/g mm of command away, at the gain g.
const NINETY_FIVE: [&str; 2] = ["operator.force_gain_n_per_mm=23.75", "controller.null_offset_counts=-108"];
const NINETY: [&str; 2] = ["operator.force_gain_n_per_mm=22.5", "controller.null_offset_counts=-228"];
const EIGHTY: [&str; 2] = ["operator.force_gain_n_per_mm=20", "controller.null_offset_counts=-512"];

pub(super) const NULL_LEARNING: Study = Study {
    name: "null-learning",
    section: "8.2.3",
    about: "A control strategy that learns the null of the valve",
    variants: &[
        Variant { name: "not learning", rig: "servo-b-thesis", settings: &[STEPS, STEPS_TIME, OFF_NULL] },
        Variant {
            name: "learning",
            rig: "servo-b-thesis",
            settings: &[
                STEPS,
                STEPS_TIME,
                OFF_NULL,
                "controller.learn_null_offset=true",
                "controller.tolerance_counts=200",
            ],
        },
    ],
    statements: &[Statement {
        thesis: "The learning strategy adjusts the null offset of the valve as it runs; no data were there to compare with.",
        judge: |runs| {
            let [without, with] = [&runs[0], &runs[1]].map(|run| {
                let asked = run.asked();
                [Outcome::mean_error_mm(&run.moves[..1]), Outcome::mean_error_mm(&asked[asked.len() - 2..])]
            });
            let halved = |all: [Option<f64>; 3]| {
                let [begin, end, other] = all;
                Some(end? < 0.5 * begin? && end? < 0.5 * other?)
            };
            let [begin, end, other] = [with[0], with[1], without[1]].map(|error| formatted(error, 2, "mm"));
            Finding::decided(
                halved([with[0], with[1], without[1]]),
                format!(
                    "with the null off by 0.1 mm the mean error in the last quarter of a move goes from {begin} to {end}; without learning it stays at {other}"
                ),
            )
        },
    }],
};

const STEPS: &str =
    "test.moves=[[0.0, 8192], [0.3, 16384], [1.3, 8192], [2.3, 16384], [3.3, 8192], [4.3, 16384]]";
const STEPS_TIME: &str = "test.duration_s=5.3";
const OFF_NULL: &str = "valve.null_offset_mm=0.1";

pub(super) const STEP_TIME: Study = Study {
    name: "step-time",
    section: "8.2.4",
    about: "The step test of the soft spring with half the time for each step",
    variants: &[drive("soft spring", &[SOFT]), drive("reduced step time", &[SOFT, SHORT_STEPS])],
    statements: &[
        Statement {
            thesis: "With reduced step time the system behaves as it does with the longer one (Fig. 8.4 against 8.1).",
            judge: |runs| {
                let [long, short] = [&runs[0], &runs[1]].map(Outcome::rise_s);
                let same = short.zip(long).map(|(short, long)| (short / long - 1.0).abs() < 0.05);
                let shows = format!(
                    "the mean rise time is {} for {}",
                    formatted(short, 3, "s"),
                    formatted(long, 3, "s")
                );
                Finding::decided(same, shows)
            },
        },
        Statement {
            thesis: "The deviations of the simulation from the rig are in the same pattern.",
            judge: |runs| {
                let [long, short] = [&runs[0], &runs[1]].map(|run| formatted(run.lag_mm(), 1, "mm"));
                Finding::open(format!(
                    "for half a second after a step it is {short} off in the mean, for {long}"
                ))
            },
        },
    ],
};

const SHORT_STEPS: &str = "test.moves=[[0.0, 8192], [0.3, 16384], [1.01, 8192], [1.72, 16384], [2.43, 8192]]";

pub(super) const POSITIVE_GAIN: Study = Study {
    name: "positive-gain",
    section: "8.2.5",
    about: "The software bug by which the gain routine \"could only give positive gains\"",
    variants: &[
        THESIS,
        drive("without negative gains", &["faults.gain_bug=no-negative-gain"]),
        drive("with the error as positive", &["faults.gain_bug=positive-error"]),
        drive("with the last gain for negative errors", &["faults.gain_bug=last-gain"]),
    ],
    statements: &[
        Statement {
            thesis: "With the bug a test does not run as it does without.",
            judge: |runs| {
                let share = |bug: &Outcome| runs[0].deviation(bug, POSITION);
                let shows = of_each_bug(runs, |bug| format!("{:.1} %", 100.0 * share(bug)));
                let shows = format!("the positions are apart by, of their range (rms): {shows}");
                Finding::new(share(&runs[1]) > 0.01, shows)
            },
        },
        Statement {
            thesis: "The spool command shows jerks with the bug, and none without.",
            judge: |runs| {
                let well = runs[0].jerk();
                let shows = of_each_bug(runs, |bug| format!("{:.0}", bug.jerk()));
                let shows = format!(
                    "while the setpoint holds, the command jumps by at most {well:.0} counts without the bug; {shows}"
                );
                Finding::new(runs[1].jerk() > 2.0 * well, shows)
            },
        },
    ],
};

/// A figure of each reading of the bug. The first reading gives the verdict, because it takes the thesis's sentence
/// to the letter.
fn of_each_bug(runs: &[Outcome], figure: impl Fn(&Outcome) -> String) -> String {
    let figures = runs[1..].iter().map(|bug| format!("{} {}", figure(bug), bug.name));
    figures.collect::<Vec<_>>().join(", ")
}

fn both(one: &Outcome, other: &Outcome) -> String {
    format!("{}; {}", one.rest(), other.rest())
}
