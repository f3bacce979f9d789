//! Whether a drive that stands still rests, or sticks until its pressures make it jump.
//!
//! The time at rest is divided into three parts, each T long. Let a and b be the changes of a mean pressure from the
//! first part to the second and from there to the third. The remaining change of an exponential at the end is then
//!
//! ```text
//! c = |b| min(q^1.5/(1 - q), H/T)      q = b/a;  H = 10 s: nothing is foreseen for longer
//! ```
//!
//! If q is not between 0 and 1, the pressure may continue to change in this way for H. The means are weighted by a
//! Hann window, so that the ripple of a dither does not count.
//!
//! Pressures are at rest if the remaining change of each is below 2 kPa. It also has to be less than half of the
//! force that still holds the load, if the friction is known. A record does not show the friction; there, pressures
//! at rest must suffice.

use std::f64::consts::TAU;
use std::ops::Range;

use super::Doubt;
use crate::transient::FrictionUse;

/// Pressures with a smaller remaining change are at rest, kPa.
const STEADY_KPA: f64 = 2.0;

/// How long a change may continue unabated, s.
const FORESEEN_S: f64 = 10.0;

/// The remaining change is this much smaller than the holding force.
const HOLDS: f64 = 2.0;

/// Into how many parts the time is divided.
const PARTS: usize = 3;

/// A drive that stands still.
pub(super) struct Standstill<'a> {
    /// Its pressures, kPa; NaN where they were not measured.
    pressures: [&'a [f64]; 2],
    /// Of a simulated run, the part of its grip that is used ([`FrictionUse::used`]), and [`FrictionUse::per_kpa`].
    grip: Option<(&'a [f64], [f64; 2])>,
    /// How long it stands, s.
    during_s: f64,
}

impl<'a> Standstill<'a> {
    /// The verdict on a transient from these samples, the last ones of its move.
    pub fn of(
        pressures: [&'a [f64]; 2],
        grip: Option<&'a FrictionUse>,
        samples: Range<usize>,
        during_s: f64,
    ) -> Standstill<'a> {
        Standstill {
            pressures: pressures.map(|pressure| &pressure[samples.clone()]),
            grip: grip.map(|grip| (&grip.used[samples.clone()], grip.per_kpa)),
            during_s,
        }
    }

    /// Why it cannot be decided whether the drive rests; None if it can.
    pub fn doubt(&self) -> Option<Doubt> {
        if self.pressures[0].len() < PARTS {
            return Some(Doubt::JustStopped);
        }
        if !self.pressures.into_iter().flatten().all(|kpa| kpa.is_finite()) {
            return Some(Doubt::PressuresUnknown);
        }
        let courses = self.pressures.map(|pressure| PressureTrend::of(pressure, self.during_s));
        let allowed = self.allowed_kpa(courses.map(|course| course.remainder()));
        let moving = || courses.iter().zip(allowed).filter(|(course, allowed)| course.remainder() > *allowed);
        let kpa_s = moving().map(|(course, _)| course.rate()).reduce(f64::max)?;
        let still_s = moving().map(|(course, allowed)| course.until(allowed)).reduce(f64::max)?;
        Some(Doubt::Sticking { kpa_s, still_s })
    }

    /// How much may still come of each pressure, kPa.
    fn allowed_kpa(&self, to_come: [f64; 2]) -> [f64; 2] {
        let Some((used, per_kpa)) = self.grip else { return [STEADY_KPA; 2] };
        let last = &used[used.len() - used.len() / PARTS..];
        let left = 1.0 - last.iter().fold(0.0_f64, |most, used| most.max(used.abs()));
        let taken: f64 = to_come.iter().zip(per_kpa).map(|(kpa, per_kpa)| kpa * per_kpa).sum();
        // Both may come by the same part, so that they leave enough of it together.
        let part = left.max(0.0) / HOLDS / taken;
        to_come.map(|kpa| if part < 1.0 { STEADY_KPA.min(kpa * part) } else { STEADY_KPA })
    }
}

/// How a pressure changes.
#[derive(Clone, Copy)]
struct PressureTrend {
    /// From the first part to the second, and from there to the third, kPa.
    changes: [f64; 2],
    /// How long a part is, s.
    part_s: f64,
}

impl PressureTrend {
    /// The course of a pressure (kPa) over a time (s).
    fn of(pressure: &[f64], during_s: f64) -> PressureTrend {
        let samples = pressure.len() / PARTS;
        let mean = |part: usize| weighted_mean(&pressure[part * samples..(part + 1) * samples]);
        let changes = [mean(1) - mean(0), mean(2) - mean(1)];
        PressureTrend { changes, part_s: during_s / PARTS as f64 }
    }

    /// The ratio of the second change to the first one, if an exponential can change in this way.
    fn decays(&self) -> Option<f64> {
        let ratio = self.changes[1] / self.changes[0];
        (0.0..1.0).contains(&ratio).then_some(ratio)
    }

    /// The size of the remaining change, kPa.
    fn remainder(&self) -> f64 {
        let as_it_goes = FORESEEN_S / self.part_s;
        let by = self.decays().map_or(as_it_goes, |ratio| ratio.powf(1.5) / (1.0 - ratio));
        self.changes[1].abs() * by.min(as_it_goes)
    }

    /// The size of the rate of change, kPa/s.
    fn rate(&self) -> f64 {
        self.changes[1].abs() / self.part_s
    }

    /// How long until the remaining change is below this, s; at most the time that is foreseen.
    fn until(&self, allowed: f64) -> f64 {
        let wait = |ratio: f64| self.part_s * (self.remainder() / allowed).ln() / -ratio.ln();
        self.decays().map_or(FORESEEN_S, wait).min(FORESEEN_S)
    }
}

/// By a Hann window: a ripple that has some periods in it does not count.
fn weighted_mean(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let weight = |k: usize| 1.0 - (TAU * (k as f64 + 0.5) / count).cos();
    values.iter().enumerate().map(|(k, value)| weight(k) * value).sum::<f64>() / count
}
