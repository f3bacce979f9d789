//! Profiles: the course of the setpoint during a move. A profile is a factor for each sample k of its move, times a
//! distance:
//!
//! ```text
//! ramp:  n[k] = start  + (target - start) s[k],   0 <= s <= 1     start: the setpoint that was in force before
//! wave:  n[k] = target + amplitude sin(2 pi p[k])
//! noise: n[k] = target + amplitude b[k],          b = -1 or 1
//! ```
//!
//! **Ramp.** s is a step averaged three times, over V, A and J samples (moving averages in series: Biagiotti and
//! Melchiorri, "FIR filters for online trajectory planning with time- and frequency-domain specifications", Control
//! Engineering Practice 20, 2012). It arrives V + A + J - 2 samples after its beginning. With V >= A + J and A >= J
//! its steepest difference is 1/V, the largest second one 1/(V A), the third 1/(V A J). These are the limits of
//! velocity, acceleration and jerk. A = J = 1 gives a ramp of constant velocity, J = 1 a trapezoid of velocity,
//! anything else an S-curve. In units of 1/(V A J), s is a sum of sums of sums of
//!
//! ```text
//! j[k] = w[k - 1] - w[k - 1 - A] - w[k - 1 - V] + w[k - 1 - V - A],   w[i] = 1 for 0 <= i < J, else 0
//! ```
//!
//! and the sums are exact. The unit is rounded down to a multiple of 2^-63, so s falls short by less than V A J /
//! 2^63 before the last sample. The last sample is the target itself.
//!
//! **Wave.** The phase p counts in turns, `p[k + 1] = p[k] + rate + k sweep`, modulo 1 in steps of 2^-64. Without
//! sweep it is a sine, else a chirp. The sine is a polynomial with an error of at most 1e-8 of the amplitude.
//!
//! **Noise.** A pseudo-random binary sequence: a shift register moves on every `hold` samples, and its last bit is
//! the sign.
//!
//! After their last sample, wave and noise rest at the target. The setpoint is rounded once to the nearest count,
//! from 2^-30 of a count.

use crate::fixed::{quotient, saturate};

/// The factor 1.
const ONE: i64 = 1 << FRACTION_BITS;
const FRACTION_BITS: u32 = 30;

/// Most samples of each average of a ramp.
pub const LONGEST_AVERAGE: u32 = 1 << 29;

/// Largest product of the three lengths of a ramp.
pub const LARGEST_PRODUCT: u64 = 1 << 40;

/// The course of the setpoint from the beginning of a move on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Profile {
    /// To the target at once.
    #[default]
    Step,
    /// From the setpoint in force to the target.
    Ramp(Ramp),
    /// A sine or a chirp about the target.
    Wave(Wave),
    /// A pseudo-random binary sequence about the target.
    Noise(Noise),
}

/// A step that is averaged over three times.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ramp {
    velocity: u32,
    acceleration: u32,
    jerk: u32,
    /// 1/(V A J), in 2^-63.
    unit: u64,
}

/// A sine whose frequency may change evenly.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wave {
    /// From the target to a crest, counts; negative: the wave begins downwards.
    pub amplitude: i32,
    /// Samples until it is over.
    pub samples: u32,
    /// Turns from the first sample to the second, in 2^-64.
    pub rate: u64,
    /// The increase of the turns from sample to sample, in 2^-64.
    pub sweep: i64,
}

/// A sequence of signs that looks random and repeats.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Noise {
    /// From the target to either side, counts.
    pub amplitude: i32,
    /// Samples until it is over.
    pub samples: u32,
    /// Samples that a sign lasts.
    pub hold: u32,
    /// The bits that are toggled when a 1 leaves the shift register (Galois form); the highest one is its length.
    pub taps: u32,
}

impl Ramp {
    /// A ramp that averages over these numbers of samples: V, A, J.
    ///
    /// None if one of them is 0 or above [`LONGEST_AVERAGE`], or their product above [`LARGEST_PRODUCT`].
    #[must_use]
    pub fn new(velocity: u32, acceleration: u32, jerk: u32) -> Option<Ramp> {
        let lengths = [velocity, acceleration, jerk];
        let all_fit = lengths.iter().all(|length| (1..=LONGEST_AVERAGE).contains(length));
        let product =
            lengths.iter().try_fold(1_u64, |product, &length| product.checked_mul(u64::from(length)))?;
        (all_fit && product <= LARGEST_PRODUCT).then(|| Ramp {
            velocity,
            acceleration,
            jerk,
            unit: quotient(1 << 63, product),
        })
    }

    /// V, A and J, samples.
    #[must_use]
    pub fn averages(&self) -> [u32; 3] {
        [self.velocity, self.acceleration, self.jerk]
    }

    /// The next s, in 2^-63. `sums`: s, its first and its second difference.
    fn advance(&self, k: u32, sums: &mut [u64; 3]) -> u64 {
        let pulse = |begin: u32| u64::from(k.wrapping_sub(begin) < self.jerk);
        let (v, a) = (self.velocity, self.acceleration);
        let sign = pulse(1).wrapping_add(pulse(1 + v + a)).wrapping_sub(pulse(1 + v) + pulse(1 + a));
        let [s, first, second] = sums;
        *second = second.wrapping_add(sign.wrapping_mul(self.unit));
        *first = first.wrapping_add(*second);
        *s = s.wrapping_add(*first);
        *s
    }
}

impl Profile {
    /// Samples from the beginning of the profile to its end.
    #[must_use]
    pub fn samples(&self) -> u32 {
        match self {
            Profile::Step => 0,
            Profile::Ramp(ramp) => ramp.velocity + ramp.acceleration + ramp.jerk - 2,
            Profile::Wave(wave) => wave.samples,
            Profile::Noise(noise) => noise.samples,
        }
    }

    /// Largest distance of the setpoint from the target to either side, counts. A ramp has none, as it comes from the
    /// setpoint before.
    #[must_use]
    pub fn amplitude(&self) -> u32 {
        match self {
            Profile::Step | Profile::Ramp(_) => 0,
            Profile::Wave(Wave { amplitude, .. }) | Profile::Noise(Noise { amplitude, .. }) => {
                amplitude.unsigned_abs()
            }
        }
    }
}

/// The state of a profile, from which its next sample follows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Progress {
    /// Samples since its beginning.
    k: u32,
    /// The setpoint at factor 0, counts.
    base: i32,
    /// From there to factor 1, counts.
    span: i64,
    /// Ramp: s, its first and second difference. Wave: phase, turns of a sample. Noise: shift register, samples left.
    sums: [u64; 3],
    /// The last setpoint, in 2^-30 counts.
    at: i64,
    /// Its motion in the sample before, in 2^-30 counts.
    velocity: i64,
    acceleration: i64,
}

/// A point of a course in time, with what a law needs that follows it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Point {
    /// Counts, in 2^-16.
    pub x: i64,
    /// Counts a sample, in 2^-16.
    pub v: i32,
    /// Counts per sample squared, in 2^-16.
    pub a: i32,
    /// Counts per sample cubed, in 2^-24.
    pub j: i32,
}

impl Point {
    /// At rest in the middle of a count.
    pub(crate) fn at(count: i32) -> Point {
        Point { x: (i64::from(count) << 16) + (1 << 15), ..Point::default() }
    }

    /// The sum of two motions.
    pub(crate) fn plus(self, other: Point) -> Point {
        Point {
            x: self.x.wrapping_add(other.x),
            v: self.v.saturating_add(other.v),
            a: self.a.saturating_add(other.a),
            j: self.j.saturating_add(other.j),
        }
    }

    /// The motion this many samples later (2^-16) at the same jerk; the place is not carried on.
    pub(crate) fn later(self, samples: i32) -> Point {
        let changed = saturate((i64::from(self.j) * i64::from(samples)) >> 24);
        let mean = self.a.saturating_add(changed >> 1);
        let faster = saturate((i64::from(mean) * i64::from(samples)) >> 16);
        Point { v: self.v.saturating_add(faster), a: self.a.saturating_add(changed), ..self }
    }
}

/// A sample of a profile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Waypoint {
    /// Counts.
    pub setpoint: i32,
    /// Counts a sample, in 2^-12.
    pub velocity: i32,
    /// Counts per sample squared, in 2^-12.
    pub acceleration: i32,
    /// Place and motion in finer units.
    pub point: Point,
    /// Whether it is the last one.
    pub last: bool,
}

impl Progress {
    /// At the beginning of a move from one setpoint to another. The setpoint of this sample itself is
    /// [`Progress::first`].
    pub fn new(profile: &Profile, from: i32, target: i32) -> Progress {
        let about = |amplitude: i32, sums| (target, i64::from(amplitude), sums);
        let (base, span, sums) = match *profile {
            Profile::Step => about(0, [0; 3]),
            Profile::Ramp(_) => (from, i64::from(target) - i64::from(from), [0; 3]),
            Profile::Wave(wave) => about(wave.amplitude, [0, wave.rate, 0]),
            Profile::Noise(noise) => about(noise.amplitude, [1, 0, 0]),
        };
        Progress {
            k: 0,
            base,
            span,
            sums,
            at: i64::from(base) << FRACTION_BITS,
            velocity: 0,
            acceleration: 0,
        }
    }

    /// The setpoint of the sample at which the move begins, counts.
    pub fn first(&self) -> i32 {
        self.base
    }

    /// The next sample.
    pub fn advance(&mut self, profile: &Profile, target: i32) -> Waypoint {
        self.k = self.k.saturating_add(1);
        if self.k >= profile.samples() {
            return Waypoint { setpoint: target, last: true, ..Waypoint::default() };
        }
        let at = (i64::from(self.base) << FRACTION_BITS) + self.span.wrapping_mul(self.factor(profile));
        let setpoint = rounded(at, FRACTION_BITS);
        if matches!(profile, Profile::Noise(_)) {
            return Waypoint { setpoint, point: Point::at(setpoint), ..Waypoint::default() };
        }
        let velocity = at.wrapping_sub(self.at);
        // The motion before a profile is not part of it.
        let acceleration = if self.k == 1 { 0 } else { velocity.wrapping_sub(self.velocity) };
        let jerk = if self.k <= 2 { 0 } else { acceleration.wrapping_sub(self.acceleration) };
        (self.at, self.velocity, self.acceleration) = (at, velocity, acceleration);
        let point = point(at, [velocity, acceleration, jerk]);
        let [velocity, acceleration] = [velocity, acceleration].map(|difference| rounded(difference, 18));
        Waypoint { setpoint, velocity, acceleration, point, last: false }
    }

    /// The factor at sample k, in 2^-30.
    fn factor(&mut self, profile: &Profile) -> i64 {
        match profile {
            Profile::Step => ONE,
            Profile::Ramp(ramp) => ((ramp.advance(self.k, &mut self.sums) >> 32) as i64 + 1) >> 1,
            Profile::Wave(wave) => {
                let [phase, rate, _] = &mut self.sums;
                *phase = phase.wrapping_add(*rate);
                *rate = rate.wrapping_add_signed(wave.sweep);
                i64::from(sine((*phase >> 32) as u32))
            }
            Profile::Noise(noise) => {
                let [register, left, _] = &mut self.sums;
                if *left == 0 {
                    *register = shifted(*register as u32, noise.taps).into();
                    *left = noise.hold.into();
                }
                *left = left.wrapping_sub(1);
                if *register & 1 == 0 { -ONE } else { ONE }
            }
        }
    }
}

/// A point by a place and its backward differences, all in 2^-30 counts:
/// v = D x + D^2 x/2 + D^3 x/3,   a = D^2 x + D^3 x,   j = D^3 x.
fn point(at: i64, [first, second, third]: [i64; 3]) -> Point {
    Point {
        x: (at >> 14) + (1 << 15),
        v: rounded(first.wrapping_add(second >> 1).wrapping_add((third >> 2) + (third >> 4)), 14),
        a: rounded(second.wrapping_add(third), 14),
        j: rounded(third, 6),
    }
}

/// A number in 2^-bits, rounded to the nearest whole one; a half goes up.
fn rounded(value: i64, bits: u32) -> i32 {
    saturate(value.wrapping_add(1 << (bits - 1)) >> bits)
}

/// The register after a shift.
fn shifted(register: u32, taps: u32) -> u32 {
    (register >> 1) ^ if register & 1 == 0 { 0 } else { taps }
}

/// sin(2 pi phase), the phase in 2^-32 turns, in 2^-30: sin(y pi / 2) = y (c0 + c1 y^2 + ... + c4 y^8) for -1 <= y <= 1,
/// interpolated at the Chebyshev points of y^2.
fn sine(phase: u32) -> i32 {
    const C: [i32; 5] = [1_686_629_706, -693_598_305, 85_566_398, -5_018_824, 162_856];
    let product = |a: i32, b: i32| ((i64::from(a) * i64::from(b)) >> FRACTION_BITS) as i32;
    // The second and third quarter of a turn mirror the fourth and first one: y within -2^30 to 2^30.
    let mirrored = (phase.wrapping_add(1 << 30)) & (1 << 31) != 0;
    let y = (if mirrored { (1_u32 << 31).wrapping_sub(phase) } else { phase }) as i32;
    let square = product(y, y);
    let [rest @ .., highest] = C;
    let sum = rest.iter().rev().fold(highest, |sum, c| c.wrapping_add(product(sum, square)));
    let one = ONE as i32;
    product(sum, y).min(one).max(-one)
}

#[cfg(test)]
mod tests;
