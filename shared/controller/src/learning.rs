//! The valve's null, learned at rest (Pu's strategy, thesis 8.2.3).
//!
//! ```text
//! new offset = old offset + gain * n_p         where a move ends that has arrived
//! demand     = ... + new offset / scale
//! ```
//!
//! The error that remains at rest shows how far the command is off the valve's null. The thesis adds the error
//! itself, a gain of 1. Its comparison lacks the magnitude of the error; without it, errors of one sign always learn.

use core::num::NonZeroU32;

use crate::fixed::{divide_toward_zero, saturate};

/// The learned offset: times the scale of the law, and in valve counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct NullOffset {
    scaled: i32,
    counts: i32,
}

impl NullOffset {
    /// A move has ended with this error, counts.
    pub fn learn(&mut self, gain: u16, error: i32, scale: NonZeroU32) {
        self.scaled = self.scaled.saturating_add(saturate(i64::from(gain) * i64::from(error)));
        self.counts = divide_toward_zero(self.scaled, scale);
    }

    /// The offset, valve counts.
    pub fn counts(self) -> i32 {
        self.counts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_left_at_rest_add_up_to_the_offset() {
        let scale = NonZeroU32::new(256).expect("not zero");
        let mut offset = NullOffset::default();
        for (error, counts) in [(3, 1), (3, 3), (-20, -7), (0, -7)] {
            offset.learn(128, error, scale);
            assert_eq!(offset.counts(), counts);
        }
        offset.learn(u16::MAX, i32::MIN, scale);
        offset.learn(u16::MAX, i32::MIN, scale);
        assert_eq!(offset.counts(), i32::MIN / 256, "saturated, not wrapped");
    }

    #[test]
    fn without_a_gain_nothing_is_learned() {
        let mut offset = NullOffset::default();
        offset.learn(0, i32::MAX, NonZeroU32::MIN);
        assert_eq!(offset, NullOffset::default());
    }
}
