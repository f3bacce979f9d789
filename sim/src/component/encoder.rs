//! The encoder: the controller's reading of the position.
//!
//! ```text
//! quadrature      count = floor(x / pulse + 1e-9)
//! potentiometer   count = clamp(floor((x' - zero) / pulse + 0.5 + noise), 0, 2^bits - 1),     pulse = range / (2^bits - 1)
//! ssi             count = clamp(floor((x' - zero) / pulse + 1e-9 + noise), 0, 2^bits - 1)
//!
//! x' = x + range linearity sin(2 pi clamp((x - zero) / range, 0, 1))
//! ```
//!
//! as in DESIGN section 4. The noise, in counts, is normal. Linearity is the largest deviation from the straight line
//! through both ends, as in data sheets. They do not state the curve; a whole sine is an assumption. A quadrature
//! encoder counts from the retracted end, as if the axis had been homed. The other two are absolute: the controller
//! adds the position of their count 0.

use std::f64::consts::{PI, TAU};

pub use pneudrive_controller::choice::EncoderKind;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

use crate::component::actuator;
use crate::key::{Kind, Preset, keys};
use crate::random::normal;
use crate::values::{Findings, Rig};

/// The widest word or converter.
pub const MAX_BITS: i64 = 30;

/// The longest count that the controller's picometres hold, mm.
const LONGEST_COUNT_MM: f64 = 2.0;

/// The random stream of an encoder's noise. The other sensors use the generator's first one.
const STREAM: u64 = 1;

/// Noise is taken to stay within this many standard deviations.
const NEVER: f64 = 10.0;

keys! {
    MODEL: EncoderKind = choice("encoder.model", "", "quadrature counts edges, and the axis must be homed. potentiometer, on a converter, and ssi, an encoder with a synchronous serial interface, are absolute: the axis is homed when the drive starts.");
    MM_PER_COUNT: f64 = number("encoder.mm_per_count", 0.01205, 1e-6, 2.0, "C(42)", "Stroke per encoder count.").of(&["quadrature", "ssi"]);
    POLARITY: i64 = integer("encoder.polarity", 1, -1, 1, "", "-1: the encoder counts down when the rod extends (a matter of wiring; the twin always counts up).");
    BITS: Option<i64> = other("encoder.bits", Kind::Integer { min: 8, max: MAX_BITS }, Preset::Absent("12 of a potentiometer, 24 with SSI"), "", "Width of the potentiometer's converter, or of the encoder's word.").of(&["potentiometer", "ssi"]);
    ZERO_MM: f64 = number("encoder.zero_mm", 0.0, -20_000.0, 20_000.0, "", "Position at which an absolute encoder reads 0: a little below 0, with a range a little longer than the stroke, keeps both ends of the stroke within the range.").of(&["potentiometer", "ssi"]);
    RANGE_MM: Option<f64> = optional_number("encoder.range_mm", 1.0, 40_000.0, "from zero_mm to the end of the stroke", "", "Length that an absolute encoder measures; a potentiometer divides it into 2^bits - 1 counts.").of(&["potentiometer", "ssi"]);
    LINEARITY_PERCENT: f64 = number("encoder.linearity_percent", 0.0, 0.0, 5.0, "", "Largest deviation from the straight line through both ends, part of the range; the controller does not know it.").of(&["potentiometer", "ssi"]);
    NOISE_COUNTS: f64 = number("encoder.noise_counts", 0.0, 0.0, 1000.0, "", "Standard deviation of the reading's noise.").of(&["potentiometer", "ssi"]);
    SCALE_ERROR_PERCENT: f64 = number("encoder.scale_error_percent", 0.0, -10.0, 10.0, "", "How much longer a count really is than the file says; the controller does not know it.");
    SCALE_TOLERANCE_PERCENT: f64 = number("encoder.scale_tolerance_percent", 0.3, 0.0, 10.0, "", "How far the true length of a count may be from the file's, for identify. 0.3 is an assumption: that of a belt or a measuring wheel. A glass scale or a magnetic tape has 0.01, a scale that was compared with a gauge what that comparison leaves; 0: exact.");
    OFFSET_ERROR_MM: f64 = number("encoder.offset_error_mm", 0.0, -100.0, 100.0, "", "What the encoder reads at the retracted end of the stroke; the controller does not know it.");
    OFFSET_TOLERANCE_MM: f64 = number("encoder.offset_tolerance_mm", 0.1, 0.0, 100.0, "", "How far that reading may be from the file's, for identify. 0.1 is an assumption: what a homing run against a stop repeats, and how well the end of the stroke is known; 0: exact.");
}

/// A count of the encoder, m.
#[must_use]
pub fn pulse(rig: &Rig) -> f64 {
    mm_per_count(rig) * 1e-3
}

/// The counts of a length, m, rounded down. A length of whole counts keeps its last one: 250 mm are 25,000 counts of 10 um, although
/// their quotient may be a rounding error less.
#[must_use]
pub fn counts_of(rig: &Rig, metres: f64) -> i64 {
    (metres * 1e3 / mm_per_count(rig) + 1e-6).floor() as i64
}

/// A count of the encoder, mm.
#[must_use]
pub fn mm_per_count(rig: &Rig) -> f64 {
    match rig.get(&keys::MODEL) {
        EncoderKind::Quadrature | EncoderKind::Ssi => rig.get(&keys::MM_PER_COUNT),
        EncoderKind::Potentiometer => range_mm(rig) / largest_count(rig),
    }
}

/// The middle of the positions that the controller reads as `count`, in counts. Edges are counted from below; a potentiometer
/// is rounded to the nearest count; the zero of an absolute encoder lies between two counts of the controller.
#[must_use]
pub fn middle(rig: &Rig, count: f64) -> f64 {
    match rig.get(&keys::MODEL) {
        EncoderKind::Quadrature => count + 0.5,
        EncoderKind::Potentiometer => count + zero_between(rig),
        EncoderKind::Ssi => count + zero_between(rig) + 0.5,
    }
}

/// The count that the controller reads at a position in counts, without noise and deviation.
#[must_use]
pub fn count_at(rig: &Rig, position: f64) -> f64 {
    match rig.get(&keys::MODEL) {
        EncoderKind::Quadrature => position.floor(),
        EncoderKind::Potentiometer => (position - zero_between(rig) + 0.5).floor(),
        EncoderKind::Ssi => (position - zero_between(rig)).floor(),
    }
}

/// How far the zero of an absolute encoder is from the controller's whole count for it, counts.
fn zero_between(rig: &Rig) -> f64 {
    rig.get(&keys::ZERO_MM) / mm_per_count(rig) - f64::from(zero_counts(rig))
}

/// The position at which an absolute encoder reads 0, counts; 0 of a quadrature encoder.
#[must_use]
pub fn zero_counts(rig: &Rig) -> i32 {
    match rig.get(&keys::MODEL) {
        EncoderKind::Quadrature => 0,
        _ => (rig.get(&keys::ZERO_MM) / mm_per_count(rig)).round() as i32,
    }
}

/// How far noise may shift a reading, counts.
pub(crate) fn noise_band(rig: &Rig) -> f64 {
    match rig.get(&keys::MODEL) {
        EncoderKind::Quadrature => 0.0,
        _ => (NEVER * rig.get(&keys::NOISE_COUNTS)).ceil(),
    }
}

fn range_mm(rig: &Rig) -> f64 {
    rig.get(&keys::RANGE_MM)
        .unwrap_or_else(|| 1e3 * rig.get(&actuator::keys::STROKE_M) - rig.get(&keys::ZERO_MM))
}

/// Width of the converter or of the word.
#[must_use]
pub fn bits(rig: &Rig) -> i64 {
    let usual = if rig.get(&keys::MODEL) == EncoderKind::Potentiometer { 12 } else { 24 };
    rig.get(&keys::BITS).unwrap_or(usual).clamp(1, MAX_BITS)
}

fn largest_count(rig: &Rig) -> f64 {
    f64::from((1u32 << bits(rig)) - 1)
}

/// The constraints on the encoder's keys.
pub(crate) fn check(rig: &Rig, findings: &mut Findings) {
    if rig.get(&keys::POLARITY) == 0 {
        findings.note(&keys::POLARITY, "must be 1 or -1");
    }
    if !rig.get(&keys::MODEL).is_absolute() {
        return;
    }
    if rig.get(&keys::POLARITY) < 0 {
        let message = "an absolute encoder must count up when the rod extends: exchange the ends of the potentiometer, or set the direction in the encoder";
        findings.note(&keys::POLARITY, message);
    }
    let [zero, stroke] = [rig.get(&keys::ZERO_MM), 1e3 * rig.get(&actuator::keys::STROKE_M)];
    let count = mm_per_count(rig);
    let words = largest_count(rig) * count;
    if zero > 0.0 {
        let message = format!("is {zero}: from 0 to there the encoder would read 0; it must be 0 or less");
        findings.note(&keys::ZERO_MM, message);
    }
    if zero + words.min(range_mm(rig)) < stroke * (1.0 - 1e-9) {
        let (key, remedy) = match words < range_mm(rig) {
            true => (&keys::BITS.key, "more bits or longer counts"),
            false => (&keys::RANGE_MM.key, "a longer range"),
        };
        let end = zero + words.min(range_mm(rig));
        let message = format!(
            "the encoder measures to {end:.3} mm, but the stroke is {stroke:.3} mm: it takes {remedy}"
        );
        findings.0.push((key.path, message));
    }
    if count > LONGEST_COUNT_MM {
        let message =
            format!("a count would be {count:.3} mm, more than {LONGEST_COUNT_MM}: it takes more bits");
        findings.note(&keys::BITS, message);
    }
}

/// The encoder of a rig.
#[derive(Clone, Debug)]
pub struct Encoder {
    pulse: f64,
    absolute: Option<Absolute>,
}

/// The conversion of an absolute encoder.
#[derive(Clone, Debug)]
struct Absolute {
    /// m.
    zero: f64,
    /// m.
    range: f64,
    /// Largest deviation, m.
    deviation: f64,
    largest: f64,
    /// The value that is added before the reading is rounded down, counts.
    rounding: f64,
    noise_counts: f64,
    random: ChaCha8Rng,
}

impl Encoder {
    /// The encoder of a rig, its noise drawn from `seed`.
    #[must_use]
    pub fn new(rig: &Rig, seed: u64) -> Encoder {
        let model = rig.get(&keys::MODEL);
        let absolute = model.is_absolute().then(|| {
            let range = 1e-3 * range_mm(rig);
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            random.set_stream(STREAM);
            Absolute {
                zero: 1e-3 * rig.get(&keys::ZERO_MM),
                range,
                deviation: range * 1e-2 * rig.get(&keys::LINEARITY_PERCENT),
                largest: largest_count(rig),
                rounding: if model == EncoderKind::Potentiometer { 0.5 } else { 1e-9 },
                noise_counts: rig.get(&keys::NOISE_COUNTS),
                random,
            }
        });
        Encoder { pulse: pulse(rig), absolute }
    }

    /// The reading with the axis at rest at a position, m, without noise.
    #[must_use]
    pub fn at_rest(rig: &Rig, position: f64) -> i32 {
        let mut encoder = Encoder::new(rig, 0);
        if let Some(absolute) = &mut encoder.absolute {
            absolute.noise_counts = 0.0;
        }
        encoder.read(position)
    }

    /// Its count at a position, m.
    #[inline]
    pub fn read(&mut self, position: f64) -> i32 {
        let noise = self.noise();
        match &self.absolute {
            None => count(position, self.pulse),
            Some(absolute) => {
                absolute.counts(position, self.pulse, noise).clamp(0.0, absolute.largest) as i32
            }
        }
    }

    /// How far a position is from where its count changes, m, with the noise that [`Encoder::read`] would have drawn.
    pub(crate) fn distance(&mut self, position: f64) -> f64 {
        let noise = self.noise();
        match &self.absolute {
            None => distance_to_count(position, self.pulse),
            Some(absolute) => absolute.distance(position, self.pulse, noise),
        }
    }

    #[inline]
    fn noise(&mut self) -> f64 {
        match &mut self.absolute {
            Some(absolute) => normal(&mut absolute.random, absolute.noise_counts),
            None => 0.0,
        }
    }
}

impl Absolute {
    /// The reading before it is rounded down and held within its word.
    fn counts(&self, position: f64, pulse: f64, noise: f64) -> f64 {
        let along = position - self.zero;
        let deviation = match self.deviation {
            0.0 => 0.0,
            largest => largest * libm::sin(2.0 * PI * (along / self.range).clamp(0.0, 1.0)),
        };
        (along + deviation) / pulse + self.rounding + noise
    }

    fn distance(&self, position: f64, pulse: f64, noise: f64) -> f64 {
        let counts = self.counts(position, pulse, noise);
        // Below 1 the count is 0, and from the largest on it stays.
        let beyond = counts.clamp(1.0, self.largest) - counts;
        let between = counts - counts.floor();
        let steps = if beyond == 0.0 { between.min(1.0 - between) } else { beyond.abs() };
        // Where the curve is steepest, a count is shorter.
        steps * pulse / (1.0 + TAU * self.deviation / self.range)
    }
}

/// How far a position is from where its count changes, in its unit.
fn distance_to_count(position: f64, pulse: f64) -> f64 {
    let pulses = position / pulse + 1e-9;
    let between = pulses - pulses.floor();
    between.min(1.0 - between) * pulse
}

/// The count of a quadrature encoder at a position, both in the same unit.
#[must_use]
#[inline]
pub fn count(position: f64, pulse: f64) -> i32 {
    let pulses = position / pulse + 1e-9;
    // Towards zero, and from there down.
    let whole = pulses as i32;
    whole.saturating_sub(i32::from(f64::from(whole) > pulses))
}

#[cfg(test)]
mod tests;
