//! Channels with clocks of their own on one clock.

use anyhow::{Context, Result, bail};

use super::{Sampled, Table};
use crate::column_map::CHANNELS;

/// A clock is even if each of its steps is within this part of the mean one.
const EVEN: f64 = 0.01;

/// Behind a gap, samples of an even clock are within this part of a step of where they would be without.
const IN_STEP: f64 = 0.1;

/// Times that differ by less than this part of a step are the same.
const SAME: f64 = 1e-6;

/// The most samples of a record.
const MAX: f64 = 10e6;

/// The channels as they are, if they share an even clock and no other is requested; else resampled every `asked_s`,
/// or every `usual_s`.
///
/// # Errors
/// When they have no time in common.
pub fn on_one_clock(
    channels: &[Option<Sampled>; CHANNELS.len()],
    asked_s: Option<f64>,
    usual_s: f64,
) -> Result<Table> {
    let there: Vec<&Sampled> = channels.iter().flatten().collect();
    let first = there.first().context("the map names no channel")?;
    let is_shared = there.iter().all(|one| one.time_s == first.time_s);
    let is_kept = asked_s.is_none_or(|asked| (asked / first.step_s - 1.0).abs() < EVEN);
    match even(first).filter(|_| is_shared && is_kept) {
        Some(indices) => {
            let values = channels.each_ref().map(|one| one.as_ref().map(|one| one.values.clone()));
            Ok(Table { period_s: first.step_s, indices, channels: values, remark: None })
        }
        None => again(channels, asked_s.unwrap_or(usual_s), first.step_s),
    }
}

/// The index of each sample of an even clock; None of another clock.
fn even(one: &Sampled) -> Option<Vec<i32>> {
    let (time_s, period_s) = (&one.time_s, one.step_s);
    let mut indices = Vec::with_capacity(time_s.len());
    indices.push(0);
    let mut gaps = one.gaps.iter().peekable();
    for pair in time_s.windows(2) {
        let steps = (pair[1] - pair[0]) / period_s;
        let is_gap = gaps.next_if(|[before, _]| *before == pair[0]).is_some();
        let (whole, most) = if is_gap { (steps.round(), IN_STEP) } else { (1.0, EVEN) };
        if (steps - whole).abs() > most {
            return None;
        }
        let next = f64::from(*indices.last()?) + whole;
        indices.push((next <= f64::from(i32::MAX)).then_some(next as i32)?);
    }
    Some(indices)
}

fn again(channels: &[Option<Sampled>; CHANNELS.len()], period_s: f64, logged_s: f64) -> Result<Table> {
    let ends = |end: fn(&[f64]) -> Option<&f64>| {
        channels.iter().flatten().filter_map(move |one| end(&one.time_s).copied())
    };
    let from = ends(<[f64]>::first).fold(f64::NEG_INFINITY, f64::max);
    let to = ends(<[f64]>::last).fold(f64::INFINITY, f64::min);
    let last = ((to - from) / period_s).floor();
    if last.is_nan() || last < 1.0 {
        bail!("the channels have less than two periods of {:.3} ms in common", 1e3 * period_s);
    }
    let (indices, times) = instants(channels, from, last, period_s)?;
    let mut taken: [Option<Vec<f64>>; CHANNELS.len()] = Default::default();
    for ((taken, one), channel) in taken.iter_mut().zip(channels).zip(&CHANNELS) {
        *taken = one.as_ref().map(|one| times.iter().map(|&time| one.at(time, channel.holds)).collect());
    }
    let remark = format!(
        "The log has a sample every {:.3} ms, the record every {:.3} ms: values in between are on straight lines, commands and setpoints hold. Noise looks smaller than it is; identify takes a log that is sampled evenly as it is.",
        1e3 * logged_s,
        1e3 * period_s
    );
    Ok(Table { period_s, indices, channels: taken, remark: Some(remark) })
}

/// The multiples of a period, up to the last one, that lie in no gap, and their times.
fn instants(
    channels: &[Option<Sampled>; CHANNELS.len()],
    from: f64,
    last: f64,
    period_s: f64,
) -> Result<(Vec<i32>, Vec<f64>)> {
    let mut gaps: Vec<[f64; 2]> = channels.iter().flatten().flat_map(|one| one.gaps.clone()).collect();
    gaps.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let (mut indices, mut times, mut k) = (Vec::new(), Vec::new(), 0.0);
    let mut gaps = gaps.into_iter().peekable();
    while k <= last {
        let time = from + k * period_s;
        while gaps.next_if(|[_, after]| *after <= time).is_some() {}
        match gaps.peek() {
            // Over hours without a sample there is nothing to count.
            Some([before, after]) if time > *before => k = ((after - from) / period_s).ceil().max(k + 1.0),
            _ => {
                if k > f64::from(i32::MAX) || times.len() as f64 >= MAX {
                    bail!(
                        "a sample every {:.3} ms from {from} s on makes more than the {MAX} of a record; choose a longer --period, or cut the log",
                        1e3 * period_s
                    );
                }
                indices.push(k as i32);
                times.push(time);
                k += 1.0;
            }
        }
    }
    // A record begins with sample 0.
    let first = indices.first().copied().context("the channels have no time in common without a gap")?;
    indices.iter_mut().for_each(|index| *index -= first);
    Ok((indices, times))
}

impl Sampled {
    /// The value at a time within the log.
    fn at(&self, time: f64, holds: bool) -> f64 {
        // Two sums of the same steps differ in their last digits.
        let same = time + SAME * self.step_s;
        let after = self.time_s.partition_point(|&other| other <= same);
        let before = after.saturating_sub(1);
        if holds || after == self.time_s.len() {
            return self.values[before];
        }
        let part = (time - self.time_s[before]) / (self.time_s[after] - self.time_s[before]);
        self.values[before] + part * (self.values[after] - self.values[before])
    }
}
