//! Numbers as the thesis prints them.

/// The value of a number as the thesis prints it, with commas between thousands.
///
/// # Panics
/// If it is not a number; a test reads all of them.
#[must_use]
pub fn value_of(text: &str) -> f64 {
    text.replace(',', "").parse().unwrap_or_else(|_| panic!("{text:?} is not a number"))
}
