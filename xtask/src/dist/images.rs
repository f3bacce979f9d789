//! The images of the boards: the ELF file for a debug probe, and the file that is loaded without one. Both leave the sectors
//! with configuration and fault log alone, as a raw copy of the flash would not.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use ihex::Record;
use pneudrive_build::cargo::{THUMB, THUMB_V8};
use pneudrive_build::firmware::PICO2;

use super::Source;
use crate::image::{Image, Load};

const NUCLEO: &str = "nucleo-f446";

/// Builds both images.
///
/// # Errors
/// When one does not build, or does not bear the id of this commit.
pub fn make(source: &Source, out: &Path) -> Result<()> {
    fs::create_dir_all(out)?;
    for (image, workspace, target) in [(NUCLEO, "firmware", THUMB), (PICO2, "firmware/pico2", THUMB_V8)] {
        let package = format!("pneudrive-{image}");
        source.cargo(workspace, &["build", "--locked", "--quiet", "--release", "--package", &package])?;
        let built = source.target().join(target).join("release").join(image);
        let elf = fs::read(&built).with_context(|| built.display().to_string())?;
        let loads = Image::loads(&elf)?;
        ensure!(
            loads.iter().any(|load| holds(&load.bytes, source.build_id().as_bytes())),
            "{image} does not bear the id {}",
            source.build_id()
        );
        let name = format!("{}-{image}", source.name());
        fs::write(out.join(format!("{name}.elf")), &elf)?;
        if image == PICO2 {
            fs::write(out.join(format!("{name}.uf2")), uf2(&loads)?)?;
        } else {
            fs::write(out.join(format!("{name}.hex")), hex(&loads)?)?;
        }
    }
    Ok(())
}

fn holds(bytes: &[u8], wanted: &[u8]) -> bool {
    bytes.windows(wanted.len()).any(|part| part == wanted)
}

/// Bytes of data per line.
const LINE: usize = 16;

/// Intel HEX, with 32-bit addresses.
fn hex(loads: &[Load]) -> Result<String> {
    let mut records = Vec::new();
    let mut upper = None;
    for load in loads {
        let (mut address, mut rest) = (load.address, load.bytes.as_slice());
        while !rest.is_empty() {
            // A line ends at a multiple of its length, so that none crosses the 64 KiB that an offset reaches.
            let (line, behind) = rest.split_at(rest.len().min(LINE - address as usize % LINE));
            let [above_1, above_0, offset_1, offset_0] = address.to_be_bytes();
            let above = u16::from_be_bytes([above_1, above_0]);
            if upper != Some(above) {
                records.push(Record::ExtendedLinearAddress(above));
                upper = Some(above);
            }
            let offset = u16::from_be_bytes([offset_1, offset_0]);
            records.push(Record::Data { offset, value: line.to_vec() });
            address += u32::try_from(line.len())?;
            rest = behind;
        }
    }
    records.push(Record::EndOfFile);
    Ok(ihex::create_object_file_representation(&records)?)
}

/// Bytes of flash in a block of a UF2 file, which is a page of the chip's flash.
const PAGE: usize = 256;
/// `rp2350-arm-s` in the list of families of the UF2 specification.
const FAMILY: u32 = 0xE48B_FF59;

/// A UF2 file: blocks of 512 bytes, each with one page of flash (UF2 specification, "File format").
fn uf2(loads: &[Load]) -> Result<Vec<u8>> {
    let mut pages: Vec<(u32, Vec<u8>)> = Vec::new();
    for load in loads {
        for (address, byte) in (load.address..).zip(&load.bytes) {
            let offset = address as usize % PAGE;
            let begin = address - offset as u32;
            if pages.last().is_none_or(|(last, _)| *last != begin) {
                pages.push((begin, vec![0xFF; PAGE]));
            }
            if let Some(at) = pages.last_mut().and_then(|(_, page)| page.get_mut(offset)) {
                *at = *byte;
            }
        }
    }
    let count = u32::try_from(pages.len())?;
    let blocks = pages.iter().zip(0..).map(|((address, page), number)| {
        let head = [0x0A32_4655, 0x9E5D_5157, 0x0000_2000, *address, PAGE as u32, number, count, FAMILY];
        let mut block: Vec<u8> = head.iter().flat_map(|word: &u32| word.to_le_bytes()).collect();
        block.extend(page);
        block.resize(508, 0);
        block.extend(0x0AB1_6F30_u32.to_le_bytes());
        block
    });
    Ok(blocks.flatten().collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn load(address: u32, bytes: &[u8]) -> Load {
        Load { address, bytes: bytes.to_vec() }
    }

    #[test]
    fn a_hex_file_has_the_addresses_of_both_parts_and_nothing_between() {
        let text = hex(&[load(0x0800_0000, &[1, 2]), load(0x0802_000E, &[3, 4, 5])]).expect("a file");
        let wanted = [
            ":020000040800F2",
            ":020000000102FB",
            ":020000040802F0",
            ":02000E000304E9",
            ":0100100005EA",
            ":00000001FF",
        ];
        assert_eq!(text.lines().collect::<Vec<_>>(), wanted);
    }

    #[test]
    fn a_uf2_block_has_the_words_of_the_specification() {
        let file = uf2(&[load(0x1000_0100, &[0xAA; 257])]).expect("a file");
        assert_eq!(file.len(), 2 * 512);
        let word = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().expect("four bytes"));
        assert_eq!([word(0), word(4), word(8)], [0x0A32_4655, 0x9E5D_5157, 0x2000]);
        assert_eq!([word(12), word(16), word(20), word(24), word(28)], [0x1000_0100, 256, 0, 2, 0xE48B_FF59]);
        assert_eq!([word(508), word(512 + 12), word(512 + 20)], [0x0AB1_6F30, 0x1000_0200, 1]);
        assert_eq!((file[512 + 32], file[512 + 33]), (0xAA, 0xFF), "the rest of a page is erased flash");
    }

    #[test]
    fn parts_that_share_a_page_share_a_block() {
        let file = uf2(&[load(0x1000_0000, &[1; 8]), load(0x1000_0010, &[2; 8])]).expect("a file");
        assert_eq!((file.len(), file[32], file[32 + 8], file[32 + 16]), (512, 1, 0xFF, 2));
    }
}
