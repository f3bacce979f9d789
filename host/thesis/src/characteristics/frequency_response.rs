//! Frequency response of the spool (7.1.2.3): the spool under a sine of commands, frequency by frequency.
//!
//! The commands are whole counts, a fixed number of them per period. Gain and phase are those of the fundamental of
//! the spool over the fundamental of the commands themselves, so neither their rounding nor their steps count. A
//! linear operator follows its transfer function:
//!
//! ```text
//! empirical (6.32)   K_S / (s^2 + K_D s + K_S)
//! analytical (6.33)  G_s / (M s^2 + D s + K)         without friction and hysteresis
//! ```
//!
//! The response is measured on a grid of frequencies. The frequency of the largest gain, and the frequencies at which
//! gain and phase pass a level, are then located between neighbouring points of the grid by more measurements.

use pneudrive_sim::keys;
use std::f64::consts::PI;

use super::bench::{SpoolBench, decay_s, natural_hz};
use super::{Characteristic, Figure, Graph, Reading, Unfit};
use pneudrive_report::Curve;
use pneudrive_sim::Rig;
use pneudrive_sim::component::dither::Dither;

pub(super) const ABOUT: &str = "gain and phase of the spool under a swept sine (7.1.2.3)";

/// Commands in a period.
const STEPS: usize = 64;

/// Readings in a period.
const READINGS: usize = 4 * STEPS;

/// The sine's amplitude, counts: 0.4 mm, so that the spool stays within its travel at a resonance of 2.5.
const AMPLITUDE: f64 = 819.0;

/// Gain and phase of the spool at one frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response {
    /// Amplitude of the spool over the amplitude of the command.
    pub gain: f64,
    /// Phase, radians; negative where the spool lags.
    pub phase: f64,
}

/// Real and imaginary part of a fundamental.
type Phasor = [f64; 2];

/// The response of a rig's operator without dither, to a sine of `amplitude` counts.
///
/// # Errors
/// When the spool cannot be followed.
pub fn response(rig: &Rig, frequency_hz: f64, amplitude: f64) -> Result<Response, Unfit> {
    let still = Dither { amplitude: 0.0, ..Dither::of(rig) };
    let mut bench = SpoolBench::new(rig, Some(still));
    let period = 1.0 / frequency_hz;
    let command = |step: usize| (amplitude * (2.0 * PI * step as f64 / STEPS as f64).sin()).round();
    let mut cycle = || -> Result<Vec<f64>, Unfit> {
        let mut spool = Vec::with_capacity(READINGS);
        for step in 0..STEPS {
            bench.drive(command(step) as i16);
            spool.extend(bench.watch(period / STEPS as f64, READINGS / STEPS)?);
        }
        Ok(spool)
    };
    // Until what the start has stirred up has gone: half a second, ten decays, and three periods at least.
    let periods = ((0.5_f64.max(10.0 * decay_s(rig)) * frequency_hz).ceil() as usize).max(3);
    for _ in 0..periods {
        cycle()?;
    }
    let spool = cycle()?;
    let per_count = rig.get(&keys::valve::SPOOL_TRAVEL_MM) * 1e-3 / 2048.0;
    let commands: Vec<f64> = (0..READINGS).map(|i| command(i * STEPS / READINGS) * per_count).collect();
    let (input, output) = (fundamental(&commands), fundamental(&spool));
    let phase = output[1].atan2(output[0]) - input[1].atan2(input[0]);
    Ok(Response {
        gain: output[0].hypot(output[1]) / input[0].hypot(input[1]),
        phase: if phase > 1e-6 { phase - 2.0 * PI } else { phase },
    })
}

/// The fundamental of one period of readings, each in the middle of its part.
fn fundamental(values: &[f64]) -> Phasor {
    let mut sum = [0.0; 2];
    for (i, value) in values.iter().enumerate() {
        let angle = 2.0 * PI * (i as f64 + 0.5) / values.len() as f64;
        sum[0] += value * angle.cos();
        sum[1] -= value * angle.sin();
    }
    sum
}

/// The lowest frequency of the grid, Hz. Its highest one is three times the natural frequency of the spool, and at
/// least the next value. The last value is the ratio of two neighbouring frequencies.
const LOWEST_HZ: f64 = 2.0;
const HIGHEST_HZ: f64 = 300.0;
const APART: f64 = 1.133_4;

/// A location between two neighbouring frequencies is accurate to this part.
const FOUND: f64 = 1e-3;

/// Parts of a frequency and of a gain (dB) to which they are known: the response is within 0.2 % of a linear spool's.
const HZ_WITHIN: f64 = 5e-3;
const DB_WITHIN: f64 = 0.02;

/// The responses of a rig's operator to a sine of one amplitude.
struct Bode<'a> {
    rig: &'a Rig,
    amplitude: f64,
    frequencies: &'a [f64],
    responses: Vec<Response>,
}

impl Bode<'_> {
    fn of<'a>(rig: &'a Rig, amplitude: f64, frequencies: &'a [f64]) -> Result<Bode<'a>, Unfit> {
        let responses = frequencies.iter().map(|&frequency| response(rig, frequency, amplitude));
        Ok(Bode { rig, amplitude, frequencies, responses: responses.collect::<Result<_, _>>()? })
    }

    fn at(&self, frequency_hz: f64) -> Result<Response, Unfit> {
        response(self.rig, frequency_hz, self.amplitude)
    }

    /// The largest gain, dB, and where it is, Hz, if that is not at an end of the grid.
    fn resonance(&self) -> Result<[Reading; 2], Unfit> {
        let gain = |i: &usize| self.responses[*i].gain;
        let peak = (0..self.responses.len()).max_by(|a, b| gain(a).total_cmp(&gain(b))).unwrap_or(0);
        // A spool that its friction holds has no gain.
        let decibels = |gain: f64| match gain > 0.0 {
            true => Reading::Read { value: 20.0 * gain.log10(), within: DB_WITHIN },
            false => self.nowhere(),
        };
        if peak == 0 || peak + 1 == self.frequencies.len() {
            return Ok([decibels(gain(&peak)), self.nowhere()]);
        }
        let (mut low, mut high) = (self.frequencies[peak - 1], self.frequencies[peak + 1]);
        // By thirds of the bracket: each step leaves two of them.
        while high / low > 1.0 + FOUND {
            let third = (high / low).cbrt();
            let [one, two] = [self.at(low * third)?.gain, self.at(high / third)?.gain];
            if one < two { low *= third } else { high /= third }
        }
        let middle = (low * high).sqrt();
        Ok([decibels(self.at(middle)?.gain), found(middle)])
    }

    /// The lowest frequency at which `falls` comes down through zero, Hz.
    fn passes(&self, falls: impl Fn(Response) -> f64) -> Result<Reading, Unfit> {
        let below = |response: &Response| falls(*response) < 0.0;
        let Some(after) = self.responses.windows(2).position(|pair| !below(&pair[0]) && below(&pair[1]))
        else {
            return Ok(self.nowhere());
        };
        let (mut low, mut high) = (self.frequencies[after], self.frequencies[after + 1]);
        while high / low > 1.0 + FOUND {
            let middle = (low * high).sqrt();
            if below(&self.at(middle)?) { high = middle } else { low = middle }
        }
        Ok(found((low * high).sqrt()))
    }

    fn nowhere(&self) -> Reading {
        Reading::NotBetween([self.frequencies[0], self.frequencies[self.frequencies.len() - 1]])
    }

    fn figures(&self, name: &str) -> Result<Vec<Figure>, Unfit> {
        let still = self.responses[0].gain;
        let [gain, frequency] = self.resonance()?;
        let half_power = self.passes(|response| response.gain - still * 0.5_f64.sqrt())?;
        let quarter_turn = self.passes(|response| response.phase + PI / 2.0)?;
        let figure =
            |what: String, reading, unit| Figure { name: format!("{what} at {name}"), reading, unit };
        Ok(vec![
            figure("largest gain".to_owned(), gain, "dB"),
            figure("its frequency".to_owned(), frequency, "Hz"),
            figure(format!("-3 dB of the gain at {LOWEST_HZ} Hz,"), half_power, "Hz"),
            figure("-90 degrees".to_owned(), quarter_turn, "Hz"),
        ])
    }
}

fn found(frequency_hz: f64) -> Reading {
    Reading::Read { value: frequency_hz, within: HZ_WITHIN * frequency_hz }
}

/// The grid of frequencies, Hz.
fn grid(rig: &Rig) -> Vec<f64> {
    let highest = HIGHEST_HZ.max(3.0 * natural_hz(rig));
    let steps = ((highest / LOWEST_HZ).ln() / APART.ln()).ceil();
    (0..=steps as i32).map(|i| LOWEST_HZ * (highest / LOWEST_HZ).powf(f64::from(i) / steps)).collect()
}

pub(super) fn measure(rig: &Rig) -> Result<Characteristic, Unfit> {
    if !rig.get(&keys::operator::MODEL).is_solenoid() {
        return Err(Unfit::NoPart(
            "its operator has no moving mass: a spool that follows at once has no response",
        ));
    }
    let frequencies = grid(rig);
    let mut graphs = [("gain, dB", Vec::new()), ("phase, degrees", Vec::new())];
    let mut figures = Vec::new();
    for part in [1.0, 0.5] {
        let amplitude = part * AMPLITUDE;
        let name = format!("{:.3} mm", amplitude / 2048.0 * rig.get(&keys::valve::SPOOL_TRAVEL_MM));
        let bode = Bode::of(rig, amplitude, &frequencies)?;
        figures.extend(bode.figures(&name)?);
        let y = |of: &dyn Fn(&Response) -> f64| bode.responses.iter().map(of).collect();
        let gains = y(&|response| 20.0 * response.gain.log10());
        graphs[0].1.push(Curve::new(&name, frequencies.clone(), gains));
        let phases = y(&|response| response.phase.to_degrees());
        graphs[1].1.push(Curve::new(&name, frequencies.clone(), phases));
    }
    Ok(Characteristic {
        notes: vec!["A sine of commands without dither; the fundamental of the spool over that of the commands. Friction and hysteresis make the response depend on the amplitude.".to_owned()],
        across: "frequency, Hz",
        logarithmic: true,
        graphs: graphs.map(|(title, series)| Graph { title, series }).into(),
        figures,
    })
}

#[cfg(test)]
mod tests {
    use super::super::servo_b as rig;
    use super::*;

    /// |k / (k - w^2 + j d w)| and its angle.
    fn oscillator(k: f64, d: f64, w: f64) -> Response {
        Response { gain: k / (k - w * w).hypot(d * w), phase: -(d * w).atan2(k - w * w) }
    }

    fn agrees(rig: &Rig, frequency: f64, k: f64, d: f64) {
        let found = response(rig, frequency, AMPLITUDE / 4.0).expect("it can be followed");
        let expected = oscillator(k, d, 2.0 * PI * frequency);
        assert!(
            (found.gain / expected.gain - 1.0).abs() < 2e-3,
            "{frequency} Hz: {found:?} for {expected:?}"
        );
        assert!((found.phase - expected.phase).abs() < 2e-3, "{frequency} Hz: {found:?} for {expected:?}");
    }

    #[test]
    fn a_spool_that_its_friction_holds_has_no_largest_gain() {
        let held = rig(&["operator.static_friction_n=90", "operator.coulomb_friction_n=90"]);
        let found = measure(&held).expect("it can be followed");
        let gains = found.figures.iter().filter(|figure| figure.name.starts_with("largest gain"));
        let readings: Vec<Reading> = gains.map(|figure| figure.reading).collect();
        assert!(readings.iter().all(|reading| matches!(reading, Reading::NotBetween(_))), "{readings:?}");
        assert_eq!(readings.len(), 2);
    }

    #[test]
    fn the_empirical_spool_follows_its_transfer_function() {
        let linear = rig(&["operator.model=\"solenoid-empirical\"", "operator.hysteresis_percent=0"]);
        for frequency in [3.0, 20.0, 30.2, 60.0] {
            agrees(&linear, frequency, 36_000.0, 100.0);
        }
    }

    #[test]
    fn the_analytical_spool_without_friction_and_slack_follows_its_transfer_function() {
        let linear = rig(&[
            "operator.static_friction_n=0",
            "operator.coulomb_friction_n=0",
            "operator.hysteresis_percent=0",
            "operator.damping_n_s_per_m=24",
        ]);
        for frequency in [10.0, 100.0, 166.0, 250.0] {
            agrees(&linear, frequency, 25e3 / 0.023, 24.0 / 0.023);
        }
    }

    /// Without friction and slack, with a natural frequency (Hz) and a damping ratio.
    fn linear(natural_hz: f64, ratio: f64) -> Rig {
        let k = (2.0 * PI * natural_hz).powi(2);
        rig(&[
            "operator.model=\"solenoid-empirical\"",
            "operator.hysteresis_percent=0",
            &format!("operator.stiffness_per_mass_per_s2={k:?}"),
            &format!("operator.damping_per_s={:?}", 2.0 * ratio * k.sqrt()),
        ])
    }

    /// f_r = f sqrt(1 - 2 z^2), its gain 1 / (2 z sqrt(1 - z^2)); -90 degrees at f; -3 dB at f sqrt(u), where
    /// (1 - u)^2 + 4 z^2 u = 2.
    #[test]
    fn the_figures_of_a_linear_spool_are_those_of_its_transfer_function() {
        for (natural_hz, ratio) in [(30.2, 0.26), (97.0, 0.45), (166.0, 0.3), (400.0, 0.35)] {
            let found = measure(&linear(natural_hz, ratio)).expect("it can be followed").figures;
            let z2 = ratio * ratio;
            let u = 1.0 - 2.0 * z2 + ((1.0 - 2.0 * z2).powi(2) + 1.0).sqrt();
            let expected = [
                -20.0 * (2.0 * ratio * (1.0 - z2).sqrt()).log10(),
                natural_hz * (1.0 - 2.0 * z2).sqrt(),
                natural_hz * u.sqrt(),
                natural_hz,
            ];
            for (figure, expected) in found.iter().zip(expected) {
                let Reading::Read { value, within } = figure.reading else {
                    panic!("{natural_hz} Hz: {figure:?}")
                };
                assert!(
                    (value - expected).abs() < within,
                    "{natural_hz} Hz, {ratio}: {figure:?} for {expected}"
                );
            }
        }
    }

    #[test]
    fn what_is_not_within_the_range_is_said_to_be_outside_it() {
        let figures = measure(&linear(1.2, 1.5)).expect("it can be followed").figures;
        let [highest, resonance, _, quarter_turn] = &figures[..4] else { panic!("four figures") };
        assert!(highest.value().is_some_and(|decibels| decibels < 0.0), "{highest:?}");
        for outside in [resonance, quarter_turn] {
            assert_eq!(outside.reading, Reading::NotBetween([2.0, 300.0]), "{outside:?}");
        }
    }

    #[test]
    fn stiction_holds_a_small_sine_back_more_than_a_large_one() {
        let [small, large] = [0.25, 1.0]
            .map(|part| response(&rig(&[]), 10.0, part * AMPLITUDE).expect("it can be followed").gain);
        assert!(small < 0.8 * large, "{small} {large}");
    }
}
