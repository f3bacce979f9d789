//! Numbers with the digits that count.

/// A number with this many significant digits.
pub(super) fn significant(value: f64, digits: i32) -> String {
    let before = if value == 0.0 { 1 } else { value.abs().log10().floor() as i32 + 1 };
    let decimals = (digits - before).clamp(0, 15) as usize;
    format!("{value:.decimals$}")
}
