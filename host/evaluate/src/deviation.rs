//! How far one transient is from another (the thesis's `stat`, Tab. 7.4).

use crate::transient::{CHANNELS, Transient};
use pneudrive_report::Table;

/// The deviation of one channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Name of the channel.
    pub channel: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Samples compared.
    pub samples: usize,
    /// Mean of the difference.
    pub mean: f64,
    /// Standard deviation of the difference about its mean.
    pub standard_deviation: f64,
    /// Mean of the squared difference, in the unit squared.
    pub mean_square: f64,
    /// Largest difference.
    pub largest: f64,
    /// Root of the mean square as a fraction of the reference's range; NaN for a constant channel.
    pub fraction_of_range: f64,
    /// The part of it that the perturbed runs of a simulated run explain; None without them.
    pub within_band: Option<WithinBand>,
}

/// A deviation beside the band of a simulated run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WithinBand {
    /// Fraction of the samples of the other transient that lie in the band.
    pub inside: f64,
    /// Root of the mean square of the distance to the band, 0 inside.
    pub beyond: f64,
}

/// The deviations of `other` from `reference`, channel by channel, at the reference's instants that
/// both cover. The setpoint is not a result and is left out.
///
/// ```
/// use pneudrive_evaluate::deviation::deviations;
/// use pneudrive_evaluate::transient::Transient;
/// use pneudrive_sim::{Accuracy, Rig, run};
///
/// let light = Rig::builtin("press").expect("a built-in rig");
/// let heavy = light.with_plant(&["load.mass_kg=12"])?;
/// let [light, heavy] = [("light", &light), ("heavy", &heavy)].map(|(name, rig)| {
///     let run = run(rig, Accuracy::of(rig)).expect("a rig that can be integrated");
///     Transient::of_simulation(name, rig, &run)
/// });
/// let position = deviations(&light, &heavy)[0];
/// assert_eq!((position.channel, position.unit), ("position", "mm"));
/// assert!((0.1..1.0).contains(&position.largest), "{} mm", position.largest);
/// # Ok::<(), pneudrive_sim::rig::Problems>(())
/// ```
#[must_use]
pub fn deviations(reference: &Transient, other: &Transient) -> Vec<Deviation> {
    (1..CHANNELS.len()).filter_map(|channel| deviation(reference, other, channel)).collect()
}

/// How far `measured` is from the band of `run`, over the instants of `measured` that both cover.
fn within_band(run: &Transient, measured: &Transient, channel: usize) -> Option<WithinBand> {
    let samples = measured.time.iter().zip(&measured.channels[channel]);
    let distances: Vec<f64> = samples
        .filter_map(|(&time, &value)| {
            let [low, high] = run.band_at(channel, time)?;
            (value.is_finite() && low.is_finite() && high.is_finite())
                .then(|| (low - value).max(value - high).max(0.0))
        })
        .collect();
    let count = distances.len() as f64;
    (count > 0.0).then(|| WithinBand {
        inside: distances.iter().filter(|distance| **distance == 0.0).count() as f64 / count,
        beyond: (distances.iter().map(|distance| distance * distance).sum::<f64>() / count).sqrt(),
    })
}

fn deviation(reference: &Transient, other: &Transient, channel: usize) -> Option<Deviation> {
    let pairs: Vec<(f64, f64)> = reference
        .time
        .iter()
        .zip(&reference.channels[channel])
        .filter_map(|(&time, &value)| Some((value, other.at(channel, time)?)))
        // Samples that either transient lacks are left out.
        .filter(|(value, other)| value.is_finite() && other.is_finite())
        .collect();
    if pairs.is_empty() {
        return None;
    }
    let count = pairs.len() as f64;
    let differences = || pairs.iter().map(|(a, b)| b - a);
    let mean = differences().sum::<f64>() / count;
    let mean_square = differences().map(|d| d * d).sum::<f64>() / count;
    let (low, high) = pairs.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (value, _)| {
        (low.min(*value), high.max(*value))
    });
    let range = high - low;
    Some(Deviation {
        channel: CHANNELS[channel].0,
        unit: CHANNELS[channel].1,
        samples: pairs.len(),
        mean,
        standard_deviation: (mean_square - mean * mean).max(0.0).sqrt(),
        mean_square,
        largest: differences().map(f64::abs).fold(0.0, f64::max),
        fraction_of_range: if range > 0.0 { mean_square.sqrt() / range } else { f64::NAN },
        within_band: within_band(other, reference, channel)
            .or_else(|| within_band(reference, other, channel)),
    })
}

/// The deviations as a table.
#[must_use]
pub fn table(heading: &str, deviations: &[Deviation]) -> Table {
    let columns = ["channel", "unit", "mean", "std deviation", "rms", "largest", "rms / range"];
    let banded = deviations.iter().any(|deviation| deviation.within_band.is_some());
    let of_band = if banded { &["inside band", "rms beyond it"][..] } else { &[] };
    Table::new(
        heading,
        columns.iter().chain(of_band).map(|&name| name.to_owned()),
        deviations.iter().map(|deviation| {
            let of_band = banded.then(|| band_cells(deviation.within_band)).into_iter().flatten();
            cells(deviation).into_iter().chain(of_band).collect()
        }),
    )
}

fn band_cells(within: Option<WithinBand>) -> [String; 2] {
    within.map_or_else(
        || ["-", "-"].map(str::to_owned),
        |within| [format!("{:.0} %", 100.0 * within.inside), number(within.beyond)],
    )
}

fn cells(deviation: &Deviation) -> Vec<String> {
    let percent = 100.0 * deviation.fraction_of_range;
    vec![
        deviation.channel.to_owned(),
        deviation.unit.to_owned(),
        number(deviation.mean),
        number(deviation.standard_deviation),
        number(deviation.mean_square.sqrt()),
        number(deviation.largest),
        if percent.is_nan() { "-".to_owned() } else { format!("{percent:.2} %") },
    ]
}

/// A figure with four significant digits, and at most four decimals.
fn number(value: f64) -> String {
    let whole_digits = value.abs().max(1.0).log10().floor() as usize + 1;
    let decimals = if value.abs() < 1.0 { 4 } else { 4_usize.saturating_sub(whole_digits) };
    let scale = 10_f64.powi(decimals as i32);
    // Not -0.
    format!("{:.decimals$}", (value * scale).round() / scale + 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn transient(position: &[f64]) -> Transient {
        let mut channels: [Vec<f64>; CHANNELS.len()] = std::array::from_fn(|_| vec![0.0; position.len()]);
        channels[1] = position.to_vec();
        let time = (0..position.len()).map(|i| i as f64).collect();
        Transient { time, channels, ..Transient::default() }
    }

    #[test]
    fn the_figures_are_those_of_their_definitions() {
        let found = deviations(&transient(&[0.0, 10.0, 20.0, 10.0]), &transient(&[1.0, 12.0, 21.0, 12.0]));
        let position = found[0];
        assert_eq!((position.channel, position.samples), ("position", 4));
        assert_eq!((position.mean, position.mean_square, position.largest), (1.5, 2.5, 2.0));
        assert_eq!(position.standard_deviation, 0.5);
        assert!((position.fraction_of_range - 2.5_f64.sqrt() / 20.0).abs() < 1e-15);
        assert!(found[1].fraction_of_range.is_nan(), "a constant channel has no range");
    }

    #[test]
    fn figures_have_four_significant_digits() {
        let shown = [40_132.609_2, 1152.0, 199.573_1, -17.411_7, 5.279_8, -0.174_8, 0.000_04, -0.000_04];
        let told = ["40133", "1152", "199.6", "-17.41", "5.280", "-0.1748", "0.0000", "0.0000"];
        assert_eq!(shown.map(number), told);
    }

    #[test]
    fn only_instants_that_both_cover_are_compared() {
        assert_eq!(deviations(&transient(&[0.0; 9]), &transient(&[0.0; 4]))[0].samples, 4);
        let mut later = transient(&[0.0; 3]);
        later.time.iter_mut().for_each(|t| *t += 100.0);
        assert!(deviations(&transient(&[0.0; 9]), &later).is_empty());
    }
}
