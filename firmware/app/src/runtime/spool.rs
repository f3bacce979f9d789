//! The spool location of a stepper valve, as two words of memory that a reset leaves as they are.
//!
//! The second word is the complement of the first, which holds a mark beside the location. A reset between the two
//! writes leaves words that do not match, and so does memory that was without power.

use pneudrive_controller::drive::SpoolLocation;

/// Two words of memory that a reset leaves as they are; after a power cut they hold anything.
pub trait SpoolMemory {
    /// Keeps the words, in the control interrupt.
    fn keep(&mut self, words: [u32; 2]);

    /// The words.
    fn kept(&self) -> [u32; 2];
}

/// Upper half of the first word.
const MARK: u32 = 0x5b1c_0000;

/// The two words for a location.
#[must_use]
pub fn words(location: SpoolLocation) -> [u32; 2] {
    let word = MARK | u32::from(location.steps().cast_unsigned());
    [word, !word]
}

/// The location in two words; None if they hold none.
#[must_use]
pub fn location([word, check]: [u32; 2]) -> Option<SpoolLocation> {
    let [low, high, ..] = word.to_le_bytes();
    let location = SpoolLocation::at(i16::from_le_bytes([low, high]));
    ([word, check] == words(location)).then_some(location)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_location_comes_back() {
        for steps in i16::MIN..=i16::MAX {
            let kept = SpoolLocation::at(steps);
            assert_eq!(location(words(kept)), Some(kept));
        }
    }

    #[test]
    fn memory_without_power_holds_no_location() {
        for words in [[0, 0], [u32::MAX, 0], [0, u32::MAX], [u32::MAX; 2], [0xa5a5_a5a5, 0x5a5a_5a5a]] {
            assert_eq!(location(words), None, "{words:x?}");
        }
    }

    #[test]
    fn a_flipped_bit_or_a_write_that_was_cut_short_is_noticed() {
        let [word, check] = words(SpoolLocation::at(-17));
        for bit in 0..32 {
            assert_eq!(location([word ^ 1 << bit, check]), None);
            assert_eq!(location([word, check ^ 1 << bit]), None);
        }
        let [next, _] = words(SpoolLocation::at(-16));
        assert_eq!(location([next, check]), None);
    }
}
