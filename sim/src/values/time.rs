//! Times of a rig in seconds and in whole microseconds.

/// The instant of a whole number of microseconds, s: rounded once.
pub(crate) fn seconds(microseconds: u64) -> f64 {
    // A signed number becomes a float in one instruction; no time is too large for it.
    microseconds as i64 as f64 / 1e6
}

/// Seconds as whole microseconds, if they are (to a thousandth of one).
pub(crate) fn whole_microseconds(seconds: f64) -> Option<u64> {
    let us = (seconds * 1e6).round();
    (us >= 0.0 && (seconds * 1e6 - us).abs() < 1e-3).then_some(us as u64)
}
