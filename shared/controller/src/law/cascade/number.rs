//! Products, quotients and roots of fixed-point numbers. None of them panics, overflows or loops without an end.

use crate::fixed::saturate;

/// 1 of a pressure and of a force, Q24.
pub(super) const ONE: i32 = 1 << 24;

/// `a b / 2^bits`, rounded to the nearest, a half up, and saturated; `bits` from 1 to 62.
#[inline(always)]
pub(super) fn product(a: i32, b: i32, bits: u32) -> i32 {
    saturate((i64::from(a) * i64::from(b) + (1 << (bits - 1))) >> bits)
}

/// The same of numbers whose product fits, and so without the saturation.
#[inline(always)]
pub(super) fn fitting(a: u32, b: u32, bits: u32) -> u32 {
    ((u64::from(a) * u64::from(b) + (1 << (bits - 1))) >> bits) as u32
}

/// The same with a sign: mostly of a number and a part of 1, which is 2^bits.
#[inline(always)]
pub(super) fn scaled(a: i32, b: i32, bits: u32) -> i32 {
    let exact = (i64::from(a) * i64::from(b) + (1 << (bits - 1))) >> bits;
    debug_assert!(i32::try_from(exact).is_ok(), "{a} {b} {bits}");
    exact as i32
}

/// `a b / 2^32`, rounded down; exact for any a.
#[inline(always)]
pub(super) fn part(a: i64, b: u32) -> i64 {
    let (high, low) = (a >> 32, a & 0xffff_ffff);
    high.wrapping_mul(i64::from(b)).wrapping_add(((low as u64).wrapping_mul(u64::from(b)) >> 32) as i64)
}

/// `a / b` within 2^-15 of it, rounded down; the largest number for a b of 0, and where it does not fit.
#[inline]
pub(super) fn ratio(a: u64, b: u64) -> u64 {
    if a == 0 || b == 0 {
        return if b == 0 { u64::MAX } else { 0 };
    }
    let (up, down) = (a.leading_zeros(), b.leading_zeros());
    // The leading 32 bits by the leading 16.
    let (top, bottom) = (((a << up) >> 32) as u32, ((b << down) >> 48) as u32);
    let quotient = u64::from(top.checked_div(bottom).unwrap_or(u32::MAX));
    // a = top 2^(32 - up), b = bottom 2^(48 - down)
    match down as i32 - up as i32 - 16 {
        left @ 0.. if quotient.leading_zeros() as i32 <= left => u64::MAX,
        left @ 0.. => quotient << left,
        right => quotient >> right.unsigned_abs().min(63),
    }
}

/// The whole part of a square root, by Newton's method from above.
#[inline]
pub(super) fn root(square: u32) -> u32 {
    if square == 0 {
        return 0;
    }
    let bits = u32::BITS - square.leading_zeros();
    let step = |root: u32| (root + square.checked_div(root).unwrap_or(0)) >> 1;
    // Within a factor of the root of 2, then of 6e-2, 2e-3, 1e-6 and exact but for the last count.
    step(step(step(step(1 << bits.div_ceil(2)))))
}

/// The high half of a product: `a b / 2^32`, rounded down.
#[inline(always)]
pub(super) fn high(a: u32, b: u32) -> u32 {
    ((u64::from(a) * u64::from(b)) >> 32) as u32
}

/// `a 2^bits / b` within 2^-14 of it, rounded down; the largest number where it does not fit. `bits` up to 32.
#[inline(always)]
pub(super) fn over(a: u32, b: u32, bits: u32) -> u32 {
    let (up, down) = ((a | 1).leading_zeros(), (b | 1).leading_zeros());
    // All of its bits by the leading 16: a/b 2^(up - down + 16), below 2^17.
    let quotient = (a << up) / (((b << down) >> 16) | 1);
    match (up + 16) as i32 - (down + bits) as i32 {
        right @ 0.. => quotient >> right.min(31),
        left if quotient.leading_zeros() as i32 >= -left => quotient << -left,
        _ => u32::MAX,
    }
}

/// `n + sqrt(n^2 + d^2)` within a count or two, of numbers up to 2^15.
#[inline(always)]
pub(super) fn bend(n: u32, d: u32) -> u32 {
    let square = n * n + d * d;
    // By Newton's method from above. The lowest bit only keeps it from 0.
    let step = |root: u32| ((root | 1) + square / (root | 1)) >> 1;
    // Within 0.42, then 6e-2, 2e-3 and 1e-6 of it.
    n + step(step(step(n + d)))
}

/// The whole part of a cube root below 2^17.
pub(super) fn cube_root(cube: u64) -> u32 {
    (0..17).rev().fold(0, |root, bit| {
        let next = root | (1_u32 << bit);
        let side = u64::from(next);
        if side * side * side <= cube { next } else { root }
    })
}

/// Whole samples in microseconds.
pub(super) fn samples(us: u32, period_us: u32) -> u32 {
    us.checked_div(period_us).unwrap_or(0)
}

/// Limited to plus and minus `most`, which is not negative.
#[inline(always)]
pub(super) fn within(value: i32, most: i32) -> i32 {
    value.min(most).max(-most)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_rounded_once_and_saturated() {
        assert_eq!((product(3, 1, 1), product(-3, 1, 1), product(5, 3, 2)), (2, -1, 4));
        assert_eq!(
            (fitting(3, 1, 1), fitting(5, 3, 2), fitting(u32::MAX, u32::MAX, 32)),
            (2, 4, u32::MAX - 1)
        );
        for a in [i32::MIN, -12_345, -1, 0, 7, i32::MAX] {
            assert!(
                [0, 1, 3 << 28, 1 << 30].iter().all(|&part| scaled(a, part, 30) == product(a, part, 30)),
                "{a}"
            );
        }
        assert_eq!((product(i32::MIN, i32::MIN, 1), product(i32::MIN, i32::MAX, 1)), (i32::MAX, i32::MIN));
        for a in [0, 1, -1, 1 << 40, -(1 << 47), i64::from(i32::MIN), (1 << 52) + 12_345] {
            for b in [0, 1, u32::MAX, 1 << 31, 123_456_789] {
                assert_eq!(i128::from(part(a, b)), (i128::from(a) * i128::from(b)) >> 32, "{a} {b}");
            }
        }
    }

    #[test]
    fn what_a_bend_makes_of_a_number_is_its_equation() {
        for n in [0, 1, 2, 77, 1000, 4096, 9999, 20_000, 32_767, 32_768] {
            for d in [0, 1, 2, 77, 4096, 20_000, 32_767] {
                let exact = f64::from(n).hypot(f64::from(d)) + f64::from(n);
                assert!((f64::from(bend(n, d)) - exact).abs() <= 2.0, "{n}, {d}: {}", bend(n, d));
            }
        }
    }

    #[test]
    fn a_scaled_quotient_is_within_its_bound() {
        let numbers = [1, 2, 3, 7, 65_535, 65_537, 0x1234_5678, 1 << 31, u32::MAX];
        for a in numbers.into_iter().chain([0]) {
            for b in numbers {
                for bits in [0, 1, 16, 30, 32] {
                    let exact =
                        (f64::from(a) * f64::from(bits).exp2() / f64::from(b)).min(f64::from(u32::MAX));
                    let error = f64::from(over(a, b, bits)) - exact;
                    assert!(error <= 1e-9 + 6e-5 * exact && -error <= 1.0 + 6e-5 * exact, "{a}/{b}, {bits}");
                }
            }
        }
        assert_eq!(high(u32::MAX, u32::MAX), u32::MAX - 1);
    }

    #[test]
    fn a_quotient_is_within_its_bound() {
        let numbers =
            [1, 2, 3, 7, 65_535, 65_537, (1 << 31) - 1, 1 << 32, 0x1234_5678_9abc, 1 << 62, u64::MAX];
        for a in numbers {
            for b in numbers {
                let exact = a as f64 / b as f64;
                let error = ratio(a, b) as f64 - exact;
                assert!(
                    error <= 1.0 + 2.0_f64.powi(-15) * exact && -error <= 1.0 + 2.0_f64.powi(-15) * exact,
                    "{a}/{b}"
                );
            }
        }
        assert_eq!((ratio(0, 5), ratio(5, 0), ratio(0, 0)), (0, u64::MAX, u64::MAX));
    }

    #[test]
    fn roots_are_within_a_count() {
        let squares = [
            0,
            1,
            2,
            3,
            4,
            15,
            16,
            17,
            99,
            1 << 20,
            (1 << 30) - 1,
            1 << 30,
            0x7fff_ffff,
            u32::MAX - 1,
            u32::MAX,
        ];
        for square in squares.into_iter().chain((0..2000).map(|i| i * i * 1003 + i)) {
            let exact = f64::from(square).sqrt();
            assert!((f64::from(root(square)) - exact).abs() <= 1.0, "{square}");
        }
        for side in [1_u64, 2, 10, 999, 65_536, 131_071] {
            let cube = side * side * side;
            assert_eq!(
                [cube - 1, cube, cube + 1].map(cube_root),
                [side as u32 - 1, side as u32, side as u32]
            );
        }
    }
}
