//! Percentages.

/// A fraction from "10%" or "10".
pub(super) fn percent(text: &str) -> Result<f64, String> {
    let number = text.trim_end_matches('%').trim();
    let value: f64 = number.parse().map_err(|_| format!("{text:?} is not a percentage such as 10%"))?;
    if (0.0..=50.0).contains(&value) {
        Ok(value / 100.0)
    } else {
        Err("must be between 0% and 50%".to_owned())
    }
}
