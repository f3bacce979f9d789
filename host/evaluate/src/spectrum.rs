//! The spectrum of a channel (the thesis used a package of its time, ILS, for this).
//!
//! With the samples `x_k` less their mean, the weights `w_k` of a window, `N` samples a period `T` apart:
//!
//! ```text
//! A_m = 2 / (sum of w_k) * | sum over k of w_k x_k exp(-2 pi i m k / N) |      at m / (N T)
//! ```
//!
//! so a sine of amplitude `A` whose frequency is one of these shows as `A`, whatever the window.

use std::f64::consts::TAU;

use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

/// The weights of the samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Window {
    /// `1/2 - 1/2 cos`: narrow peaks; between two frequencies an amplitude reads up to 1.4 dB low.
    Hann,
    /// Five cosines (ISO 18431-2): amplitudes to 0.01 dB, wide peaks.
    FlatTop,
    /// None: for a whole number of periods.
    Rectangular,
}

impl Window {
    /// The weight of sample `k` of `n`.
    fn weight(self, k: usize, n: usize) -> f64 {
        let angle = TAU * k as f64 / n as f64;
        let cosines: &[f64] = match self {
            Window::Hann => &[1.0, -1.0],
            Window::FlatTop => &[1.0, -1.933, 1.286, -0.388, 0.0322],
            Window::Rectangular => &[1.0],
        };
        cosines.iter().enumerate().map(|(order, factor)| factor * (order as f64 * angle).cos()).sum()
    }
}

/// Amplitudes over frequencies.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spectrum {
    /// Frequencies, Hz, evenly spaced from 0 to half the sampling frequency.
    pub frequency: Vec<f64>,
    /// Amplitudes, in the channel's unit.
    pub amplitude: Vec<f64>,
}

/// A peak of a spectrum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// Frequency, Hz; it may lie between the spectrum's frequencies.
    pub frequency: f64,
    /// Amplitude, in the channel's unit.
    pub amplitude: f64,
}

impl Spectrum {
    /// The spectrum of samples that lie `period` seconds apart.
    ///
    /// ```
    /// use pneudrive_evaluate::spectrum::{Spectrum, Window};
    ///
    /// // A dither of 50 Hz and 0.26 mm, sampled every millisecond for a second.
    /// let spool: Vec<f64> = (0..1000).map(|k| 0.26 * (0.1 * std::f64::consts::PI * f64::from(k)).sin()).collect();
    /// let peak = Spectrum::of(&spool, 1e-3, Window::Hann).peaks(1)[0];
    /// assert!((peak.frequency - 50.0).abs() < 1e-6 && (peak.amplitude - 0.26).abs() < 1e-6);
    /// ```
    #[must_use]
    pub fn of(samples: &[f64], period: f64, window: Window) -> Spectrum {
        let n = samples.len();
        let mean = samples.iter().sum::<f64>() / n.max(1) as f64;
        let weights: Vec<f64> = (0..n).map(|k| window.weight(k, n)).collect();
        let weighted = samples.iter().zip(&weights).map(|(x, w)| Complex::new((x - mean) * w, 0.0));
        let mut values: Vec<Complex<f64>> = weighted.collect();
        FftPlanner::new().plan_fft_forward(n).process(&mut values);
        let scale = 2.0 / weights.iter().sum::<f64>();
        values.truncate(n / 2 + usize::from(n > 0));
        Spectrum {
            frequency: (0..values.len()).map(|m| m as f64 / (n as f64 * period)).collect(),
            amplitude: values.iter().map(|value| scale * value.norm()).collect(),
        }
    }

    /// The highest peaks, highest first. Each exceeds both its neighbours and a thousandth of the highest one. Its
    /// place is the top of the parabola through the logarithms of the three.
    #[must_use]
    pub fn peaks(&self, most: usize) -> Vec<Peak> {
        let highest = self.amplitude.iter().copied().fold(0.0, f64::max);
        let is_peak = |m: &usize| {
            let [before, here, after] = [m - 1, *m, m + 1].map(|m| self.amplitude[m]);
            here > before && here >= after && here > highest / 1e3
        };
        let last = self.amplitude.len().saturating_sub(1);
        let mut peaks: Vec<Peak> = (1..last.max(1)).filter(is_peak).map(|m| self.peak(m)).collect();
        peaks.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
        peaks.truncate(most);
        peaks
    }

    fn peak(&self, m: usize) -> Peak {
        // Values a million times below a peak are rounding and do not show its place.
        let floor = self.amplitude[m] / 1e6;
        let [before, here, after] = [m - 1, m, m + 1].map(|m| self.amplitude[m].max(floor).ln());
        let curvature = before - 2.0 * here + after;
        let shift = if curvature < 0.0 { (before - after) / (2.0 * curvature) } else { 0.0 };
        let step = self.frequency[1] - self.frequency[0];
        Peak { frequency: self.frequency[m] + shift * step, amplitude: self.amplitude[m] }
    }
}

/// A channel as integers of 12 bits, -2048 to 2048: the samples less their mean, the largest of them at the
/// end of the range. Also the mean, and the size of an integer's unit.
#[must_use]
pub fn bipolar_12_bit(samples: &[f64]) -> (Vec<i16>, f64, f64) {
    let mean = samples.iter().sum::<f64>() / samples.len().max(1) as f64;
    let largest = samples.iter().map(|x| (x - mean).abs()).fold(0.0, f64::max);
    let unit = if largest > 0.0 { largest / 2048.0 } else { 1.0 };
    (samples.iter().map(|x| ((x - mean) / unit).round() as i16).collect(), mean, unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD: f64 = 0.001;

    fn sine(amplitude: f64, frequency: f64, samples: usize) -> Vec<f64> {
        (0..samples).map(|k| 5.0 + amplitude * (TAU * frequency * k as f64 * PERIOD).sin()).collect()
    }

    #[test]
    fn a_sine_of_a_whole_number_of_periods_shows_its_amplitude_through_every_window() {
        for window in [Window::Hann, Window::FlatTop, Window::Rectangular] {
            let spectrum = Spectrum::of(&sine(3.0, 50.0, 1000), PERIOD, window);
            let peak = spectrum.peaks(1)[0];
            assert!((peak.amplitude - 3.0).abs() < 1e-9, "{window:?}: {peak:?}");
            assert!((peak.frequency - 50.0).abs() < 1e-6, "{window:?}: {peak:?}");
            assert!(spectrum.amplitude[0] < 1e-9, "the mean is left out");
        }
    }

    #[test]
    fn between_two_frequencies_each_window_keeps_its_promise() {
        let peak = |window| Spectrum::of(&sine(3.0, 50.5, 1000), PERIOD, window).peaks(1)[0];
        let decibel = |window| 20.0 * (peak(window).amplitude / 3.0).log10();
        assert!((-1.45..-1.35).contains(&decibel(Window::Hann)), "{}", decibel(Window::Hann));
        assert!(decibel(Window::FlatTop).abs() < 0.01, "{}", decibel(Window::FlatTop));
        assert!((peak(Window::Hann).frequency - 50.5).abs() < 0.02);
    }

    #[test]
    fn the_parts_of_a_sum_are_told_apart_highest_first() {
        let sum: Vec<f64> =
            sine(1.0, 20.0, 997).iter().zip(sine(4.0, 166.0, 997)).map(|(a, b)| a + b).collect();
        let peaks = Spectrum::of(&sum, PERIOD, Window::Hann).peaks(2);
        assert!((peaks[0].frequency - 166.0).abs() < 0.05 && (peaks[1].frequency - 20.0).abs() < 0.05);
    }

    #[test]
    fn silence_and_nothing_have_no_peaks() {
        assert!(Spectrum::of(&[5.0; 64], PERIOD, Window::Hann).peaks(5).is_empty());
        assert!(Spectrum::of(&[], PERIOD, Window::Hann).peaks(5).is_empty());
        assert!(Spectrum::of(&[1.0, 2.0], PERIOD, Window::Hann).peaks(5).is_empty());
    }

    #[test]
    fn twelve_bits_hold_the_largest_sample_at_their_end() {
        assert_eq!(bipolar_12_bit(&[1.0, 3.0, 2.0]), (vec![-2048, 2048, 0], 2.0, 1.0 / 2048.0));
        assert_eq!(bipolar_12_bit(&[7.0, 7.0]).0, [0, 0]);
    }
}
