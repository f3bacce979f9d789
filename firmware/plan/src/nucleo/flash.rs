//! What is where in the flash of 512 KiB: four sectors of 16 KiB, one of 64, three of 128.
//!
//! | sectors | hold |
//! |---|---|
//! | 0 | the vector table; the processor starts there |
//! | 1, 2 | the configuration |
//! | 3, 4 | the fault log |
//! | 5, 6, 7 | the program |
//!
//! The small sectors are the quick ones to erase. Flashing a program erases the sectors that it has
//! bytes in and no others, so the configuration outlives it. `memory.x` puts the program where this
//! says; `cargo xtask test` compares them.

use core::ops::{Range, RangeInclusive};

use pneudrive_app::store::Layout;

/// Bytes of the flash.
pub const BYTES: u32 = 512 * 1024;

/// Bytes of the smallest sector: ranges start and end on a multiple.
pub const UNIT: u32 = 16 * 1024;

/// Where the sectors start, and the end of the last.
const STARTS: [u32; 9] = [0, 0x4000, 0x8000, 0xc000, 0x1_0000, 0x2_0000, 0x4_0000, 0x6_0000, BYTES];

/// What no program may have bytes in.
pub const KEPT: Range<u32> = 0x4000..0x2_0000;

/// Where configuration and fault log are, bytes from the start of the flash.
#[must_use]
pub fn layout() -> Layout {
    Layout { config: [0x4000..0x8000, 0x8000..0xc000], faults: [0xc000..0x1_0000, 0x1_0000..0x2_0000] }
}

/// The sectors of a range that is kept and made of whole ones; None for any other.
#[must_use]
pub fn sectors(range: &Range<u32>) -> Option<RangeInclusive<u8>> {
    if range.is_empty() || range.start < KEPT.start || range.end > KEPT.end {
        return None;
    }
    let number = |address| STARTS.iter().position(|&start| start == address);
    let (first, behind) = (number(range.start)?, number(range.end)?);
    Some(first as u8..=behind.saturating_sub(1) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_slot_is_whole_sectors_of_its_own() {
        let Layout { config, faults } = layout();
        let slots = [config, faults].concat();
        let numbers = slots.iter().map(|slot| sectors(slot).expect("whole sectors"));
        assert!(numbers.eq([1..=1, 2..=2, 3..=3, 4..=4]));
        for pair in slots.windows(2) {
            assert_eq!(pair[0].end, pair[1].start);
        }
        assert_eq!((slots[0].start, slots[3].end), (KEPT.start, KEPT.end));
    }

    #[test]
    fn neither_program_nor_part_of_a_sector_is_erased() {
        for range in [0..0x4000, 0x1_c000..0x2_0000, 0x2_0000..0x4_0000, 0..BYTES, 0x4000..0x4000] {
            assert_eq!(sectors(&range), None, "{range:x?}");
        }
        assert_eq!(sectors(&(0x4000..0x2_0000)), Some(1..=4));
    }
}
