//! The residuals of a fit by frequency: whether they are noise, and how large they are where the parameters are found.
//!
//! ```text
//! c_k = cosine transform (orthonormal DCT-II) of the residuals of a channel in a record
//! E_b = sum of c_k^2 over a band b, and over the records          expected of noise: sigma^2 (n_b - l_b)
//! l_b = sum of g_k' C g_k                                         absorbed by the fit; g_k: the transform of J
//! F_b = E_b / (n_b - l_b) over the same of the highest band       F distributed where all is noise
//! ```
//!
//! A model that lacks something leaves slow residuals, whose sum of squares is a small part of all: in a band of their own
//! they are seen where the total does not show them. Noise is told by the highest band, where no model that is half right
//! leaves much; that this is not more than in the rests is a test, too. A channel with too few samples for any of this cannot
//! be judged; if none can, it is not known whether the model fits.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use rustfft::FftPlanner;
use rustfft::num_complex::Complex;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use super::model::{Block, ROUNDING};
use super::recording::CHANNELS;

/// Upper edges of the bands, in parts of half the sampling rate; the last one gives the noise.
const EDGES: [f64; 6] = [0.03125, 0.0625, 0.125, 0.25, 0.5, 1.0];

/// The edges of the highest band.
const HIGHEST: f64 = EDGES[EDGES.len() - 2];
const TOP: f64 = EDGES[EDGES.len() - 1];

/// A band can be judged with this many degrees of freedom.
const FEWEST: f64 = 3.0;

/// Residuals are more than noise where that happens by chance once in a thousand fits.
const CHANCE: f64 = 1e-3;

/// A band whose F is above 1 by chance more often than this counts as noise.
const LOUD: f64 = 0.05;

/// The residuals of a channel in a band.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// Place in [`CHANNELS`].
    pub channel: usize,
    /// Lower and upper edge, in parts of half the sampling rate. The whole range for the noise itself.
    pub edges: [f64; 2],
    /// Variance over that of the noise.
    pub ratio: f64,
    /// How often noise has as large a ratio.
    pub chance: f64,
    /// Sum of squares beyond that of the noise, in the squared unit of the residuals; 0 where it may be chance.
    pub excess: f64,
}

impl Band {
    /// A band whose noise has another variance, which is known as well as these degrees of freedom say.
    fn of(channel: usize, edges: [f64; 2], energy: Energy, (noise, freedom): (f64, f64)) -> Band {
        let ratio = energy.variance() / noise;
        let chance = chance(ratio, energy.freedom, freedom);
        let beyond = (energy.variance() - noise).max(0.0) * energy.freedom;
        Band { channel, edges, ratio, chance, excess: if chance < LOUD { beyond } else { 0.0 } }
    }
}

/// The residuals of a fit by channel and frequency.
#[derive(Clone, Debug, Default)]
pub struct Spectrum {
    /// All bands that can be judged.
    pub bands: Vec<Band>,
    /// Standard deviation of the noise of each channel, in the unit of the residuals.
    pub noise: [Option<f64>; CHANNELS.len()],
    /// Places in [`CHANNELS`] of those whose samples are too few to be judged.
    pub unjudged: Vec<usize>,
}

/// A sum of squares and its degrees of freedom.
#[derive(Clone, Copy, Debug, Default)]
struct Energy {
    squares: f64,
    freedom: f64,
}

impl Energy {
    fn variance(self) -> f64 {
        self.squares / self.freedom
    }
}

/// What rests have shown of a channel's noise.
#[derive(Clone, Copy, Debug)]
pub struct AtRest {
    /// Standard deviation, in the unit of the residuals.
    pub noise: f64,
    /// Independent readings; infinite where rounding is all there is.
    pub freedom: f64,
    /// Standard deviation of rounding, in the same unit; noise is not below it.
    pub rounding: f64,
}

/// The transform of a block: of its residuals and, column by column, of their derivatives.
struct Transformed {
    channel: usize,
    residuals: Vec<f64>,
    derivatives: DMatrix<f64>,
}

/// Residuals and derivatives of a fit, transformed.
pub struct Transform {
    blocks: Vec<Transformed>,
    has_samples: [bool; CHANNELS.len()],
}

impl Transform {
    /// Of the rows of each block.
    pub(super) fn of(blocks: &[Block], residuals: &DVector<f64>, jacobian: &DMatrix<f64>) -> Transform {
        let mut planner = FftPlanner::new();
        let has_samples = std::array::from_fn(|channel| {
            blocks.iter().any(|block| block.channel == channel && !block.rows.is_empty())
        });
        let blocks = blocks.iter().filter(|block| block.rows.len() > 1).map(|block| {
            let Range { start, .. } = block.rows;
            let n = block.rows.len();
            let mut derivatives = jacobian.rows(start, n).into_owned();
            for mut column in derivatives.column_iter_mut() {
                let transformed = cosine_transform(&mut planner, column.iter().copied());
                column.copy_from_slice(&transformed);
            }
            let residuals = cosine_transform(&mut planner, residuals.rows(start, n).iter().copied());
            Transformed { channel: block.channel, residuals, derivatives }
        });
        Transform { blocks: blocks.collect(), has_samples }
    }

    /// The energy of a channel in a band, where the unknowns have this covariance.
    fn energy(&self, channel: usize, edges: [f64; 2], covariance: &DMatrix<f64>) -> Energy {
        let mut energy = Energy::default();
        for block in self.blocks.iter().filter(|block| block.channel == channel) {
            let rows = rows(edges, block.residuals.len());
            energy.squares += block.residuals[rows.clone()].iter().map(|c| c * c).sum::<f64>();
            let derivatives = block.derivatives.rows(rows.start, rows.len());
            let taken = (derivatives * covariance).component_mul(&derivatives).sum();
            energy.freedom += rows.len() as f64 - taken;
        }
        energy
    }

    /// J' J with each band weighted by its variance, or that of the noise where it is louder by chance.
    pub(super) fn weighted(&self, spectrum: &Spectrum) -> DMatrix<f64> {
        let columns = self.blocks.first().map_or(0, |block| block.derivatives.ncols());
        let mut sum = DMatrix::zeros(columns, columns);
        for block in &self.blocks {
            for edges in bands() {
                let rows = rows(edges, block.residuals.len());
                let derivatives = block.derivatives.rows(rows.start, rows.len());
                sum += derivatives.tr_mul(&derivatives) * spectrum.variance(block.channel, edges);
            }
        }
        sum
    }

    /// The bands of each channel.
    pub(super) fn spectrum(&self, covariance: &DMatrix<f64>, rests: [AtRest; CHANNELS.len()]) -> Spectrum {
        let mut spectrum = Spectrum::default();
        for (channel, rest) in rests.into_iter().enumerate() {
            let noise = self.noise(channel, rest, covariance);
            let bands = noise.map_or_else(Vec::new, |noise| self.bands(channel, noise, rest, covariance));
            spectrum.noise[channel] = noise.map(|noise| noise.variance().sqrt());
            if bands.is_empty() && self.has_samples[channel] {
                spectrum.unjudged.push(channel);
            }
            spectrum.bands.extend(bands);
        }
        spectrum
    }

    /// The energy of a channel's highest band, not below that of rounding; None of too few samples.
    fn noise(&self, channel: usize, rest: AtRest, covariance: &DMatrix<f64>) -> Option<Energy> {
        let noise = self.energy(channel, [HIGHEST, TOP], covariance);
        let squares = noise.squares.max(rest.rounding.powi(2) * noise.freedom);
        (noise.freedom >= FEWEST).then_some(Energy { squares, ..noise })
    }

    /// The bands of a channel below the highest against its noise, and its noise against that of the rests.
    fn bands(&self, channel: usize, noise: Energy, rest: AtRest, covariance: &DMatrix<f64>) -> Vec<Band> {
        let below = bands().filter(|edges| edges[1] < TOP).filter_map(|edges| {
            let energy = self.energy(channel, edges, covariance);
            let of = || Band::of(channel, edges, energy, (noise.variance(), noise.freedom));
            (energy.freedom >= FEWEST).then(of)
        });
        let resting = (rest.noise.powi(2), rest.freedom);
        let at_rest = (rest.freedom >= FEWEST).then(|| Band::of(channel, [0.0, TOP], noise, resting));
        below.chain(at_rest).collect()
    }
}

impl Spectrum {
    /// Whether any channel has enough samples to be judged.
    #[must_use]
    pub fn is_testable(&self) -> bool {
        !self.bands.is_empty()
    }

    /// Whether all that remains is noise; not where nothing can be judged.
    #[must_use]
    pub(crate) fn is_noise(&self) -> bool {
        self.is_testable() && !self.is_more_than_noise()
    }

    /// Whether more than noise remains; not where nothing can be judged.
    #[must_use]
    pub(crate) fn is_more_than_noise(&self) -> bool {
        self.loudest().is_some_and(|band| band.chance * (self.bands.len() as f64) < CHANCE)
    }

    /// Norm of the residuals beyond noise; 0 where no more than noise is seen.
    #[must_use]
    pub fn misfit(&self) -> f64 {
        let excess = || self.bands.iter().map(|band| band.excess).sum::<f64>().sqrt();
        if self.is_more_than_noise() { excess() } else { 0.0 }
    }

    /// The band that noise explains least.
    #[must_use]
    pub(crate) fn loudest(&self) -> Option<&Band> {
        let order = |a: &&Band, b: &&Band| a.chance.total_cmp(&b.chance).then(b.ratio.total_cmp(&a.ratio));
        self.bands.iter().min_by(order)
    }

    /// The variance of a channel in a band.
    fn variance(&self, channel: usize, edges: [f64; 2]) -> f64 {
        let of = |band: &&Band| band.channel == channel && band.edges == edges;
        let ratio = match self.bands.iter().find(of) {
            Some(band) if band.chance < LOUD => band.ratio.max(1.0),
            _ => 1.0,
        };
        ratio * self.noise[channel].unwrap_or(1.0).powi(2)
    }
}

/// The edges of each band.
fn bands() -> impl Iterator<Item = [f64; 2]> {
    let lower = std::iter::once(0.0).chain(EDGES);
    lower.zip(EDGES).map(|(low, high)| [low, high])
}

/// The indices of a transform of `n` values that lie in a band.
fn rows([low, high]: [f64; 2], n: usize) -> Range<usize> {
    let place = |edge: f64| (edge * n as f64).ceil() as usize;
    place(low)..place(high)
}

/// How often F is above `ratio`.
fn chance(ratio: f64, freedom: f64, of_noise: f64) -> f64 {
    // An F distribution of that many degrees of freedom is that of a known noise.
    let of_noise = of_noise.min(1e6);
    if !ratio.is_finite() {
        return 0.0;
    }
    FisherSnedecor::new(freedom, of_noise).map_or(1.0, |f| f.sf(ratio))
}

/// DCT-II, orthonormal: by the transform of the values and their mirror image.
fn cosine_transform(planner: &mut FftPlanner<f64>, values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut both: Vec<Complex<f64>> = values.map(|value| Complex::new(value, 0.0)).collect();
    let n = both.len();
    both.extend_from_within(..);
    both[n..].reverse();
    planner.plan_fft_forward(2 * n).process(&mut both);
    let size = |k: usize| if k == 0 { (1.0 / n as f64).sqrt() } else { (2.0 / n as f64).sqrt() };
    let turned = |k: usize| {
        let angle = std::f64::consts::PI * k as f64 / (2 * n) as f64;
        0.5 * (both[k].re * angle.cos() + both[k].im * angle.sin())
    };
    (0..n).map(|k| size(k) * turned(k)).collect()
}

/// What rests tell of the noise of a channel of `sigma` counts: that it is `noise` counts, from `freedom` readings; 0
/// where rounding is all there is.
#[must_use]
pub fn at_rest(sigma: f64, noise: f64, freedom: f64) -> AtRest {
    let freedom = if freedom > 0.0 { freedom } else { f64::INFINITY };
    AtRest { noise: noise / sigma, freedom, rounding: ROUNDING / sigma }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Normal numbers from a fixed sequence.
    fn draws(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed;
        move || {
            (0..12).fold(-6.0, |sum, _| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                sum + (state >> 11) as f64 / (1u64 << 53) as f64
            })
        }
    }

    const RECORDS: usize = 6;
    const SAMPLES: usize = 200;

    fn blocks() -> Vec<Block> {
        (0..RECORDS).map(|i| Block { channel: 1, rows: i * SAMPLES..(i + 1) * SAMPLES }).collect()
    }

    /// The spectrum of noise of 1 and a slow swing, where nothing was fitted.
    fn spectrum(seed: u64, swing: f64) -> Spectrum {
        let mut draw = draws(seed);
        let residuals =
            DVector::from_fn(RECORDS * SAMPLES, |i, _| swing * (0.05 * (i % SAMPLES) as f64).sin() + draw());
        let jacobian = DMatrix::zeros(RECORDS * SAMPLES, 1);
        let rest = AtRest { noise: 1.0, freedom: 200.0, rounding: 0.3 };
        Transform::of(&blocks(), &residuals, &jacobian)
            .spectrum(&DMatrix::zeros(1, 1), [rest; CHANNELS.len()])
    }

    #[test]
    fn the_transform_keeps_the_sum_of_squares_and_knows_a_cosine() {
        let n = 7;
        let wave = |i: usize| (std::f64::consts::PI * 3.0 * (i as f64 + 0.5) / n as f64).cos();
        let transformed = cosine_transform(&mut FftPlanner::new(), (0..n).map(wave));
        for (k, c) in transformed.iter().enumerate() {
            let expected = if k == 3 { (0.5 * n as f64).sqrt() } else { 0.0 };
            assert!((c - expected).abs() < 1e-12, "{k}: {c}");
        }
    }

    #[test]
    fn noise_alone_passes_nearly_always() {
        let refused = (1..=300).filter(|&seed| !spectrum(seed, 0.0).is_noise()).count();
        assert!(refused <= 3, "{refused} of 300");
    }

    /// The root of the mean square grows by four per cent.
    #[test]
    fn a_slow_swing_that_the_total_does_not_show_is_noticed() {
        let noticed = (1..=100).filter(|&seed| !spectrum(seed, 0.4).is_noise()).count();
        assert!(noticed >= 95, "{noticed} of 100");
        let loudest = spectrum(1, 0.4);
        assert!(loudest.loudest().expect("bands").edges[1] < 0.1);
    }

    #[test]
    fn noise_that_is_louder_than_the_rests_is_noticed() {
        let mut draw = draws(5);
        let residuals = DVector::from_fn(RECORDS * SAMPLES, |_, _| 2.0 * draw());
        let jacobian = DMatrix::zeros(RECORDS * SAMPLES, 1);
        let rest = AtRest { noise: 1.0, freedom: 200.0, rounding: 0.3 };
        let transform = Transform::of(&blocks(), &residuals, &jacobian);
        assert!(!transform.spectrum(&DMatrix::zeros(1, 1), [rest; CHANNELS.len()]).is_noise());
    }

    /// Of a record of a few samples whose residuals are many times the noise.
    fn of_few(samples: usize, of_rests: f64) -> Spectrum {
        let block = [Block { channel: 1, rows: 0..samples }];
        let (residuals, jacobian) = (DVector::from_element(samples, 50.0), DMatrix::zeros(samples, 1));
        let rest = AtRest { noise: 1.0, freedom: of_rests, rounding: 0.3 };
        let transform = Transform::of(&block, &residuals, &jacobian);
        transform.spectrum(&DMatrix::zeros(1, 1), [rest; CHANNELS.len()])
    }

    #[test]
    fn residuals_too_few_to_be_judged_do_not_pass_for_noise() {
        for (samples, of_rests) in [(1, 200.0), (4, 200.0), (6, 0.0)] {
            let spectrum = of_few(samples, of_rests);
            assert!(spectrum.bands.is_empty() && !spectrum.is_noise(), "{samples}: {spectrum:?}");
        }
    }

    /// A fit takes what its column shows: of a constant, one degree of freedom a record, and no noise is left there.
    #[test]
    fn degrees_of_freedom_that_a_fit_takes_do_not_count() {
        let mut draw = draws(9);
        let residuals = DVector::from_fn(SAMPLES, |_, _| draw());
        let flat = DMatrix::from_element(SAMPLES, 1, 1.0);
        let block = [Block { channel: 1, rows: 0..SAMPLES }];
        let transform = Transform::of(&block, &residuals, &flat);
        let energy = transform.energy(1, [0.0, 0.03125], &DMatrix::from_element(1, 1, 1.0 / SAMPLES as f64));
        assert!((energy.freedom - 6.0).abs() < 1e-9, "{energy:?}");
    }

    #[test]
    fn derivatives_count_by_the_noise_of_their_band() {
        let mut draw = draws(3);
        let residuals =
            DVector::from_fn(RECORDS * SAMPLES, |i, _| 3.0 * (0.05 * (i % SAMPLES) as f64).sin() + draw());
        let [slow, fast] = [1.0, -1.0]
            .map(|sign| DMatrix::from_fn(RECORDS * SAMPLES, 1, |i, _| if i % 2 == 0 { 1.0 } else { sign }));
        let weight = |jacobian: DMatrix<f64>| {
            let transform = Transform::of(&blocks(), &residuals, &jacobian);
            let rest = AtRest { noise: 1.0, freedom: 200.0, rounding: 0.3 };
            let spectrum = transform.spectrum(&DMatrix::zeros(1, 1), [rest; CHANNELS.len()]);
            transform.weighted(&spectrum)[(0, 0)] / jacobian.norm_squared()
        };
        assert!(weight(slow) > 20.0);
        assert!((weight(fast) - 1.0).abs() < 0.1);
    }
}
