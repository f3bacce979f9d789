//! The flash, which the PC keeps: the flash bus over two pipes in the emulator's folder, by semihosting.

use core::ffi::CStr;

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};
use pneudrive_app::flash_bus::{DONE, Operation, Request};
use pneudrive_app::ram_flash::{BYTES, SECTOR, WORD};
use semihosting::fs::File;
use semihosting::io::{self, Read, Write};

/// From the board to the PC.
const REQUESTS: &CStr = c"flash-requests";
/// From the PC to the board.
const ANSWERS: &CStr = c"flash-answers";

/// The board's end of the bus.
pub struct BusFlash {
    requests: File,
    answers: File,
}

impl BusFlash {
    /// Opens the pipes.
    pub fn open() -> io::Result<BusFlash> {
        Ok(BusFlash { requests: File::create(REQUESTS)?, answers: File::open(ANSWERS)? })
    }

    fn ask(
        &mut self,
        operation: Operation,
        offset: u32,
        length: usize,
        bytes: &[u8],
        answer: &mut [u8],
    ) -> Result<(), NorFlashErrorKind> {
        let request = Request { operation, offset, length: length as u32 };
        self.requests
            .write_all(&request.to_bytes())
            .and_then(|()| self.requests.write_all(bytes))
            .and_then(|()| self.answers.read_exact(answer))
            .map_err(|_| NorFlashErrorKind::Other)
    }

    fn have_done(
        &mut self,
        operation: Operation,
        offset: u32,
        length: usize,
        bytes: &[u8],
    ) -> Result<(), NorFlashErrorKind> {
        let mut answer = [0];
        self.ask(operation, offset, length, bytes, &mut answer)?;
        if answer == [DONE] { Ok(()) } else { Err(NorFlashErrorKind::Other) }
    }
}

impl ErrorType for BusFlash {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for BusFlash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        self.ask(Operation::Read, offset, bytes.len(), &[], bytes)
    }

    fn capacity(&self) -> usize {
        BYTES
    }
}

impl NorFlash for BusFlash {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = SECTOR;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        self.have_done(Operation::Erase, from, to.saturating_sub(from) as usize, &[])
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        self.have_done(Operation::Write, offset, bytes.len(), bytes)
    }
}
