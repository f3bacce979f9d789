//! The flashed image, read from its ELF file.

use std::path::Path;

use anyhow::{Context, Result, ensure};
use object::elf::FileHeader32;
use object::read::elf::{ElfFile, ProgramHeader};
use object::{LittleEndian, Object, ObjectSegment};

use crate::peripheral::flash;

/// Bytes of an image and where the programmer writes them, from the start of the flash on.
#[derive(Clone, Debug)]
pub struct Image(Vec<(usize, Vec<u8>)>);

impl Image {
    /// Reads an ELF file.
    ///
    /// # Errors
    /// When it is none, or has bytes beyond the flash.
    pub fn read(path: &Path) -> Result<Image> {
        let named = || format!("{}", path.display());
        let file = std::fs::read(path).with_context(named)?;
        let elf = ElfFile::<FileHeader32<LittleEndian>>::parse(&*file).with_context(named)?;
        let mut parts = Vec::new();
        for segment in elf.segments() {
            let bytes = segment.data().with_context(named)?;
            if bytes.is_empty() {
                continue;
            }
            let address = segment.elf_program_header().p_paddr(LittleEndian);
            let place = address.checked_sub(flash::START).map(|place| place as usize);
            let fits = place.filter(|place| place + bytes.len() <= flash::BYTES);
            parts.push((fits.with_context(|| format!("{address:#x} is no flash"))?, bytes.to_vec()));
        }
        ensure!(!parts.is_empty(), "{}: nothing to flash", path.display());
        Ok(Image(parts))
    }

    /// Flashes it: what else the cells hold stays.
    pub fn flash(&self, cells: &mut [u8]) {
        for (place, bytes) in &self.0 {
            cells[*place..][..bytes.len()].copy_from_slice(bytes);
        }
    }
}
