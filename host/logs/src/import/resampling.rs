//! Channels with clocks of their own on one clock.

use anyhow::{Result, bail};

use super::{Sampled, Table};
use crate::column_map::CHANNELS;

/// A clock is even if each of its steps is within this part of the mean one.
const EVEN: f64 = 0.01;

/// The most samples of a record.
const MOST: f64 = 50e6;

/// The channels as they are, if they share an even clock and no other is asked for; else taken again every `asked_s`, or
/// every `usual_s`.
///
/// # Errors
/// When they have no time in common.
pub fn on_one_clock(
    channels: &[Option<Sampled>; CHANNELS.len()],
    asked_s: Option<f64>,
    usual_s: f64,
) -> Result<Table> {
    let there: Vec<&Sampled> = channels.iter().flatten().collect();
    let period_s = mean_step(&there[0].time_s)?;
    let is_shared = there.iter().all(|one| one.time_s == there[0].time_s);
    let is_kept = asked_s.is_none_or(|asked| (asked / period_s - 1.0).abs() < EVEN);
    if is_shared && is_kept && is_even(&there[0].time_s, period_s) {
        let channels = channels.each_ref().map(|one| one.as_ref().map(|one| one.values.clone()));
        return Ok(Table { period_s, channels, remark: None });
    }
    again(channels, asked_s.unwrap_or(usual_s), period_s)
}

fn again(channels: &[Option<Sampled>; CHANNELS.len()], period_s: f64, logged_s: f64) -> Result<Table> {
    let ends = |end: fn(&[f64]) -> Option<&f64>| {
        channels.iter().flatten().filter_map(move |one| end(&one.time_s).copied())
    };
    let from = ends(<[f64]>::first).fold(f64::NEG_INFINITY, f64::max);
    let to = ends(<[f64]>::last).fold(f64::INFINITY, f64::min);
    let samples = ((to - from) / period_s).floor() + 1.0;
    if samples.is_nan() || samples < 2.0 {
        bail!("the channels have less than two periods of {:.3} ms in common", 1e3 * period_s);
    }
    if samples > MOST {
        bail!(
            "{samples} samples every {:.3} ms are too many; choose a longer --period, or cut the log",
            1e3 * period_s
        );
    }
    let times: Vec<f64> = (0..samples as usize).map(|k| from + k as f64 * period_s).collect();
    let mut taken: [Option<Vec<f64>>; CHANNELS.len()] = Default::default();
    for ((taken, one), channel) in taken.iter_mut().zip(channels).zip(&CHANNELS) {
        *taken = one.as_ref().map(|one| times.iter().map(|&time| one.at(time, channel.holds)).collect());
    }
    let remark = format!(
        "The log has a sample every {:.3} ms, the record every {:.3} ms: values in between are on straight lines, commands and setpoints hold. Noise looks smaller than it is; identify takes a log that is sampled evenly as it is.",
        1e3 * logged_s,
        1e3 * period_s
    );
    Ok(Table { period_s, channels: taken, remark: Some(remark) })
}

impl Sampled {
    /// The value at a time within the log.
    fn at(&self, time: f64, holds: bool) -> f64 {
        let after = self.time_s.partition_point(|&other| other <= time);
        let before = after.saturating_sub(1);
        if holds || after == self.time_s.len() {
            return self.values[before];
        }
        let part = (time - self.time_s[before]) / (self.time_s[after] - self.time_s[before]);
        self.values[before] + part * (self.values[after] - self.values[before])
    }
}

fn mean_step(time_s: &[f64]) -> Result<f64> {
    match time_s {
        [first, .., last] => Ok((last - first) / (time_s.len() - 1) as f64),
        _ => bail!("it has fewer than two rows"),
    }
}

fn is_even(time_s: &[f64], period_s: f64) -> bool {
    time_s.windows(2).all(|pair| (pair[1] - pair[0] - period_s).abs() <= EVEN * period_s)
}
