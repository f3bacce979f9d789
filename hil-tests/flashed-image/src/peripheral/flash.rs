//! Embedded flash: its interface and its cells. RM0390 section 3 (3.3 organisation, 3.6 erase and program, 3.8
//! registers); times by the data sheet ([`Corner`]).
//!
//! ```text
//! sectors   0 to 3: 16 KiB, 4: 64 KiB, 5 to 7: 128 KiB
//! erase     every bit of a sector to 1;  program: zeros of what is written, never a one
//! ```
//!
//! Whoever reads the flash meanwhile waits, and the program stands in it: the processor stalls for as long as an
//! operation takes.

use crate::register::{Words, Write};
use crate::time::{Corner, MICROSECOND, MILLISECOND, Ticks};

/// Where the flash is.
pub const START: u32 = 0x0800_0000;

const ACR: u32 = 0x00;
const KEYR: u32 = 0x04;
const SR: u32 = 0x0c;
const CR: u32 = 0x10;

const KEYS: [u32; 2] = [0x4567_0123, 0xcdef_89ab];

const PG: u32 = 0;
const SER: u32 = 1;
const STRT: u32 = 16;
const LOCK: u32 = 31;
const SEQUENCE_ERROR: u32 = 1 << 7;
const WRITE_PROTECTED: u32 = 1 << 4;

/// Where the sectors start, and the end of the last.
const SECTORS: [usize; 9] = [0, 0x4000, 0x8000, 0xc000, 0x1_0000, 0x2_0000, 0x4_0000, 0x6_0000, 0x8_0000];

/// Bytes of the flash.
pub const BYTES: usize = SECTORS[8];

/// A power cut in the middle of an operation, which is then done in part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cut {
    /// The power goes in the nth operation from now; the next one is the first. An operation is what stands between
    /// unlocking and locking.
    pub operation: u64,
    /// How much is done of the bytes that are programmed next, or of the sector that is erased, percent.
    pub percent: usize,
}

/// The peripheral and its cells.
pub struct Flash {
    words: Words<6>,
    keys: usize,
    corner: Corner,
    cells: Vec<u8>,
    /// Operations since the reset.
    operations: u64,
    cut: Option<Cut>,
    /// Bytes that were programmed in the present operation.
    programmed: usize,
    /// The power has gone in an operation.
    pub dark: bool,
}

impl Flash {
    /// After a reset, with what its cells hold.
    ///
    /// # Panics
    /// When they are not as many as the flash has.
    #[must_use]
    pub fn new(cells: Vec<u8>, corner: Corner) -> Flash {
        assert_eq!(cells.len(), BYTES, "cells of the flash");
        let words = Words::after_reset(&[(SR, 0), (CR, 1 << LOCK)]);
        Flash { words, keys: 0, corner, cells, operations: 0, cut: None, programmed: 0, dark: false }
    }

    /// The power will go.
    pub fn cut_power(&mut self, cut: Cut) {
        self.cut = Some(Cut { operation: self.operations + cut.operation, ..cut });
    }

    /// Its cells.
    #[must_use]
    pub fn cells(&self) -> &[u8] {
        &self.cells
    }

    /// These cells read 0 from now on, as after damage.
    pub fn clear(&mut self, offset: usize, bytes: usize) {
        self.cells[offset..offset + bytes].fill(0);
    }

    /// Bytes of its cells as a number.
    #[must_use]
    pub fn load(&self, offset: usize, bytes: usize) -> u64 {
        let cells = self.cells.get(offset..offset + bytes).unwrap_or(&[]);
        cells.iter().rev().fold(0, |number, byte| number << 8 | u64::from(*byte))
    }

    /// A register.
    #[must_use]
    pub fn read(&self, offset: u32) -> u32 {
        if offset == KEYR { 0 } else { self.words.get(offset) }
    }

    /// Writes a register; how long the processor stalls.
    pub fn write(&mut self, write: Write) -> Ticks {
        match write.offset {
            KEYR => self.unlock(write.value),
            SR => self.words.set(SR, self.words.get(SR) & !write.value),
            CR if self.words.bit(CR, LOCK) => {}
            CR => {
                let value = self.words.keep(write);
                // An operation that is too short to be cut where it was meant is cut at its end.
                self.dark |= value >> LOCK & 1 == 1 && self.is_cut().is_some();
                if value >> STRT & 1 == 1 {
                    self.words.put(CR, STRT, false);
                    return self.erase(self.words.field(CR, 3, 4) as usize);
                }
            }
            ACR => {
                self.words.keep(write);
            }
            _ => {}
        }
        0
    }

    fn unlock(&mut self, key: u32) {
        self.keys = if key == KEYS[self.keys] { self.keys + 1 } else { 0 };
        if self.keys == KEYS.len() {
            self.words.put(CR, LOCK, false);
            (self.keys, self.programmed) = (0, 0);
            self.operations += 1;
        }
    }

    /// Whether the power goes in the present operation.
    fn is_cut(&self) -> Option<Cut> {
        self.cut.filter(|cut| cut.operation == self.operations)
    }

    fn erase(&mut self, sector: usize) -> Ticks {
        let erases = self.words.bit(CR, SER) && !self.words.bit(CR, PG);
        let (Some(&from), Some(&to)) = (SECTORS.get(sector), SECTORS.get(sector + 1)) else {
            self.words.set(SR, self.words.get(SR) | WRITE_PROTECTED);
            return 0;
        };
        if !erases {
            return 0;
        }
        let done = match self.is_cut() {
            Some(cut) => {
                self.dark = true;
                (to - from) * cut.percent / 100
            }
            None => to - from,
        };
        self.cells[from..from + done].fill(0xff);
        self.corner.erase_16k_ms * MILLISECOND * if sector < 4 { 1 } else { 3 }
    }

    /// Programs bytes at an offset from the start; how long the processor stalls.
    pub fn program(&mut self, offset: usize, bytes: usize, value: u64) -> Ticks {
        if self.words.bit(CR, LOCK) || !self.words.bit(CR, PG) {
            self.words.set(SR, self.words.get(SR) | SEQUENCE_ERROR);
            return 0;
        }
        let cut = self.is_cut();
        for (cell, byte) in self.cells[offset..].iter_mut().zip(&value.to_le_bytes()[..bytes]) {
            if self.dark {
                break;
            }
            *cell &= byte;
            self.programmed += 1;
            // Of the sixteen bytes that the program writes in a row at most.
            self.dark = cut.is_some_and(|cut| self.programmed * 100 > cut.percent * 16);
        }
        self.corner.program_us * MICROSECOND * bytes as Ticks
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::FAST;

    fn unlocked() -> Flash {
        let mut flash = Flash::new(vec![0xff; BYTES], FAST);
        KEYS.into_iter().for_each(|key| assert_eq!(flash.write(Write::of(KEYR, 4, key.into())), 0));
        flash
    }

    #[test]
    fn a_locked_flash_keeps_what_it_holds() {
        let mut flash = Flash::new(vec![0xff; BYTES], FAST);
        flash.write(Write::of(CR, 4, 1 << PG));
        assert_eq!(flash.program(0x4000, 1, 0), 0);
        assert_eq!((flash.load(0x4000, 1), flash.read(SR)), (0xff, SEQUENCE_ERROR));
    }

    #[test]
    fn programming_clears_bits_and_erasing_sets_those_of_its_sector() {
        let mut flash = unlocked();
        flash.write(Write::of(CR, 4, 1 << PG));
        assert_eq!(flash.program(0x4000, 1, 0x0f), 16 * MICROSECOND);
        flash.program(0x4000, 1, 0xf3);
        flash.program(0x8000, 1, 0);
        assert_eq!(flash.load(0x4000, 1), 0x03);
        let stalled = flash.write(Write::of(CR, 4, 1 << STRT | 1 << SER | 1 << 3));
        assert_eq!(stalled, 400 * MILLISECOND);
        assert_eq!((flash.load(0x4000, 1), flash.load(0x8000, 1)), (0xff, 0));
    }

    #[test]
    fn a_power_cut_leaves_an_operation_half_done() {
        let mut flash = unlocked();
        flash.cut_power(Cut { operation: 1, percent: 50 });
        flash.write(Write::of(CR, 4, 1 << LOCK));
        KEYS.into_iter().for_each(|key| assert_eq!(flash.write(Write::of(KEYR, 4, key.into())), 0));
        flash.write(Write::of(CR, 4, 1 << PG));
        (0..16).for_each(|k| assert_eq!(flash.program(0x4000 + k, 1, 0), 16 * MICROSECOND));
        assert!(flash.dark);
        assert_eq!((flash.load(0x4008, 1), flash.load(0x4009, 1)), (0, 0xff));
    }

    #[test]
    fn a_power_cut_comes_at_the_end_of_a_short_operation() {
        let mut flash = unlocked();
        flash.cut_power(Cut { operation: 1, percent: 50 });
        flash.write(Write::of(CR, 4, 1 << LOCK));
        KEYS.into_iter().for_each(|key| assert_eq!(flash.write(Write::of(KEYR, 4, key.into())), 0));
        flash.write(Write::of(CR, 4, 1 << PG));
        flash.program(0x4000, 2, 0);
        assert!(!flash.dark);
        flash.write(Write::of(CR, 4, 1 << LOCK));
        assert!(flash.dark);
        assert_eq!((flash.load(0x4000, 2), flash.load(0x4002, 1)), (0, 0xff));
    }
}
