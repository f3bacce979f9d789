//! A figure of a run stated as a range over the run and its neighbours.

/// The nominal value, which comes first, and between which values all lie, if that is more than the decimals show:
/// `0.21 (0.20 to 0.23)`. A value that a run does not show counts as `none`.
#[must_use]
pub fn stated(values: &[Option<f64>], decimals: usize) -> String {
    let word =
        |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.decimals$}"));
    let nominal = word(values.first().copied().flatten());
    let known = || values.iter().flatten().copied();
    let (low, high) = (known().fold(f64::INFINITY, f64::min), known().fold(f64::NEG_INFINITY, f64::max));
    let lacking = values.iter().filter(|value| value.is_none()).count();
    if low > high || (word(Some(low)) == word(Some(high)) && lacking == 0) {
        return nominal;
    }
    let ends = if word(Some(low)) == word(Some(high)) {
        word(Some(low))
    } else {
        format!("{} to {}", word(Some(low)), word(Some(high)))
    };
    match lacking {
        0 => format!("{nominal} ({ends})"),
        _ => format!("{nominal} ({ends}, none in {lacking} of {} runs)", values.len()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_that_the_digits_do_not_show_is_not_stated() {
        assert_eq!(stated(&[Some(0.2101), Some(0.2099)], 3), "0.210");
        assert_eq!(stated(&[Some(0.21), Some(0.2), Some(0.23)], 2), "0.21 (0.20 to 0.23)");
        assert_eq!(stated(&[Some(1.5)], 1), "1.5");
    }

    #[test]
    fn what_some_runs_do_not_show_is_told() {
        assert_eq!(stated(&[None, None], 2), "-");
        assert_eq!(stated(&[None, Some(0.2), Some(0.3)], 1), "- (0.2 to 0.3, none in 1 of 3 runs)");
        assert_eq!(stated(&[Some(0.2), Some(0.2), None], 1), "0.2 (0.2, none in 1 of 3 runs)");
    }
}
