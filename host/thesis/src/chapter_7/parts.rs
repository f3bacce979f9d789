//! Volumes, tubes and timer (7.1.3.3 to 7.1.5).

use std::f64::consts::FRAC_PI_4;

use crate::characteristics::pressure_drop::ratio;
use anyhow::Result;
use pneudrive_sim::Rig;
use pneudrive_sim::keys;

use crate::drives::rig;
use crate::{Chart, Entry, Exhibit, Experiment, Found, Line, Measured, Reading};

const ONE_DIGIT: &str = "half of its only digit";

pub(super) const EXHIBITS: [Exhibit; 3] = [
    Exhibit {
        section: "7.1.3.3",
        place: "Tab. 7.3",
        about: "Residual volumes",
        lost: "",
        commands: &["pneudrive rig show servo-b-thesis", "pneudrive rig show servo-c"],
        entries: &[
            Entry::number(
                "asymmetric",
                "a gap of 10 mm at 50 mm, asymmetric",
                ["0.00002", "m3"],
                5e-6,
                ONE_DIGIT,
            ),
            Entry::number(
                "symmetric",
                "a gap of 10 mm at 25 mm, symmetric",
                ["0.000005", "m3"],
                5e-7,
                ONE_DIGIT,
            ),
        ],
        why: "",
        experiment: Experiment::Own(volumes),
        takes_s: 0.01,
    },
    Exhibit {
        section: "7.1.4",
        place: "Fig. 7.12",
        about: "Pressure drop in the tubing",
        lost: "the measured drops",
        commands: &[
            "pneudrive characterise servo-b-thesis pressure-drop --out DIR",
            "pneudrive characterise servo-b-thesis pressure-drop --set tubing.model=analytical --out DIR",
        ],
        entries: &[
            Entry::number(
                "regression",
                "part of the pressure lost at 4.65 g/s",
                ["0.4", ""],
                0.05,
                ONE_DIGIT,
            ),
            Entry::number("pipe", "the same by the analytical tube (6.6.2)", ["0.4", ""], 0.05, ONE_DIGIT),
        ],
        why: "The analytical tube is computed from first principles, with 317 kPa in front as in Fig. 7.4; the length of 1 m and the friction factor are not printed.",
        experiment: Experiment::Own(tubes),
        takes_s: 0.05,
    },
    Exhibit {
        section: "7.1.5",
        place: "Fig. 7.13",
        about: "Calibration of the timer",
        lost: "the calibration chart",
        commands: &["cargo xtask figures"],
        entries: &[Entry::number(
            "timer",
            "shortest interval of the interrupt",
            ["0.28", "ms"],
            0.005,
            "half of its last digit",
        )],
        why: "It is the time of the 68000's interrupt routine. The twin keeps whole microseconds, and of our firmware instructions are counted, not time (docs/reference/firmware-figures.md).",
        experiment: Experiment::Own(timer),
        takes_s: 0.01,
    },
];

fn volumes() -> Result<Measured> {
    let volume = |key: &str, name: &str| -> Result<Reading> {
        let bore = rig(name, &[])?.get(&keys::actuator::BORE_M);
        Ok(Reading::exact(key, 0.01 * FRAC_PI_4 * bore * bore, 7, format!("bore of {name}")))
    };
    Ok(Measured {
        readings: vec![volume("asymmetric", "servo-b-thesis")?, volume("symmetric", "servo-c")?],
        ..Measured::default()
    })
}

/// C(30), kg/s, and the pressure in front of the tube, Pa.
const FLOW: f64 = 0.00465;
const IN_FRONT_PA: f64 = 317e3;

fn lost_part(rig: &Rig) -> f64 {
    1.0 - ratio(rig, IN_FRONT_PA, FLOW)
}

fn tubes() -> Result<Measured> {
    let regression = rig("servo-b-thesis", &[])?;
    let pipe = |friction: &str| rig("servo-b-thesis", &["tubing.model=analytical", friction]);
    let factors =
        ["tubing.friction_factor=0.005", "tubing.friction_factor=0.0045", "tubing.friction_factor=0.0055"];
    let pipes: Vec<Rig> = factors.iter().map(|factor| pipe(factor)).collect::<Result<_>>()?;
    let drops: Vec<f64> = pipes.iter().map(lost_part).collect();
    let given = Reading {
        key: "regression".to_owned(),
        found: Found::TakenOver { value: lost_part(&regression), decimals: 3 },
        rests_on: "C(28), C(30)".to_owned(),
    };
    let rests_on = "1 m of 4 mm, a Fanning friction factor of 0.005 (0.0045 to 0.0055)";
    let flows: Vec<f64> = (0..=60).map(|step| 0.1 * f64::from(step)).collect();
    let line = |name: &str, rig: &Rig| {
        let ratios: Vec<f64> = flows.iter().map(|flow| ratio(rig, IN_FRONT_PA, 1e-3 * flow)).collect();
        Line::new(name, &flows, &ratios)
    };
    let chart = Chart {
        title: "pressure behind the tube".to_owned(),
        across: "flow, g/s",
        up: "pressure ratio",
        lines: vec![line("regression, C(28)", &regression), line("analytical", &pipes[0])],
        printed_across: vec![[4.63, 4.67]],
        printed_up: vec![[0.55, 0.65]],
    };
    Ok(Measured { readings: vec![given, Reading::over("pipe", &drops, 3, rests_on)], charts: vec![chart] })
}

fn timer() -> Result<Measured> {
    let readings = vec![Reading::nothing("timer", "the interrupt of the 68000 is not modelled")];
    Ok(Measured { readings, ..Measured::default() })
}
