//! The sectors of the internal flash that are kept ([`pneudrive_plan::nucleo::flash`]). While it erases
//! or writes, the processor stalls: it runs from the same flash.

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};
use pneudrive_app::runtime::talk::Watchdog as _;
use pneudrive_plan::nucleo::flash::{BYTES, KEPT, UNIT, sectors};
use pneudrive_plan::range;
use stm32f4xx_hal::flash::FlashExt;
use stm32f4xx_hal::pac::FLASH;

use crate::watchdog::Watchdog;

/// The kept sectors.
pub struct KeptFlash {
    flash: FLASH,
    watchdog: Watchdog,
}

impl KeptFlash {
    /// A flash that takes its time from the watchdog.
    pub fn new(flash: FLASH, watchdog: Watchdog) -> KeptFlash {
        KeptFlash { flash, watchdog }
    }
}

/// The flags of the state register that an operation leaves: end, and the seven errors.
const FLAGS: u32 = 0x1f3;

/// What the last operation has left: flags, and old words in the data cache.
fn tidy(flash: &FLASH) {
    // SAFETY: ones clear these flags, and there is nothing else in the register to be written.
    flash.sr().write(|w| unsafe { w.bits(FLAGS) });
    flash.acr().modify(|_, w| w.dcen().clear_bit());
    flash.acr().modify(|_, w| w.dcrst().set_bit());
    flash.acr().modify(|_, w| w.dcrst().clear_bit());
    flash.acr().modify(|_, w| w.dcen().set_bit());
}

impl ErrorType for KeptFlash {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for KeptFlash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        let from = self.flash.read().get(offset as usize..).and_then(|rest| rest.get(..bytes.len()));
        bytes.copy_from_slice(from.ok_or(NorFlashErrorKind::OutOfBounds)?);
        Ok(())
    }

    fn capacity(&self) -> usize {
        BYTES as usize
    }
}

impl NorFlash for KeptFlash {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = UNIT as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        let sectors = sectors(&(from..to)).ok_or(NorFlashErrorKind::NotAligned)?;
        let KeptFlash { flash, watchdog } = self;
        tidy(flash);
        for sector in sectors {
            let erased = watchdog.while_writing(|| flash.unlocked().erase(sector));
            erased.map_err(|_| NorFlashErrorKind::Other)?;
        }
        tidy(flash);
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        if !range::contains(&KEPT, offset, bytes.len()) {
            return Err(NorFlashErrorKind::OutOfBounds);
        }
        tidy(&self.flash);
        let written = self.flash.unlocked().program(offset as usize, bytes.iter());
        tidy(&self.flash);
        self.watchdog.feed();
        written.map_err(|_| NorFlashErrorKind::Other)
    }
}
