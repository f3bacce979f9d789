//! What is where in the flash of 4 MiB: the program from its start, and in the last 64 KiB what is kept.
//!
//! | offset | holds |
//! |---|---|
//! | 0 .. 0x3f_0000 | the program |
//! | 0x3f_0000 .. 0x3f_8000 | the configuration, two slots of 16 KiB |
//! | 0x3f_8000 .. 0x40_0000 | the fault log, two slots of 16 KiB |
//!
//! The boot ROM writes the blocks of a UF2 file alone, and a probe the sectors of the program: what is kept outlives
//! both, as long as the whole flash is not erased.

use core::ops::Range;

use pneudrive_app::store::Layout;

/// Bytes of the flash.
pub const BYTES: u32 = 4 * 1024 * 1024;

/// Bytes of a sector: the least that is erased.
pub const SECTOR: u32 = 4096;

/// Bytes of a page: the ROM programs whole ones.
pub const PAGE: usize = 256;

/// What no program may have bytes in.
pub const KEPT: Range<u32> = 0x3f_0000..BYTES;

/// Where configuration and fault log are, bytes from the start of the flash.
#[must_use]
pub fn layout() -> Layout {
    Layout {
        config: [0x3f_0000..0x3f_4000, 0x3f_4000..0x3f_8000],
        faults: [0x3f_8000..0x3f_c000, 0x3f_c000..BYTES],
    }
}

/// The page that an offset is in, and the place in it.
#[must_use]
pub fn page(offset: u32) -> (u32, usize) {
    let place = offset % PAGE as u32;
    (offset - place, place as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_slot_is_whole_sectors_of_its_own() {
        let Layout { config, faults } = layout();
        let slots = [config, faults].concat();
        assert!(slots.iter().all(|slot| slot.start % SECTOR == 0 && slot.end % SECTOR == 0));
        assert!(slots.windows(2).all(|pair| pair[0].end == pair[1].start));
        assert_eq!((slots[0].start, slots[3].end), (KEPT.start, KEPT.end));
    }

    #[test]
    fn every_offset_is_in_a_page_of_256_bytes() {
        assert_eq!([0, 255, 256, 0x3f_0101].map(page), [(0, 0), (0, 255), (256, 0), (0x3f_0100, 1)]);
    }
}
