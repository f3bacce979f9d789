//! The unit that a number without one is likely to be in.

/// The unit in which people and catalogues state such a number, for a quantity of the unit `si`.
pub fn unit_of(number: f64, si: &str) -> &str {
    let size = number.abs();
    match si {
        "m" if size >= 1.0 => "mm",
        "Pa" if size <= 50.0 => "bar(g)",
        "Pa" if size < 5e3 => "kPa(a)",
        "Pa" => "Pa(a)",
        "K" if size < 150.0 => "degC",
        "m3" if size >= 0.01 => "cm3",
        "m3/s" if size >= 1.0 => "l/min",
        "m3/(s Pa)" if size >= 1e-3 => "dm3/(s bar)",
        "s" if size >= 1.0 => "ms",
        other => other,
    }
}
