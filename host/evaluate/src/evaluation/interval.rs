//! The samples of a move, and its step in them. Quantities that they do not show are None.

use std::ops::RangeInclusive;

use super::limit_cycle::{rest, still_band};
use super::{Doubt, LimitCycle, Tracking};
use crate::transient::{POSITION, PRESSURES, SETPOINT, Transient};

/// A distance of fewer counts cannot be distinguished from a drive that rests on the edge of a count.
const SHORTEST_DISTANCE_COUNTS: f64 = 2.5;

/// A tenth of the distance must be a count at least to be seen.
const SHORTEST_RISE_COUNTS: f64 = 10.0;

/// The part of a move, at its end, that must show that the drive has settled.
const LAST_PART: f64 = 0.25;

/// The samples of a move.
pub(super) struct Interval<'a> {
    pub transient: &'a Transient,
    pub begin: usize,
    pub end: usize,
    /// Largest motion of the drive while it rests, mm.
    still_mm: f64,
}

impl<'a> Interval<'a> {
    pub fn new(transient: &'a Transient, begin: usize, end: usize) -> Interval<'a> {
        let position = &transient.channels[POSITION][begin..end];
        Interval { transient, begin, end, still_mm: still_band(position, transient.mm_per_count) }
    }

    pub fn time(&self) -> &[f64] {
        &self.transient.time[self.begin..self.end]
    }

    pub fn position(&self) -> &[f64] {
        &self.transient.channels[POSITION][self.begin..self.end]
    }

    /// Where the move leads, mm.
    pub fn setpoint(&self) -> Option<f64> {
        let arrival = self.profile().map_or(self.begin, |samples| *samples.end());
        Some(self.transient.channels[SETPOINT][arrival]).filter(|value| value.is_finite())
    }

    fn profile(&self) -> Option<RangeInclusive<usize>> {
        self.transient.profile(self.begin, self.end)
    }

    /// The target of the move, mm, if its setpoint never leaves the range from start to target. A sine and a random sequence leave it,
    /// and their rise or overshoot would say nothing about the drive.
    pub fn straight_to(&self) -> Option<f64> {
        let to = self.setpoint()?;
        let Some(samples) = self.profile() else { return Some(to) };
        let setpoints = &self.transient.channels[SETPOINT][samples];
        let from = setpoints[0];
        let count = self.transient.mm_per_count;
        let range = from.min(to) - count..=from.max(to) + count;
        setpoints.iter().all(|setpoint| range.contains(setpoint)).then_some(to)
    }

    /// How the drive follows a profile; None of a step, and in open loop.
    pub fn tracking(&self) -> Option<Tracking> {
        let samples = self.profile()?;
        let channels = &self.transient.channels;
        let errors = || samples.clone().map(|k| channels[SETPOINT][k] - channels[POSITION][k]);
        let most_mm = errors().map(f64::abs).fold(0.0, f64::max);
        let rms_mm = mean(&errors().map(|error| error * error).collect::<Vec<_>>()).sqrt();
        (most_mm.is_finite() && rms_mm.is_finite()).then_some(Tracking { most_mm, rms_mm })
    }

    pub fn limit_cycle(&self) -> LimitCycle {
        let pressures = PRESSURES.map(|channel| &self.transient.channels[channel][self.begin..self.end]);
        let mm_per_count = self.transient.mm_per_count;
        let grip = self.transient.grip.as_ref().map(|grip| grip.between(self.begin, self.end));
        LimitCycle::of(self.time(), self.position(), pressures, grip.as_ref(), mm_per_count, self.still_mm)
    }

    /// How far it should go, mm, if that is at least this many counts.
    fn distance(&self, to: f64, least_counts: f64) -> Option<f64> {
        Some(to - self.position()[0])
            .filter(|distance| distance.abs() > least_counts * self.transient.mm_per_count)
    }

    /// From 10 % to 90 % of the distance to `to`, for the first time each, s.
    pub fn rise(&self, to: f64) -> Option<f64> {
        let distance = self.distance(to, SHORTEST_RISE_COUNTS)?;
        Some(self.passes(distance, 0.9)? - self.passes(distance, 0.1)?)
    }

    /// When the position has gone a share of its distance, on the straight line between two samples, s.
    fn passes(&self, distance: f64, share: f64) -> Option<f64> {
        let (time, position) = (self.time(), self.position());
        let gone = |k: usize| (position[k] - position[0]) / distance;
        let after = (1..position.len()).find(|&k| gone(k) >= share)?;
        let part = (share - gone(after - 1)) / (gone(after) - gone(after - 1));
        Some(time[after - 1] + part * (time[after] - time[after - 1]))
    }

    /// How far the position goes beyond `to`, mm: of a drive that stands still, swings for good, or has turned back
    /// and swings less and less.
    pub fn overshoot(&self, to: f64, limit_cycle: &LimitCycle) -> Option<f64> {
        let distance = self.distance(to, SHORTEST_DISTANCE_COUNTS)?;
        let beyond = |position: &f64| (position - to) * distance.signum();
        let furthest = self.position().iter().map(beyond).fold(f64::NEG_INFINITY, f64::max);
        let turned_back = || {
            let back = furthest - self.position().last().map_or(furthest, beyond);
            furthest > 0.0 && back > self.still_mm
        };
        let is_over = match limit_cycle {
            LimitCycle::None { .. } | LimitCycle::Sustained(_) => true,
            LimitCycle::Undecided(
                Doubt::DyingOut { .. }
                | Doubt::JustStopped
                | Doubt::Sticking { .. }
                | Doubt::PressuresUnknown,
            ) => self.stands() || turned_back(),
            LimitCycle::Undecided(_) => self.stands(),
        };
        is_over.then_some(furthest.max(0.0))
    }

    /// From its beginning until the position stays within `tolerance` of `to`, s; it must do so for the last
    /// quarter of the move.
    pub fn settling(&self, to: f64, tolerance: f64) -> Option<f64> {
        let outside = |position: &f64| (position - to).abs() > tolerance;
        let first_inside = self.position().iter().rposition(outside).map_or(0, |last| last + 1);
        (first_inside <= self.last_part()).then(|| self.time()[first_inside] - self.time()[0])
    }

    /// Mean of `to` less the position in the last quarter, mm, whatever the drive does there.
    pub fn mean_error(&self, to: f64) -> f64 {
        to - mean(&self.position()[self.last_part()..])
    }

    /// From the lowest to the highest position in the last quarter, mm.
    pub fn range(&self) -> f64 {
        let last = || self.position()[self.last_part()..].iter().copied();
        last().fold(f64::NEG_INFINITY, f64::max) - last().fold(f64::INFINITY, f64::min)
    }

    /// The mean error of a drive that stands there; of one that swings for good over its whole cycles.
    pub fn steady_error(&self, to: f64, limit_cycle: &LimitCycle) -> Option<f64> {
        match limit_cycle {
            LimitCycle::Sustained(oscillation) => {
                let [from, until] = oscillation.during_s.map(|at| self.time().partition_point(|t| *t < at));
                Some(to - mean(&self.position()[from..until]))
            }
            _ => self.stands().then(|| self.mean_error(to)),
        }
    }

    /// Whether it is at rest in the last quarter.
    fn stands(&self) -> bool {
        let position = &self.position()[self.last_part()..];
        let time = &self.time()[self.last_part()..];
        position.len() > 1 && rest(time, position, self.still_mm) >= time[time.len() - 1] - time[0]
    }

    fn last_part(&self) -> usize {
        let samples = self.position().len();
        samples - (samples as f64 * LAST_PART).ceil() as usize
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}
