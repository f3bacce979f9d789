//! The sum of what laws feed back and forward, exact in `i64` and saturated once to `i32`.
//!
//! ```text
//! n = Kp n_p - Kv n_v - Ka n_a - k5 n_q + n_f
//! n_f = Fv Wv v + Fa Wv Wa a        v, a: first and second difference of the setpoint, counts a sample (and sample)
//! ```
//!
//! Inside the velocity dead band n_v counts as 0; inside the position dead band there is no sum, unless something is fed forward.
//! k5 is 0 unless pressures are fed back for damping (9.1.2, [`crate::pressure`]).
//!
//! Feed-forward (not in the thesis) is of the setpoint's own motion while a profile moves it, with windows of Wv and Wa samples,
//! so that Fv = Kv and Fa = Ka feed back the deviation from the setpoint's motion. It is 0 while the setpoint stands and where it
//! jumps.

use super::{LawConfig, Measured, Reference};
use crate::fixed::{divide_toward_zero, saturate};
use crate::pressure::Mean;

/// n without pressures, with Kp for the error; None in the dead band.
#[inline(always)]
pub(super) fn sum(
    config: &LawConfig,
    gain: impl FnOnce(i32) -> u16,
    measured: Measured,
    reference: Reference,
) -> Option<i64> {
    (!is_idle(config, reference))
        .then(|| weighed(config, gain(reference.error), measured, reference.error) + reference.feed_forward)
}

/// What damping remembers: the mean of the pressures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Feedback(Mean);

impl Feedback {
    /// n; pressures are looked at in the dead band, too.
    pub fn damped_sum(
        &mut self,
        config: &LawConfig,
        gain: impl FnOnce(i32) -> u16,
        measured: Measured,
        reference: Reference,
    ) -> Option<i64> {
        let damping = self.pressure(config, measured);
        Some(sum(config, gain, measured, reference)? - damping)
    }

    /// k5 n_q.
    pub fn pressure(&mut self, config: &LawConfig, measured: Measured) -> i64 {
        i64::from(config.pressure_gain) * i64::from(self.0.transient(measured.pressures))
    }
}

/// Whether the error is in the dead band and nothing is fed forward.
fn is_idle(config: &LawConfig, reference: Reference) -> bool {
    reference.error.unsigned_abs() < config.dead_band && reference.feed_forward == 0
}

/// Kp n_p - Kv n_v - Ka n_a: 16 + 32, 16 + 33 and 16 + 34 bits, so the sum is exact in 64, also with the 16 + 17
/// bits of k5 n_q, or the 48 bits of n_f.
pub(super) fn weighed(config: &LawConfig, gain: u16, measured: Measured, error: i32) -> i64 {
    let motion = measured.motion;
    let velocity = match config.velocity_dead_band {
        Some(band) if motion.velocity.unsigned_abs() < u64::from(band.get()) => 0,
        _ => motion.velocity,
    };
    i64::from(gain) * i64::from(error)
        - i64::from(config.velocity_gain) * velocity
        - i64::from(config.acceleration_gain) * motion.acceleration
}

/// The demand of a sum; without a sum, that of the null alone.
#[inline(always)]
pub(super) fn from_null(config: &LawConfig, sum: Option<i64>, measured: Measured) -> i32 {
    let null = measured.null(config);
    sum.map_or(null, |sum| scaled(config, sum).saturating_add(null))
}

/// Saturated once, and divided by the scale toward zero: valve counts.
pub(super) fn scaled(config: &LawConfig, sum: i64) -> i32 {
    divide_toward_zero(saturate(sum), config.scale)
}
