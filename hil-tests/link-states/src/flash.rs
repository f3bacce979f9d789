//! A flash whose power goes in the middle of a write or an erase, kept by value: a state of the model owns it.

use std::sync::Arc;

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};
use pneudrive_app::ram_flash::{RamFlash, SECTOR, WORD};

/// The power is off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PowerOff;

impl NorFlashError for PowerOff {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

/// The flash.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Flash {
    cells: Arc<RamFlash>,
    /// Writes and erases that are still carried out whole; None: all.
    until_cut: Option<u8>,
    powered_off: bool,
}

impl Flash {
    /// The power goes in the middle of the nth write or erase from now, 0 being the next: half of its bytes are done.
    pub fn cut_power_at(&mut self, nth: u8) {
        self.until_cut = Some(nth);
    }

    /// Whether the power went.
    #[must_use]
    pub fn is_powered_off(&self) -> bool {
        self.powered_off
    }

    /// The same flash with its power on, as it stays.
    #[must_use]
    pub fn powered(&self) -> Flash {
        Flash { cells: Arc::clone(&self.cells), until_cut: None, powered_off: false }
    }

    /// How many of `bytes` are done: all, or half of them in whole `unit`s as the power goes.
    fn grant(&mut self, bytes: usize, unit: usize) -> Result<usize, PowerOff> {
        match self.until_cut {
            _ if self.powered_off => Err(PowerOff),
            Some(0) => {
                self.powered_off = true;
                Ok(bytes / unit / 2 * unit)
            }
            left => {
                self.until_cut = left.map(|left| left - 1);
                Ok(bytes)
            }
        }
    }

    fn check_power(&self) -> Result<(), PowerOff> {
        if self.powered_off { Err(PowerOff) } else { Ok(()) }
    }
}

impl ErrorType for Flash {
    type Error = PowerOff;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), PowerOff> {
        self.check_power()?;
        let start = offset as usize;
        let there = self.cells.bytes().get(start..start + bytes.len()).ok_or(PowerOff)?;
        bytes.copy_from_slice(there);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.cells.capacity()
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = SECTOR;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), PowerOff> {
        // An erase that is cut stops anywhere in a sector.
        let done = self.grant(to.saturating_sub(from) as usize, 1)?;
        let Ok(()) = Arc::make_mut(&mut self.cells).erase(from, from + done as u32);
        self.check_power()
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), PowerOff> {
        let done = self.grant(bytes.len(), WORD)?;
        let Ok(()) = Arc::make_mut(&mut self.cells).write(offset, &bytes[..done]);
        self.check_power()
    }
}
