//! Bytes in and out of flash in whole chunks, under a running CRC-32 (ISO-HDLC).

use embedded_storage::nor_flash::{NorFlash, ReadNorFlash};
use pneudrive_protocol::RecordCrc;

/// Bytes that go to and from the flash at once: a multiple of every flash's read and write size.
pub const CHUNK_BYTES: usize = 32;

/// The value of an erased byte.
pub const ERASED: u8 = 0xff;

/// Where in the flash something lies; whole chunks, from a byte up to but not with another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// The first byte.
    pub start: u32,
    /// The byte after the last.
    pub end: u32,
}

impl Span {
    /// Its length, bytes; 0 for one that ends before its start.
    pub fn len(&self) -> usize {
        self.end.saturating_sub(self.start) as usize
    }
}

/// Reads a span from its start on. Unreadable data end it early.
pub struct Reader<'a, F> {
    flash: &'a mut F,
    span: Span,
    chunk: [u8; CHUNK_BYTES],
    used: usize,
    crc: RecordCrc,
}

impl<'a, F: ReadNorFlash> Reader<'a, F> {
    /// A reader at the start of the span.
    pub fn new(flash: &'a mut F, span: Span) -> Self {
        const { assert!(CHUNK_BYTES.is_multiple_of(F::READ_SIZE), "a chunk is whole words to be read") };
        Reader { flash, span, chunk: [0; CHUNK_BYTES], used: CHUNK_BYTES, crc: RecordCrc::new() }
    }

    /// The next N bytes; None if there are fewer.
    pub fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let mut bytes = [0; N];
        for byte in &mut bytes {
            *byte = self.byte()?;
        }
        self.crc.update(&bytes);
        Some(bytes)
    }

    /// Leaves out bytes, but not in the CRC; None if there are fewer.
    pub fn skip(&mut self, bytes: usize) -> Option<()> {
        let mut left = bytes;
        while left > 0 {
            if self.used >= CHUNK_BYTES {
                self.refill()?;
            }
            let part = self.chunk.get(self.used..)?;
            let part = part.get(..left).unwrap_or(part);
            self.crc.update(part);
            self.used += part.len();
            left -= part.len();
        }
        Some(())
    }

    /// Whether the CRC of all that was read follows.
    pub fn ends_with_crc(mut self) -> bool {
        let crc = self.crc.clone().finish();
        self.take() == Some(crc.to_le_bytes())
    }

    /// Whether the whole span can be read and is erased.
    pub fn all_blank(mut self) -> bool {
        while self.refill().is_some() {
            if self.chunk != [ERASED; CHUNK_BYTES] {
                return false;
            }
        }
        self.span.start == self.span.end
    }

    fn byte(&mut self) -> Option<u8> {
        if self.used >= CHUNK_BYTES {
            self.refill()?;
        }
        let byte = self.chunk.get(self.used).copied();
        self.used += 1;
        byte
    }

    #[cold]
    #[inline(never)]
    fn refill(&mut self) -> Option<()> {
        let next = self.span.start.checked_add(CHUNK_BYTES as u32).filter(|&next| next <= self.span.end)?;
        self.flash.read(self.span.start, &mut self.chunk).ok()?;
        self.span.start = next;
        self.used = 0;
        Some(())
    }
}

/// Writes from a byte of erased flash on, each word once.
pub struct Writer<'a, F> {
    flash: &'a mut F,
    at: u32,
    chunk: [u8; CHUNK_BYTES],
    filled: usize,
    crc: RecordCrc,
}

impl<'a, F: NorFlash> Writer<'a, F> {
    /// A writer at the start of the span. The caller has checked that the bytes fit.
    pub fn new(flash: &'a mut F, span: Span) -> Self {
        const { assert!(CHUNK_BYTES.is_multiple_of(F::WRITE_SIZE), "a chunk is whole words to be written") };
        Writer { flash, at: span.start, chunk: [ERASED; CHUNK_BYTES], filled: 0, crc: RecordCrc::new() }
    }

    /// Writes the bytes that follow; the last of them wait until their chunk is full.
    pub fn put(&mut self, bytes: &[u8]) -> Result<(), F::Error> {
        self.crc.update(bytes);
        for &byte in bytes {
            if let Some(place) = self.chunk.get_mut(self.filled) {
                *place = byte;
            }
            self.filled += 1;
            if self.filled >= CHUNK_BYTES {
                self.flush()?;
            }
        }
        Ok(())
    }

    /// Writes the CRC of all bytes, and those that still wait.
    pub fn finish(mut self) -> Result<(), F::Error> {
        let crc = self.crc.clone().finish();
        self.put(&crc.to_le_bytes())?;
        self.flush()
    }

    /// Writes the chunk up to the word that is filled last; its remaining bytes stay erased.
    #[cold]
    #[inline(never)]
    fn flush(&mut self) -> Result<(), F::Error> {
        let bytes = self.filled.next_multiple_of(F::WRITE_SIZE);
        let words = self.chunk.get(..bytes).unwrap_or(&self.chunk);
        if !words.is_empty() {
            self.flash.write(self.at, words)?;
        }
        self.at = self.at.wrapping_add(CHUNK_BYTES as u32);
        self.chunk = [ERASED; CHUNK_BYTES];
        self.filled = 0;
        Ok(())
    }
}
