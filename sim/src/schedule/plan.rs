//! The moves of a test with their profiles, in counts and samples. All rounding takes place here, once.
//!
//! | of a move | becomes | rounded |
//! |---|---|---|
//! | time | samples | up |
//! | target, amplitude | counts | to the nearest |
//! | limits | lengths of a ramp ([`super::ramp`]) | to samples, so that no limit is exceeded |
//! | frequency | turns a sample | to the nearest 2^-64, once the samples of whole cycles are rounded |
//! | duration of a chirp | samples | to whole cycles |
//! | hold | samples | to the nearest, 1 at least |
//!
//! A ramp begins at the setpoint before it. The first ramp of a closed loop begins where the drive stands, which no file
//! knows. It has the lengths for the longest distance between the soft limits, so it is within its limits from anywhere.

use std::num::NonZeroU32;

use pneudrive_controller::Move;
use pneudrive_controller::profile::{Noise, Profile, Ramp, Wave};

use super::entry::Shape;
use super::keys;
use super::ramp::{Limits, up};
use crate::component::controller::{self, Loop};
use crate::component::{actuator, encoder, safety};
use crate::key::Choice;
use crate::values::{Fields, Rig, Value, field, whole_microseconds};

/// A move of a test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planned {
    /// From the start of the test, s.
    pub time_s: f64,
    /// Counts.
    pub target: i64,
    /// The profile there; None where it cannot be had.
    pub profile: Result<Profile, Slip>,
}

/// Why a move has no profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Slip {
    /// The target is neither in mm nor in counts, or in both.
    Target,
    /// The amplitude is neither in mm nor in counts, or in both.
    Amplitude,
    /// The ramp is longer than the controller can count.
    TooLong,
    /// A cycle takes less than four samples.
    TooFast,
    /// A point is not after the one before.
    Points,
}

impl Slip {
    pub(super) fn advice(self) -> &'static str {
        match self {
            Slip::Target => "give either to_mm or to_counts; mm mean nothing in open loop",
            Slip::Amplitude => "give either amplitude_mm or amplitude_counts; mm mean nothing in open loop",
            Slip::TooLong => {
                "takes more samples than the controller can count: raise velocity, acceleration or jerk"
            }
            Slip::Points => "its points must be a sample apart at least, in order of time",
            Slip::TooFast => "has less than four samples a cycle: lower the frequency or controller.period_s",
        }
    }
}

impl Planned {
    /// As the controller takes it.
    ///
    /// # Panics
    /// When the rig has not been checked.
    pub(super) fn in_force(&self, period_us: NonZeroU32) -> Move {
        let time_us = u32::try_from(whole_microseconds(self.time_s).unwrap_or(0)).unwrap_or(u32::MAX);
        let step = Move::at_time_us(time_us, period_us, i32::try_from(self.target).unwrap_or(i32::MAX));
        Move { profile: self.profile.expect("checked to have a profile"), ..step }
    }

    /// The lowest and the highest setpoint about its target.
    pub(super) fn extremes(&self) -> [i64; 2] {
        let amplitude = self.profile.map_or(0, |profile| i64::from(profile.amplitude()));
        [self.target - amplitude, self.target + amplitude]
    }

    pub(super) fn samples(&self) -> u32 {
        self.profile.map_or(0, |profile| profile.samples())
    }
}

impl Rig {
    /// The moves of the test, in their order.
    #[must_use]
    pub fn planned(&self) -> Vec<Planned> {
        match self.get(&keys::MOVE) {
            Some(entries) => self.entries_planned(&entries),
            None => self.listed_planned(),
        }
    }

    fn entries_planned(&self, entries: &[Fields]) -> Vec<Planned> {
        let (mut all, mut free_s): (Vec<Planned>, f64) = (Vec::new(), 0.0);
        for entry in entries {
            let time_s = number(entry, "at_s").unwrap_or(free_s);
            match field(entry, "points") {
                Some(Value::Rows(points)) => all.extend(self.points(time_s, points)),
                _ => all.push(self.entry_planned(entry, time_s, all.last().map(|before| before.target))),
            }
            free_s = all.last().map_or(time_s, |last| self.end_s(last));
        }
        all
    }

    fn entry_planned(&self, entry: &Fields, time_s: f64, before: Option<i64>) -> Planned {
        let target = self.counts(entry, "to");
        let distance = self.distance(before, target.unwrap_or(0));
        let profile = target.ok_or(Slip::Target).and_then(|_| self.profile(entry, distance));
        Planned { time_s, target: target.unwrap_or(0), profile }
    }

    /// Points as a move each, in a straight line from the one before; a first one at time 0 is a step.
    fn points(&self, time_s: f64, points: &[Vec<f64>]) -> Vec<Planned> {
        let period_s = self.get(&controller::keys::PERIOD_S);
        let scale = match self.get(&controller::keys::LOOP) {
            Loop::Closed => encoder::mm_per_count(self),
            Loop::Open => 1.0,
        };
        let sample = |point: &[f64]| up((time_s + point[0]) / period_s);
        let mut before = up(time_s / period_s);
        let planned = points.iter().enumerate().map(|(index, point)| {
            let begin = std::mem::replace(&mut before, sample(point));
            let profile = match before - begin {
                0.0 if index == 0 => Ok(Profile::Step),
                samples if samples >= 1.0 => ramp([samples, 1.0, 1.0], 0.0),
                _ => Err(Slip::Points),
            };
            let time_s = (begin * period_s * 1e6).round().max(0.0) / 1e6;
            Planned { time_s, target: (point[1] / scale).round() as i64, profile }
        });
        planned.collect()
    }

    /// The instant of the sample at which the profile of a move is over, s.
    pub(super) fn end_s(&self, planned: &Planned) -> f64 {
        let period_us = self.microseconds(&controller::keys::PERIOD_S).max(1);
        let begin = whole_microseconds(planned.time_s).unwrap_or(0).div_ceil(period_us);
        crate::values::seconds((begin + u64::from(planned.samples())) * period_us)
    }

    /// Counts of a length that is given in mm or in counts, not both.
    fn counts(&self, entry: &Fields, name: &str) -> Option<i64> {
        let mm = number(entry, &format!("{name}_mm")).filter(|_| self.is_closed());
        match (mm, field(entry, &format!("{name}_counts"))) {
            (Some(mm), None) => Some(self.to_counts(mm)),
            (None, Some(Value::Integer(counts))) if number(entry, &format!("{name}_mm")).is_none() => {
                Some(*counts)
            }
            _ => None,
        }
    }

    fn profile(&self, entry: &Fields, distance: f64) -> Result<Profile, Slip> {
        let period_s = self.get(&controller::keys::PERIOD_S);
        let frequency = || number(entry, "frequency_hz").unwrap_or(1.0) * period_s;
        let amplitude = || self.amplitude(entry);
        let duration = || number(entry, "duration_s").unwrap_or(1.0) / period_s;
        match field(entry, "profile") {
            Some(Value::Word(word)) => match word.as_str() {
                "step" => Ok(Profile::Step),
                "linear" => ramp([up(duration()).max(1.0), 1.0, 1.0], distance),
                "sine" => sine(amplitude()?, frequency(), integer(entry, "cycles")),
                "chirp" => {
                    let end = number(entry, "end_frequency_hz").unwrap_or(1.0) * period_s;
                    chirp(amplitude()?, [frequency(), end], duration())
                }
                "prbs" => {
                    let hold = number(entry, "hold_s").unwrap_or(0.0) / period_s;
                    noise(amplitude()?, hold, integer(entry, "order"), integer(entry, "repeats"))
                }
                word => {
                    let shape = Shape::of_word(word).unwrap_or(Shape::Step);
                    let given = |name: &str| number(entry, name);
                    let limits = self.limits(shape, given);
                    ramp(limits.lengths(distance), distance)
                }
            },
            _ => Ok(Profile::Step),
        }
    }

    fn amplitude(&self, entry: &Fields) -> Result<i32, Slip> {
        self.counts(entry, "amplitude").and_then(|counts| i32::try_from(counts).ok()).ok_or(Slip::Amplitude)
    }

    /// The limits of a shape, in counts and samples; those that are not given are the test's.
    fn limits(&self, shape: Shape, given: impl Fn(&str) -> Option<f64>) -> Limits {
        let period_s = self.get(&controller::keys::PERIOD_S);
        let scale = match self.get(&controller::keys::LOOP) {
            Loop::Closed => encoder::mm_per_count(self),
            Loop::Open => 1.0,
        };
        let limit =
            |name: &str, test: f64, order: i32| given(name).unwrap_or(test) * period_s.powi(order) / scale;
        Limits {
            velocity: limit("velocity_mm_s", self.get(&keys::VELOCITY_MM_S), 1),
            acceleration: limit("acceleration_mm_s2", self.get(&keys::ACCELERATION_MM_S2), 2),
            jerk: (shape == Shape::SCurve).then(|| limit("jerk_mm_s3", self.get(&keys::JERK_MM_S3), 3)),
        }
    }

    /// How far a move goes at most, counts.
    fn distance(&self, before: Option<i64>, target: i64) -> f64 {
        match (before, self.get(&controller::keys::LOOP)) {
            (Some(before), _) => (target - before).abs() as f64,
            (None, Loop::Open) => target.abs() as f64,
            (None, Loop::Closed) => {
                let pulse_mm = encoder::mm_per_count(self);
                let low = self.get(&safety::keys::END_MIN_MM).unwrap_or(0.0);
                let stroke_mm = self.get(&actuator::keys::STROKE_M) * 1e3;
                let high = self.get(&safety::keys::END_MAX_MM).unwrap_or(stroke_mm);
                [low, high]
                    .map(|end| (end / pulse_mm - target as f64).abs())
                    .into_iter()
                    .fold(0.0, f64::max)
                    .ceil()
            }
        }
    }

    /// The targets of the test, counts.
    pub(super) fn targets(&self) -> Option<Vec<i64>> {
        let in_mm = || self.get(&keys::TARGETS_MM).filter(|_| self.is_closed());
        let counts = |targets: Vec<f64>| targets.into_iter().map(|mm| self.to_counts(mm)).collect();
        self.get(&keys::TARGETS).or_else(|| in_mm().map(counts))
    }

    /// The moves of the test without profiles: [time in s, counts].
    pub(super) fn moves_listed(&self) -> Vec<(f64, i64)> {
        let counts =
            |moves: Vec<Vec<f64>>| moves.iter().map(|one| (one[0], self.to_counts(one[1]))).collect();
        let in_mm = self.get(&keys::MOVES_MM).filter(|_| self.is_closed());
        in_mm.map_or_else(|| self.get(&keys::MOVES), counts)
    }

    /// Whether setpoints in mm mean something.
    fn is_closed(&self) -> bool {
        self.get(&controller::keys::LOOP) == Loop::Closed
    }

    /// Counts of a setpoint in mm, to the nearest.
    fn to_counts(&self, mm: f64) -> i64 {
        (mm / encoder::mm_per_count(self)).round() as i64
    }

    /// Moves or targets, all with the profile of the test.
    fn listed_planned(&self) -> Vec<Planned> {
        let moves = match self.targets() {
            Some(targets) => {
                let waits = self.get(&controller::keys::EXIT_ON_DEAD_BAND);
                let each = if waits { 0.0 } else { self.get(&controller::keys::FORCED_EXIT_S) };
                targets.iter().enumerate().map(|(i, &target)| (i as f64 * each, target)).collect()
            }
            None => self.moves_listed(),
        };
        let moves = match self.get(&keys::IMPULSE) {
            Some(impulse) => with_impulse(&moves, &impulse),
            None => moves,
        };
        let mut before = None;
        let planned = moves.into_iter().map(|(time_s, target)| {
            let profile = self.listed_profile(self.distance(before.replace(target), target));
            Planned { time_s, target, profile }
        });
        planned.collect()
    }

    fn listed_profile(&self, distance: f64) -> Result<Profile, Slip> {
        match self.get(&keys::PROFILE) {
            Shape::Step => Ok(Profile::Step),
            shape => ramp(self.limits(shape, |_| None).lengths(distance), distance),
        }
    }
}

fn number(entry: &Fields, name: &str) -> Option<f64> {
    match field(entry, name) {
        Some(Value::Number(number)) => Some(*number),
        _ => None,
    }
}

fn integer(entry: &Fields, name: &str) -> i64 {
    match field(entry, name) {
        Some(Value::Integer(integer)) => *integer,
        _ => 1,
    }
}

/// A ramp of these lengths. A profile so long that rounding would show at its end is refused.
fn ramp(lengths: [f64; 3], distance: f64) -> Result<Profile, Slip> {
    let product: f64 = lengths.iter().product();
    let [v, a, j] = lengths.map(|samples| samples as u32);
    let ramp = Ramp::new(v, a, j).filter(|_| distance * product <= 2_f64.powi(62));
    ramp.map(Profile::Ramp).ok_or(Slip::TooLong)
}

/// Turns in 2^-64, spread over samples.
fn rate(turns: f64, samples: u32) -> i128 {
    let whole = (turns.round() as i128) << 64;
    (whole + i128::from(samples) / 2) / i128::from(samples.max(1))
}

/// `frequency` in cycles a sample.
fn sine(amplitude: i32, frequency: f64, cycles: i64) -> Result<Profile, Slip> {
    let samples = countable(cycles as f64 / frequency)?;
    if frequency > 0.25 {
        return Err(Slip::TooFast);
    }
    let rate = rate(cycles as f64, samples) as u64;
    Ok(Profile::Wave(Wave { amplitude, samples, rate, sweep: 0 }))
}

/// From one frequency to another, cycles a sample: N samples, over which rate and sweep make whole cycles,
/// N rate + N (N - 1)/2 sweep.
fn chirp(amplitude: i32, frequencies: [f64; 2], duration: f64) -> Result<Profile, Slip> {
    let [first, last] = frequencies;
    if first.max(last) > 0.25 {
        return Err(Slip::TooFast);
    }
    let mean = 0.5 * (first + last);
    let cycles = (mean * duration).round().max(1.0);
    let samples = countable(cycles / mean)?.max(2);
    let turns = (cycles as i128) << 64;
    let begin = (first * 2_f64.powi(64)) as i128;
    let n = i128::from(samples);
    let sweep = 2 * (turns - n * begin) / (n * (n - 1));
    Ok(Profile::Wave(Wave { amplitude, samples, rate: begin as u64, sweep: sweep as i64 }))
}

fn noise(amplitude: i32, hold: f64, order: i64, repeats: i64) -> Result<Profile, Slip> {
    let hold = countable(hold.max(1.0))?;
    let signs = (1_i64 << order) - 1;
    // The sample at which it begins is the target's own.
    let samples = countable(f64::from(hold) * (signs * repeats) as f64 + 1.0)?;
    Ok(Profile::Noise(Noise { amplitude, samples, hold, taps: taps(order) }))
}

fn countable(samples: f64) -> Result<u32, Slip> {
    let samples = samples.round().max(1.0);
    if samples <= f64::from(1 << 30) { Ok(samples as u32) } else { Err(Slip::TooLong) }
}

/// The taps of a shift register of this length that goes through all its states except 0 (primitive polynomials, as
/// in Xilinx XAPP 052).
pub(super) fn taps(order: i64) -> u32 {
    let places: &[u32] = match order {
        3 => &[3, 2],
        4 => &[4, 3],
        5 => &[5, 3],
        6 => &[6, 5],
        7 => &[7, 6],
        8 => &[8, 6, 5, 4],
        9 => &[9, 5],
        10 => &[10, 7],
        11 => &[11, 9],
        12 => &[12, 6, 4, 1],
        13 => &[13, 4, 3, 1],
        14 => &[14, 5, 3, 1],
        15 => &[15, 14],
        _ => &[16, 15, 13, 4],
    };
    places.iter().fold(0, |taps, place| taps | 1 << (place - 1))
}

/// Moves with a pulse `[time, duration, counts]` on top of them (thesis 8.2.1).
fn with_impulse(moves: &[(f64, i64)], impulse: &[f64]) -> Vec<(f64, i64)> {
    let &[start, duration, counts] = impulse else { return moves.to_vec() };
    let end = ((start + duration) * 1e6).round() / 1e6;
    let in_force =
        |time: f64| moves.iter().rev().find(|(at, _)| *at <= time).map_or(0, |(_, target)| *target);
    let raised = |time: f64, target: i64| {
        (time, if (start..end).contains(&time) { target + counts as i64 } else { target })
    };
    let edges = [start, end].into_iter().filter(|edge| moves.iter().all(|(at, _)| at != edge));
    let mut all: Vec<_> = moves.iter().copied().chain(edges.map(|edge| (edge, in_force(edge)))).collect();
    all.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    all.into_iter().map(|(time, target)| raised(time, target)).collect()
}
