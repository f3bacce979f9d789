//! The number type of an equation: one number, or two at once.
//!
//! Valve and cylinder have two of everything. An equation for a [`Number`] holds for a [`Pair`] as well. One
//! instruction adds or multiplies both numbers of a pair, and each gets the bits that it would have alone.

use std::f64::consts::PI;
use std::ops::{Add, Div, Mul, Neg, Sub};

use wide::{f64x2, u64x2};

/// Of node 1 and node 2, or of chamber 1 and chamber 2.
pub(crate) type Pair = f64x2;

/// A number, or two.
pub(crate) trait Number:
    Copy
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The answer to a question, one for each number.
    type Truth: Copy;

    /// Number `i` of them.
    fn lane(self, i: usize) -> f64;
    /// Made of one, or two.
    fn of(lane: impl FnMut(usize) -> f64) -> Self;
    /// self > other.
    fn above(self, other: Self) -> Self::Truth;
    /// self >= other.
    fn at_least(self, other: Self) -> Self::Truth;
    /// `yes` where `truth` holds, else `no`.
    fn choose(truth: Self::Truth, yes: Self, no: Self) -> Self;
    /// Both, in this order where `truth` holds, else exchanged.
    fn either(truth: Self::Truth, one: Self, other: Self) -> [Self; 2];
    /// With its sign where `truth` holds, else with the other one.
    fn signed(self, truth: Self::Truth) -> Self;
    /// The larger one.
    fn larger(self, other: Self) -> Self;
    /// The smaller one.
    fn smaller(self, other: Self) -> Self;
    /// The square root.
    fn root(self) -> Self;
    /// Whether it holds for all of them.
    fn all(truth: Self::Truth) -> bool;
    /// Its size without the sign.
    fn size(self) -> Self;
    /// Sine and cosine of an angle to which the quarters of a cycle are added that the last two bits of `counted` say:
    /// each swaps the two and turns the sign of one.
    fn turned_by(counted: Self, sine_and_cosine: [Self; 2]) -> [Self; 2];

    /// Sine and cosine of an angle in cycles. Reduced to an eighth of one beforehand, which is exact, it needs no
    /// multiple of pi, and a series of few terms. Up to 1e15 cycles.
    #[inline(always)]
    fn sine_and_cosine_of_cycles(self) -> [Self; 2] {
        let counted = Self::from(4.0) * self + Self::from(WHOLE);
        let quarters = counted - Self::from(WHOLE);
        let angle = Self::from(2.0 * PI) * (self - Self::from(0.25) * quarters);
        let square = angle * angle;
        let sine = angle * square.series(&OF_SINE);
        let cosine = square.series(&OF_COSINE);
        Self::turned_by(counted, [sine, cosine])
    }

    /// A polynomial in it, its highest coefficient first; even and odd powers at the same time.
    #[inline(always)]
    fn series<const TERMS: usize>(self, coefficients: &[f64; TERMS]) -> Self {
        let square = self * self;
        let mut sums = [Self::from(coefficients[0]), Self::from(coefficients[1])];
        for pair in coefficients[2..].chunks(2) {
            for (sum, &coefficient) in sums.iter_mut().zip(pair) {
                *sum = *sum * square + Self::from(coefficient);
            }
        }
        // The last coefficient is that of the even powers.
        let [even, odd] = if TERMS % 2 == 1 { sums } else { [sums[1], sums[0]] };
        even + self * odd
    }

    /// e to its power, to 5e-16 of it. Small ones, as drops of pressure and fading oscillations have, need no
    /// library: Pade's approximant of order 5 over 5.
    #[inline(always)]
    fn exponential(self) -> Self {
        if !Self::all(Self::from(SMALL).at_least(self.size())) {
            return Self::of(|i| libm::exp(self.lane(i)));
        }
        let square = self * self;
        let even = (Self::from(30.0) * square + Self::from(3360.0)) * square + Self::from(30240.0);
        let odd = self * ((square + Self::from(420.0)) * square + Self::from(15120.0));
        (even + odd) / (even - odd)
    }
}

/// Up to here the approximant is off by less than 3e-16.
const SMALL: f64 = 0.3;

/// Added to a smaller number and taken off again it leaves the next whole one, whose last bits it has itself.
const WHOLE: f64 = 1.5 * (1_u64 << 52) as f64;

/// (-1)^n/(2n + 1)! for n from 7 to 0, of an eighth of a cycle to 5e-17.
const OF_SINE: [f64; 8] = [
    -1.0 / 1_307_674_368_000.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 39_916_800.0,
    1.0 / 362_880.0,
    -1.0 / 5_040.0,
    1.0 / 120.0,
    -1.0 / 6.0,
    1.0,
];

/// (-1)^n/(2n)! for n from 8 to 0.
const OF_COSINE: [f64; 9] = [
    1.0 / 20_922_789_888_000.0,
    -1.0 / 87_178_291_200.0,
    1.0 / 479_001_600.0,
    -1.0 / 3_628_800.0,
    1.0 / 40_320.0,
    -1.0 / 720.0,
    1.0 / 24.0,
    -1.0 / 2.0,
    1.0,
];

impl Number for f64 {
    type Truth = bool;

    #[inline(always)]
    fn lane(self, _: usize) -> f64 {
        self
    }

    #[inline(always)]
    fn of(mut lane: impl FnMut(usize) -> f64) -> f64 {
        lane(0)
    }

    #[inline(always)]
    fn above(self, other: f64) -> bool {
        self > other
    }

    #[inline(always)]
    fn at_least(self, other: f64) -> bool {
        self >= other
    }

    #[inline(always)]
    fn choose(truth: bool, yes: f64, no: f64) -> f64 {
        if truth { yes } else { no }
    }

    #[inline(always)]
    fn either(truth: bool, one: f64, other: f64) -> [f64; 2] {
        if truth { [one, other] } else { [other, one] }
    }

    #[inline(always)]
    fn signed(self, truth: bool) -> f64 {
        if truth { self } else { -self }
    }

    #[inline(always)]
    fn larger(self, other: f64) -> f64 {
        if self > other { self } else { other }
    }

    #[inline(always)]
    fn smaller(self, other: f64) -> f64 {
        if self < other { self } else { other }
    }

    #[inline(always)]
    fn root(self) -> f64 {
        self.sqrt()
    }

    #[inline(always)]
    fn all(truth: bool) -> bool {
        truth
    }

    #[inline(always)]
    fn size(self) -> f64 {
        self.abs()
    }

    #[inline(always)]
    fn turned_by(counted: f64, sine_and_cosine: [f64; 2]) -> [f64; 2] {
        let quarters = counted.to_bits();
        let [sine, cosine] = sine_and_cosine.map(f64::to_bits);
        let swap = (sine ^ cosine) & (quarters & 1).wrapping_neg();
        let signs = [quarters & 2, quarters.wrapping_add(1) & 2].map(|second| second << 62);
        [sine ^ swap ^ signs[0], cosine ^ swap ^ signs[1]].map(f64::from_bits)
    }
}

impl Number for Pair {
    type Truth = Pair;

    #[inline(always)]
    fn lane(self, i: usize) -> f64 {
        self.to_array()[i]
    }

    #[inline(always)]
    fn of(mut lane: impl FnMut(usize) -> f64) -> Pair {
        Pair::new([lane(0), lane(1)])
    }

    #[inline(always)]
    fn above(self, other: Pair) -> Pair {
        self.simd_gt(other)
    }

    #[inline(always)]
    fn at_least(self, other: Pair) -> Pair {
        self.simd_ge(other)
    }

    #[inline(always)]
    fn choose(truth: Pair, yes: Pair, no: Pair) -> Pair {
        truth.select(yes, no)
    }

    #[inline(always)]
    fn either(truth: Pair, one: Pair, other: Pair) -> [Pair; 2] {
        let apart = !truth & (one ^ other);
        [one ^ apart, other ^ apart]
    }

    #[inline(always)]
    fn signed(self, truth: Pair) -> Pair {
        self ^ (!truth & Pair::splat(-0.0))
    }

    #[inline(always)]
    fn larger(self, other: Pair) -> Pair {
        self.fast_max(other)
    }

    #[inline(always)]
    fn smaller(self, other: Pair) -> Pair {
        self.fast_min(other)
    }

    #[inline(always)]
    fn root(self) -> Pair {
        self.sqrt()
    }

    #[inline(always)]
    fn all(truth: Pair) -> bool {
        truth.all()
    }

    #[inline(always)]
    fn size(self) -> Pair {
        self.abs()
    }

    #[inline(always)]
    fn turned_by(counted: Pair, sine_and_cosine: [Pair; 2]) -> [Pair; 2] {
        let (one, two) = (u64x2::splat(1), u64x2::splat(2));
        let quarters = bits(counted);
        let [sine, cosine] = sine_and_cosine.map(bits);
        let swap = (sine ^ cosine) & (u64x2::ZERO - (quarters & one));
        let signs = [quarters & two, (quarters + one) & two].map(|second| second << 62);
        [sine ^ swap ^ signs[0], cosine ^ swap ^ signs[1]]
            .map(|each: u64x2| Pair::new(each.to_array().map(f64::from_bits)))
    }
}

/// Of both numbers.
#[inline(always)]
fn bits(pair: Pair) -> u64x2 {
    u64x2::new(pair.to_array().map(f64::to_bits))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn formula<N: Number>(a: N, b: N) -> N {
        let ratio = (a - b) / (a * b + N::from(0.1));
        let [one, other] = N::either(a.above(b), a, b.signed(a.above(b)));
        let sum = one.larger(b) + N::from(2.0) * other.smaller(a);
        N::choose(a.above(b), ratio.larger(-ratio).root(), N::of(|i| libm::exp(b.lane(i)))) + sum
    }

    #[test]
    fn the_exponential_is_that_of_the_library_to_the_last_digits() {
        for i in -80..=80 {
            let x = 0.005 * f64::from(i);
            let expected = x.exp();
            assert!((x.exponential() / expected - 1.0).abs() < 5e-16, "{x}");
            let both = Pair::new([x, -x]).exponential();
            assert!((both.lane(1) * expected - 1.0).abs() < 7e-16, "{x}");
        }
        assert_eq!(5.0.exponential(), libm::exp(5.0));
    }

    #[test]
    fn an_angle_in_cycles_has_the_sine_and_cosine_of_the_textbook() {
        for i in -400..400 {
            let cycles = 0.0173 * f64::from(i);
            let [sine, cosine] = cycles.sine_and_cosine_of_cycles();
            let (expected_sine, expected_cosine) = (2.0 * PI * cycles).sin_cos();
            assert!((sine - expected_sine).abs() < 1e-14 && (cosine - expected_cosine).abs() < 1e-14, "{i}");
        }
        assert_eq!((1e6 + 0.25).sine_and_cosine_of_cycles(), [1.0, 0.0]);
        // Within an eighth of a cycle to the last digits.
        for i in -125..=125 {
            let cycles = 0.001 * f64::from(i);
            let [sine, cosine] = cycles.sine_and_cosine_of_cycles();
            let (expected_sine, expected_cosine) = libm::sincos(2.0 * PI * cycles);
            let near = |got: f64, expected: f64| (got - expected).abs() <= 3.4e-16 * expected.abs();
            assert!(near(sine, expected_sine), "{cycles}: {sine} {expected_sine}");
            assert!(near(cosine, expected_cosine), "{cycles}: {cosine} {expected_cosine}");
        }
    }

    #[test]
    fn two_numbers_at_once_have_the_bits_of_each_alone() {
        for (one, two) in [((0.3, 0.7), (1.1, -4.0)), ((1e9, 1e-9), (0.1, 0.1)), ((-2.0, 5.0), (7.0, 3.0))] {
            let both = formula(Pair::new([one.0, two.0]), Pair::new([one.1, two.1]));
            let alone = [formula(one.0, one.1), formula(two.0, two.1)];
            assert_eq!(both.to_array().map(f64::to_bits), alone.map(f64::to_bits));
        }
    }
}
