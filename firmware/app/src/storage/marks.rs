//! Entries in the free part of a pair of slots, each a mark of its own. Writing a mark takes no erase.
//!
//! | bytes of a mark | hold |
//! |---|---|
//! | its kind's | magic |
//! | its kind's | the entry |
//! | 4 | CRC-32 (ISO-HDLC) of both |
//! | the rest of 32 | nothing: erased |
//!
//! Each mark goes to the first erased place. A mark that a power cut has torn keeps its place and is skipped. One
//! that still reads as erased is tried again.

use embedded_storage::nor_flash::{NorFlash, ReadNorFlash};
use pneudrive_protocol::frame;

use super::stream::{CHUNK_BYTES, ERASED, Span};

/// The contents of a place.
pub type Mark = [u8; CHUNK_BYTES];

/// The marks of a part, in the order of their places. Unreadable ones are left out.
pub fn all<F: ReadNorFlash>(flash: &mut F, part: Span) -> impl Iterator<Item = Mark> {
    places(part).filter_map(|at| read(flash, at))
}

/// Writes a mark, and tells whether the flash holds it now. A place that reads as erased may refuse: a power cut has hit
/// it before. The next one is tried then.
#[cold]
#[inline(never)]
pub fn add<F: NorFlash>(flash: &mut F, part: Span, mark: &Mark) -> bool {
    places(part).any(|at| {
        read(flash, at) == Some([ERASED; CHUNK_BYTES])
            && flash.write(at, mark).is_ok()
            && read(flash, at) == Some(*mark)
    })
}

/// The mark of an entry behind the magic of its kind.
#[cold]
#[inline(never)]
pub fn of(magic: &[u8], entry: &[u8]) -> Mark {
    let mut mark = [ERASED; CHUNK_BYTES];
    let sealed = magic.iter().chain(entry);
    mark.iter_mut().zip(sealed).for_each(|(to, from)| *to = *from);
    let length = magic.len() + entry.len();
    let crc = frame::crc32(mark.get(..length).unwrap_or(&mark)).to_le_bytes();
    mark.iter_mut().skip(length).zip(crc).for_each(|(to, from)| *to = from);
    mark
}

/// The entry of N bytes in a mark; None if it is torn or of another kind.
pub fn entry<const N: usize>(magic: &[u8], mark: &Mark) -> Option<[u8; N]> {
    let entry = *mark.get(magic.len()..)?.first_chunk()?;
    (*mark == of(magic, &entry)).then_some(entry)
}

fn places(part: Span) -> impl Iterator<Item = u32> {
    let last = part.end.saturating_sub(CHUNK_BYTES as u32);
    (part.start..=last).step_by(CHUNK_BYTES)
}

/// The contents of a place; None if it cannot be read.
fn read<F: ReadNorFlash>(flash: &mut F, at: u32) -> Option<Mark> {
    let mut mark = [0; CHUNK_BYTES];
    flash.read(at, &mut mark).ok().map(|()| mark)
}
