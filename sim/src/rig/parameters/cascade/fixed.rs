//! Numbers of the law.

/// A number in 2^-bits; what does not fit an integer becomes the last one, beyond the range of its parameter.
pub(super) fn fixed(value: f64, bits: i32) -> i32 {
    (value * 2.0_f64.powi(bits)).round() as i32
}
