//! `pneudrive spectrum`.

use std::path::Path;

use anyhow::{Result, bail};
use pneudrive_analysis::evaluation::Motion;
use pneudrive_analysis::page::{Curve, Figure, Page, Panel, Table};
use pneudrive_analysis::spectrum::{Spectrum, Window, bipolar_12_bit};
use pneudrive_analysis::transient::{COMMAND, ERROR, POSITION, PRESSURES, SPOOL, Transient};
use pneudrive_records::own_file::{GENERATOR, refuse_to_replace};
use pneudrive_records::whole_file::put;

use super::eval::interval;
use crate::cli::{Channel, Spectrum as Arguments, Window as WindowName};

/// Peaks in a table.
const PEAKS: usize = 10;

/// A channel of a transient, ready to be transformed.
struct Samples {
    name: String,
    unit: &'static str,
    values: Vec<f64>,
    period: f64,
}

pub(super) fn execute(arguments: &Arguments) -> Result<()> {
    refuse_to_replace(&arguments.out, GENERATOR)?;
    if let Some(path) = arguments.ascii.as_ref().filter(|path| path.exists()) {
        bail!("{} already exists; choose another name", path.display());
    }
    let mut all = vec![samples(arguments, &arguments.file, arguments.channel)?];
    if let Some(second) = &arguments.with {
        all.push(samples(arguments, second, arguments.with_channel.unwrap_or(arguments.channel))?);
    }
    if let Some(path) = &arguments.ascii {
        write_ascii(path, &all[0])?;
    }
    let window = match arguments.window {
        WindowName::Hann => Window::Hann,
        WindowName::FlatTop => Window::FlatTop,
        WindowName::Rectangular => Window::Rectangular,
    };
    let spectra: Vec<Spectrum> =
        all.iter().map(|samples| Spectrum::of(&samples.values, samples.period, window)).collect();
    let tables: Vec<Table> =
        all.iter().zip(&spectra).map(|(samples, spectrum)| table(samples, spectrum)).collect();
    for table in &tables {
        say!("{}\n{}", table.heading, table.to_text());
    }
    page(&all, &spectra, tables, arguments.window).write(&arguments.out)?;
    say!("{}", arguments.out.display());
    Ok(())
}

fn samples(arguments: &Arguments, path: &Path, channel: Channel) -> Result<Samples> {
    let transient = interval(Transient::read(path)?, &arguments.interval)?;
    let (what, unit, values) = values(&transient, channel);
    if values.iter().any(|value| !value.is_finite()) {
        bail!("{}: its {what} is not known at every sample", path.display());
    }
    Ok(Samples { name: format!("{what}, {}", transient.name), unit, values, period: transient.period_s() })
}

/// Name, unit and samples of a channel.
fn values(transient: &Transient, channel: Channel) -> (&'static str, &'static str, Vec<f64>) {
    let stored = |channel: usize| transient.channels[channel].clone();
    match channel {
        Channel::Position => ("position", "mm", stored(POSITION)),
        Channel::Velocity => ("velocity", "mm/s", Motion::of(transient).velocity_mm_s),
        Channel::Acceleration => ("acceleration", "mm/s^2", Motion::of(transient).acceleration_mm_s2),
        Channel::Pressure1 => ("pressure 1", "kPa", stored(PRESSURES[0])),
        Channel::Pressure2 => ("pressure 2", "kPa", stored(PRESSURES[1])),
        Channel::Spool => ("spool", "mm", stored(SPOOL)),
        Channel::Command => ("command", "counts", stored(COMMAND)),
        Channel::Error => ("error", "counts", stored(ERROR)),
    }
}

fn table(samples: &Samples, spectrum: &Spectrum) -> Table {
    let row = |peak: &pneudrive_analysis::spectrum::Peak| {
        vec![format!("{:.2}", peak.frequency), format!("{:.5}", peak.amplitude)]
    };
    Table {
        heading: format!("peaks of {}", samples.name),
        columns: vec!["Hz".to_owned(), format!("amplitude, {}", samples.unit)],
        rows: spectrum.peaks(PEAKS).iter().map(row).collect(),
    }
}

fn page(all: &[Samples], spectra: &[Spectrum], tables: Vec<Table>, window: WindowName) -> Page {
    let names: Vec<&str> = all.iter().map(|samples| samples.name.as_str()).collect();
    let curves = all.iter().zip(spectra).map(|(samples, spectrum)| {
        let (frequency, amplitude) = (spectrum.frequency.clone(), spectrum.amplitude.clone());
        (samples.unit, Curve::new(&samples.name, frequency, amplitude))
    });
    let mut panels: Vec<Panel> = Vec::new();
    for (unit, curve) in curves {
        let title = format!("amplitude, {unit}");
        match panels.iter_mut().find(|panel| panel.title == title) {
            Some(panel) => panel.curves.push(curve),
            None => panels.push(Panel::new(&title, vec![curve])),
        }
    }
    let resolution = spectra[0].frequency.get(1).copied().unwrap_or(0.0);
    Page {
        title: format!("spectrum of {}", names.join(" and ")),
        notes: vec![format!(
            "Window: {window:?}; one frequency per {resolution:.3} Hz; the mean is removed. A sine shows its amplitude."
        )],
        tables,
        figures: vec![Figure { across: "frequency, Hz".to_owned(), panels, ..Figure::default() }],
    }
}

/// One number per line, LF. Prints the scale, which the file does not contain.
fn write_ascii(path: &Path, samples: &Samples) -> Result<()> {
    let (integers, mean, unit) = bipolar_12_bit(&samples.values);
    let text: String = integers.iter().map(|integer| format!("{integer}\n")).collect();
    put(path, &text)?;
    say!("{}: {} integers, 1 = {unit:.6} {} about {mean:.6}", path.display(), integers.len(), samples.unit);
    Ok(())
}
