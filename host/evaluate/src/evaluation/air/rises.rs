//! The total rise of a noisy value.

/// Rises up to each value.
pub(super) struct Rises {
    /// Sum of the rises up to each value.
    pub sum: Vec<f64>,
    /// The sum of the bands at which each was seen.
    pub bands: Vec<f64>,
}

/// The rises of values with a band each: changes within the band are noise.
///
/// A rise is seen when the value stands more than its band above the lowest since the last one, and ends when it has
/// fallen by its band.
pub(super) fn rises(values: &[f64], bands: &[f64]) -> Rises {
    let mut found = Rises { sum: Vec::with_capacity(values.len()), bands: Vec::with_capacity(values.len()) };
    let (mut sum, mut seen, mut low, mut top) = (0.0, 0.0, f64::INFINITY, None);
    for (&value, &band) in values.iter().zip(bands) {
        match top {
            None if value < low => low = value,
            None if value > low + band => {
                sum += value - low;
                seen += band;
                top = Some(value);
            }
            Some(highest) if value > highest => {
                sum += value - highest;
                top = Some(value);
            }
            Some(highest) if value < highest - band => (low, top) = (value, None),
            _ => {}
        }
        found.sum.push(sum);
        found.bands.push(seen);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_rises_above_the_band_count() {
        let with_band = |values: &[f64]| {
            let found = rises(values, &vec![1.0; values.len()]);
            (*found.sum.last().expect("values"), *found.bands.last().expect("values"))
        };
        assert_eq!(with_band(&[5.0, 5.5, 4.8, 5.4, 5.0]), (0.0, 0.0), "the steps of a converter");
        assert_eq!(with_band(&[5.0, 7.0, 9.0, 8.5, 9.5]), (4.5, 1.0), "filled, with a jitter on top");
        assert_eq!(with_band(&[5.0, 9.0, 3.0, 6.0]), (7.0, 2.0), "filled, emptied, filled");
    }
}
