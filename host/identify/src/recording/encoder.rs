//! The position as a channel.

use pneudrive_sim::component::encoder::EncoderKind;
use pneudrive_sim::{Rig, keys};

use super::{Channel, GOLDEN, HALF_WIDTH, Rest};

/// How far noise may shift the readings at rest, counts: six standard deviations.
pub(super) fn noise(rig: &Rig) -> i32 {
    match rig.get(&keys::encoder::MODEL).is_absolute() {
        true => (6.0 * rig.get(&keys::encoder::NOISE_COUNTS)).ceil() as i32,
        false => 0,
    }
}

/// The positions that were read, with this length of a count. An absolute encoder begins between two counts of the
/// controller, whose zero is a whole one; a potentiometer is rounded like a converter.
pub(super) fn channel(
    measured: Vec<f64>,
    pulse: f64,
    at_rest: impl Fn(&[f64]) -> Rest,
    rig: &Rig,
) -> Channel {
    let between = match rig.get(&keys::encoder::MODEL) {
        EncoderKind::Quadrature => return counted(measured, pulse),
        EncoderKind::Potentiometer => 0.0,
        EncoderKind::Ssi => 0.5 * pulse,
    };
    let zero = 1e-3 * rig.get(&keys::encoder::ZERO_MM) / pulse;
    let offset = between + (zero - zero.round()) * pulse;
    let rest = at_rest(&measured);
    match rest.is_rounding() {
        true => Channel { offset, ..counted(measured, pulse) },
        false => Channel { taken: (0..measured.len()).collect(), rest, measured, offset, scale: pulse },
    }
}

/// Of counts without noise.
fn counted(measured: Vec<f64>, pulse: f64) -> Channel {
    Channel {
        taken: independent(&measured, HALF_WIDTH),
        rest: Rest::default(),
        measured,
        // The middle of the positions that read as this count.
        offset: 0.5 * pulse,
        scale: pulse,
    }
}

/// Samples whose rounding has nothing to do with one another: the drive has moved on by one to two counts
/// since the last one. How far it moved is told by a mean speed, and the distance differs from sample to
/// sample; if a change of the count itself chose the sample, a slow drive would always stand just behind an
/// edge. A rest gives one sample, in its middle; a drive that is about to break away, and has a speed by what comes
/// next, is still at that rest.
pub(super) fn independent(counts: &[f64], reach: usize) -> Vec<usize> {
    let speed = |k: usize| {
        let (from, to) = (k.saturating_sub(reach), (k + reach).min(counts.len() - 1));
        (counts[to] - counts[from]).abs() / (to - from).max(1) as f64
    };
    let (mut moved, mut distance, mut rest) = (0.0, first_distance(counts), 0);
    let mut taken: Vec<usize> = Vec::new();
    let take = |taken: &mut Vec<usize>, k: usize| {
        let stands = |last: &usize| counts[*last..=k].iter().all(|count| *count == counts[k]);
        if !taken.last().is_some_and(stands) {
            taken.push(k);
        }
    };
    for k in 0..counts.len() {
        let speed = speed(k);
        if speed > 0.0 {
            if rest > 2 * reach {
                take(&mut taken, k - rest / 2);
            }
            rest = 0;
            moved += speed;
        } else {
            rest += 1;
        }
        if moved >= distance {
            take(&mut taken, k);
            moved = 0.0;
            // The fractions of the golden ratio's multiples fill the range from 1 to 2 evenly.
            distance = 1.0 + (distance + GOLDEN) % 1.0;
        }
    }
    if rest > 2 * reach {
        take(&mut taken, counts.len() - rest / 2 - 1);
    }
    taken
}

/// Where records of the same start begin with other distances: else the rounding of their first samples is the same, and
/// no number of records averages it away.
fn first_distance(counts: &[f64]) -> f64 {
    let travel: f64 = counts.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum();
    1.0 + (GOLDEN * (travel + counts.len() as f64)) % 1.0
}

#[cfg(test)]
mod tests {
    use pneudrive_sim::component::encoder::{Encoder, pulse, zero_counts};

    use super::*;

    /// Mean and variance of what readings of an even motion are off the model, counts, and how many count.
    fn off(keys: &str) -> (f64, f64, usize) {
        let text = format!("[encoder]\n{keys}[test]\nmoves = [[0.0, 200]]\n");
        let rig = Rig::read("test", &text).expect("valid");
        let (mut encoder, pulse) = (Encoder::new(&rig, 1), pulse(&rig));
        let position = |k: usize| 0.05 + 9.3e-6 * k.saturating_sub(100) as f64;
        let read = |k| f64::from(encoder.read(position(k)) + zero_counts(&rig));
        let measured: Vec<f64> = (0..20_000).map(read).collect();
        let channel = channel(measured, pulse, |readings| Rest::of(&readings[..100], false), &rig);
        let off = channel.taken.iter().map(|&k| channel.measured[k] - channel.counts(position(k)));
        let off: Vec<f64> = off.collect();
        let mean = off.iter().sum::<f64>() / off.len() as f64;
        let variance = off.iter().map(|off| (off - mean).powi(2)).sum::<f64>() / off.len() as f64;
        (mean, variance, off.len())
    }

    #[test]
    fn wherever_an_absolute_encoder_reads_0_its_model_is_right_in_the_mean() {
        for keys in [
            "",
            "model = \"ssi\"\nzero_mm = -7.3031\n",
            "model = \"ssi\"\nzero_mm = -7.3031\nnoise_counts = 1.5\n",
            "model = \"potentiometer\"\nbits = 14\nzero_mm = -5.008\nrange_mm = 310\n",
            "model = \"potentiometer\"\nbits = 14\nzero_mm = -5.008\nrange_mm = 310\nnoise_counts = 1.5\n",
        ] {
            let (mean, variance, taken) = off(keys);
            let noisy = keys.contains("noise");
            assert_eq!(taken == 20_000, noisy, "{keys}: {taken} samples");
            let expected = 1.0 / 12.0 + if noisy { 1.5 * 1.5 } else { 0.0 };
            assert!(
                mean.abs() < 0.04 && (variance / expected - 1.0).abs() < 0.1,
                "{keys}: {mean}, {variance}"
            );
        }
    }
}
