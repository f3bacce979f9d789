//! A NOR flash in memory that holds its user to the rules, and can lose its power at any operation.
//!
//! An operation is one word programmed or one sector erased.

use std::ops::Range;

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};

/// Bytes of an erase sector.
pub const SECTOR: usize = 512;

/// What the operation that the power cut hits does to its word or sector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tear {
    /// Nothing yet.
    Untouched,
    /// So many sixteenths of its bytes are done, rounded up.
    Sixteenths(usize),
    /// All its bytes are zero: an erase often begins so.
    Zeros,
    /// Its bytes are anything.
    Garbage(u64),
    /// So are those of the words that the same call was still to write.
    GarbageToTheEnd(u64),
    /// All is done, but nobody was told.
    Done,
}

/// One of each kind.
pub const TEARS: [Tear; 8] = [
    Tear::Untouched,
    Tear::Sixteenths(1),
    Tear::Sixteenths(8),
    Tear::Sixteenths(15),
    Tear::Zeros,
    Tear::Garbage(1),
    Tear::GarbageToTheEnd(2),
    Tear::Done,
];

/// What becomes of a word whose writing was cut, and which still reads as erased, when it is written again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TornWord {
    /// Nobody may do that: the test fails.
    Forbidden,
    /// It is written: flash without a code that corrects errors.
    Taken,
    /// It is refused: flash with such a code.
    Refused,
}

/// Why the flash did not do it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlashError {
    /// The power is off.
    NoPower,
    /// The bytes can't be corrected.
    Unreadable,
    /// The word was written before.
    WrittenBefore,
}

impl NorFlashError for FlashError {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

/// A flash whose words have WRITE bytes. It panics at what a real one would do wrong in silence: a word
/// that is written twice, addresses between words or sectors.
///
/// Writing clears bits and sets none (reference manuals of the STM32F4, "Standard programming"): a word
/// that is written as all ones stays erased and may be written. One whose writing was cut may not, whatever it
/// reads as.
#[derive(Clone)]
pub struct Flash<const WRITE: usize> {
    pub bytes: Vec<u8>,
    written: Vec<bool>,
    /// What becomes of a word whose writing was cut.
    pub torn_word: TornWord,
    /// Erases of each sector.
    pub erases: Vec<u32>,
    /// Operations so far.
    pub operations: usize,
    cut: Option<(usize, Tear)>,
    powered: bool,
    /// Where a read fails.
    pub unreadable: Range<u32>,
}

impl<const WRITE: usize> Flash<WRITE> {
    /// An erased flash.
    pub fn new(sectors: usize) -> Self {
        let bytes = sectors * SECTOR;
        Flash {
            bytes: vec![0xff; bytes],
            written: vec![false; bytes / WRITE],
            torn_word: TornWord::Forbidden,
            erases: vec![0; sectors],
            operations: 0,
            cut: None,
            powered: true,
            unreadable: 0..0,
        }
    }

    /// Puts bytes there, as if they had been written.
    pub fn put(&mut self, at: u32, bytes: &[u8]) {
        let at = at as usize;
        self.bytes[at..at + bytes.len()].copy_from_slice(bytes);
        (at / WRITE..(at + bytes.len()).div_ceil(WRITE)).for_each(|word| self.note_written(word));
    }

    fn note_written(&mut self, word: usize) {
        self.written[word] |= self.bytes[word * WRITE..(word + 1) * WRITE].iter().any(|&byte| byte != 0xff);
    }

    /// The power goes after so many more operations; the next one is torn.
    pub fn cut_after(&mut self, operations: usize, tear: Tear) {
        self.cut = Some((self.operations + operations, tear));
    }

    /// The power is back.
    pub fn reboot(&mut self) {
        self.cut = None;
        self.powered = true;
    }

    /// Whether the power went.
    pub fn is_powered_off(&self) -> bool {
        !self.powered
    }

    fn power(&self) -> Result<(), FlashError> {
        if self.powered { Ok(()) } else { Err(FlashError::NoPower) }
    }

    /// How the present operation is torn, if it is.
    fn operate(&mut self) -> Option<Tear> {
        let tear = self.cut.filter(|(at, _)| *at == self.operations).map(|(_, tear)| tear);
        self.operations += 1;
        self.powered = tear.is_none();
        tear
    }

    fn damage(&mut self, range: Range<usize>, tear: Tear, wanted: &[u8], rest_of_call: usize) {
        let garbage = |seed: u64, at: usize| (mixed(seed ^ (at as u64) << 20) >> 24) as u8;
        let part = |sixteenths: usize| (range.len() * sixteenths).div_ceil(16);
        match tear {
            Tear::Untouched => return,
            Tear::Sixteenths(n) => {
                self.bytes[range.start..range.start + part(n)].copy_from_slice(&wanted[..part(n)]);
            }
            Tear::Zeros => self.bytes[range.clone()].fill(0),
            Tear::Garbage(seed) => range.clone().for_each(|at| self.bytes[at] = garbage(seed, at)),
            Tear::GarbageToTheEnd(seed) => {
                (range.start..range.start + rest_of_call).for_each(|at| self.bytes[at] = garbage(seed, at));
                self.written[range.start / WRITE..(range.start + rest_of_call) / WRITE].fill(true);
            }
            Tear::Done => self.bytes[range.clone()].copy_from_slice(wanted),
        }
        self.written[range.start / WRITE..range.end / WRITE].fill(true);
    }
}

/// Splitmix64: a number that looks like nothing else.
fn mixed(seed: u64) -> u64 {
    let z = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

impl<const WRITE: usize> ErrorType for Flash<WRITE> {
    type Error = FlashError;
}

impl<const WRITE: usize> ReadNorFlash for Flash<WRITE> {
    const READ_SIZE: usize = if WRITE < 4 { 1 } else { 4 };

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        self.power()?;
        let (start, end) = (offset as usize, offset as usize + bytes.len());
        assert!(start.is_multiple_of(Self::READ_SIZE) && end.is_multiple_of(Self::READ_SIZE), "alignment");
        if start < self.unreadable.end as usize && (self.unreadable.start as usize) < end {
            return Err(FlashError::Unreadable);
        }
        bytes.copy_from_slice(&self.bytes[start..end]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl<const WRITE: usize> NorFlash for Flash<WRITE> {
    const WRITE_SIZE: usize = WRITE;
    const ERASE_SIZE: usize = SECTOR;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        assert!((from as usize).is_multiple_of(SECTOR) && (to as usize).is_multiple_of(SECTOR), "alignment");
        for start in (from as usize..to as usize).step_by(SECTOR) {
            self.power()?;
            let sector = start..start + SECTOR;
            if let Some(tear) = self.operate() {
                self.damage(sector, tear, &[0xff; SECTOR], SECTOR);
                return Err(FlashError::NoPower);
            }
            self.erases[start / SECTOR] += 1;
            self.bytes[sector.clone()].fill(0xff);
            self.written[sector.start / WRITE..sector.end / WRITE].fill(false);
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        assert!((offset as usize).is_multiple_of(WRITE) && bytes.len().is_multiple_of(WRITE), "alignment");
        for (i, word) in bytes.chunks(WRITE).enumerate() {
            self.power()?;
            let start = offset as usize + i * WRITE;
            let reads_as_erased = self.bytes[start..start + WRITE].iter().all(|&byte| byte == 0xff);
            match self.torn_word {
                TornWord::Refused if self.written[start / WRITE] => return Err(FlashError::WrittenBefore),
                TornWord::Taken if reads_as_erased => {}
                _ => assert!(!self.written[start / WRITE], "the word at {start} is written twice"),
            }
            if let Some(tear) = self.operate() {
                self.damage(start..start + WRITE, tear, word, bytes.len() - i * WRITE);
                return Err(FlashError::NoPower);
            }
            self.bytes[start..start + WRITE].copy_from_slice(word);
            self.note_written(start / WRITE);
        }
        Ok(())
    }
}

/// A record as the layout says, worked out apart from the crate: without the seal.
pub fn record(
    magic: &[u8; 4],
    format: u16,
    entry_bytes: u16,
    generation: u32,
    entries: &[Vec<u8>],
) -> Vec<u8> {
    let mut bytes = magic.to_vec();
    bytes.extend(format.to_le_bytes());
    bytes.extend(entry_bytes.to_le_bytes());
    bytes.extend(generation.to_le_bytes());
    bytes.extend((entries.len() as u16).to_le_bytes());
    entries.iter().for_each(|entry| bytes.extend(entry));
    bytes.extend(crc32(&bytes).to_le_bytes());
    bytes
}

/// CRC-32/ISO-HDLC, bit by bit.
pub fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg()))
    })
}
