//! Whether recordings are measurements of their own: the same samples twice say nothing twice.
//!
//! Samples are compared by hashes over stretches in which the drive moves. Two runs of a real drive share none of them: noise and
//! the encoder differ. A file and its stream, a copy, or two cuts of one run share all or many.

use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash, Hasher};

use anyhow::{Result, bail};

use super::recording::Recording;

/// Samples of a stretch.
const STRETCH: usize = 32;

/// A drive moves in a stretch if its position changes by more than so many counts.
const MOVES: f64 = 4.0;

/// From this part of the shorter recording on, two are one measurement.
const ONE: f64 = 0.5;

/// Refuses recordings that are one measurement, and tells of those that share a stretch.
///
/// # Errors
/// When two have the same samples, or one has most of those of another.
pub fn check(recordings: &[Recording], tell: &mut dyn FnMut(&str)) -> Result<()> {
    let stretches: Vec<HashSet<u64>> = recordings.iter().map(stretches).collect();
    for (k, (one, of_one)) in recordings.iter().zip(&stretches).enumerate() {
        for (other, of_other) in recordings.iter().zip(&stretches).take(k) {
            let shared = of_one.intersection(of_other).count();
            let fewer = of_one.len().min(of_other.len());
            if shared == 0 {
                continue;
            }
            let part = shared as f64 / fewer as f64;
            let what = format!(
                "{} and {} have {:.0} % of the shorter one's motion in common, sample by sample: they are cuts or copies of one run",
                other.name,
                one.name,
                100.0 * part
            );
            if part >= ONE {
                bail!("{what}. Leave one out: counted twice, it would make the intervals too narrow");
            }
            tell(&format!(
                "{what}. What they share counts twice, and makes the intervals a little too narrow"
            ));
        }
    }
    Ok(())
}

/// Whether two recordings have the same samples.
#[must_use]
pub fn is_same(one: &Recording, other: &Recording) -> bool {
    one.commands.len() == other.commands.len()
        && (0..one.commands.len()).all(|sample| hash(one, sample) == hash(other, sample))
}

/// Hashes of all stretches in which the drive moves.
fn stretches(recording: &Recording) -> HashSet<u64> {
    let samples: Vec<u64> = (0..recording.commands.len()).map(|sample| hash(recording, sample)).collect();
    let position = &recording.channels[0].measured;
    let moves = |begin: usize| {
        let stretch = &position[begin..begin + STRETCH];
        let [low, high] = [f64::min, f64::max].map(|end| stretch.iter().copied().reduce(end).unwrap_or(0.0));
        high - low > MOVES
    };
    let of = |(begin, stretch): (usize, &[u64])| moves(begin).then(|| hash_of(stretch));
    samples.windows(STRETCH).enumerate().filter_map(of).collect()
}

/// Of what was measured and commanded at a sample.
fn hash(recording: &Recording, sample: usize) -> u64 {
    let measured = recording.channels.each_ref().map(|channel| channel.measured[sample].to_bits());
    let command = recording.commands[sample];
    hash_of(&(measured, command.counts, command.step))
}

fn hash_of(of: &(impl Hash + ?Sized)) -> u64 {
    let mut hasher = DefaultHasher::new();
    of.hash(&mut hasher);
    hasher.finish()
}

#[cfg(test)]
mod tests {
    use pneudrive_controller::Command;
    use pneudrive_sim::follow::Timing;

    use super::super::recording::Channel;
    use super::*;

    /// A drive that accelerates for some samples of a run, seen through noise that is of the run alone.
    fn recording(name: &str, run: u64, samples: std::ops::Range<u64>) -> Recording {
        let noise = |k: u64| ((k * k + 7919 * run) as f64 * 0.618_033_988_749_895).fract() * 3.0;
        let measured =
            |by: f64| samples.clone().map(|k| (by * (k * k) as f64 / 40.0 + noise(k)).floor()).collect();
        let channel = |by: f64| Channel { measured: measured(by), ..Channel::default() };
        let command = Command { counts: 100, step: 0, drive_enable: true };
        Recording {
            name: name.to_owned(),
            timing: Timing { period_us: 1300, delay_us: 500 },
            commands: samples.clone().map(|_| command).collect(),
            channels: [1.0, 0.1, 0.2, 0.0].map(channel),
            start: [0.0; 3],
        }
    }

    fn checked(recordings: &[Recording]) -> (Result<()>, Vec<String>) {
        let mut told = Vec::new();
        let result = check(recordings, &mut |line| told.push(line.to_owned()));
        (result, told)
    }

    #[test]
    fn the_same_run_twice_is_refused_whole_or_as_a_part() {
        let whole = recording("stream.txt", 1, 0..300);
        for part in [0..300, 0..120, 100..220, 140..420] {
            let (result, _) = checked(&[recording("TARGET01.DAT", 1, part.clone()), whole.clone()]);
            let told = result.expect_err("one run").to_string();
            assert!(told.starts_with("TARGET01.DAT and stream.txt have"), "{part:?}: {told}");
        }
        assert!(is_same(&whole, &recording("copy", 1, 0..300)));
        assert!(!is_same(&whole, &recording("cut", 1, 0..299)));
    }

    #[test]
    fn a_small_stretch_of_one_run_in_two_records_is_told() {
        let (result, told) = checked(&[recording("a", 1, 0..200), recording("b", 1, 130..400)]);
        assert!(result.is_ok() && told.len() == 1 && told[0].contains("counts twice"), "{told:?}");
    }

    #[test]
    fn two_runs_of_one_test_are_two_measurements() {
        let (result, told) = checked(&[recording("a", 1, 0..300), recording("b", 2, 0..300)]);
        assert!(result.is_ok() && told.is_empty(), "{told:?}");
    }
}
