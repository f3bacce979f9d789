//! `pneudrive spectrum`.

use std::path::Path;

use anyhow::{Result, bail};
use pneudrive_evaluate::channel::Channel;
use pneudrive_evaluate::spectrum::{Peak, Spectrum, Window, bipolar_12_bit};
use pneudrive_evaluate::transient::Transient;
use pneudrive_records::own_file::{GENERATOR, refuse_to_replace};
use pneudrive_records::whole_file::put;
use pneudrive_report::{Curve, Figure, Page, Panel, Table};
use serde_json::{Value, json};

use super::eval::interval;
use crate::cli::{self, Spectrum as Arguments, Window as WindowName};
use crate::json;

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
    json::figures(|| json!({ "spectra": all.iter().zip(&spectra).map(figures).collect::<Vec<_>>() }));
    page(&all, &spectra, tables, arguments.window).write(&arguments.out, arguments.pages.library())?;
    say!("{}", arguments.out.display());
    Ok(())
}

fn samples(arguments: &Arguments, path: &Path, channel: cli::Channel) -> Result<Samples> {
    let transient = interval(Transient::read(path)?, &arguments.interval)?;
    let channel = of(channel);
    let (what, unit, values) = (channel.name(), channel.unit(), channel.samples(&transient));
    if values.iter().any(|value| !value.is_finite()) {
        bail!("{}: its {what} is not known at every sample", path.display());
    }
    Ok(Samples { name: format!("{what}, {}", transient.name), unit, values, period: transient.period_s() })
}

fn of(channel: cli::Channel) -> Channel {
    match channel {
        cli::Channel::Position => Channel::Position,
        cli::Channel::Velocity => Channel::Velocity,
        cli::Channel::Acceleration => Channel::Acceleration,
        cli::Channel::Pressure1 => Channel::Pressure(0),
        cli::Channel::Pressure2 => Channel::Pressure(1),
        cli::Channel::Spool => Channel::Spool,
        cli::Channel::Command => Channel::Command,
        cli::Channel::Error => Channel::Error,
    }
}

fn table(samples: &Samples, spectrum: &Spectrum) -> Table {
    let row = |peak: &Peak| vec![format!("{:.2}", peak.frequency), format!("{:.5}", peak.amplitude)];
    Table::new(
        format!("peaks of {}", samples.name),
        vec!["Hz".to_owned(), format!("amplitude, {}", samples.unit)],
        spectrum.peaks(PEAKS).iter().map(row),
    )
}

fn figures((samples, spectrum): (&Samples, &Spectrum)) -> Value {
    let peak = |peak: &Peak| json!({ "frequency_hz": peak.frequency, "amplitude": peak.amplitude });
    json!({
        "name": samples.name,
        "unit": samples.unit,
        "resolution_hz": spectrum.frequency.get(1),
        "peaks": spectrum.peaks(PEAKS).iter().map(peak).collect::<Vec<_>>(),
    })
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
        ..Page::default()
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
