//! The air that a transient takes from the supply.
//!
//! Of a run, the inflows are summed. A record has no flows: the air in the chambers comes from its
//! pressures and positions with the cylinder of a rig file, `m = P V / (R T)` at the supply's temperature,
//! and every rise of it was let in. The converter's steps make such rises, too; a band keeps them out.
//! What escapes through leakage meanwhile cannot be seen.

use pneudrive_sim::actuator::Actuator;
use pneudrive_sim::{Rig, build};

use crate::transient::{POSITION, PRESSURES, Transient};

/// kg of a litre of air at 20 degrees Celsius, 100 kPa and 65 % relative humidity (ANR, ISO 8778).
const KG_PER_LITRE: f64 = 1.185e-3;

/// A rise counts when it is more than this much of pressure, kPa: two to three steps of a 12-bit converter
/// over 1 MPa, and its noise.
const BAND_KPA: f64 = 2.0;

/// The chambers of a cylinder, to tell masses from pressures.
#[derive(Clone, Copy, Debug)]
pub struct Chambers {
    actuator: Actuator,
    /// R T of the supply, J/kg.
    gas: f64,
}

impl Chambers {
    /// Those of a rig.
    #[must_use]
    pub fn of(rig: &Rig) -> Chambers {
        let gas = rig.number("gas.gas_constant_j_per_kg_k") * rig.number("supply.temperature_k");
        Chambers { actuator: build::actuator(rig), gas }
    }

    /// What has been let into both chambers up to each instant, kg.
    fn let_in(&self, transient: &Transient) -> Vec<f64> {
        let chambers = [0, 1].map(|i| {
            let filled = |k: usize| {
                let position = transient.channels[POSITION][k] / 1e3;
                let volume = self.actuator.volumes(position, 0.0)[i].volume;
                let kg_per_kpa = 1e3 * volume / self.gas;
                (kg_per_kpa * transient.channels[PRESSURES[i]][k], kg_per_kpa * BAND_KPA)
            };
            rises((0..transient.time.len()).map(filled))
        });
        let [one, two] = chambers;
        one.iter().zip(two).map(|(one, two)| one + two).collect()
    }
}

/// The sum of all rises up to each value. A rise is seen when the value stands more than its band above the
/// lowest since the last one, and ends when it has fallen by its band.
fn rises(values: impl Iterator<Item = (f64, f64)>) -> Vec<f64> {
    let (mut sum, mut low, mut top) = (0.0, f64::INFINITY, None);
    let mut step = |value: f64, band: f64| {
        match top {
            None if value < low => low = value,
            None if value > low + band => {
                sum += value - low;
                top = Some(value);
            }
            Some(highest) if value > highest => {
                sum += value - highest;
                top = Some(value);
            }
            Some(highest) if value < highest - band => (low, top) = (value, None),
            _ => {}
        }
        sum
    };
    values.map(|(value, band)| step(value, band)).collect()
}

/// Air let in up to each instant, kg: from the flows of a run, or from the pressures of a record.
pub(super) fn let_in(transient: &Transient, chambers: Option<&Chambers>) -> Option<Vec<f64>> {
    match &transient.inflow_kg_s {
        Some(inflow) => Some(integral(&transient.time, inflow)),
        None => chambers.map(|chambers| chambers.let_in(transient)),
    }
}

fn integral(time: &[f64], rate: &[f64]) -> Vec<f64> {
    let steps = time.windows(2).zip(rate.windows(2)).map(|(t, r)| (t[1] - t[0]) * (r[0] + r[1]) / 2.0);
    let sums = steps.scan(0.0, |sum, step| {
        *sum += step;
        Some(*sum)
    });
    time.first().map(|_| 0.0).into_iter().chain(sums).collect()
}

/// What came in between the first and the last of these instants, litres (ANR).
pub(super) fn litres(let_in: &[f64]) -> f64 {
    let_in.last().zip(let_in.first()).map_or(0.0, |(last, first)| (last - first) / KG_PER_LITRE)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with_band(values: &[f64]) -> f64 {
        *rises(values.iter().map(|&value| (value, 1.0))).last().expect("values")
    }

    #[test]
    fn only_rises_above_the_band_are_air_from_the_supply() {
        assert_eq!(with_band(&[5.0, 5.5, 4.8, 5.4, 5.0]), 0.0, "the steps of a converter");
        assert_eq!(with_band(&[5.0, 7.0, 9.0, 8.5, 9.5]), 4.5, "filled, with a jitter on top");
        assert_eq!(with_band(&[5.0, 9.0, 3.0, 6.0]), 7.0, "filled, emptied, filled");
    }

    #[test]
    fn a_constant_inflow_is_time_by_flow() {
        assert_eq!(integral(&[0.0, 1.0, 3.0], &[2.0, 2.0, 2.0]), [0.0, 2.0, 6.0]);
        assert_eq!(litres(&[1.0, 1.0 + KG_PER_LITRE]).round(), 1.0);
    }
}
