//! Published data that the thesis compares with (7.3). Their figures are lost from the scan, so only the statements of the
//! text can be compared with the model.

use std::collections::BTreeSet;

use super::super::outcome::formatted;
use super::super::{Finding, Statement, Study, Variant};
use super::growth::{SAME_MM, grows};
use pneudrive_evaluate::transient::{PRESSURES, SPOOL};

pub(super) const LUT_STEPPER: Study = Study {
    name: "lut-stepper",
    section: "7.3.1",
    about: "A heavy vertical drive with a stepper-operated valve",
    variants: &[Variant { name: "lut-stepper", rig: "lut-stepper", settings: &[] }],
    statements: &[
        Statement {
            thesis: "As the actuator is asymmetric, there is a pressure difference when it does not move.",
            judge: |runs| {
                let [p1, p2] = PRESSURES.map(|channel| runs[0].settled(channel));
                let shows = format!("where it stands after its moves P1 - P2 is {:.1} kPa", p1 - p2);
                Finding::new((p1 - p2).abs() > 1.0, shows)
            },
        },
        Statement {
            thesis: "The numerical values of the velocity match in magnitude (Fig. 7.20, 7.21).",
            judge: |runs| {
                let top = runs[0].asked().iter().map(|one| one.top_speed_mm_s).fold(0.0, f64::max);
                Finding::open(format!("it goes as fast as {top:.0} mm/s"))
            },
        },
    ],
};

/// The retraction of 7.3.2, for as long as it takes to see that the drive hunts: a cycle takes 2.4 s.
const RETRACTION: &[&str] =
    &["test.moves=[[0.0, 16384], [0.3, 8192]]", "test.position_m=0.197433225", RETRACTION_TIME];
const RETRACTION_TIME: &str = "test.duration_s=12.0";

/// Of its end, s: two cycles.
const HUNTS_FROM_S: f64 = 6.9;
const HUNTS_S: f64 = 5.0;

/// The gains of the file are for 1.6 kg. With these the retraction overshoots by 0.6 mm instead of 1.4 mm (the worst
/// of six starts).
const FOR_15_KG: &[&str] =
    &["controller.velocity_gain=3000", "controller.acceleration_gain=8000", RETRACTION_TIME];

pub(super) const LUT_SOLENOID: Study = Study {
    name: "lut-solenoid",
    section: "7.3.2",
    about: "The same drive with a solenoid-operated valve",
    variants: &[
        Variant { name: "solenoid", rig: "lut-solenoid", settings: FOR_15_KG },
        Variant { name: "stepper, same move", rig: "lut-stepper", settings: RETRACTION },
    ],
    statements: &[
        Statement {
            thesis: "It starts with less delay than with the stepper-operated valve.",
            judge: |runs| {
                let [solenoid, stepper] = [&runs[0], &runs[1]].map(|run| run.delay_s());
                let [one, other] =
                    [solenoid, stepper].map(|delay| formatted(delay.map(|s| 1e3 * s), 0, "ms"));
                Finding::decided(
                    solenoid.zip(stepper).map(|(solenoid, stepper)| solenoid < stepper),
                    format!("it has gone 1 % of the way after {one}, with the stepper after {other}"),
                )
            },
        },
        Statement {
            thesis: "It is more stable than with the stepper-operated valve.",
            judge: |runs| {
                let swing = |run: usize| runs[run].swings(HUNTS_FROM_S, HUNTS_S).first().copied();
                let [one, other] = [0, 1].map(|run| formatted(swing(run), 2, "mm"));
                Finding::decided(
                    grows(swing(0), swing(1), SAME_MM),
                    format!("it hunts by {one} in the last {HUNTS_S} s, with the stepper by {other}"),
                )
            },
        },
        Statement {
            thesis: "The simulated responses are sufficiently close to the reported ones (Fig. 7.22, 7.23).",
            judge: |runs| {
                let rise = formatted(runs[0].last().rise_s, 3, "s");
                Finding::open(format!("the retraction takes {rise} from 10 % to 90 %"))
            },
        },
    ],
};

pub(super) const BURROWS: Study = Study {
    name: "burrows",
    section: "7.3.3",
    about: "An on-off servomechanism with a flapper valve",
    variants: &[Variant { name: "burrows", rig: "burrows", settings: &[] }],
    statements: &[
        Statement {
            thesis: "The valve works in three states: closed, open to chamber 1, open to chamber 2.",
            judge: |runs| {
                let spool = &runs[0].transient.channels[SPOOL];
                let stands = spool.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| pair[0]);
                let places: BTreeSet<i64> = stands.map(|spool| (1e3 * spool).round() as i64).collect();
                let named: Vec<String> =
                    places.iter().map(|um| format!("{:.1} mm", *um as f64 / 1e3)).collect();
                Finding::new(places.len() == 3, format!("its spool stands at {}", named.join(", ")))
            },
        },
        Statement {
            thesis: "The position error agrees in the fashion of its variation (Fig. 7.24, 7.25).",
            judge: |runs| {
                let error = formatted(runs[0].last().steady_error_mm, 2, "mm");
                let overshoot = formatted(runs[0].overshoot_mm(), 1, "mm");
                Finding::open(format!(
                    "{}, {error} off its setpoint, after an overshoot of {overshoot}",
                    runs[0].rest()
                ))
            },
        },
    ],
};
