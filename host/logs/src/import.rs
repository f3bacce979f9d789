//! A log of another recorder as a TARGET file of a rig: its encoder counts, converters and parameters.
//!
//! If the samples of all channels are taken together at equal distances, they stay as they are. Otherwise they are
//! resampled at the rig's period or the requested one: by linear interpolation; commands and setpoints hold until the
//! next.
//!
//! Where two samples are further apart than a limit, nothing is known in between: the record has a gap there, as a stream that
//! lost samples.

mod gaps;
mod record;
mod resampling;

use anyhow::{Context, Result, bail};
use pneudrive_records::target::TargetFile;
use pneudrive_sim::{Rig, keys};

use crate::column_map::{CHANNELS, Channel, Column, ColumnMap, Time};
use crate::log::{Log, Series};

/// A log that became a record.
#[derive(Clone, Debug)]
pub struct Imported {
    /// The record.
    pub file: TargetFile,
    /// The remarks for the user.
    pub remarks: Vec<String>,
}

/// A channel of the log in the unit of [`CHANNELS`].
#[derive(Clone, Debug, PartialEq)]
struct Sampled {
    time_s: Vec<f64>,
    values: Vec<f64>,
    /// Times before and after each gap, s.
    gaps: Vec<[f64; 2]>,
    /// Mean distance of two samples but over gaps, s.
    step_s: f64,
}

/// The channels on one clock: a value each at multiples of `period_s`.
struct Table {
    period_s: f64,
    /// The multiple of each value, from 0; gaps leave some out.
    indices: Vec<i32>,
    /// None for a quantity that the log does not have.
    channels: [Option<Vec<f64>>; CHANNELS.len()],
    remark: Option<String>,
}

/// The record of a log, with samples at `period_s` if given.
///
/// # Errors
/// When a column is missing or named twice, has no number in a row, or does not fit the rig.
pub fn import(log: &Log, map: &ColumnMap, rig: &Rig, period_s: Option<f64>) -> Result<Imported> {
    let mut channels: [Option<Sampled>; CHANNELS.len()] = Default::default();
    for ((sampled, column), channel) in channels.iter_mut().zip(&map.channels).zip(&CHANNELS) {
        let Some(column) = column else { continue };
        *sampled =
            Some(self::sampled(log, map, column, channel).with_context(|| format!("[{}]", channel.name))?);
    }
    let table = resampling::on_one_clock(&channels, period_s, rig.get(&keys::controller::PERIOD_S))?;
    let mut imported = record::of(log, rig, &table)?;
    imported.remarks.extend(remarks(log, map)?);
    Ok(imported)
}

/// The remarks on the file.
fn remarks(log: &Log, map: &ColumnMap) -> Result<Vec<String>> {
    let mut remarks = log.table.as_ref().map_or_else(Vec::new, |table| table.notes().to_vec());
    if let Time::Column(of, Some(_)) = &map.time
        && log.times(of)?.is_some()
    {
        remarks
            .push(format!("The column {} has times of a clock: the unit in [time] is not used.", of.column));
    }
    Ok(remarks)
}

/// The values of a column with their times.
fn sampled(log: &Log, map: &ColumnMap, column: &Column, channel: &Channel) -> Result<Sampled> {
    let series = log.get(&column.of)?;
    if let Some(row) = series.values.iter().position(|value| !value.is_finite()) {
        return Err(log.no_number(&column.of.column, row));
    }
    let time_s = times(log, &map.time, &series)?;
    if time_s.len() != series.values.len() {
        bail!(
            "{} has {} values and the time {}; take the time of the same topic",
            series.name,
            series.values.len(),
            time_s.len()
        );
    }
    check_order(log, map, column, &time_s)?;
    let values = series.values.iter().map(|value| column.scale * value + column.offset).collect();
    let step_s = gaps::step(&time_s, map.gap_s);
    let gaps = gaps::of(&time_s, gaps::limit(&time_s, map.gap_s, step_s, channel.holds));
    Ok(Sampled { time_s, values, gaps, step_s })
}

/// The times of a series, s.
fn times(log: &Log, time: &Time, series: &Series) -> Result<Vec<f64>> {
    match time {
        Time::Period(period) => Ok((0..series.values.len()).map(|k| k as f64 * period).collect()),
        Time::OfFile => series.clock_s.clone().with_context(|| {
            format!("{} has no time of its own; name its column in [time], or give the period", log.name)
        }),
        Time::Column(of, unit) => match (log.times(of)?, unit) {
            (Some(times), _) => Ok(times),
            (None, None) => bail!("[time] needs a unit, such as \"ms\": {} has plain numbers", of.column),
            (None, Some(seconds)) => {
                let values = log.get(of)?.values;
                match values.iter().position(|value| !value.is_finite()) {
                    Some(row) => Err(log.no_number(&of.column, row)),
                    None => Ok(values.iter().map(|value| value * seconds).collect()),
                }
            }
        },
    }
}

/// Refuses fewer than two rows, and times that do not follow each other.
fn check_order(log: &Log, map: &ColumnMap, column: &Column, time_s: &[f64]) -> Result<()> {
    if time_s.len() < 2 {
        bail!("{} has {} rows of numbers; a transient has two at least", log.name, time_s.len());
    }
    let Some(row) = time_s.windows(2).position(|pair| pair[1] <= pair[0]) else { return Ok(()) };
    let clock = match &map.time {
        Time::Column(of, _) => &of.column,
        _ => &column.of.column,
    };
    bail!(
        "{}: its time, {} s, is not after that of the row before, {} s; was the clock set back, or are the rows out of order or repeated? Cut the log there, or sort it by its time",
        log.at(clock, row + 1),
        time_s[row + 1],
        time_s[row]
    )
}

#[cfg(test)]
mod tests;
