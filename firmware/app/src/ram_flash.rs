//! A flash in memory, for execution levels without one. It counts its erases, never wears out, and lives as long as
//! its owner keeps it.

use core::convert::Infallible;

use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};

use crate::store::Layout;

/// Bytes of a sector.
pub const SECTOR: usize = 4096;
const SECTORS: usize = 4;

/// Bytes of the whole.
pub const BYTES: usize = SECTORS * SECTOR;

/// Bytes of a word, the least that is written.
pub const WORD: usize = 4;

/// Four sectors: two slots of the configuration, two of the fault log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RamFlash {
    bytes: [u8; BYTES],
    erases: [u32; SECTORS],
}

impl Default for RamFlash {
    fn default() -> Self {
        RamFlash { bytes: [0xff; BYTES], erases: [0; SECTORS] }
    }
}

impl RamFlash {
    /// Its contents.
    #[must_use]
    pub fn layout() -> Layout {
        let sector = |n: u32| n * SECTOR as u32..(n + 1) * SECTOR as u32;
        Layout { config: [sector(0), sector(1)], faults: [sector(2), sector(3)] }
    }

    /// All its bytes.
    #[must_use]
    pub fn bytes(&self) -> &[u8; BYTES] {
        &self.bytes
    }

    /// How often each sector was erased.
    #[must_use]
    pub fn erases(&self) -> [u32; SECTORS] {
        self.erases
    }

    fn range(&mut self, offset: u32, len: usize) -> &mut [u8] {
        let start = offset as usize;
        self.bytes.get_mut(start..start.saturating_add(len)).unwrap_or(&mut [])
    }
}

impl ErrorType for RamFlash {
    type Error = Infallible;
}

impl ReadNorFlash for RamFlash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Infallible> {
        let from = self.range(offset, bytes.len());
        bytes.iter_mut().zip(from.iter()).for_each(|(to, from)| *to = *from);
        Ok(())
    }

    fn capacity(&self) -> usize {
        BYTES
    }
}

impl NorFlash for RamFlash {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = SECTOR;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Infallible> {
        self.range(from, to.saturating_sub(from) as usize).fill(0xff);
        let sectors = from as usize / SECTOR..to as usize / SECTOR;
        self.erases.get_mut(sectors).unwrap_or(&mut []).iter_mut().for_each(|erases| *erases += 1);
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Infallible> {
        self.range(offset, bytes.len()).iter_mut().zip(bytes).for_each(|(to, from)| *to &= *from);
        Ok(())
    }
}
