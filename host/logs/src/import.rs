//! A log of another recorder as a TARGET file of a rig: its encoder counts, converters and parameters.
//!
//! Where the samples of all channels are taken together at equal distances, they stay as they are. Otherwise they are
//! taken again at the rig's period or the one that is asked for: on the straight line between two samples; commands and
//! setpoints hold until the next.

mod record;
mod resampling;

use anyhow::{Context, Result, bail};
use pneudrive_records::target::TargetFile;
use pneudrive_sim::{Rig, keys};

use crate::column_map::{CHANNELS, Column, ColumnMap, Time};
use crate::log::Log;

/// A log that became a record.
#[derive(Clone, Debug)]
pub struct Imported {
    /// The record.
    pub file: TargetFile,
    /// What the user has to know of it.
    pub remarks: Vec<String>,
}

/// A channel of the log in the unit of [`CHANNELS`].
#[derive(Clone, Debug, PartialEq)]
struct Sampled {
    time_s: Vec<f64>,
    values: Vec<f64>,
}

/// The channels on one clock: a value each every `period_s`.
struct Table {
    period_s: f64,
    /// None of what the log does not have.
    channels: [Option<Vec<f64>>; CHANNELS.len()],
    remark: Option<String>,
}

/// The record of a log, with samples at `period_s` if given.
///
/// # Errors
/// When a column is missing, has no number in a row, or does not fit the rig.
pub fn import(log: &Log, map: &ColumnMap, rig: &Rig, period_s: Option<f64>) -> Result<Imported> {
    let mut channels: [Option<Sampled>; CHANNELS.len()] = Default::default();
    for ((sampled, column), channel) in channels.iter_mut().zip(&map.channels).zip(&CHANNELS) {
        let Some(column) = column else { continue };
        *sampled =
            Some(self::sampled(log, &map.time, column).with_context(|| format!("[{}]", channel.name))?);
    }
    let table = resampling::on_one_clock(&channels, period_s, rig.get(&keys::controller::PERIOD_S))?;
    record::of(log, rig, &table)
}

/// The values of a column with their times.
fn sampled(log: &Log, time: &Time, column: &Column) -> Result<Sampled> {
    let series = log.get(&column.series)?;
    let time_s = match time {
        Time::Period(period) => (0..series.values.len()).map(|k| k as f64 * period).collect(),
        Time::Column(name, seconds) => log.get(name)?.values.iter().map(|value| value * seconds).collect(),
        Time::OfFile => match &series.clock_s {
            Some(clock) => clock.clone(),
            None => {
                bail!("{} has no time of its own; name its column in [time], or give the period", log.name)
            }
        },
    };
    if time_s.len() != series.values.len() {
        bail!(
            "{:?} has {} values and the time {}; take the time of the same topic",
            series.name,
            series.values.len(),
            time_s.len()
        );
    }
    if let Some(row) = series.values.iter().position(|value| !value.is_finite()) {
        bail!("row {} of {:?} is not a number; fill it, or leave the rows out", row + 1, series.name);
    }
    if let Some(row) =
        time_s.windows(2).position(|pair| pair[1].partial_cmp(&pair[0]) != Some(std::cmp::Ordering::Greater))
    {
        bail!("the time does not grow from row {} to row {}", row + 1, row + 2);
    }
    let values = series.values.iter().map(|value| column.scale * value + column.offset).collect();
    Ok(Sampled { time_s, values })
}

#[cfg(test)]
mod tests;
