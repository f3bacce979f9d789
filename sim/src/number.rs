//! What an equation is computed in: one number, or two at once.
//!
//! Valve and cylinder have two of everything. An equation that is written for a [`Number`] holds for a
//! [`Pair`] as well, whose two numbers one instruction adds or multiplies; both come out in the very bits that
//! each would have alone.

use std::ops::{Add, Div, Mul, Neg, Sub};

use wide::f64x2;

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
    /// The larger one.
    fn larger(self, other: Self) -> Self;
    /// The square root.
    fn root(self) -> Self;
    /// Whether it holds for all of them.
    fn all(truth: Self::Truth) -> bool;
    /// Its size without the sign.
    fn size(self) -> Self;

    /// e to its power, to 3e-16 of it. Small ones, as drops of pressure and fading oscillations have, need
    /// multiplications and additions alone; the others are libm's.
    #[inline(always)]
    fn exponential(self) -> Self {
        if !Self::all(Self::from(SMALL).at_least(self.size())) {
            return Self::of(|i| libm::exp(self.lane(i)));
        }
        let mut sum = Self::from(PER_FACTORIAL[0]);
        for &coefficient in &PER_FACTORIAL[1..] {
            sum = sum * self + Self::from(coefficient);
        }
        sum
    }
}

/// Up to here the series below is exact to the last digit.
const SMALL: f64 = 0.35;

/// 1/n! for n from 13 to 0.
const PER_FACTORIAL: [f64; 14] = [
    1.0 / 6_227_020_800.0,
    1.0 / 479_001_600.0,
    1.0 / 39_916_800.0,
    1.0 / 3_628_800.0,
    1.0 / 362_880.0,
    1.0 / 40_320.0,
    1.0 / 5_040.0,
    1.0 / 720.0,
    1.0 / 120.0,
    1.0 / 24.0,
    1.0 / 6.0,
    1.0 / 2.0,
    1.0,
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
    fn larger(self, other: f64) -> f64 {
        if self > other { self } else { other }
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
    fn larger(self, other: Pair) -> Pair {
        self.fast_max(other)
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
}

#[cfg(test)]
mod tests {
    use super::*;

    fn formula<N: Number>(a: N, b: N) -> N {
        let ratio = (a - b) / (a * b + N::from(0.1));
        N::choose(a.above(b), ratio.larger(-ratio).root(), N::of(|i| libm::exp(b.lane(i))))
    }

    #[test]
    fn the_exponential_is_that_of_the_library_to_the_last_digits() {
        for i in -80..=80 {
            let x = 0.005 * f64::from(i);
            let expected = x.exp();
            assert!((x.exponential() / expected - 1.0).abs() < 3e-16, "{x}");
            let both = Pair::new([x, -x]).exponential();
            assert!((both.lane(1) * expected - 1.0).abs() < 5e-16, "{x}");
        }
        assert_eq!(5.0.exponential(), libm::exp(5.0));
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
