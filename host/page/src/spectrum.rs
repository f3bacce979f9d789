//! The spectrum of a channel, of the page's run or of a record over it, as `spectrum` shows it.

use pneudrive_evaluate::channel::Channel;
use pneudrive_evaluate::spectrum::{Peak, Spectrum, Window};
use pneudrive_evaluate::transient::Transient;
use pneudrive_report::Table;
use serde::Deserialize;
use serde_json::json;

use crate::columns::{Column, Columns};
use crate::compare::{Record, simulated};
use crate::page_rig::PageRig;
use crate::refusal::HttpRefusal;
use crate::simulation::to_json;

/// Peaks in the table.
const PEAKS: usize = 8;

/// A channel of a transient, and the visible part of it.
#[derive(Debug, Deserialize)]
pub struct Transformed {
    #[serde(flatten)]
    asked: PageRig,
    /// The record; without it, the run.
    #[serde(default)]
    record: Option<Record>,
    channel: String,
    from_s: f64,
    to_s: f64,
}

/// Amplitude over frequency, Hz in place of the time, with a Hann window; and the highest peaks.
///
/// # Errors
/// When there is no such channel, when samples are missing, or as [`compare`](crate::compare).
pub fn answer(transformed: &Transformed) -> Result<Vec<u8>, HttpRefusal> {
    let channel = Channel::of_name(&transformed.channel).ok_or_else(|| {
        HttpRefusal::wrong(format!("there is no channel {} to transform", transformed.channel))
    })?;
    let transient = match &transformed.record {
        Some(record) => record.transient()?,
        None => simulated(&transformed.asked)?,
    };
    let part = whole(&transient.between(transformed.from_s, transformed.to_s))?;
    let samples = channel.samples(&part);
    if samples.len() < 2 || samples.iter().any(|value| !value.is_finite()) {
        return Err(HttpRefusal::wrong(format!(
            "{}: its {} is not known at every sample",
            part.name,
            channel.name()
        )));
    }
    let spectrum = Spectrum::of(&samples, part.period_s(), Window::Hann);
    let head = json!({
        "name": part.name,
        "resolution_hz": spectrum.frequency.get(1),
        "samples": samples.len(),
        "peaks": to_json(&peaks(&part.name, channel, &spectrum)),
    });
    Ok(columns(channel, &spectrum).to_bytes(head))
}

/// Refuses a part with a gap, or with too few samples for a spectrum.
fn whole(part: &Transient) -> Result<Transient, HttpRefusal> {
    if let Some([before, after]) = part.gaps.first() {
        return Err(HttpRefusal::wrong(format!(
            "{}: samples are missing between {before:.4} s and {after:.4} s; zoom to a part without a gap",
            part.name
        )));
    }
    if part.time.len() < 4 {
        return Err(HttpRefusal::wrong(format!(
            "{} has {} samples in view; zoom out",
            part.name,
            part.time.len()
        )));
    }
    Ok(part.clone())
}

fn peaks(name: &str, channel: Channel, spectrum: &Spectrum) -> Table {
    let row = |peak: &Peak| vec![format!("{:.2}", peak.frequency), format!("{:.5}", peak.amplitude)];
    Table::new(
        format!("peaks of {}, {name}", channel.name()),
        vec!["frequency, Hz".to_owned(), format!("amplitude, {}", channel.unit())],
        spectrum.peaks(PEAKS).iter().map(row),
    )
}

fn columns(channel: Channel, spectrum: &Spectrum) -> Columns {
    let values = spectrum.amplitude.iter().map(|amplitude| *amplitude as f32).collect();
    let amplitude = Column { name: channel.name(), unit: channel.unit(), values };
    Columns { time: spectrum.frequency.clone(), columns: vec![amplitude] }
}
