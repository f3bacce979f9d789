//! The air that flows into the chambers.
//!
//! It is stated in litres at 20 degrees Celsius, 100 kPa and 65 % relative humidity (ANR, ISO 8778). Leakage of the valve
//! from the supply to the exhaust does not enter the chambers and is not included.
//!
//! For a run, the flows into the chambers are integrated by the trapezoidal rule; the difference from the integral over
//! every other row gives its uncertainty. A record has no flows: there the air is computed from the pressures
//! ([`filling`]). Rows or samples too far apart to follow the dither are not used: at a multiple of its period all of them
//! would see it at the same phase.

mod filling;
mod record;
mod rises;

pub use record::Chambers;

use crate::transient::Transient;

/// Mass of a litre of air at 20 degrees Celsius, 100 kPa and 65 % relative humidity (ANR, ISO 8778), kg.
const KG_PER_LITRE: f64 = 1.185e-3;

/// Air that is let into the chambers, litres (ANR).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Air {
    /// The best estimate.
    pub litres: f64,
    /// Lower bound.
    pub least: f64,
    /// Upper bound.
    pub most: f64,
}

/// Air let in up to each instant of a transient, kg.
pub(super) struct Inflow {
    best: Vec<f64>,
    least: Vec<f64>,
    most: Vec<f64>,
    /// Whether a pressure is beyond its converter at an instant, and so not known.
    beyond: Vec<bool>,
}

impl Inflow {
    /// Of a run from its flows, of a record from its pressures and its chambers; None where these are not known, or the
    /// dither of the chambers' rig is not followed.
    pub fn of(transient: &Transient, chambers: Option<&Chambers>) -> Option<Inflow> {
        if chambers.is_some_and(|chambers| !chambers.follows_dither(transient)) {
            return None;
        }
        match &transient.inflow_kg_s {
            Some(inflow) => Some(Inflow::of_flows(&transient.time, inflow)),
            None if transient.has_pressures() => Some(record::course(transient, chambers?)),
            None => None,
        }
    }

    fn of_flows(time: &[f64], inflow: &[f64]) -> Inflow {
        let (best, coarse) = (integral::<1>(time, inflow), integral::<2>(time, inflow));
        let most = best.iter().zip(&coarse).map(|(best, coarse)| 2.0 * best - coarse).collect();
        Inflow { beyond: vec![false; time.len()], least: coarse, best, most }
    }

    /// The inflow from sample `begin` to sample `end`, or to the last one; None if a pressure is not known.
    pub fn between(&self, begin: usize, end: usize) -> Option<Air> {
        let end = end.min(self.best.len() - 1);
        let litres = |mass: &[f64]| (mass[end] - mass[begin]) / KG_PER_LITRE;
        let [best, one, other] = [&self.best, &self.least, &self.most].map(|mass| litres(mass));
        let known = !self.beyond[begin..=end].contains(&true);
        let (least, most) = (best.min(one).min(other).max(0.0), best.max(one).max(other));
        known.then_some(Air { litres: best, least, most })
    }
}

/// The integral of a rate up to each instant, by the trapezoidal rule over every `STEP`th of them.
fn integral<const STEP: usize>(time: &[f64], rate: &[f64]) -> Vec<f64> {
    let trapezium = |from: usize, to: usize| (time[to] - time[from]) * (rate[from] + rate[to]) / 2.0;
    let mut sum = 0.0;
    let up_to = |k: usize| {
        let last = k - k % STEP;
        if k > 0 && last == k {
            sum += trapezium(k - STEP, k);
        }
        sum + trapezium(last, k)
    };
    (0..time.len()).map(up_to).collect()
}

#[cfg(test)]
mod tests;
