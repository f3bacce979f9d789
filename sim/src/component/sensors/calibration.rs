//! The errors of scale and offset of the sensors: their readings of a true value, SI.
//!
//! ```text
//! position     x / (1 + e) + o           e: how much longer a count is than the file says
//! pressures    p (1 + e) + o             absolute, each sensor with its own e and o
//! spool        y (1 + e) + o
//! ```
//!
//! The controller knows none of them. Their keys are among those of the encoder and the sensors. Without errors,
//! readings are true in every bit.

use crate::key::Typed;
use crate::keys::{encoder, sensors};
use crate::values::Rig;

/// The readings of the sensors at a sample without noise and quantisation, SI. With a channel skew the second
/// pressure and the spool are from slightly after the sample's instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// m.
    pub position: f64,
    /// Absolute chamber pressures, Pa.
    pub pressures: [f64; 2],
    /// m.
    pub spool: f64,
}

/// A sensor's reading of a true value: a straight line.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Line {
    gain: f64,
    offset: f64,
}

impl Line {
    fn read(self, true_value: f64) -> f64 {
        true_value * self.gain + self.offset
    }

    fn true_value(self, read: f64) -> f64 {
        (read - self.offset) / self.gain
    }
}

/// The calibration errors of a rig's sensors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    position: Line,
    pressures: [Line; 2],
    spool: Line,
}

impl Calibration {
    /// The errors by the values of their keys.
    #[must_use]
    pub fn of(number: impl Fn(&Typed<f64>) -> f64) -> Calibration {
        let gain = |key| 1.0 + 1e-2 * number(key);
        let pressure = |error, offset| Line { gain: gain(error), offset: number(offset) };
        Calibration {
            position: Line {
                gain: 1.0 / gain(&encoder::SCALE_ERROR_PERCENT),
                offset: 1e-3 * number(&encoder::OFFSET_ERROR_MM),
            },
            pressures: [
                pressure(&sensors::PRESSURE_1_GAIN_ERROR_PERCENT, &sensors::PRESSURE_1_OFFSET_ERROR_PA),
                pressure(&sensors::PRESSURE_2_GAIN_ERROR_PERCENT, &sensors::PRESSURE_2_OFFSET_ERROR_PA),
            ],
            spool: Line {
                gain: gain(&sensors::SPOOL_GAIN_ERROR_PERCENT),
                offset: 1e-3 * number(&sensors::SPOOL_OFFSET_ERROR_MM),
            },
        }
    }

    /// The errors of a rig's sensors.
    #[must_use]
    pub fn of_rig(rig: &Rig) -> Calibration {
        Calibration::of(|key| rig.get(key))
    }

    /// Whether the readings are true.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        let lines = [self.position, self.pressures[0], self.pressures[1], self.spool];
        lines.iter().all(|line| *line == Line { gain: 1.0, offset: 0.0 })
    }

    /// The sensors' readings of true values.
    #[must_use]
    pub fn read(&self, of: &Reading) -> Reading {
        Reading {
            position: self.position.read(of.position),
            pressures: std::array::from_fn(|i| self.pressures[i].read(of.pressures[i])),
            spool: self.spool.read(of.spool),
        }
    }

    /// The true position (m) and pressures (Pa) behind these readings.
    #[must_use]
    pub fn true_values(&self, position: f64, pressures: [f64; 2]) -> (f64, [f64; 2]) {
        let pressures = std::array::from_fn(|i| self.pressures[i].true_value(pressures[i]));
        (self.position.true_value(position), pressures)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::sensors::Sensors;

    fn rig(keys: &str) -> Rig {
        Rig::read("test", keys).expect("valid")
    }

    const WRONG: &str = "[encoder]\nscale_error_percent = 0.5\noffset_error_mm = 0.2\n[sensors]\npressure_1_gain_error_percent = 2.0\npressure_2_offset_error_pa = -3000.0\nspool_gain_error_percent = -1.0\n";

    #[test]
    fn a_count_that_is_longer_than_the_file_says_is_read_as_a_shorter_travel() {
        let (calibration, of) = (
            Calibration::of_rig(&rig(WRONG)),
            Reading { position: 0.201, pressures: [5e5, 4e5], spool: 1e-3 },
        );
        let read = calibration.read(&of);
        assert!((read.position - 0.2002).abs() < 1e-12, "{read:?}");
        assert!((read.pressures[0] - 5.1e5).abs() < 1e-6 && (read.pressures[1] - 3.97e5).abs() < 1e-6);
        assert!((read.spool - 0.99e-3).abs() < 1e-15);
        let (position, pressures) = calibration.true_values(read.position, read.pressures);
        assert!((position - of.position).abs() < 1e-12 && (pressures[0] - 5e5).abs() < 1e-6);
    }

    #[test]
    fn the_sensors_of_a_rig_with_wrong_scales_count_accordingly() {
        let read = |keys: &str| Sensors::new(&rig(keys), 1).read(0.201, [5e5, 4e5], 1e-3);
        let (exact, wrong) = (read(""), read(WRONG));
        assert_eq!(wrong.position, (0.2002 / 0.01205e-3) as i32);
        assert_eq!(f64::from(wrong.pressure_1), (5.1e5f64 / 1e6 * 4095.0).round());
        assert_ne!(exact.pressure_2, wrong.pressure_2);
        assert!(Calibration::of_rig(&rig("")).is_exact() && !Calibration::of_rig(&rig(WRONG)).is_exact());
    }
}
