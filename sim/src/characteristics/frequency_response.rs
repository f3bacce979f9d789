//! Frequency response of the spool (7.1.2.3): the spool under a sine of commands, frequency by frequency.
//!
//! The commands are whole counts, so many of them a period; gain and phase are those of the fundamental
//! of the spool over that of the commands themselves, so that neither their rounding nor their steps count.
//! A linear operator follows its transfer function:
//!
//! ```text
//! empirical (6.32)   K_S / (s^2 + K_D s + K_S)
//! analytical (6.33)  G_s / (M s^2 + D s + K)         without friction and hysteresis
//! ```

use std::f64::consts::PI;

use super::bench::SpoolBench;
use super::{Characteristic, Figure, Graph, Series, Unfit};
use crate::build;
use crate::dither::Dither;
use crate::rig::Rig;

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
    /// Amplitude of the spool over that of the command.
    pub gain: f64,
    /// Radians, negative where the spool lags.
    pub phase: f64,
}

/// Real and imaginary part of a fundamental.
type Phasor = [f64; 2];

/// The response of a rig's operator without dither, to a sine of `amplitude` counts.
///
/// # Errors
/// When the spool cannot be followed.
pub fn response(rig: &Rig, frequency_hz: f64, amplitude: f64) -> Result<Response, Unfit> {
    let still = Dither { amplitude: 0.0, ..build::dither(rig) };
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
    // Until what the start has stirred up has gone: half a second, and three periods at least.
    let periods = ((0.5 * frequency_hz).ceil() as usize).max(3);
    for _ in 0..periods {
        cycle()?;
    }
    let spool = cycle()?;
    let per_count = rig.number("valve.spool_travel_mm") * 1e-3 / 2048.0;
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

pub(super) fn measure(rig: &Rig) -> Result<Characteristic, Unfit> {
    if !rig.word("operator.model").starts_with("solenoid") {
        return Err(Unfit::NoPart(
            "its operator has no moving mass: a spool that follows at once has no response",
        ));
    }
    let frequencies: Vec<f64> = (0..=40).map(|i| 2.0 * 150.0_f64.powf(f64::from(i) / 40.0)).collect();
    let mut graphs = [("gain, dB", Vec::new()), ("phase, degrees", Vec::new())];
    let mut figures = Vec::new();
    for part in [1.0, 0.5] {
        let amplitude = part * AMPLITUDE;
        let name = format!("{:.2} mm", amplitude / 2048.0 * rig.number("valve.spool_travel_mm"));
        let responses: Result<Vec<Response>, Unfit> =
            frequencies.iter().map(|&frequency| response(rig, frequency, amplitude)).collect();
        let responses = responses?;
        let y = |of: &dyn Fn(&Response) -> f64| responses.iter().map(of).collect();
        let gains: Vec<f64> = y(&|response| 20.0 * response.gain.log10());
        if let Some(peak) = (0..gains.len()).max_by(|&a, &b| gains[a].total_cmp(&gains[b])) {
            figures.push(Figure { name: format!("largest gain at {name}"), value: gains[peak], unit: "dB" });
            figures.push(Figure {
                name: format!("its frequency at {name}"),
                value: frequencies[peak],
                unit: "Hz",
            });
        }
        graphs[0].1.push(Series { name: name.clone(), x: frequencies.clone(), y: gains });
        let phases = y(&|response| response.phase.to_degrees());
        graphs[1].1.push(Series { name, x: frequencies.clone(), y: phases });
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

    #[test]
    fn stiction_holds_a_small_sine_back_more_than_a_large_one() {
        let [small, large] = [0.25, 1.0]
            .map(|part| response(&rig(&[]), 10.0, part * AMPLITUDE).expect("it can be followed").gain);
        assert!(small < 0.8 * large, "{small} {large}");
    }
}
