//! The encoder and the converters: what the controller is given of the plant.
//!
//! ```text
//! count = floor(position / pulse + 1e-9)
//! raw   = clamp(floor((x - min) / (max - min) (2^bits - 1) + 0.5 + noise), 0, 2^bits - 1)
//! ```
//!
//! as DESIGN section 4 has it; the noise, in counts, is normal and drawn from a seeded generator.

use std::f64::consts::PI;

use pneudrive_controller::Sample;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

use crate::follow::Reading;
use crate::rig::Rig;
use crate::rig::unit_interval;

/// A converter: a range of a physical value and its width.
#[derive(Clone, Copy, Debug)]
pub struct Converter {
    /// Value at raw 0.
    pub min: f64,
    /// Value at full scale.
    pub max: f64,
    /// Bits, at most 15.
    pub bits: u32,
}

impl Converter {
    fn full_scale(&self) -> f64 {
        f64::from((1u32 << self.bits) - 1)
    }

    /// How far `x` is from where its raw value changes, with `noise` counts on it.
    fn distance(&self, x: f64, noise: f64) -> f64 {
        let per_count = (self.max - self.min) / self.full_scale();
        let counts = (x - self.min) / per_count + 0.5 + noise;
        let place = counts.clamp(1.0, self.full_scale()) - counts;
        let between = counts - counts.floor();
        // Beyond an end nothing changes until the first or last step.
        let steps = if place == 0.0 { between.min(1.0 - between) } else { place.abs() };
        steps * per_count
    }

    /// The raw value of `x` with `noise` counts on it.
    #[must_use]
    pub fn raw(&self, x: f64, noise: f64) -> i16 {
        let counts = (x - self.min) / (self.max - self.min) * self.full_scale();
        // What is not negative is rounded down by the cast.
        (counts + 0.5 + noise).clamp(0.0, self.full_scale()) as i16
    }
}

/// The sensors of a rig.
#[derive(Clone, Debug)]
pub struct Sensors {
    pulse: f64,
    pressure: Converter,
    spool: Converter,
    /// The homing switch is closed below this position, m; without a switch below none.
    home_switch: f64,
    noise_counts: f64,
    random: ChaCha8Rng,
}

impl Sensors {
    /// The sensors of a rig, their noise drawn from `seed`.
    #[must_use]
    pub fn new(rig: &Rig, seed: u64) -> Sensors {
        let bits = rig.integer("sensors.bits") as u32;
        Sensors {
            pulse: rig.number("encoder.mm_per_count") * 1e-3,
            pressure: Converter {
                min: rig.number("sensors.pressure_min_pa"),
                max: rig.number("sensors.pressure_max_pa"),
                bits,
            },
            spool: Converter {
                min: rig.number("sensors.spool_min_mm") * 1e-3,
                max: rig.number("sensors.spool_max_mm") * 1e-3,
                bits,
            },
            home_switch: rig
                .optional_number("sensors.home_switch_mm")
                .map_or(f64::NEG_INFINITY, |mm| mm * 1e-3),
            noise_counts: rig.number("sensors.noise_counts"),
            random: ChaCha8Rng::seed_from_u64(seed),
        }
    }

    /// The sensors' reading of a position (m), two pressures (Pa) and a spool position (m).
    pub fn read(&mut self, position: f64, pressures: [f64; 2], spool: f64) -> Sample {
        let noise: [f64; 3] = std::array::from_fn(|_| self.noise());
        Sample {
            position: count(position, self.pulse),
            pressure_1: self.pressure.raw(pressures[0], noise[0]),
            pressure_2: self.pressure.raw(pressures[1], noise[1]),
            spool: self.spool.raw(spool, noise[2]),
            home_switch: position < self.home_switch,
        }
    }

    /// How far position (m) and pressures (Pa) are from where their readings change, with the noise that
    /// [`Sensors::read`] would have drawn.
    pub(crate) fn distances(&mut self, of: &Reading) -> [f64; 3] {
        let noise: [f64; 3] = std::array::from_fn(|_| self.noise());
        [
            distance_to_count(of.position, self.pulse),
            self.pressure.distance(of.pressures[0], noise[0]),
            self.pressure.distance(of.pressures[1], noise[1]),
        ]
    }

    /// A normal draw (Box and Muller) of the noise's size; nothing is drawn without noise.
    fn noise(&mut self) -> f64 {
        if self.noise_counts == 0.0 {
            return 0.0;
        }
        let (radius, angle) = (1.0 - unit_interval(&mut self.random), unit_interval(&mut self.random));
        self.noise_counts * (-2.0 * libm::log(radius)).sqrt() * libm::cos(2.0 * PI * angle)
    }
}

/// How far a position is from where its count changes, in its unit.
fn distance_to_count(position: f64, pulse: f64) -> f64 {
    let pulses = position / pulse + 1e-9;
    let between = pulses - pulses.floor();
    between.min(1.0 - between) * pulse
}

/// The encoder's count at a position, both in the same unit.
#[must_use]
pub fn count(position: f64, pulse: f64) -> i32 {
    let pulses = position / pulse + 1e-9;
    // Towards zero, and from there down.
    let whole = pulses as i32;
    whole.saturating_sub(i32::from(f64::from(whole) > pulses))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_whole_pulses_below_the_position() {
        let pulse = 0.01205e-3;
        assert_eq!(count(98.719625e-3, pulse), 8192);
        assert_eq!(count(8193.0 * pulse, pulse), 8193, "an exact pulse counts");
        assert_eq!(count(-0.1 * pulse, pulse), -1);
    }

    #[test]
    fn converters_round_to_the_nearest_and_stop_at_their_ends() {
        let converter = Converter { min: 0.0, max: 1e6, bits: 12 };
        assert_eq!(converter.raw(0.0, 0.0), 0);
        assert_eq!(converter.raw(1e6, 0.0), 4095);
        assert_eq!(converter.raw(0.49e6 / 4095.0, 0.0), 0);
        assert_eq!(converter.raw(0.51e6 / 4095.0, 0.0), 1);
        assert_eq!((converter.raw(-5e5, 0.0), converter.raw(5e6, 0.0)), (0, 4095));
        assert_eq!(converter.raw(1e6, 3.0), 4095, "noise is added before the limits");
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
