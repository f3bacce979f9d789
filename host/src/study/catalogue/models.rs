//! Models of other complexity (8.3), on servo-drive B with the gains of Appendix IX, at which it vibrates as
//! the thesis's figures do.

use super::super::outcome::said;
use super::super::{Finding, Statement, Study, Variant};
use super::{APPENDIX_GAINS, TUNED};
use crate::transient::{POSITION, PRESSURES};

pub(super) const CONTINUOUS: Study = Study {
    name: "continuous",
    section: "8.3.1",
    about: "A continuous controller in place of the sampled one",
    variants: &[
        APPENDIX_GAINS,
        Variant { name: "continuous", rig: "servo-b", settings: &["controller.model=\"continuous\""] },
    ],
    statements: &[
        Statement {
            thesis: "The continuous system shows more vibration.",
            judge: |runs| {
                let shows = format!("{}; {}", runs[0].rest(), runs[1].rest());
                let more = runs[1].amplitude_mm().zip(runs[0].amplitude_mm()).map(|(other, own)| other > own);
                Finding::decided(more, shows)
            },
        },
        Statement {
            thesis: "Its position deviates much: it does not represent the digital controller.",
            judge: |runs| {
                let share = runs[0].deviation(&runs[1], POSITION);
                Finding::new(
                    share > 0.05,
                    format!("the positions are {:.1} % of their range apart (rms)", 100.0 * share),
                )
            },
        },
        Statement {
            thesis: "It takes a fifth of the simulation time.",
            judge: |runs| {
                let share = runs[1].evaluations as f64 / runs[0].evaluations as f64;
                let shows =
                    format!("it takes {:.0} % of the sampled one's evaluations of the model", 100.0 * share);
                Finding::new(share <= 0.2, shows)
            },
        },
    ],
};

pub(super) const EMPIRICAL_OPERATOR: Study = Study {
    name: "empirical-operator",
    section: "8.3.2",
    about: "The empirical solenoid in place of the analytical one",
    variants: &[
        APPENDIX_GAINS,
        Variant {
            name: "empirical",
            rig: "servo-b",
            settings: &["operator.model=\"solenoid-empirical\"", "operator.damping_per_s=500"],
        },
    ],
    statements: &[
        Statement {
            thesis: "The frequency of vibration deviates in the position.",
            judge: |runs| {
                let [analytical, empirical] = [&runs[0], &runs[1]].map(|run| run.vibration().frequency_hz());
                let other = empirical.zip(analytical).map(|(one, other)| (one / other - 1.0).abs() > 0.05);
                let shows = format!("{} for {}", said(empirical, 1, "Hz"), said(analytical, 1, "Hz"));
                Finding::decided(other, shows)
            },
        },
        Statement {
            thesis: "The pressures agree remarkably.",
            judge: |runs| {
                let apart = PRESSURES.map(|channel| 100.0 * runs[0].deviation(&runs[1], channel));
                Finding::new(
                    apart.iter().all(|percent| *percent < 10.0),
                    format!("they are {:.0} % and {:.0} % of their range apart (rms)", apart[0], apart[1]),
                )
            },
        },
        Statement {
            thesis: "It takes less simulation time than the analytical one.",
            judge: |runs| {
                let share = runs[1].evaluations as f64 / runs[0].evaluations as f64;
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
        TUNED,
        Variant { name: "tuned, leaking", rig: "servo-b-tuned", settings: LEAKING },
        APPENDIX_GAINS,
        Variant { name: "Appendix IX, leaking", rig: "servo-b", settings: LEAKING },
    ],
    statements: &[
        Statement {
            thesis: "The drive is slightly less stable than without leakage.",
            judge: |runs| {
                let shows = format!("{}; {}", runs[2].rest(), runs[3].rest());
                let more =
                    runs[3].amplitude_mm().zip(runs[2].amplitude_mm()).map(|(leaking, own)| leaking > own);
                Finding::decided(more, shows)
            },
        },
        Statement {
            thesis: "The cylinder moves slower as it extends or retracts.",
            judge: |runs| {
                let rises = |run: usize| runs[run].asked().iter().map(|one| one.rise_s).collect::<Vec<_>>();
                let (tight, leaking) = (rises(0), rises(1));
                let text = |rises: &[Option<f64>]| {
                    rises.iter().map(|rise| said(*rise, 3, "s")).collect::<Vec<_>>().join(" and ")
                };
                let slower = tight.iter().zip(&leaking).map(|(tight, leaking)| Some((*leaking)? > (*tight)?));
                Finding::decided(
                    slower.reduce(|a, b| Some(a? && b?)).flatten(),
                    format!("it rises in {} for {}, extending and retracting", text(&leaking), text(&tight)),
                )
            },
        },
        Statement {
            thesis: "Deviations are larger.",
            judge: |runs| {
                let [tight, leaking] =
                    [&runs[0], &runs[1]].map(|run| super::super::Outcome::error_mm(run.asked()));
                let larger = leaking.zip(tight).map(|(leaking, tight)| leaking > tight);
                let [leaking, tight] = [leaking, tight].map(|error| said(error, 2, "mm"));
                Finding::decided(larger, format!("the mean error at rest is {leaking} for {tight}"))
            },
        },
    ],
};

/// Egli's passage (6.1.2.2) with the clearance of 1e-5 m.
const LEAKING: &[&str] = &["actuator.leakage=\"adiabatic\""];
