//! The operator of the valve on the bench (7.1.2.1, 7.1.2.2): its hysteresis, and the part that dither leaves.
//!
//! Three values are open in the text: the Coulomb friction of the spool, K_d of (6.33), and the equivalent of 4 V
//! from peak to peak at the spool. Each reading of the text is compared with the printed values; the reading of
//! `servo-b-thesis` counts.

use crate::characteristics::dither::FREQUENCIES_HZ;
use crate::characteristics::hysteresis::{Loop, mean, sweep};
use crate::characteristics::{CURVES, Reading as Figure, Unfit};
use anyhow::{Context, Result};
use pneudrive_sim::Rig;
use pneudrive_sim::component::dither::Dither;

use crate::drives::rig;
use crate::reading::{ends, rounded};
use crate::{Chart, Entry, Exhibit, Experiment, Found, Line, Measured, Reading};

/// A mm of command is half an ampere: the coil works from 0 to 1 A over 0 to 2 mm.
const A_PER_MM: f64 = 0.5;

const TWO_DIGITS: &str = "0.005 A for its two digits, 0.004 A for a level of our bench";
const ROUNDED: &str = "0.0375 is printed beside it";
const THE_SAME: &str = "0.009 A of the loop, times 25 N/A";

pub(super) const EXHIBITS: [Exhibit; 2] = [
    Exhibit {
        section: "7.1.2.1",
        place: "Fig. 7.6",
        about: "Hysteresis of the solenoid",
        lost: "the measured loop",
        commands: &[
            "pneudrive characterise servo-b-thesis hysteresis --out DIR",
            "pneudrive characterise servo-b-thesis hysteresis --set operator.coulomb_friction_n=2.5 --out DIR",
        ],
        entries: &[
            Entry::number("2 N", "total hysteresis", ["0.21", "A"], 0.009, TWO_DIGITS),
            Entry::number("App. VII", "with 5 %, 3 N and 2 N of App. VII", ["0.21", "A"], 0.009, TWO_DIGITS)
                .alternative(),
            Entry::number("2.5 N", "with a Coulomb friction of 2.5 N", ["0.21", "A"], 0.009, TWO_DIGITS)
                .alternative(),
            Entry::number("3.35 N", "with a Coulomb friction of 3.35 N", ["0.21", "A"], 0.009, TWO_DIGITS)
                .alternative(),
            Entry::number("magnetic", "half of the magnetic hysteresis", ["0.038", "A"], 0.0005, ROUNDED),
            Entry::number(
                "stiction",
                "stiction of the spool, 50 N/A (loop/2 - 0.0375 A)",
                ["3.35", "N"],
                0.23,
                THE_SAME,
            ),
        ],
        why: "The preliminary values of App. VII have a loop that is too narrow: they are not what was measured. Where Coulomb friction is lower than static friction the loop is a saw, whose outline is the same whatever the Coulomb friction is; so the loop does not tell the readings apart.",
        experiment: Experiment::Own(loops),
        takes_s: 0.6,
    },
    Exhibit {
        section: "7.1.2.2",
        place: "Fig. 7.8",
        about: "What dither leaves of the hysteresis",
        lost: "the measured branches at 20 to 60 Hz",
        commands: &[
            "pneudrive characterise servo-b-thesis dither --out DIR",
            "pneudrive characterise servo-b-thesis dither --set operator.coulomb_friction_n=3.35 --out DIR",
        ],
        entries: &[
            Entry::sentence("2 N", MINIMUM),
            Entry { what: "the same with a Coulomb friction of 2.5 N", ..Entry::sentence("2.5 N", MINIMUM) }
                .alternative(),
            Entry { what: "with 3.35 N", ..Entry::sentence("3.35 N", MINIMUM) }.alternative(),
            Entry { what: "with 3.35 N, and K_d = 24 N s/m", ..Entry::sentence("3.35 N, damped", MINIMUM) }
                .alternative(),
            Entry {
                what: "with 3.35 N, the dither a quarter of a period later",
                ..Entry::sentence("3.35 N, 90 degrees", MINIMUM)
            }
            .alternative(),
            Entry {
                what: "with 3.35 N, and 4 V read as 0.1 mm",
                ..Entry::sentence("3.35 N, 0.1 mm", MINIMUM)
            }
            .alternative(),
            Entry { what: "with 2 N, and 4 V read as 0.4 mm", ..Entry::sentence("2 N, 0.4 mm", MINIMUM) }
                .alternative(),
            Entry {
                what: "with 3.35 N, and 4 V read as 0.4 mm",
                ..Entry::sentence("3.35 N, 0.4 mm", MINIMUM)
            }
            .alternative(),
            Entry {
                what: "with 3.35 N, and a coil with a time constant of 2 ms",
                ..Entry::sentence("3.35 N, coil of 2 ms", MINIMUM)
            }
            .alternative(),
        ],
        why: "No reading has the minimum. Dither of 0.2 mm leaves nothing if the spool's Coulomb friction is 2 or 2.5 N; with 3.35 N it leaves 2 (w + F_s/G_s - a) at every frequency, a being its amplitude, and that does not depend on the frequency. More damping, another phase and another amplitude do not change this. A coil whose inductance weakens the dither at higher frequencies (2 ms) makes the hysteresis grow from 20 Hz on: it is the upper half of a minimum. What would make the lower half, at 20 and 30 Hz, stays open; the thesis read a gauge with a volume, which the bench has not.",
        experiment: Experiment::Own(dithers),
        takes_s: 4.0,
    },
];

const MINIMUM: &str = "The hysteresis is minimum around dither frequencies of 40 - 50 Hz.";

/// A reading of the text: the name of the entry, the rig, and its settings.
struct Candidate {
    key: &'static str,
    rig: &'static str,
    settings: &'static [&'static str],
}

const fn thesis(key: &'static str, settings: &'static [&'static str]) -> Candidate {
    Candidate { key, rig: "servo-b-thesis", settings }
}

const MORE: &str = "operator.coulomb_friction_n=3.35";

const LOOPS: [Candidate; 4] = [
    thesis("2 N", &[]),
    Candidate { key: "App. VII", rig: "servo-b", settings: &[] },
    thesis("2.5 N", &["operator.coulomb_friction_n=2.5"]),
    thesis("3.35 N", &[MORE]),
];

/// The loop is read this far to either side of mid-travel, m: beyond it the ends of the travel count.
const REACH_M: f64 = 0.6e-3;

/// Resolution of a loop, mm of command: a count.
const COUNT_MM: f64 = 1.0 / 2048.0;

fn swept(rig: &Rig) -> Result<Loop, Unfit> {
    sweep(rig, Dither { amplitude: 0.0, frequency_hz: 50.0, phase_cycles: 0.0 }, mean)
}

/// Distance of the outermost places of a loop along the command, A.
fn outermost_a(found: &Loop) -> f64 {
    let lags: Vec<f64> = found
        .up
        .iter()
        .chain(&found.down)
        .filter(|(command, _)| command.abs() <= REACH_M)
        .map(|(command, spool)| command - spool)
        .collect();
    let [least, most] = ends(&lags);
    1e3 * (most - least) * A_PER_MM
}

fn loops() -> Result<Measured> {
    let (mut readings, mut charts) = (Vec::new(), Vec::new());
    let rests_on =
        "outermost places within 0.6 mm of mid-travel, 128 levels to each side, read to a count of the DAC";
    for one in LOOPS {
        let found = swept(&rig(one.rig, one.settings)?)?;
        let width = outermost_a(&found);
        readings.push(Reading::read(one.key, width, COUNT_MM * A_PER_MM, 3, rests_on));
        charts.push(drawn(one.key, &found));
        if one.key == "2 N" {
            let stiction = 50.0 * (width / 2.0 - 0.0375);
            readings.push(Reading::read(
                "stiction",
                stiction,
                25.0 * COUNT_MM * A_PER_MM,
                2,
                "the formula of the thesis on our loop",
            ));
        }
    }
    let still = ["operator.static_friction_n=0", "operator.coulomb_friction_n=0"];
    let magnetic = swept(&rig("servo-b-thesis", &still)?)?.width(0.0).context("no loop")?;
    let half_a = 1e3 * magnetic * A_PER_MM / 2.0;
    readings.push(Reading::read(
        "magnetic",
        half_a,
        COUNT_MM * A_PER_MM / 2.0,
        4,
        "the loop of a spool without friction",
    ));
    Ok(Measured { readings, charts })
}

/// The loop with the straight line taken away, so that its width can be seen, and the printed width.
fn drawn(key: &str, found: &Loop) -> Chart {
    let branch = |name: &str, branch: &[(f64, f64)]| {
        let [command, lag]: [Vec<f64>; 2] = [
            branch.iter().map(|(command, _)| 1e3 * command * A_PER_MM).collect(),
            branch.iter().map(|(command, spool)| 1e3 * (command - spool) * A_PER_MM).collect(),
        ];
        Line::new(name, &command, &lag)
    };
    Chart {
        title: key.to_owned(),
        across: "current about mid-range, A",
        up: "current ahead of the spool, A",
        lines: vec![branch("up", &found.up), branch("down", &found.down)],
        printed_up: vec![[-0.1075, -0.1025], [0.1025, 0.1075]],
        ..Chart::default()
    }
}

const DITHERS: [Candidate; 8] = [
    thesis("2 N", &[]),
    thesis("2.5 N", &["operator.coulomb_friction_n=2.5"]),
    thesis("3.35 N", &[MORE]),
    thesis("3.35 N, damped", &[MORE, "operator.damping_n_s_per_m=24"]),
    thesis("3.35 N, 90 degrees", &[MORE, "operator.dither_phase_deg=90"]),
    thesis("3.35 N, 0.1 mm", &[MORE, "operator.dither_mm=0.1"]),
    thesis("2 N, 0.4 mm", &["operator.dither_mm=0.4"]),
    thesis("3.35 N, 0.4 mm", &[MORE, "operator.dither_mm=0.4"]),
];

/// The hysteresis left by the dither at each frequency, mm of command, and its uncertainty.
type Left = (Vec<f64>, f64);

fn left(rig: &Rig) -> Result<Left, Unfit> {
    let curve = CURVES.iter().find(|curve| curve.name == "dither").expect("a curve");
    let found = (curve.measure)(rig)?;
    let mut known_to = 0.0;
    let widths = FREQUENCIES_HZ.map(|frequency| {
        let name = format!("hysteresis at {frequency} Hz");
        let figure = found.figures.iter().find(|figure| figure.name == name);
        figure.map_or(f64::NAN, |figure| match figure.reading {
            Figure::Read { value, within } => {
                known_to = within;
                value
            }
            _ => f64::NAN,
        })
    });
    Ok((widths.to_vec(), known_to))
}

fn dithers() -> Result<Measured> {
    let (mut readings, mut charts) = (Vec::new(), Vec::new());
    for one in DITHERS {
        let found = left(&rig(one.rig, one.settings)?);
        note(one.key, found, &mut readings, &mut charts);
    }
    note("3.35 N, coil of 2 ms", weakened(2e-3)?, &mut readings, &mut charts);
    Ok(Measured { readings, charts })
}

/// With a coil of a time constant (s) the dither is weaker at each frequency than at 0 Hz.
fn weakened(coil_s: f64) -> Result<Result<Left, Unfit>> {
    let mut widths = Vec::new();
    let mut known_to = 0.0;
    for (place, frequency) in FREQUENCIES_HZ.into_iter().enumerate() {
        let part = 1.0 / 1.0_f64.hypot(std::f64::consts::TAU * frequency * coil_s);
        let dither = format!("operator.dither_mm={:?}", 0.2 * part);
        match left(&rig("servo-b-thesis", &[MORE, &dither])?) {
            Ok((all, within)) => {
                widths.push(all[place]);
                known_to = within;
            }
            Err(unfit) => return Ok(Err(unfit)),
        }
    }
    Ok(Ok((widths, known_to)))
}

/// A reading of the minimum and its graph; where the spool cannot be followed, nothing.
fn note(key: &str, found: Result<Left, Unfit>, readings: &mut Vec<Reading>, charts: &mut Vec<Chart>) {
    let Ok((widths, known_to)) = found else {
        readings.push(Reading::nothing(key, "the bench cannot follow the spool: events pile up"));
        return;
    };
    let labels: Vec<String> = widths.iter().map(|width| rounded(*width, 3)).collect();
    let text = format!("at 20, 30, 40, 50 and 60 Hz it leaves {} mm of command", labels.join(", "));
    let rests_on = format!(
        "each read to within {known_to:.4} mm; a minimum is one if 20 and 60 Hz both lie above 40 and 50 Hz by more"
    );
    let sizes: Vec<f64> = widths.iter().map(|width| width.abs()).collect();
    let lowest = sizes[2].min(sizes[3]);
    let holds = [sizes[0], sizes[4]].iter().all(|beside| *beside > lowest + 2.0 * known_to);
    readings.push(match widths.iter().all(|width| width.is_finite()) {
        true => Reading::shows(key, holds, text, rests_on),
        false => Reading {
            key: key.to_owned(),
            found: Found::Nothing("the loop cannot be read at every frequency"),
            rests_on,
        },
    });
    charts.push(Chart {
        title: key.to_owned(),
        across: "dither, Hz",
        up: "hysteresis, mm",
        lines: vec![Line::new("", &FREQUENCIES_HZ, &widths).dotted()],
        printed_across: vec![[40.0, 50.0]],
        ..Chart::default()
    });
}
