//! A figure of a run as a range over the run and its perturbed runs.

/// A figure over a run and its perturbed runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The figure of the run itself; None if the run does not show it.
    pub value: Option<f64>,
    /// Smallest and largest figure of the runs that show it; None if none does.
    pub ends: Option<[f64; 2]>,
    /// Number of runs that do not show it.
    pub lacking: usize,
    /// Number of runs.
    pub runs: usize,
}

impl Range {
    /// The range of a figure over several runs; the first is the run itself.
    #[must_use]
    pub fn of(values: &[Option<f64>]) -> Range {
        let known = values.iter().flatten().map(|value| [*value; 2]);
        Range {
            value: values.first().copied().flatten(),
            ends: known.reduce(|[least, most], [value, _]| [least.min(value), most.max(value)]),
            lacking: values.iter().filter(|value| value.is_none()).count(),
            runs: values.len(),
        }
    }
}

/// The nominal value, which comes first, and between which values all lie, if that is more than the decimals show:
/// `0.21 (0.20 to 0.23)`. A value that a run does not show counts as `none`.
#[must_use]
pub fn with_range(values: &[Option<f64>], decimals: usize) -> String {
    let word = |value: f64| format!("{value:.decimals$}");
    let range = Range::of(values);
    let nominal = range.value.map_or_else(|| "-".to_owned(), word);
    let Some([low, high]) = range.ends.map(|ends| ends.map(word)) else { return nominal };
    if low == high && range.lacking == 0 {
        return nominal;
    }
    let ends = if low == high { low } else { format!("{low} to {high}") };
    match range.lacking {
        0 => format!("{nominal} ({ends})"),
        lacking => format!("{nominal} ({ends}, none in {lacking} of {} runs)", range.runs),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_that_the_digits_do_not_show_is_not_stated() {
        assert_eq!(with_range(&[Some(0.2101), Some(0.2099)], 3), "0.210");
        assert_eq!(with_range(&[Some(0.21), Some(0.2), Some(0.23)], 2), "0.21 (0.20 to 0.23)");
        assert_eq!(with_range(&[Some(1.5)], 1), "1.5");
    }

    #[test]
    fn what_some_runs_do_not_show_is_told() {
        assert_eq!(with_range(&[None, None], 2), "-");
        assert_eq!(with_range(&[None, Some(0.2), Some(0.3)], 1), "- (0.2 to 0.3, none in 1 of 3 runs)");
        assert_eq!(with_range(&[Some(0.2), Some(0.2), None], 1), "0.2 (0.2, none in 1 of 3 runs)");
    }
}
