//! Recursive least squares, with a prior and bounds.
//!
//! ```text
//! y = h' t         S = 1 + doubt^2 + h' P h,   k = P h/S,   t += k (y - h' t) within its bounds,   P += drift - k (P h)'
//! ```
//!
//! Each unknown t is counted in units of its prior deviation, y in units of its noise; P begins as 1. The drift keeps P positive,
//! whatever is rounded, and lets the unknowns change.
//!
//! | quantity | format | range |
//! |---|---|---|
//! | h, y | Q16 | 2^12, 2^15 deviations, limited |
//! | P, k | Q30 | -1 to 1 |
//! | P h, S, t | Q20, Q16, Q24 | saturated; S from 1 on |

use super::number::{product, within};
use crate::fixed::saturate;

/// Added to the variances with each sample, Q30: the prior's spread in 4 million samples.
const DRIFT: i32 = 1 << 8;
/// Largest h.
const LARGEST: i32 = 1 << 28;
/// 1 of P.
const CERTAIN: i32 = 1 << 30;

/// N unknowns and how well they are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Squares<const N: usize> {
    /// In their deviations, Q24.
    pub unknown: [i32; N],
    covariance: [[i32; N]; N],
}

impl<const N: usize> Default for Squares<N> {
    fn default() -> Squares<N> {
        let mut covariance = [[0; N]; N];
        for (i, row) in covariance.iter_mut().enumerate() {
            row[i] = CERTAIN;
        }
        Squares { unknown: [0; N], covariance }
    }
}

impl<const N: usize> Squares<N> {
    /// Takes a sample; `doubt` is the square of what is uncertain besides the noise, Q16, `bounds` are those of the unknowns.
    #[inline(always)]
    pub(super) fn fit(&mut self, h: [i32; N], y: i32, doubt: i32, bounds: &[[i32; 2]; N]) {
        let h = h.map(|h| within(h, LARGEST));
        let sum = |row: &[i32; N], bits: u32| {
            let products = row.iter().zip(&h).map(|(&p, &h)| i64::from(p) * i64::from(h));
            // Each is at most 2^59.
            saturate(products.sum::<i64>() >> bits)
        };
        let ph = self.covariance.each_ref().map(|row| sum(row, 26));
        let variance = i64::from(sum(&ph, 20).max(0)) + i64::from(doubt) + (1 << 16);
        let variance = variance.min(i64::from(u32::MAX)) as u32;
        // 1/S = by 2^(zeros - 32)
        let zeros = variance.leading_zeros();
        let by = u32::MAX.checked_div((variance << zeros) >> 16).unwrap_or(0) as i32;
        let gain = ph.map(|ph| product(ph, by, 22 - zeros.min(15)));
        let miss = y.saturating_sub(sum(&self.unknown, 24));
        for i in 0..N {
            let [low, high] = bounds[i];
            let next = self.unknown[i].saturating_add(product(gain[i], miss, 22));
            self.unknown[i] = next.min(high).max(low);
            let variance = self.covariance[i][i].saturating_sub(product(gain[i], ph[i], 20));
            self.covariance[i][i] = variance.saturating_add(DRIFT).clamp(DRIFT, CERTAIN);
            for (j, &ph) in ph.iter().enumerate().skip(i + 1) {
                let next = self.covariance[i][j].saturating_sub(product(gain[i], ph, 20));
                let next = within(next, CERTAIN);
                (self.covariance[i][j], self.covariance[j][i]) = (next, next);
            }
        }
    }
}
