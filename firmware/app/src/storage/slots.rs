//! Two slots of flash that keep one record through any power cut.
//!
//! A record is written into the slot that does not hold the newest complete one. So there is always the old record or
//! the new one, whatever the flash was doing when the power went.
//!
//! | bytes of a slot | hold |
//! |---|---|
//! | 4 | magic: whose record it is |
//! | 2 | format of the entries |
//! | 2 | bytes of an entry |
//! | 4 | generation: saves so far, wrapping |
//! | 2 | entries |
//! | entries * bytes of an entry | the entries |
//! | 4 | CRC-32 (ISO-HDLC) of everything before it |
//! | the rest | nothing, or [marks](super::marks) |
//! | the last 32 of the slot | the seal |
//!
//! Numbers are little-endian. The seal is zeros, written once the record has been read back. A record with a correct
//! CRC is good with or without it. A record with a wrong CRC was never finished if the seal is erased, and was
//! damaged later if it is not. This distinguishes a first save that was cut short from a lost configuration.

use core::ops::Range;

use embedded_storage::nor_flash::{NorFlash, ReadNorFlash};

use super::stream::{CHUNK_BYTES, Reader, Span, Writer};

const HEADER_BYTES: usize = 14;
const CRC_BYTES: usize = 4;
const SEAL: [u8; CHUNK_BYTES] = [0; CHUNK_BYTES];

/// Why two ranges of flash can't be the slots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LayoutError {
    /// A range does not start and end with an erase sector.
    NotWholeSectors,
    /// A range ends beyond the flash.
    OutsideFlash,
    /// The ranges share a sector.
    Overlap,
    /// A range has no room for a whole record.
    TooShort,
}

/// Why a record was not saved. The one before is still there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SaveError<E> {
    /// The flash refused.
    Flash(E),
    /// The record is longer than a slot.
    TooLong,
    /// The flash does not hold the written data.
    NotAsWritten,
}

impl<E> From<E> for SaveError<E> {
    fn from(error: E) -> Self {
        SaveError::Flash(error)
    }
}

/// The head of a record, before its entries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Header {
    /// Format of the entries.
    pub format: u16,
    /// Length of an entry, bytes.
    pub entry_bytes: u16,
    /// The number of saves, wrapping.
    pub generation: u32,
    /// Number of entries.
    pub entries: u16,
}

impl Header {
    fn to_bytes(self, magic: [u8; 4]) -> [u8; HEADER_BYTES] {
        let [m0, m1, m2, m3] = magic;
        let [f0, f1] = self.format.to_le_bytes();
        let [b0, b1] = self.entry_bytes.to_le_bytes();
        let [g0, g1, g2, g3] = self.generation.to_le_bytes();
        let [n0, n1] = self.entries.to_le_bytes();
        [m0, m1, m2, m3, f0, f1, b0, b1, g0, g1, g2, g3, n0, n1]
    }

    /// None when it is somebody else's.
    fn from_bytes(magic: [u8; 4], bytes: [u8; HEADER_BYTES]) -> Option<Header> {
        let [m0, m1, m2, m3, f0, f1, b0, b1, g0, g1, g2, g3, n0, n1] = bytes;
        (magic == [m0, m1, m2, m3]).then_some(Header {
            format: u16::from_le_bytes([f0, f1]),
            entry_bytes: u16::from_le_bytes([b0, b1]),
            generation: u32::from_le_bytes([g0, g1, g2, g3]),
            entries: u16::from_le_bytes([n0, n1]),
        })
    }

    fn payload_bytes(&self) -> usize {
        usize::from(self.entry_bytes).saturating_mul(usize::from(self.entries))
    }

    fn record_bytes(&self) -> usize {
        self.payload_bytes().saturating_add(HEADER_BYTES + CRC_BYTES)
    }

    fn is_newer_than(&self, other: &Header) -> bool {
        self.generation.wrapping_sub(other.generation).cast_signed() > 0
    }
}

/// The contents of a slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Slot {
    /// A record whose CRC is right.
    Whole(Header),
    /// Nothing, or a record that was never finished.
    Unfinished,
    /// A record that was finished, or is not ours, and cannot be read.
    Damaged,
}

/// The newest whole record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Record {
    span: Span,
    /// Its head.
    pub header: Header,
    /// The other slot cannot be read: it may hold a newer record.
    pub other_damaged: bool,
}

/// The contents of a pair of slots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Found {
    /// No record was ever finished.
    NeverSaved,
    /// No record can be read, though one was finished.
    Damaged,
    /// A record.
    Whole(Record),
}

/// The two slots of one kind of record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Slots {
    magic: [u8; 4],
    spans: [Span; 2],
}

impl Slots {
    /// Slots in two ranges of flash, bytes from its start. Each has room for this many bytes of entries.
    pub fn new<F: NorFlash>(
        flash: &F,
        magic: [u8; 4],
        [first, second]: [Range<u32>; 2],
        entry_bytes: usize,
    ) -> Result<Slots, LayoutError> {
        const { assert!(F::ERASE_SIZE.is_multiple_of(CHUNK_BYTES), "a sector is whole chunks") };
        let room = HEADER_BYTES + CRC_BYTES + SEAL.len() + entry_bytes;
        let spans = [span(flash, first, room)?, span(flash, second, room)?];
        let [a, b] = spans;
        if a.start < b.end && b.start < a.end {
            return Err(LayoutError::Overlap);
        }
        Ok(Slots { magic, spans })
    }

    /// Looks for the newest whole record. Unreadable data count as damaged.
    #[inline(never)] // For every kind of record.
    pub fn find<F: ReadNorFlash>(&self, flash: &mut F) -> Found {
        let [a, b] = self.survey(flash);
        let [first, second] = self.spans;
        let record = |span, header, other| Record { span, header, other_damaged: other == Slot::Damaged };
        match (a, b) {
            (Slot::Whole(old), Slot::Whole(new)) if new.is_newer_than(&old) => {
                Found::Whole(record(second, new, a))
            }
            (Slot::Whole(header), _) => Found::Whole(record(first, header, b)),
            (_, Slot::Whole(header)) => Found::Whole(record(second, header, a)),
            (Slot::Unfinished, Slot::Unfinished) => Found::NeverSaved,
            _ => Found::Damaged,
        }
    }

    /// Hands out the entries of a record, the first one first. Returns false if they are not N bytes long, or differ
    /// from when the record was found: the entries handed out are void then.
    pub fn read<F: ReadNorFlash, const N: usize>(
        &self,
        flash: &mut F,
        record: &Record,
        mut each: impl FnMut([u8; N]),
    ) -> bool {
        let mut reader = Reader::new(flash, record.span);
        let header = reader.take().and_then(|bytes| Header::from_bytes(self.magic, bytes));
        if header != Some(record.header) || usize::from(record.header.entry_bytes) != N {
            return false;
        }
        for _ in 0..record.header.entries {
            let Some(entry) = reader.take() else { return false };
            each(entry);
        }
        reader.ends_with_crc()
    }

    /// Saves the entries as the newest record, and returns its generation.
    pub fn save<F: NorFlash, const N: usize, I: Iterator<Item = [u8; N]>>(
        &self,
        flash: &mut F,
        format: u16,
        entries: impl Fn() -> I,
    ) -> Result<u32, SaveError<F::Error>> {
        let entry_bytes = u16::try_from(N).map_err(|_| SaveError::TooLong)?;
        let count = u16::try_from(entries().count()).map_err(|_| SaveError::TooLong)?;
        let (span, header) = self.make_room(flash, format, entry_bytes, count)?;
        self.write(flash, span, &header, entries())?;
        self.seal(flash, span, &header)
    }

    /// Clears the slot that a record is to be written into.
    #[inline(never)] // For every kind of record.
    fn make_room<F: NorFlash>(
        &self,
        flash: &mut F,
        format: u16,
        entry_bytes: u16,
        entries: u16,
    ) -> Result<(Span, Header), SaveError<F::Error>> {
        let found = self.find(flash);
        let header = Header { format, entry_bytes, generation: found.next_generation(), entries };
        let span = self.span_to_write(flash, &found);
        if header.record_bytes() > record_part(span).len() {
            return Err(SaveError::TooLong);
        }
        clear(flash, span, &found)?;
        Ok((span, header))
    }

    /// Seals a record that reads as it was written.
    #[inline(never)] // For every kind of record.
    fn seal<F: NorFlash>(
        &self,
        flash: &mut F,
        span: Span,
        header: &Header,
    ) -> Result<u32, SaveError<F::Error>> {
        if self.look(flash, span) != Slot::Whole(*header) {
            return Err(SaveError::NotAsWritten);
        }
        flash.write(seal_part(span).start, &SEAL)?;
        Ok(header.generation)
    }

    /// The room that records of up to this many bytes of entries leave free in each slot: first in the slot that the
    /// next save leaves alone, then in the one that it erases.
    #[cold]
    #[inline(never)]
    pub fn free_parts<F: ReadNorFlash>(&self, flash: &mut F, entry_bytes: usize) -> [Span; 2] {
        let found = self.find(flash);
        let written = self.span_to_write(flash, &found);
        let [first, second] = self.spans;
        let slots = if written == first { [second, first] } else { [first, second] };
        slots.map(|slot| free_part(slot, entry_bytes))
    }

    fn write<F: NorFlash, const N: usize>(
        &self,
        flash: &mut F,
        span: Span,
        header: &Header,
        entries: impl Iterator<Item = [u8; N]>,
    ) -> Result<(), F::Error> {
        let mut writer = Writer::new(flash, record_part(span));
        writer.put(&header.to_bytes(self.magic))?;
        for entry in entries {
            writer.put(&entry)?;
        }
        writer.finish()
    }

    /// The slot without the newest whole record. Without such a record: a slot without damage if there is one,
    /// because damage must not turn into `NeverSaved`; and preferably a blank one.
    #[cold]
    #[inline(never)]
    fn span_to_write<F: ReadNorFlash>(&self, flash: &mut F, found: &Found) -> Span {
        let [first, second] = self.spans;
        let second_is_better = match found {
            Found::Whole(newest) => newest.span == first,
            Found::Damaged => self.look(flash, second) == Slot::Unfinished,
            Found::NeverSaved => !is_blank(flash, first) && is_blank(flash, second),
        };
        if second_is_better { second } else { first }
    }

    fn survey<F: ReadNorFlash>(&self, flash: &mut F) -> [Slot; 2] {
        self.spans.map(|span| self.look(flash, span))
    }

    #[inline(never)] // For every kind of record.
    fn look<F: ReadNorFlash>(&self, flash: &mut F, span: Span) -> Slot {
        match self.whole_record(flash, span) {
            Some(header) => Slot::Whole(header),
            None if is_blank(flash, seal_part(span)) => Slot::Unfinished,
            None => Slot::Damaged,
        }
    }

    #[cold]
    #[inline(never)]
    fn whole_record<F: ReadNorFlash>(&self, flash: &mut F, span: Span) -> Option<Header> {
        let mut reader = Reader::new(flash, record_part(span));
        let header = Header::from_bytes(self.magic, reader.take()?)?;
        reader.skip(header.payload_bytes())?;
        reader.ends_with_crc().then_some(header)
    }
}

impl Found {
    fn next_generation(&self) -> u32 {
        match self {
            Found::Whole(newest) => newest.header.generation.wrapping_add(1),
            Found::NeverSaved | Found::Damaged => 1,
        }
    }
}

/// Erases a slot. Only on the very first save a blank slot is taken as it is: an erase that is cut
/// leaves anything, and there would be no whole record yet to show that nothing was lost.
fn clear<F: NorFlash>(flash: &mut F, span: Span, found: &Found) -> Result<(), F::Error> {
    if *found == Found::NeverSaved && is_blank(flash, span) {
        return Ok(());
    }
    flash.erase(span.start, span.end)
}

fn is_blank<F: ReadNorFlash>(flash: &mut F, span: Span) -> bool {
    Reader::new(flash, span).all_blank()
}

fn span<F: NorFlash>(flash: &F, range: Range<u32>, room: usize) -> Result<Span, LayoutError> {
    let span = Span { start: range.start, end: range.end };
    let sector = F::ERASE_SIZE as u32;
    if !(span.start.is_multiple_of(sector) && span.end.is_multiple_of(sector)) {
        return Err(LayoutError::NotWholeSectors);
    }
    if span.end as usize > flash.capacity() {
        return Err(LayoutError::OutsideFlash);
    }
    if span.len() < room {
        return Err(LayoutError::TooShort);
    }
    Ok(span)
}

/// Where the record stands in a slot.
fn record_part(slot: Span) -> Span {
    Span { start: slot.start, end: seal_part(slot).start }
}

/// Where the seal stands in a slot.
fn seal_part(slot: Span) -> Span {
    Span { start: slot.end.saturating_sub(SEAL.len() as u32), end: slot.end }
}

/// The part between the longest record of a slot and its seal, in whole chunks.
fn free_part(slot: Span, entry_bytes: usize) -> Span {
    let record = (HEADER_BYTES + CRC_BYTES + entry_bytes).next_multiple_of(CHUNK_BYTES);
    let end = record_part(slot).end;
    Span { start: slot.start.saturating_add(record as u32).min(end), end }
}
