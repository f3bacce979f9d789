//! Moves as they travel between host and drive, and back.

use pneudrive_controller::Move;
use pneudrive_controller::profile::{Noise, Profile, Ramp, Wave};
use pneudrive_protocol::ProfiledMove;

/// How a move travels.
#[must_use]
pub fn told(next: &Move) -> ProfiledMove {
    let Move { at_sample, target, profile } = *next;
    let (kind, numbers) = match profile {
        Profile::Step => (0, [0; 6]),
        Profile::Ramp(ramp) => {
            let [velocity, acceleration, jerk] = ramp.averages();
            (1, [velocity, acceleration, jerk, 0, 0, 0])
        }
        Profile::Wave(Wave { amplitude, samples, rate, sweep }) => {
            let high = (sweep >> 32) as u32;
            (2, [amplitude as u32, samples, rate as u32, (rate >> 32) as u32, sweep as u32, high])
        }
        Profile::Noise(Noise { amplitude, samples, hold, taps }) => {
            (3, [amplitude as u32, samples, hold, taps, 0, 0])
        }
    };
    ProfiledMove { at_sample, target, kind, numbers }
}

/// The move that was received; None for a kind that this version does not know, and for an invalid ramp.
#[must_use]
#[inline(never)] // One copy of it.
pub fn meant(told: &ProfiledMove) -> Option<Move> {
    let ProfiledMove { at_sample, target, kind, numbers: [a, b, c, d, e, f] } = *told;
    let wide = |low: u32, high: u32| u64::from(high) << 32 | u64::from(low);
    let profile = match kind {
        0 => Profile::Step,
        1 => Profile::Ramp(Ramp::new(a, b, c)?),
        2 => {
            let (rate, sweep) = (wide(c, d), wide(e, f) as i64);
            Profile::Wave(Wave { amplitude: a as i32, samples: b, rate, sweep })
        }
        3 => Profile::Noise(Noise { amplitude: a as i32, samples: b, hold: c, taps: d }),
        _ => return None,
    };
    Some(Move { at_sample, target, profile })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_move_comes_back_as_it_was() {
        for profile in [
            Profile::Step,
            Profile::Ramp(Ramp::new(30, 20, 10).expect("a ramp")),
            Profile::Wave(Wave { amplitude: -3, samples: 4, rate: u64::MAX - 1, sweep: i64::MIN + 7 }),
            Profile::Noise(Noise { amplitude: -5, samples: 6, hold: 7, taps: 8 }),
        ] {
            let next = Move { at_sample: 1, target: -2, profile };
            let travels = ProfiledMove::from_bytes(&told(&next).to_bytes()).expect("whole");
            assert_eq!(meant(&travels), Some(next));
        }
    }

    #[test]
    fn what_is_no_move_is_told() {
        let ramp = ProfiledMove { kind: 1, numbers: [1, 1, 1, 0, 0, 0], ..ProfiledMove::default() };
        assert!(meant(&ramp).is_some());
        assert_eq!(meant(&ProfiledMove { numbers: [0, 1, 1, 0, 0, 0], ..ramp }), None);
        assert_eq!(meant(&ProfiledMove { kind: 4, ..ramp }), None, "of a later version");
        assert_eq!(ProfiledMove::from_bytes(&ramp.to_bytes()[1..]), None);
    }
}
