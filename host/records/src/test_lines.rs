//! The test of a record in the header of its file: `last_sample`, `round`, and a line `move.N` for each move.
//!
//! ```text
//! # last_sample = 2384
//! # round = 0
//! # move.1 = 0 8192
//! # move.2 = 231 16384 ramp 270 60 13
//! # move.3 = 769 16384 wave 800 3846 14391223451298 0
//! # move.4 = 4615 16384 noise 50 3811 30 96
//! ```
//!
//! First sample and target, then the profile with its numbers as the controller has them
//! ([`pneudrive_controller::profile`]): the three averages of a ramp; amplitude, samples, rate and sweep of a wave;
//! amplitude, samples, hold and taps of noise. A record that was imported from the log of another recorder has no such
//! lines.

use anyhow::{Context, Result, anyhow};
use pneudrive_controller::profile::{Noise, Profile, Ramp, Wave};
use pneudrive_controller::{Move, Sequence};

const LAST_SAMPLE: &str = "last_sample";
const ROUND: &str = "round";

/// The header lines of a test.
#[must_use]
pub fn lines(sequence: &Sequence) -> Vec<(String, String)> {
    let span = [(LAST_SAMPLE, sequence.duration_samples), (ROUND, sequence.round())];
    let span = span.map(|(key, samples)| (key.to_owned(), samples.to_string()));
    let moves = (1..).zip(sequence.moves()).map(|(number, next)| (format!("move.{number}"), text_of(next)));
    span.into_iter().chain(moves).collect()
}

fn text_of(next: &Move) -> String {
    let Move { at_sample, target, profile } = next;
    let profile = match profile {
        Profile::Step => String::new(),
        Profile::Ramp(ramp) => {
            let [velocity, acceleration, jerk] = ramp.averages();
            format!(" ramp {velocity} {acceleration} {jerk}")
        }
        Profile::Wave(Wave { amplitude, samples, rate, sweep }) => {
            format!(" wave {amplitude} {samples} {rate} {sweep}")
        }
        Profile::Noise(Noise { amplitude, samples, hold, taps }) => {
            format!(" noise {amplitude} {samples} {hold} {taps}")
        }
    };
    format!("{at_sample} {target}{profile}")
}

/// The test of a file; None of one that does not tell it.
///
/// # Errors
/// With the line that is no move, or does not go with those before it.
pub fn sequence(header: &[(String, String)]) -> Result<Option<Sequence>> {
    let get = |key: &str| header.iter().find(|(name, _)| name == key).map(|(_, value)| value.as_str());
    let Some(last_sample) = get(LAST_SAMPLE) else { return Ok(None) };
    let whole = |key: &str, text: &str| {
        text.parse::<u32>().map_err(|_| anyhow!("the header's {key} is {text:?}, not a number of samples"))
    };
    let mut sequence = Sequence::new(whole(LAST_SAMPLE, last_sample)?);
    sequence.repeat_every(whole(ROUND, get(ROUND).unwrap_or("0"))?).map_err(|error| anyhow!("{error:?}"))?;
    for number in 1.. {
        let key = format!("move.{number}");
        let Some(text) = get(&key) else { break };
        let next =
            move_of(text).with_context(|| format!("the header's {key} is {text:?}, which is no move"))?;
        let pushed = sequence.push(next);
        pushed
            .map_err(|error| anyhow!("the header's {key} does not go with the moves before it: {error:?}"))?;
    }
    Ok(Some(sequence))
}

fn move_of(text: &str) -> Option<Move> {
    let words: Vec<&str> = text.split(' ').collect();
    let (at_sample, target) = (words.first()?.parse().ok()?, words.get(1)?.parse().ok()?);
    let profile = match &words[2..] {
        [] => Profile::Step,
        ["ramp", velocity, acceleration, jerk] => {
            Profile::Ramp(Ramp::new(velocity.parse().ok()?, acceleration.parse().ok()?, jerk.parse().ok()?)?)
        }
        ["wave", amplitude, samples, rate, sweep] => Profile::Wave(Wave {
            amplitude: amplitude.parse().ok()?,
            samples: samples.parse().ok()?,
            rate: rate.parse().ok()?,
            sweep: sweep.parse().ok()?,
        }),
        ["noise", amplitude, samples, hold, taps] => Profile::Noise(Noise {
            amplitude: amplitude.parse().ok()?,
            samples: samples.parse().ok()?,
            hold: hold.parse().ok()?,
            taps: taps.parse().ok()?,
        }),
        _ => return None,
    };
    Some(Move { at_sample, target, profile })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn every_profile() -> Sequence {
        let mut sequence = Sequence::new(9999);
        sequence.repeat_every(500).expect("no moves yet");
        for (at_sample, profile) in (0..).zip([
            Profile::Step,
            Profile::Ramp(Ramp::new(30, 20, 10).expect("a ramp")),
            Profile::Wave(Wave { amplitude: -3, samples: 4, rate: u64::MAX, sweep: i64::MIN }),
            Profile::Noise(Noise { amplitude: 5, samples: 6, hold: 7, taps: u32::MAX }),
        ]) {
            sequence.push(Move { at_sample, target: -7, profile }).expect("room");
        }
        sequence
    }

    #[test]
    fn a_test_is_read_as_it_was_written() {
        assert_eq!(sequence(&lines(&every_profile())).expect("whole"), Some(every_profile()));
    }

    #[test]
    fn a_file_of_older_firmware_tells_no_test() {
        assert_eq!(sequence(&[]).expect("whole"), None);
    }

    #[test]
    fn a_line_that_is_no_move_is_named() {
        for text in
            ["", "5", "0 x", "0 5 ramp 1 1", "0 5 ramp 0 1 1", "0 5 wave 1 1 -1 1", "0 5 glide", "0 5 "]
        {
            let mut header = lines(&Sequence::new(9));
            header.push(("move.1".to_owned(), text.to_owned()));
            let error = format!("{:#}", sequence(&header).expect_err("no move"));
            assert!(error.contains("move.1") && error.contains(&format!("{text:?}")), "{error}");
        }
    }

    #[test]
    fn moves_out_of_order_are_refused() {
        let mut header = lines(&Sequence::new(9));
        header.extend(
            [("move.1", "5 1"), ("move.2", "4 1")].map(|(key, text)| (key.to_owned(), text.to_owned())),
        );
        let error = sequence(&header).expect_err("out of order").to_string();
        assert!(error.contains("move.2 does not go with the moves before it"), "{error}");
    }
}
