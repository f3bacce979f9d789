//! The encoder.
//!
//! ```text
//! count = floor(position / pulse + 1e-9)
//! ```
//!
//! as in DESIGN section 4.

use crate::key::keys;
use crate::values::{Findings, Rig};

keys! {
    MM_PER_COUNT: f64 = number("encoder.mm_per_count", 0.01205, 1e-6, 2.0, "C(42)", "Stroke per encoder count.");
    POLARITY: i64 = integer("encoder.polarity", 1, -1, 1, "", "-1: the encoder counts down when the rod extends (a matter of wiring; the twin always counts up).");
}

/// A pulse of the encoder, m.
#[must_use]
pub fn pulse(rig: &Rig) -> f64 {
    rig.get(&keys::MM_PER_COUNT) * 1e-3
}

/// What the encoder's keys must hold.
pub(crate) fn check(rig: &Rig, findings: &mut Findings) {
    if rig.get(&keys::POLARITY) == 0 {
        findings.note(&keys::POLARITY, "must be 1 or -1");
    }
}

/// How far a position is from where its count changes, in its unit.
pub(crate) fn distance_to_count(position: f64, pulse: f64) -> f64 {
    let pulses = position / pulse + 1e-9;
    let between = pulses - pulses.floor();
    between.min(1.0 - between) * pulse
}

/// The encoder's count at a position, both in the same unit.
#[must_use]
pub fn count(position: f64, pulse: f64) -> i32 {
    let pulses = position / pulse + 1e-9;
    // Towards zero, and from there down.
    let whole = pulses as i32;
    whole.saturating_sub(i32::from(f64::from(whole) > pulses))
}
