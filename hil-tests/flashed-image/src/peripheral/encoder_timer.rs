//! TIM2, the encoder's counter. RM0390 section 17.3.12, encoder mode 3: every edge of both tracks counts.
//!
//! ```text
//! up:   A rises while B is low, B rises while A is high, A falls while B is high, B falls while A is low
//! down: the other four
//! ```

use crate::register::{Words, Write};

const CR1: u32 = 0x00;
const SMCR: u32 = 0x08;
const CNT: u32 = 0x24;
const ENCODER_MODE_3: u32 = 3;

/// The levels of tracks A and B.
pub type Tracks = [bool; 2];

/// The tracks of an encoder at a position, counts.
#[must_use]
pub fn tracks_at(position: i32) -> Tracks {
    [[false, false], [true, false], [true, true], [false, true]][position.rem_euclid(4) as usize]
}

/// The peripheral.
pub struct EncoderTimer {
    words: Words<32>,
    tracks: Tracks,
}

impl EncoderTimer {
    /// After a reset, with the tracks as they stand.
    #[must_use]
    pub fn new(tracks: Tracks) -> EncoderTimer {
        EncoderTimer { words: Words::after_reset(&[(0x2c, u32::MAX)]), tracks }
    }

    /// A register.
    #[must_use]
    pub fn read(&self, offset: u32) -> u32 {
        self.words.get(offset)
    }

    /// Writes a register.
    pub fn write(&mut self, write: Write) {
        self.words.keep(write);
    }

    /// The tracks have other levels.
    pub fn see(&mut self, [a, b]: Tracks) {
        let up = match (a != self.tracks[0], b != self.tracks[1]) {
            (true, false) => a != b,
            (false, true) => a == b,
            _ => return,
        };
        self.tracks = [a, b];
        if self.words.bit(CR1, 0) && self.words.field(SMCR, 0, 3) == ENCODER_MODE_3 {
            let count = self.words.get(CNT);
            self.words.set(CNT, if up { count.wrapping_add(1) } else { count.wrapping_sub(1) });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counting() -> EncoderTimer {
        let mut timer = EncoderTimer::new(tracks_at(0));
        timer.write(Write::of(SMCR, 4, 3));
        timer.write(Write::of(CR1, 4, 1));
        timer
    }

    #[test]
    fn every_edge_is_a_count_toward_its_side() {
        let mut timer = counting();
        (1..=10).for_each(|position| timer.see(tracks_at(position)));
        assert_eq!(timer.read(CNT), 10);
        (-3..10).rev().for_each(|position| timer.see(tracks_at(position)));
        assert_eq!(timer.read(CNT).cast_signed(), -3);
    }

    #[test]
    fn with_one_track_gone_the_count_goes_to_and_fro() {
        let mut timer = counting();
        for position in 1..=100 {
            timer.see([tracks_at(position)[0], false]);
            assert!(timer.read(CNT) <= 1);
        }
    }
}
