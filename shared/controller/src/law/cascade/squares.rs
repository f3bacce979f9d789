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
            row.iter_mut().skip(i).take(1).for_each(|variance| *variance = CERTAIN);
        }
        Squares { unknown: [0; N], covariance }
    }
}

impl<const N: usize> Squares<N> {
    /// An unknown may have changed: its variance grows by so much (Q30), up to that of the prior.
    pub(super) fn doubt(&mut self, unknown: usize, by: i32) {
        if let Some(variance) = self.covariance.get_mut(unknown).and_then(|row| row.get_mut(unknown)) {
            *variance = variance.saturating_add(by).min(CERTAIN);
        }
    }

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
        let unknowns = self.unknown.iter_mut().zip(bounds);
        for ((t, &[low, high]), &gain) in unknowns.zip(&gain) {
            *t = t.saturating_add(product(gain, miss, 22)).min(high).max(low);
        }
        let mut rows = self.covariance.as_mut_slice();
        for (i, &gain) in gain.iter().enumerate() {
            let Some((row, below)) = rows.split_first_mut() else { return };
            let mut row = row.iter_mut().zip(&ph).skip(i);
            if let Some((variance, &ph)) = row.next() {
                let next = variance.saturating_sub(product(gain, ph, 20));
                *variance = next.saturating_add(DRIFT).clamp(DRIFT, CERTAIN);
            }
            for ((p, &ph), below) in row.zip(below.iter_mut()) {
                *p = within(p.saturating_sub(product(gain, ph, 20)), CERTAIN);
                if let Some(mirrored) = below.get_mut(i) {
                    *mirrored = *p;
                }
            }
            rows = below;
        }
    }
}
