//! The patterns of a board's one lamp: 16 slots of 131 ms (2^17 us), repeated.
//!
//! | state | pattern |
//! |---|---|
//! | disabled | a short flash every 2.1 s |
//! | enabled, standing | on |
//! | moving | half a second on, half a second off |
//! | tripped | flickers, 4 times a second |
//! | the stored configuration is lost | two short flashes every 2.1 s |

use pneudrive_controller::Mode;

/// A slot is two to the power of this many microseconds long.
const SLOT_BITS: u32 = 17;

/// The slots in which the lamp is lit; bit 0 is the first one.
#[must_use]
pub fn pattern(mode: Mode, configuration_is_lost: bool) -> u16 {
    match mode {
        _ if configuration_is_lost => 0b0000_0000_0000_0101,
        Mode::Fault(_) => 0b0101_0101_0101_0101,
        Mode::Disarmed => 0b0000_0000_0000_0001,
        Mode::Armed | Mode::Done => 0b1111_1111_1111_1111,
        Mode::Running | Mode::Homing => 0b0000_1111_0000_1111,
    }
}

/// Whether a pattern is lit this many microseconds after its beginning.
#[must_use]
pub fn is_lit(pattern: u16, time_us: u32) -> bool {
    pattern >> (time_us >> SLOT_BITS & 15) & 1 == 1
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use pneudrive_controller::Fault;
    use std::vec::Vec;

    const ROUND_US: u32 = 16 << SLOT_BITS;

    /// How often a lamp goes on in a round, and the milliseconds that it is lit.
    fn seen(mode: Mode, lost: bool) -> (usize, u32) {
        let lit: Vec<bool> =
            (0..ROUND_US).step_by(1000).map(|time_us| is_lit(pattern(mode, lost), time_us)).collect();
        let flashes = (0..lit.len()).filter(|&ms| lit[ms] && !lit[(ms + lit.len() - 1) % lit.len()]).count();
        (flashes, lit.iter().filter(|lit| **lit).count() as u32)
    }

    #[test]
    fn every_state_is_told_from_the_others_by_its_flashes() {
        assert_eq!(seen(Mode::Disarmed, false), (1, 132), "a short flash");
        assert_eq!(seen(Mode::Armed, false), (0, 2098), "on");
        assert_eq!(seen(Mode::Done, false), seen(Mode::Armed, false), "it stands, enabled");
        assert_eq!(seen(Mode::Running, false), (2, 1049), "half of the time");
        assert_eq!(seen(Mode::Homing, false), seen(Mode::Running, false), "it moves");
        assert_eq!(seen(Mode::Fault(Fault::Stop), false).0, 8, "it flickers");
        assert_eq!(seen(Mode::Fault(Fault::BadConfiguration), true).0, 2, "two flashes");
    }

    #[test]
    fn the_pattern_comes_again_and_again_also_where_the_clock_wraps() {
        for time_us in [0, 1, 131_072, 200_000, 2_000_000] {
            let lit = |time_us| is_lit(pattern(Mode::Disarmed, false), time_us);
            assert_eq!(lit(time_us), lit(time_us + ROUND_US));
            assert_eq!(lit(time_us), lit(time_us.wrapping_sub(ROUND_US)), "2^32 us are whole rounds");
        }
    }
}
