//! The spectrum of the spool (7.1.2.3) while the drive runs.

use anyhow::Result;
use pneudrive_sim::Run;

use crate::drives::{column, median, rows_within, run};
use crate::study::{Variant, at_start};
use crate::{Chart, Entry, Exhibit, Experiment, Line, Measured, Reading};
use pneudrive_evaluate::spectrum::{Spectrum, Window};

const AROUND: &str = "\"around\" 8 Hz, and the lines of a spectrum over 2.8 s lie 0.36 Hz apart";

pub(super) const EXHIBITS: [Exhibit; 1] = [Exhibit {
    section: "7.1.2.3",
    place: "Fig. 7.9",
    about: "Frequency spectra of the spool",
    lost: "both spectra",
    commands: &[
        "pneudrive simulate servo-b-thesis --ensemble 1 --no-report --out DIR",
        "pneudrive spectrum DIR spool --from 0.3",
    ],
    entries: &[
        Entry::number("2 N", "resonance", ["8", "Hz"], 1.0, AROUND),
        Entry::number("App. VII", "with 5 %, 3 N and 2 N of App. VII", ["8", "Hz"], 1.0, AROUND)
            .alternative(),
        Entry::number("2.5 N", "with a Coulomb friction of 2.5 N", ["8", "Hz"], 1.0, AROUND).alternative(),
        Entry::number("3.35 N", "with a Coulomb friction of 3.35 N", ["8", "Hz"], 1.0, AROUND).alternative(),
        Entry::number(
            "gains",
            "with velocity and acceleration gains of 1000 and 2000",
            ["8", "Hz"],
            1.0,
            AROUND,
        )
        .alternative(),
        Entry::sentence("harmonics", "There are several harmonics in the 50 Hz spectrum."),
    ],
    why: "The peak is of the drive, not of the spool, which resonates at 165 Hz on its spring. Where it lies depends on the starting place, on the Coulomb friction of the spool, and most on the two feedback gains, which the thesis does not print: their 1 and 1 of App. VII are for preliminary runs.",
    experiment: Experiment::Own(spectra),
    takes_s: 4.0,
}];

const STARTS: usize = 8;

/// Where a resonance "around 8 Hz" is looked for, Hz.
const BETWEEN_HZ: [f64; 2] = [4.0, 20.0];

/// The first move begins here, s.
const FROM_S: f64 = 0.3;

const fn drive(name: &'static str, rig: &'static str, settings: &'static [&'static str]) -> Variant {
    Variant { name, rig, settings }
}

const GAINS: [&str; 2] = ["controller.velocity_gain=1500", "controller.acceleration_gain=4000"];

const DRIVES: [Variant; 5] = [
    drive("2 N", "servo-b-thesis", &[]),
    drive("App. VII", "servo-b", &GAINS),
    drive("2.5 N", "servo-b-thesis", &["operator.coulomb_friction_n=2.5"]),
    drive("3.35 N", "servo-b-thesis", &["operator.coulomb_friction_n=3.35"]),
    drive("gains", "servo-b-thesis", &["controller.velocity_gain=1000", "controller.acceleration_gain=2000"]),
];

fn spectra() -> Result<Measured> {
    let mut measured = Measured::default();
    for variant in DRIVES {
        let starts = (0..STARTS).map(|start| Ok(of_spool(&run(&at_start(&variant, start)?)?)));
        let spectra: Vec<Spectrum> = starts.collect::<Result<_>>()?;
        let peaks: Vec<f64> = spectra.iter().filter_map(resonance_hz).collect();
        let rests_on = format!("largest peak from 4 to 20 Hz in {} of {STARTS} starts", peaks.len());
        measured.readings.push(Reading::over(variant.name, &peaks, 1, rests_on));
        if variant.name == "2 N" {
            measured.readings.push(harmonics(&spectra));
        }
        measured.charts.push(drawn(variant.name, &spectra[0]));
    }
    Ok(measured)
}

fn of_spool(run: &Run) -> Spectrum {
    let spool = column(run, |row| 1e3 * row.plant.spool);
    let part = rows_within(run, [FROM_S, f64::INFINITY]);
    Spectrum::of(&spool[part], run.rows[1].time - run.rows[0].time, Window::Hann)
}

fn resonance_hz(spectrum: &Spectrum) -> Option<f64> {
    let peaks = spectrum.peaks(usize::MAX);
    peaks.iter().map(|peak| peak.frequency).find(|hz| (BETWEEN_HZ[0]..=BETWEEN_HZ[1]).contains(hz))
}

/// The largest amplitude within 1 Hz, mm.
fn line_mm(spectrum: &Spectrum, hz: f64) -> f64 {
    let near = spectrum.frequency.iter().zip(&spectrum.amplitude).filter(|(f, _)| (**f - hz).abs() <= 1.0);
    near.map(|(_, amplitude)| *amplitude).fold(0.0, f64::max)
}

/// A harmonic is seen if it is more than a twentieth of the line at 50 Hz.
fn harmonics(spectra: &[Spectrum]) -> Reading {
    let lines = [50.0, 100.0, 150.0, 200.0, 250.0]
        .map(|hz| median(&spectra.iter().map(|spectrum| line_mm(spectrum, hz)).collect::<Vec<_>>()));
    let seen = lines[1..].iter().filter(|line| **line > 0.05 * lines[0]).count();
    let labels: Vec<String> = lines.iter().map(|line| format!("{line:.3}")).collect();
    let text = format!("the lines of 50, 100, 150, 200 and 250 Hz are {} mm", labels.join(", "));
    Reading::shows(
        "harmonics",
        seen >= 2,
        text,
        format!("medians of {STARTS} starts; two of more than a twentieth of the first are several"),
    )
}

fn drawn(name: &str, spectrum: &Spectrum) -> Chart {
    let shown = spectrum.frequency.partition_point(|hz| *hz <= 60.0);
    Chart {
        title: format!("{name}, the rig as it is"),
        across: "frequency, Hz",
        up: "spool, mm",
        lines: vec![Line::new("", &spectrum.frequency[..shown], &spectrum.amplitude[..shown])],
        printed_across: vec![[7.0, 9.0]],
        ..Chart::default()
    }
}
