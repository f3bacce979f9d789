//! Exact integer arithmetic that cannot panic: saturation and division toward zero.

use core::num::NonZeroU32;

/// `value` limited to the range of `i32`. The only saturation of the law's exact sums.
pub(crate) fn saturate(value: i64) -> i32 {
    let low = value as i32;
    if i64::from(low) == value {
        low
    } else if value < 0 {
        i32::MIN
    } else {
        i32::MAX
    }
}

/// `value / divisor`, truncated toward zero; exact for every input, also for `i32::MIN`.
///
/// The magnitudes are divided, since an unsigned division by a `NonZeroU32` has no path that traps.
/// EQUATIONS section 9: the thesis says "/" and "shifting"; toward zero keeps the law odd.
pub(crate) fn divide_toward_zero(value: i32, divisor: NonZeroU32) -> i32 {
    // At most 2^31, which is what i32::MIN by 1 gives: as its own negative.
    let magnitude = (value.unsigned_abs() / divisor) as i32;
    if value < 0 { magnitude.wrapping_neg() } else { magnitude }
}

/// `value / divisor`, rounded down; all bits set for a divisor of 0. Uses a shift and a subtraction for each bit:
/// 64-bit divisions of the compiler's library take more room, and no control sample needs this one. Inlined, its rounds are
/// written out wherever it is called.
#[inline(never)]
pub(crate) fn quotient(value: u64, divisor: u64) -> u64 {
    let (mut quotient, mut rest) = (0_u64, 0_u64);
    for bit in (0..u64::BITS).rev() {
        let carry = rest >> 63;
        rest = (rest << 1) | ((value >> bit) & 1);
        quotient <<= 1;
        if carry == 1 || rest >= divisor {
            rest = rest.wrapping_sub(divisor);
            quotient |= 1;
        }
    }
    quotient
}

#[cfg(test)]
mod tests {
    use super::*;

    fn divisor(value: u32) -> NonZeroU32 {
        NonZeroU32::new(value).expect("not zero")
    }

    #[test]
    fn saturation_keeps_what_fits_and_limits_what_does_not() {
        let edges = [(0, 0), (-1, -1), (1 << 40, i32::MAX), (-(1 << 40), i32::MIN)];
        for (value, expected) in edges {
            assert_eq!(saturate(value), expected);
        }
        assert_eq!(saturate(i64::from(i32::MAX)), i32::MAX);
        assert_eq!(saturate(i64::from(i32::MIN)), i32::MIN);
        assert_eq!(saturate(i64::from(i32::MAX) + 1), i32::MAX);
        assert_eq!(saturate(i64::from(i32::MIN) - 1), i32::MIN);
    }

    #[test]
    fn division_truncates_toward_zero_on_both_sides() {
        for (value, by, expected) in
            [(255, 256, 0), (-255, 256, 0), (257, 256, 1), (-257, 256, -1), (-512, 256, -2)]
        {
            assert_eq!(divide_toward_zero(value, divisor(by)), expected);
        }
        assert_eq!(divide_toward_zero(i32::MIN, divisor(1)), i32::MIN);
        assert_eq!(divide_toward_zero(i32::MAX, divisor(u32::MAX)), 0);
    }

    #[test]
    fn quotients_of_64_bits_are_those_of_the_processor() {
        let edges = [1, 2, 3, 7, 1 << 31, u64::from(u32::MAX), (1 << 40) - 87, 1 << 63, u64::MAX];
        for value in edges.into_iter().chain([0]) {
            for divisor in edges {
                assert_eq!(quotient(value, divisor), value / divisor, "{value} / {divisor}");
            }
        }
        assert_eq!(quotient(5, 0), u64::MAX);
    }
}
