//! Numbers in what the records of a pair of slots leave free, each a mark of its own: to note one takes no erase.
//!
//! | bytes of a mark | hold |
//! |---|---|
//! | 4 | magic |
//! | 4 | the number |
//! | 4 | CRC-32 (ISO-HDLC) of both |
//! | 20 | nothing: erased |
//!
//! Numbers are little endian. Each mark goes to the first erased place. One that a power cut has torn takes its place for
//! good and is passed over; one that still reads as erased is tried again.

use embedded_storage::nor_flash::{NorFlash, ReadNorFlash};
use pneudrive_protocol::frame;

use super::stream::{CHUNK_BYTES, ERASED, Span};

const MAGIC: [u8; 4] = *b"PDbt";

type Mark = [u8; CHUNK_BYTES];

/// The largest number that is marked; None: no mark is whole.
pub fn newest<F: ReadNorFlash>(flash: &mut F, part: Span) -> Option<u32> {
    places(part).filter_map(|at| number_in(&read(flash, at)?)).max()
}

/// Marks a number, and tells whether the flash holds it now. A place that reads as erased may refuse: a power cut has hit
/// it before. The next one is tried then.
pub fn add<F: NorFlash>(flash: &mut F, part: Span, number: u32) -> bool {
    let mark = mark_of(number);
    places(part).any(|at| {
        is_blank(&read(flash, at)) && flash.write(at, &mark).is_ok() && read(flash, at) == Some(mark)
    })
}

fn places(part: Span) -> impl Iterator<Item = u32> {
    let last = part.end.saturating_sub(CHUNK_BYTES as u32);
    (part.start..=last).step_by(CHUNK_BYTES)
}

/// What stands in a place; None if it cannot be read.
fn read<F: ReadNorFlash>(flash: &mut F, at: u32) -> Option<Mark> {
    let mut mark = [0; CHUNK_BYTES];
    flash.read(at, &mut mark).ok().map(|()| mark)
}

fn is_blank(mark: &Option<Mark>) -> bool {
    *mark == Some([ERASED; CHUNK_BYTES])
}

fn mark_of(number: u32) -> Mark {
    let [m0, m1, m2, m3] = MAGIC;
    let [n0, n1, n2, n3] = number.to_le_bytes();
    let sealed = [m0, m1, m2, m3, n0, n1, n2, n3];
    let bytes = sealed.into_iter().chain(frame::crc32(&sealed).to_le_bytes());
    let mut mark = [ERASED; CHUNK_BYTES];
    mark.iter_mut().zip(bytes).for_each(|(to, from)| *to = from);
    mark
}

/// The number in a mark; None if it is torn or something else.
fn number_in(mark: &Mark) -> Option<u32> {
    let (_, behind) = mark.split_first_chunk::<4>()?;
    let number = u32::from_le_bytes(*behind.first_chunk()?);
    (*mark == mark_of(number)).then_some(number)
}
