//! The flash of a simulated board, kept by this program: it outlives the board, and the board's power can
//! be cut at any of its operations.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};
use pneudrive_app::ram_flash::{RamFlash, SECTOR, WORD};

/// The flash. Clones share it.
#[derive(Clone, Debug, Default)]
pub struct PersistentFlash(Arc<Mutex<Cells>>);

#[derive(Debug, Default)]
struct Cells {
    flash: RamFlash,
    /// Writes and erases that are still completed; None: all.
    until_cut: Option<u64>,
    powered_off: bool,
}

/// The power is off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PowerOff;

impl NorFlashError for PowerOff {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl PersistentFlash {
    /// Cuts the power in the middle of the nth write or erase from now, the next one being the first: half of its bytes are
    /// done.
    pub fn cut_power_at(&self, nth: u64) {
        self.cells().until_cut = Some(nth.saturating_sub(1));
    }

    /// Overwrites the heads of both slots of the configuration with zeros.
    pub fn damage_configuration(&self) {
        let mut cells = self.cells();
        for slot in RamFlash::layout().config {
            let Ok(()) = cells.flash.write(slot.start, &[0; 4 * WORD]);
        }
    }

    /// Whether the power is off.
    #[must_use]
    pub fn is_powered_off(&self) -> bool {
        self.cells().powered_off
    }

    /// Switches the power on again, without a further cut.
    pub fn switch_on(&self) {
        let mut cells = self.cells();
        (cells.until_cut, cells.powered_off) = (None, false);
    }

    fn cells(&self) -> MutexGuard<'_, Cells> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Cells {
    /// How many of `bytes` are done: all or, if the power fails, half of them in whole `unit`s.
    fn grant(&mut self, bytes: usize, unit: usize) -> Result<usize, PowerOff> {
        match self.until_cut {
            _ if self.powered_off => Err(PowerOff),
            Some(0) => {
                self.powered_off = true;
                Ok(bytes / unit / 2 * unit)
            }
            ref mut left => {
                *left = left.map(|left| left - 1);
                Ok(bytes)
            }
        }
    }

    fn check_power(&self) -> Result<(), PowerOff> {
        if self.powered_off { Err(PowerOff) } else { Ok(()) }
    }
}

impl ErrorType for PersistentFlash {
    type Error = PowerOff;
}

impl ReadNorFlash for PersistentFlash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), PowerOff> {
        let mut cells = self.cells();
        let Ok(()) = cells.flash.read(offset, bytes);
        cells.check_power()
    }

    fn capacity(&self) -> usize {
        self.cells().flash.capacity()
    }
}

impl NorFlash for PersistentFlash {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = SECTOR;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), PowerOff> {
        let mut cells = self.cells();
        // An erase that is cut stops anywhere in a sector.
        let done = cells.grant(to.saturating_sub(from) as usize, 1)?;
        let Ok(()) = cells.flash.erase(from, from + done as u32);
        cells.check_power()
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), PowerOff> {
        let mut cells = self.cells();
        let done = cells.grant(bytes.len(), WORD)?;
        let Ok(()) = cells.flash.write(offset, &bytes[..done]);
        cells.check_power()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(flash: &mut PersistentFlash) -> [u8; 8] {
        let mut bytes = [0; 8];
        flash.read(0, &mut bytes).expect("power");
        bytes
    }

    #[test]
    fn the_operation_in_which_the_power_goes_is_half_done_and_nothing_comes_after_it() {
        let mut flash = PersistentFlash::default();
        flash.cut_power_at(2);
        assert_eq!(flash.write(0, &[0; 4]), Ok(()));
        assert_eq!(flash.write(4, &[0; 4]), Err(PowerOff), "a word is written or not");
        assert_eq!((flash.write(4, &[0; 4]), flash.read(0, &mut [0])), (Err(PowerOff), Err(PowerOff)));
        assert!(flash.is_powered_off());
        flash.switch_on();
        assert_eq!(read(&mut flash), [0, 0, 0, 0, 0xff, 0xff, 0xff, 0xff]);
        flash.cut_power_at(1);
        assert_eq!(flash.erase(0, SECTOR as u32), Err(PowerOff));
        flash.switch_on();
        assert_eq!(read(&mut flash), [0xff; 8], "the first half is erased");
    }
}
