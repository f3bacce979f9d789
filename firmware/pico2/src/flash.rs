//! The kept end of the flash ([`pneudrive_plan::pico2::flash`]), erased and written by the boot ROM (RP2350 data sheet, 5.4.8).
//!
//! The program runs from the same flash, which cannot be read meanwhile. So what calls the ROM stands in RAM, with every
//! interrupt masked, and it puts the flash back into the quick mode in which the boot ROM has found it.

use core::ptr;
use core::slice;

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};
use pneudrive_app::runtime::talk::Watchdog as _;
use pneudrive_plan::pico2::flash::{BYTES, KEPT, PAGE, SECTOR, page};
use pneudrive_plan::range;
use rp235x_hal::rom_data::{
    connect_internal_flash, flash_exit_xip, flash_flush_cache, flash_range_erase, flash_range_program,
};

use crate::watchdog::Watchdog;

/// Where the flash is read.
const START: usize = 0x1000_0000;

/// Where the boot ROM keeps the routine that puts the flash into the mode in which it was found.
const MODE_ROUTINE: *const u32 = 0x400e_0000 as *const u32;

/// Words of that routine.
const ROUTINE_WORDS: usize = 64;

/// The erase command for 64 KiB, which the ROM takes where it can.
const BLOCK: u32 = 64 * 1024;
const ERASE_BLOCK: u8 = 0xd8;

/// The routines of the ROM, looked up while the flash can be read.
struct Rom {
    connect: unsafe extern "C" fn(),
    exit_quick_mode: unsafe extern "C" fn(),
    erase: unsafe extern "C" fn(u32, usize, u32, u8),
    program: unsafe extern "C" fn(u32, *const u8, usize),
    flush: unsafe extern "C" fn(),
    /// The routine for the quick mode.
    quick_mode: [u32; ROUTINE_WORDS],
}

/// What is to be done.
enum Work<'a> {
    Erase { offset: u32 },
    Program { offset: u32, page: &'a [u8; PAGE] },
}

impl Rom {
    fn look_up() -> Rom {
        let mut quick_mode = [0; ROUTINE_WORDS];
        for (n, word) in quick_mode.iter_mut().enumerate() {
            // SAFETY: the boot RAM has 1 KiB, of words that do not change after the boot.
            *word = unsafe { ptr::read_volatile(MODE_ROUTINE.add(n)) };
        }
        Rom {
            connect: connect_internal_flash::ptr(),
            exit_quick_mode: flash_exit_xip::ptr(),
            erase: flash_range_erase::ptr(),
            program: flash_range_program::ptr(),
            flush: flash_flush_cache::ptr(),
            quick_mode,
        }
    }

    fn carry_out(&self, work: &Work<'_>) {
        // SAFETY: interrupts are masked, and the other core was never started.
        cortex_m::interrupt::free(|_| unsafe { in_ram(self, work) });
    }
}

/// # Safety
/// Nothing else may run meanwhile: the flash, and the program in it, cannot be read.
#[unsafe(link_section = ".data.in_ram")]
#[inline(never)]
unsafe fn in_ram(rom: &Rom, work: &Work<'_>) {
    // SAFETY: in the order of the data sheet; offsets and lengths are those of whole sectors and pages that are kept. The
    // routine is Thumb code and stands in RAM.
    unsafe {
        (rom.connect)();
        (rom.exit_quick_mode)();
        match *work {
            Work::Erase { offset } => (rom.erase)(offset, SECTOR as usize, BLOCK, ERASE_BLOCK),
            Work::Program { offset, page } => (rom.program)(offset, page.as_ptr(), PAGE),
        }
        (rom.flush)();
        let routine = rom.quick_mode.as_ptr() as usize | 1;
        core::mem::transmute::<usize, unsafe extern "C" fn()>(routine)();
    }
}

/// The kept sectors.
pub struct KeptFlash {
    watchdog: Watchdog,
}

impl KeptFlash {
    /// The watchdog is given the time that erasing takes.
    pub fn new(watchdog: Watchdog) -> KeptFlash {
        KeptFlash { watchdog }
    }

    fn carry_out(&mut self, work: &Work<'_>) {
        let rom = Rom::look_up();
        self.watchdog.while_writing(|| rom.carry_out(work));
    }
}

impl ErrorType for KeptFlash {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for KeptFlash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        if !range::contains(&KEPT, offset, bytes.len()) {
            return Err(NorFlashErrorKind::OutOfBounds);
        }
        // SAFETY: bytes of the flash that nobody writes meanwhile, as writing takes this by `&mut`.
        let kept = unsafe { slice::from_raw_parts((START + offset as usize) as *const u8, bytes.len()) };
        bytes.copy_from_slice(kept);
        Ok(())
    }

    fn capacity(&self) -> usize {
        BYTES as usize
    }
}

impl NorFlash for KeptFlash {
    const WRITE_SIZE: usize = 1;
    const ERASE_SIZE: usize = SECTOR as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        if !from.is_multiple_of(SECTOR) || !to.is_multiple_of(SECTOR) {
            return Err(NorFlashErrorKind::NotAligned);
        }
        if from > to || from < KEPT.start || to > KEPT.end {
            return Err(NorFlashErrorKind::OutOfBounds);
        }
        for offset in (from..to).step_by(SECTOR as usize) {
            self.carry_out(&Work::Erase { offset });
        }
        self.watchdog.feed();
        Ok(())
    }

    /// Page by page. The bytes of a page that are not written are programmed as 0xff, which changes none.
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        if !range::contains(&KEPT, offset, bytes.len()) {
            return Err(NorFlashErrorKind::OutOfBounds);
        }
        let (mut offset, mut rest) = (offset, bytes);
        while !rest.is_empty() {
            let (start, place) = page(offset);
            let (now, later) = rest.split_at(rest.len().min(PAGE - place));
            let mut image = [0xff; PAGE];
            image.iter_mut().skip(place).zip(now).for_each(|(to, from)| *to = *from);
            self.carry_out(&Work::Program { offset: start, page: &image });
            offset += now.len() as u32;
            rest = later;
        }
        Ok(())
    }
}
