//! The sensors and their converter: the readings that the controller gets.
//!
//! ```text
//! raw   = clamp(floor((x - min) / (max - min) (2^bits - 1) + 0.5 + noise), 0, 2^bits - 1)
//! ```
//!
//! as in DESIGN section 4. The noise, in counts, is normal and comes from a seeded generator. A pressure without a
//! sensor is raw 0, and the controller ignores it.

pub mod calibration;

use pneudrive_controller::Sample;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

use crate::component::encoder::Encoder;
use crate::component::{controller, faults};
use crate::key::keys;
use crate::random::normal;
use crate::values::{Findings, Rig, whole_microseconds};
use calibration::{Calibration, Reading};

keys! {
    PRESSURE: bool = switch("sensors.pressure", true, "", "Whether the pressures of both chambers are measured. Without, nothing trips by them, records have none, and the on-off law must not feed them back.");
    PRESSURE_MIN_PA: f64 = number("sensors.pressure_min_pa", 0.0, 0.0, 1e7, "", "Absolute pressure at raw 0.");
    PRESSURE_MAX_PA: f64 = number("sensors.pressure_max_pa", 1_000_000.0, 1.0, 1e8, "", "Absolute pressure at full scale.");
    SPOOL_MIN_MM: f64 = number("sensors.spool_min_mm", -1.25, -1000.0, 1000.0, "", "Spool displacement at raw 0.");
    SPOOL_MAX_MM: f64 = number("sensors.spool_max_mm", 1.25, -1000.0, 1000.0, "", "Spool displacement at full scale.");
    BITS: i64 = integer("sensors.bits", 12, 8, 15, "", "Width of the converter.");
    HOME_SWITCH_MM: Option<f64> = optional_number("sensors.home_switch_mm", -1000.0, 20_000.0, "there is no switch", "", "The homing switch is closed below this position.");
    PRESSURE_LAG_S: f64 = number("sensors.pressure_lag_s", 0.0, 0.0, 1.0, "", "First-order lag of the pressure sensors; 0: none.");
    CHANNEL_SKEW_S: f64 = number("sensors.channel_skew_s", 0.0, 0.0, 0.01, "5.3.1", "Delay between the channels of the converter: it reads pressure 1 with the encoder, pressure 2 this much later, and the spool this much after that; whole microseconds, less than half of controller.delay_s. 0: all at once. About 1e-4 on the thesis's test rig.");
    NOISE_COUNTS: f64 = number("sensors.noise_counts", 0.0, 0.0, 1000.0, "", "Standard deviation of the converter's noise.");
    PRESSURE_1_GAIN_ERROR_PERCENT: f64 = number("sensors.pressure_1_gain_error_percent", 0.0, -20.0, 20.0, "", "What the first sensor reads too much, part of the absolute pressure; the controller does not know it.");
    PRESSURE_1_OFFSET_ERROR_PA: f64 = number("sensors.pressure_1_offset_error_pa", 0.0, -1e6, 1e6, "", "The same at every pressure.");
    PRESSURE_2_GAIN_ERROR_PERCENT: f64 = number("sensors.pressure_2_gain_error_percent", 0.0, -20.0, 20.0, "", "What the second sensor reads too much, part of the absolute pressure; the controller does not know it.");
    PRESSURE_2_OFFSET_ERROR_PA: f64 = number("sensors.pressure_2_offset_error_pa", 0.0, -1e6, 1e6, "", "The same at every pressure.");
    PRESSURE_GAIN_TOLERANCE_PERCENT: f64 = number("sensors.pressure_gain_tolerance_percent", 2.0, 0.0, 20.0, "", "How far the scale of a pressure reading may be from the file's, for identify: transmitter and converter together. 2 is an assumption: transmitters are sold with 0.25 to 1 % of their span, plus drift by temperature, and the reference of a converter has as much again; 0: exact.");
    PRESSURE_OFFSET_TOLERANCE_PA: f64 = number("sensors.pressure_offset_tolerance_pa", 5000.0, 0.0, 1e6, "", "How far the zero of a pressure reading may be off, for identify. 5000 is an assumption: 0.5 % of a span of 1 MPa. A zero that was compared with a barometer has some 200; 0: exact.");
    SPOOL_GAIN_ERROR_PERCENT: f64 = number("sensors.spool_gain_error_percent", 0.0, -20.0, 20.0, "", "What the spool's sensor reads too much, part of the displacement; the controller does not know it.");
    SPOOL_OFFSET_ERROR_MM: f64 = number("sensors.spool_offset_error_mm", 0.0, -10.0, 10.0, "", "What the spool's sensor reads at mid-travel; the controller does not know it.");
    SPOOL_GAIN_TOLERANCE_PERCENT: f64 = number("sensors.spool_gain_tolerance_percent", 1.0, 0.0, 20.0, "", "How far the scale of the spool's sensor may be from the file's, for identify; 1 is an assumption; 0: exact.");
    SPOOL_OFFSET_TOLERANCE_MM: f64 = number("sensors.spool_offset_tolerance_mm", 0.01, 0.0, 10.0, "", "How far the zero of the spool's sensor may be off, for identify; 0.01 is an assumption; 0: exact.");
}

/// The constraints on the ranges.
pub(crate) fn check(rig: &Rig, findings: &mut Findings) {
    let why = "the sensor's range would be empty";
    findings.below(rig, &keys::PRESSURE_MIN_PA, &keys::PRESSURE_MAX_PA, why);
    findings.below(rig, &keys::SPOOL_MIN_MM, &keys::SPOOL_MAX_MM, why);
    check_channel_skew(rig, findings);
    check_without_pressures(rig, findings);
}

/// A law that feeds back pressures, and an event of a pressure sensor, need the sensors.
fn check_without_pressures(rig: &Rig, findings: &mut Findings) {
    if rig.get(&keys::PRESSURE) {
        return;
    }
    let gain = &controller::keys::PRESSURE_FEEDBACK_GAIN;
    if rig.get(gain) != 0.0 {
        let message = format!(
            "must be 0 with sensors.pressure = false, is {}: there are no pressures to feed back; write 0, or give the rig its sensors",
            rig.get(gain)
        );
        findings.note(gain, message);
    }
    if rig.fault_events().iter().any(|event| event.kind.is_of_pressure_sensor()) {
        let message = "a pressure sensor cannot come off with sensors.pressure = false; leave the event out";
        findings.note(&faults::keys::EVENT, message);
    }
}

/// All channels of a sample are read before its command goes out.
fn check_channel_skew(rig: &Rig, findings: &mut Findings) {
    let (skew, delay) = (rig.get(&keys::CHANNEL_SKEW_S), rig.get(&controller::keys::DELAY_S));
    if whole_microseconds(skew).is_none() {
        findings.note(&keys::CHANNEL_SKEW_S, "must be a whole number of microseconds");
    }
    if skew > 0.0 && 2.0 * skew >= delay {
        let message = format!(
            "must be less than half of controller.delay_s = {delay}, is {skew}: all three channels are read before the output"
        );
        findings.note(&keys::CHANNEL_SKEW_S, message);
    }
    if skew > 0.0 && rig.get(&controller::keys::MODEL) == controller::ControllerKind::Continuous {
        let message = "must be 0 with controller.model = \"continuous\", which has no converter";
        findings.note(&keys::CHANNEL_SKEW_S, message);
    }
}

/// A converter: a range of a physical value and its width.
#[derive(Clone, Copy, Debug)]
pub struct Converter {
    /// Value at raw 0.
    min: f64,
    /// Value at full scale, less that.
    span: f64,
    /// Raw value at full scale.
    full_scale: i32,
}

impl Converter {
    /// A converter with these values at raw 0 and at full scale, and this many bits, at most 15.
    #[must_use]
    pub fn new(min: f64, max: f64, bits: u32) -> Converter {
        Converter { min, span: max - min, full_scale: (1 << bits) - 1 }
    }

    /// How far `x` is from where its raw value changes, with `noise` counts on it.
    fn distance(&self, x: f64, noise: f64) -> f64 {
        let full_scale = f64::from(self.full_scale);
        let per_count = self.span / full_scale;
        let counts = (x - self.min) / per_count + 0.5 + noise;
        let place = counts.clamp(1.0, full_scale) - counts;
        let between = counts - counts.floor();
        // Beyond an end nothing changes until the first or last step.
        let steps = if place == 0.0 { between.min(1.0 - between) } else { place.abs() };
        steps * per_count
    }

    /// The raw value of `x` with `noise` counts on it.
    #[must_use]
    #[inline]
    pub fn raw(&self, x: f64, noise: f64) -> i16 {
        let counts = (x - self.min) / self.span * f64::from(self.full_scale);
        // The cast rounds towards zero: what is not negative, down.
        ((counts + 0.5 + noise) as i32).clamp(0, self.full_scale) as i16
    }
}

/// The sensors of a rig.
#[derive(Clone, Debug)]
pub struct Sensors {
    encoder: Encoder,
    /// None: the pressures are not measured.
    pressure: Option<Converter>,
    spool: Converter,
    /// The homing switch is closed below this position, m; negative infinity without a switch.
    home_switch: f64,
    noise_counts: f64,
    random: ChaCha8Rng,
    /// Errors of scale and offset; None without any.
    calibration: Option<Calibration>,
}

impl Sensors {
    /// The sensors of a rig, their noise drawn from `seed`.
    #[must_use]
    pub fn new(rig: &Rig, seed: u64) -> Sensors {
        let bits = rig.get(&keys::BITS) as u32;
        Sensors {
            encoder: Encoder::new(rig, seed),
            pressure: rig.get(&keys::PRESSURE).then(|| {
                Converter::new(rig.get(&keys::PRESSURE_MIN_PA), rig.get(&keys::PRESSURE_MAX_PA), bits)
            }),
            spool: Converter::new(
                rig.get(&keys::SPOOL_MIN_MM) * 1e-3,
                rig.get(&keys::SPOOL_MAX_MM) * 1e-3,
                bits,
            ),
            home_switch: rig.get(&keys::HOME_SWITCH_MM).map_or(f64::NEG_INFINITY, |mm| mm * 1e-3),
            noise_counts: rig.get(&keys::NOISE_COUNTS),
            random: ChaCha8Rng::seed_from_u64(seed),
            calibration: Some(Calibration::of_rig(rig)).filter(|calibration| !calibration.is_exact()),
        }
    }

    /// The sensors' reading of a position (m), two pressures (Pa) and a spool position (m).
    #[inline]
    pub fn read(&mut self, position: f64, pressures: [f64; 2], spool: f64) -> Sample {
        let Reading { position, pressures, spool } = self.sensed(Reading { position, pressures, spool });
        let noise: [f64; 3] = std::array::from_fn(|_| self.noise());
        let pressure = |i: usize| self.pressure.as_ref().map_or(0, |of| of.raw(pressures[i], noise[i]));
        Sample {
            pressure_1: pressure(0),
            pressure_2: pressure(1),
            position: self.encoder.read(position),
            spool: self.spool.raw(spool, noise[2]),
            home_switch: position < self.home_switch,
        }
    }

    /// How far position (m) and pressures (Pa) are from where their readings change, with the noise that
    /// [`Sensors::read`] would have drawn. A pressure that is not measured never changes.
    pub(crate) fn distances(&mut self, of: &Reading) -> [f64; 3] {
        let of = self.sensed(*of);
        let noise: [f64; 3] = std::array::from_fn(|_| self.noise());
        let pressure = |i: usize| {
            self.pressure.as_ref().map_or(f64::INFINITY, |sensor| sensor.distance(of.pressures[i], noise[i]))
        };
        [self.encoder.distance(of.position), pressure(0), pressure(1)]
    }

    /// The sensor readings of true values.
    #[inline]
    fn sensed(&self, of: Reading) -> Reading {
        self.calibration.as_ref().map_or(of, |calibration| calibration.read(&of))
    }

    #[inline]
    fn noise(&mut self) -> f64 {
        normal(&mut self.random, self.noise_counts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn converters_round_to_the_nearest_and_stop_at_their_ends() {
        let converter = Converter::new(0.0, 1e6, 12);
        assert_eq!(converter.raw(0.0, 0.0), 0);
        assert_eq!(converter.raw(1e6, 0.0), 4095);
        assert_eq!(converter.raw(0.49e6 / 4095.0, 0.0), 0);
        assert_eq!(converter.raw(0.51e6 / 4095.0, 0.0), 1);
        assert_eq!((converter.raw(-5e5, 0.0), converter.raw(5e6, 0.0)), (0, 4095));
        assert_eq!(converter.raw(1e6, 3.0), 4095, "noise is added before the limits");
    }

    #[test]
    fn without_pressure_sensors_both_read_0_and_the_other_sensors_as_before() {
        let read = |text: &str| {
            let rig = Rig::read("test", &format!("[sensors]\nnoise_counts = 2.0\n{text}")).expect("valid");
            let mut sensors = Sensors::new(&rig, 1);
            (0..50).map(|_| sensors.read(0.1, [5e5; 2], 1e-4)).collect::<Vec<Sample>>()
        };
        for (with, without) in read("").into_iter().zip(read("pressure = false\n")) {
            assert_ne!(with.pressure_1, 0);
            assert_eq!(without, Sample { pressure_1: 0, pressure_2: 0, ..with });
        }
    }

    #[test]
    fn noise_has_the_size_that_was_asked_for_and_repeats_with_its_seed() {
        let text = "[sensors]\nnoise_counts = 2.0\n";
        let rig = Rig::read("test", text).expect("valid");
        let draw = |seed| {
            let mut sensors = Sensors::new(&rig, seed);
            (0..4000).map(|_| sensors.read(0.1, [5e5; 2], 0.0).pressure_1).collect::<Vec<_>>()
        };
        let (first, again, other) = (draw(1), draw(1), draw(2));
        assert_eq!(first, again);
        assert_ne!(first, other);
        let mean = first.iter().map(|&raw| f64::from(raw)).sum::<f64>() / 4000.0;
        let variance = first.iter().map(|&raw| (f64::from(raw) - mean).powi(2)).sum::<f64>() / 4000.0;
        assert!((variance.sqrt() - 2.0).abs() < 0.15, "{}", variance.sqrt());
    }
}
