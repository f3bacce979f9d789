//! The sensors of a drive at rest.
//!
//! | reading of a pressure | means |
//! |---|---|
//! | stays at or below `sensor_low_raw` | an open wire, which the pull-down holds at 0 |
//! | at or above `sensor_high_raw` | a short, or a transmitter beyond its range |
//! | varies by more than a tenth of the range | an open input without a pull-down, which picks up the mains |
//!
//! The variation is the difference of a reading from the mean of the readings before and after it, so that air which
//! settles slowly does not count as noise. The dither of a valve also makes the pressures hum, by a few percent.
//! Readings that still seem wrong are repeated a second later. Without pressure sensors there is nothing to read.

use std::time::Duration;

use anyhow::Result;
use pneudrive_controller::parameters::id;

use super::{BringUp, Check};

/// The number of readings at rest, and the alternating pauses between them, ms. Whatever time the port takes to
/// answer, the readings do not all fall on the same phase of the mains, which would hide its hum.
const READINGS: usize = 40;
const PAUSES_MS: [u64; 3] = [2, 7, 13];

/// How long air may take to settle before sensors are read again, and how often they are read at most.
const SETTLING: Duration = Duration::from_secs(1);
const ROUNDS: usize = 3;

/// A pressure at rest varies by less than this part of the range.
const QUIET: f64 = 0.1;

/// The names of the two channels, and their wires on the Nucleo.
pub(super) const CHANNELS: [&str; 2] =
    ["pressure 1 (blind side; A5 of the Nucleo)", "pressure 2 (rod side; A4)"];

impl BringUp<'_> {
    /// Reads the sensors of the drive for a while, and again if air may still settle.
    pub(super) fn check_rest(&mut self) -> Result<()> {
        const NAME: &str = "sensors at rest";
        if !self.measures_pressures() {
            let why = "the drive has no pressure sensors (sensors.pressure = false)";
            self.note(Check::left_out(NAME, why));
            return Ok(());
        }
        let low = self.parameter(id::SENSOR_LOW_RAW).unwrap_or(-1);
        let high = self.parameter(id::SENSOR_HIGH_RAW).unwrap_or(i32::MAX);
        let full_scale = f64::from((1u32 << self.parameter(id::SENSOR_BITS).unwrap_or(12).clamp(1, 15)) - 1);
        let judged = |readings: &[Vec<i32>; 2]| -> Vec<String> {
            let channels = CHANNELS.iter().zip(readings);
            let judged = channels
                .filter_map(|(name, readings)| Some((name, judge(readings, [low, high], full_scale)?)));
            judged.map(|(name, why)| format!("{name}: {why}")).collect()
        };
        let mut readings = self.read_pressures(Duration::ZERO)?;
        for _ in 1..ROUNDS {
            if judged(&readings).is_empty() {
                break;
            }
            readings = self.read_pressures(SETTLING)?;
        }
        let mut saw = Vec::from(readings.each_ref().map(|readings| {
            let (least, most) = ends(readings);
            format!("{} to {}", self.units.pressure(least as i16), self.units.pressure(most as i16))
        }));
        if low < 0 && high >= i32::from(i16::MAX) {
            saw.push("their range is not watched (sensor_low_raw, sensor_high_raw are off)".to_owned());
        }
        let did = format!("read both pressures {READINGS} times, drive disabled");
        let must = format!(
            "raw above {low} and below {high}, to and fro by less than {:.0} % of the range",
            100.0 * QUIET
        );
        self.note(Check::of(NAME, &did, saw.join("; "), &must, judged(&readings)));
        Ok(())
    }

    /// Readings of both pressures, after a pause.
    fn read_pressures(&mut self, pause: Duration) -> Result<[Vec<i32>; 2]> {
        std::thread::sleep(pause);
        let mut readings = [const { Vec::new() }; 2];
        for pause_ms in PAUSES_MS.into_iter().cycle().take(READINGS) {
            let status = self.look()?;
            readings[0].push(status.pressure_1.into());
            readings[1].push(status.pressure_2.into());
            std::thread::sleep(Duration::from_millis(pause_ms));
        }
        Ok(readings)
    }
}

/// The smallest and the largest reading.
fn ends(readings: &[i32]) -> (i32, i32) {
    let ends = |of: &dyn Fn(i32, i32) -> i32| readings.iter().copied().reduce(of).unwrap_or(0);
    (ends(&i32::min), ends(&i32::max))
}

/// The problem with readings, if the range between `low` and `high` is watched.
fn judge(readings: &[i32], [low, high]: [i32; 2], full_scale: f64) -> Option<String> {
    let (least, most) = ends(readings);
    let to_and_fro =
        readings.windows(3).map(|three| f64::from(2 * three[1] - three[0] - three[2]).abs() / 2.0);
    if to_and_fro.fold(0.0, f64::max) > QUIET * full_scale {
        Some(format!(
            "swings between {least} and {most}: the input is open and has no pull-down (100 kΩ to GND), or the line picks up the mains; connect the transmitter, check its ground and shield"
        ))
    } else if most <= low {
        Some(format!("reads {most}: its wire is open, or the transmitter has no supply"))
    } else if least >= high {
        Some(format!("reads {least}: its wire is shorted to the supply, or the pressure is beyond its range"))
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn open_shorted_and_floating_inputs_are_told_apart() {
        let judged = |readings: &[i32]| judge(readings, [63, 4032], 4095.0);
        assert_eq!(judged(&[1600, 1640, 1620, 1600]), None);
        assert!(judged(&[0, 3, 0]).expect("wrong").contains("wire is open"));
        assert!(judged(&[4095, 4090, 4095]).expect("wrong").contains("shorted"));
        assert!(judged(&[1000, 1500, 1000]).expect("wrong").contains("no pull-down"));
        assert_eq!(judge(&[0, 3, 0], [-1, 32_767], 4095.0), None, "a rig without transmitters");
    }

    /// The dither of a valve at its null, 154 counts of pressure from peak to peak, was once taken for an open input.
    #[test]
    fn the_hum_of_dither_is_no_open_input() {
        assert_eq!(judge(&[1296, 1450, 1296, 1450], [63, 4032], 4095.0), None);
    }

    /// A port whose answers take 13 ms: with pauses of 7 ms alone it would read every 20 ms, always at the same phase
    /// of 50 Hz.
    #[test]
    fn the_hum_of_the_mains_is_seen_through_a_port_of_any_latency() {
        for latency_ms in 0..40 {
            let mut time_s = 0.0;
            let hum = PAUSES_MS.iter().cycle().take(READINGS).map(|pause_ms| {
                time_s += (latency_ms + pause_ms) as f64 * 1e-3;
                (2048.0 + 1024.0 * (std::f64::consts::TAU * 50.0 * time_s).sin()) as i32
            });
            let hum: Vec<i32> = hum.collect();
            assert!(judge(&hum, [63, 4032], 4095.0).is_some(), "{latency_ms} ms: {hum:?}");
        }
    }

    #[test]
    fn air_that_settles_is_no_noise() {
        let settling: Vec<i32> = (0..40).map(|k| 1300 + 10 * k).collect();
        assert_eq!(judge(&settling, [63, 4032], 4095.0), None);
    }
}
