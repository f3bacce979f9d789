//! The air that a record shows, with its bounds.
//!
//! | | is |
//! |---|---|
//! | seen | the rises of the filling above 6.5 standard deviations of its noise |
//! | gained | their excess over the rises of every other sample |
//! | how much | seen, and a third of what is gained: what is lost between samples goes with the square of their distance |
//! | at least | the rises of the smoothed filling, each less 2 standard deviations at its ends, and less 1.5 % |
//! | at most | seen, and 0.5 %, all of what is gained, and a ripple as large as the noise in each period of the dither in which the filling stays within its noise |
//!
//! The 1.5 % allow for air that enters hotter than the supply, as fast air through the port does in the model.

use pneudrive_sim::Rig;
use pneudrive_sim::component::actuator::{Actuator, cushion};
use pneudrive_sim::component::gas::Gas;
use pneudrive_sim::keys;

use super::Inflow;
use super::filling::{Filling, Readings};
use super::rises::rises;
use crate::evaluation::noise;
use crate::transient::{POSITION, PRESSURES, Transient};

/// A rise of the filling counts when it is more than this, standard deviations of its noise.
const BAND: f64 = 6.5;

/// A rise begins and ends at extremes of the noise, which may lengthen it by this, standard deviations.
const LENGTHENED: f64 = 2.0;

/// Parts of the measured amount that may not be air, and that may be missing.
const HOTTER: f64 = 0.015;
const MISSING: f64 = 0.005;

/// Samples in a period of the dither, at least: with fewer its ripple cannot be followed.
const FEWEST_IN_A_PERIOD: f64 = 6.0;

/// The chambers of a cylinder, to compute air from pressures, and the dither that moves it in and out.
#[derive(Clone, Copy, Debug)]
pub struct Chambers {
    actuator: Actuator,
    gas: Gas,
    /// Temperature of the supply, K.
    temperature: f64,
    /// Frequency of the operator's dither, Hz; None without one.
    dither_hz: Option<f64>,
    /// Range of the pressure converters, kPa.
    range_kpa: [f64; 2],
    /// Positions between which no spear of a cushion is between sensor and chamber, mm.
    seen_mm: [f64; 2],
}

impl Chambers {
    /// The chambers of a rig.
    #[must_use]
    pub fn of(rig: &Rig) -> Chambers {
        let dithers =
            rig.get(&keys::operator::MODEL).is_solenoid() && rig.get(&keys::dither::DITHER_MM) > 0.0;
        Chambers {
            actuator: Actuator::of(rig),
            gas: Gas::new(
                rig.get(&keys::gas::HEAT_CAPACITY_RATIO),
                rig.get(&keys::gas::GAS_CONSTANT_J_PER_KG_K),
            ),
            temperature: rig.get(&keys::supply::TEMPERATURE_K),
            dither_hz: dithers.then(|| rig.get(&keys::dither::DITHER_HZ)).filter(|hz| *hz > 0.0),
            range_kpa: [&keys::sensors::PRESSURE_MIN_PA, &keys::sensors::PRESSURE_MAX_PA]
                .map(|key| rig.get(key) / 1e3),
            seen_mm: cushion::between(rig).map(|m| 1e3 * m),
        }
    }

    /// Samples in a period of the dither; None without one.
    fn samples_in_a_period(&self, transient: &Transient) -> Option<f64> {
        self.dither_hz.map(|hz| 1.0 / (hz * transient.period_s()))
    }

    /// Whether the samples of a transient are close enough to follow the dither: six to its period at least.
    #[must_use]
    pub fn follows_dither(&self, transient: &Transient) -> bool {
        self.samples_in_a_period(transient).is_none_or(|samples| samples >= FEWEST_IN_A_PERIOD)
    }

    /// The known quantities of both chambers at each sample.
    fn readings(&self, transient: &Transient) -> [Readings; 2] {
        let channels = &transient.channels;
        let noise =
            |channel: usize, step: f64| noise::deviation(&channels[channel]).max(step / 12_f64.sqrt());
        let volumes: Vec<[f64; 2]> = channels[POSITION]
            .iter()
            .map(|mm| self.actuator.volumes(mm / 1e3, 0.0).map(|chamber| chamber.volume))
            .collect();
        let leak: Vec<f64> = channels[PRESSURES[0]]
            .iter()
            .zip(&channels[PRESSURES[1]])
            .map(|(one, two)| {
                self.actuator.leakage.at_pressures(&self.gas, [1e3 * one, 1e3 * two], self.temperature)
            })
            .collect();
        let areas = [self.actuator.area_1, self.actuator.area_2];
        [(0, -1.0), (1, 1.0)].map(|(i, into)| Readings {
            time: transient.time.clone(),
            pressure: channels[PRESSURES[i]].iter().map(|kpa| 1e3 * kpa).collect(),
            volume: volumes.iter().map(|both| both[i]).collect(),
            leak: leak.iter().map(|flow| into * flow).collect(),
            pressure_noise: 1e3 * noise(PRESSURES[i], transient.pressure_step_kpa),
            volume_noise: areas[i] * 1e-3 * noise(POSITION, transient.mm_per_count),
        })
    }
}

/// Air let in up to each sample of a record whose samples follow the dither.
pub(super) fn course(transient: &Transient, chambers: &Chambers) -> Inflow {
    let in_a_period = chambers.samples_in_a_period(transient);
    let (n, gas) = (chambers.gas.heat_capacity_ratio, chambers.gas.gas_constant * chambers.temperature);
    let readings = chambers.readings(transient);
    let [one, two] = [0, 1].map(|i| match chambers.actuator.is_vented(i) {
        true => Seen::nothing(transient.time.len()),
        false => Seen::of(&Filling::of(&readings[i], n, gas), in_a_period),
    });
    let both = |of: fn(&Seen) -> &Vec<f64>| of(&one).iter().zip(of(&two)).map(|(a, b)| a + b).collect();
    Inflow {
        best: both(|seen| &seen.best),
        least: both(|seen| &seen.least),
        most: both(|seen| &seen.most),
        beyond: beyond(transient, chambers),
    }
}

/// Whether a pressure is at an end of its converter's range, or the load in a cushion, whose air no sensor sees.
fn beyond(transient: &Transient, Chambers { range_kpa, seen_mm: [low, high], .. }: &Chambers) -> Vec<bool> {
    let [one, two] = PRESSURES.map(|channel| &transient.channels[channel]);
    let at_an_end =
        |kpa: &f64| range_kpa.iter().any(|end| (kpa - end).abs() < transient.pressure_step_kpa / 2.0);
    let is_cushioned = |mm: &f64| mm < low || mm > high;
    let pressures = one.iter().zip(two).map(|(one, two)| at_an_end(one) || at_an_end(two));
    pressures
        .zip(&transient.channels[POSITION])
        .map(|(at_an_end, mm)| at_an_end || is_cushioned(mm))
        .collect()
}

/// Air let into a chamber up to each sample, kg.
struct Seen {
    best: Vec<f64>,
    least: Vec<f64>,
    most: Vec<f64>,
}

impl Seen {
    /// Of a chamber that the supply does not feed.
    fn nothing(samples: usize) -> Seen {
        let [best, least, most] = std::array::from_fn(|_| vec![0.0; samples]);
        Seen { best, least, most }
    }

    fn of(filling: &Filling, samples_in_a_period: Option<f64>) -> Seen {
        let (seen, _) = above_noise(filling);
        let (smooth, at_ends) = above_noise(&filling.smoothed());
        let [even, odd] =
            [0, 1].map(|from| spread(&above_noise(&filling.every_other(from)).0, from, seen.len()));
        let hidden = hidden(filling, samples_in_a_period);
        let gained = |k: usize| seen[k] - (even[k] + odd[k]) / 2.0;
        let at_most = |k: usize| (1.0 + MISSING) * seen[k] + gained(k) + hidden[k];
        Seen {
            best: (0..seen.len()).map(|k| seen[k] + gained(k) / 3.0).collect(),
            least: smooth.iter().zip(&at_ends).map(|(sum, ends)| (1.0 - HOTTER) * (sum - ends)).collect(),
            most: (0..seen.len()).map(at_most).collect(),
        }
    }
}

/// The rises of a filling, and by how much noise may have lengthened them, kg.
fn above_noise(filling: &Filling) -> (Vec<f64>, Vec<f64>) {
    let bands: Vec<f64> = filling.noise.iter().map(|noise| BAND * noise).collect();
    let found = rises(&filling.mass, &bands);
    let at_ends = found.bands.iter().map(|bands| LENGTHENED / BAND * bands).collect();
    (found.sum, at_ends)
}

/// What every other sample tells, from `from` on, at all of them.
fn spread(values: &[f64], from: usize, samples: usize) -> Vec<f64> {
    (0..samples)
        .map(|k| k.checked_sub(from).map_or(0.0, |k| values.get(k / 2).copied().unwrap_or(0.0)))
        .collect()
}

/// The air that a ripple of the dither may have let in unseen up to each sample, kg: in each period in which the
/// filling stays within its noise, as much as that noise.
fn hidden(filling: &Filling, samples_in_a_period: Option<f64>) -> Vec<f64> {
    let Some(samples) = samples_in_a_period else { return vec![0.0; filling.mass.len()] };
    let samples = samples.round() as usize;
    let (mut sum, mut sums) = (0.0, Vec::with_capacity(filling.mass.len()));
    for (masses, noises) in filling.mass.chunks(samples).zip(filling.noise.chunks(samples)) {
        let low = masses.iter().copied().fold(f64::INFINITY, f64::min);
        let high = masses.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let band = BAND * noises[0];
        let part = if high - low < band { band / samples as f64 } else { 0.0 };
        sums.extend(masses.iter().map(|_| {
            sum += part;
            sum
        }));
    }
    sums
}
