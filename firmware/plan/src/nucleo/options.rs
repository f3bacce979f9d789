//! The option bytes: the supply voltage below which the chip is held in reset (RM0390, BOR_LEV in FLASH_OPTCR).
//!
//! As delivered that is 1.8 V. The flash is read for 180 MHz from 2.7 V on; between the two the processor may do
//! anything.

/// OPTLOCK and OPTSTRT.
const CONTROL: u32 = 0b11;

/// BOR_LEV: 0b00 is the highest level (2.7 V and more), 0b11 switches it off.
const LEVEL: u32 = 0b11 << 2;

/// The keys that unlock the option bytes, in their order.
pub const KEYS: [u32; 2] = [0x0819_2a3b, 0x4c5d_6e7f];

/// What to write for the highest level, with nothing else changed; None where the chip has it.
#[must_use]
pub fn with_highest_level(options: u32) -> Option<u32> {
    (options & LEVEL != 0).then_some(options & !LEVEL & !CONTROL)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chip_as_delivered_gets_the_highest_level_and_keeps_the_rest() {
        assert_eq!(with_highest_level(0x0fff_aaed), Some(0x0fff_aae0), "no protection, all sectors writable");
        assert_eq!(with_highest_level(0x0fff_aae5), Some(0x0fff_aae0), "from level 2");
    }

    #[test]
    fn one_that_has_it_is_not_written() {
        assert_eq!(with_highest_level(0x0fff_aae1), None);
    }
}
