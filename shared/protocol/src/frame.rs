//! Messages in a stream of bytes: where each begins and ends, and whether it came whole.
//!
//! A frame is `COBS(message ++ CRC-32/ISO-HDLC of it, little endian) ++ 0x00`. 0x00 stands nowhere
//! else, so a reader that lost its place is right again after the next one. There is no empty
//! message: its CRC is 0 and a few stray bytes would make one.

use cobs::{CobsEncoder, DecodeResult, DecoderState};
use crc::{CRC_32_ISO_HDLC, Crc};

use crate::MAX_MESSAGE;

pub(crate) static CRC_32: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// What ends a frame and stands nowhere inside one.
pub const DELIMITER: u8 = 0;

/// Length of the CRC at the end of a frame, bytes.
pub const CRC_BYTES: usize = size_of::<u32>();

/// The frame of a message, delimiter included, at the front of `out`.
///
/// None for an empty message, for one above [`MAX_MESSAGE`] and when `out` is too short;
/// [`MAX_FRAME`](crate::MAX_FRAME) bytes are always enough.
#[must_use]
pub fn encode<'out>(message: &[u8], out: &'out mut [u8]) -> Option<&'out [u8]> {
    if message.is_empty() || message.len() > MAX_MESSAGE {
        return None;
    }
    let mut encoder = CobsEncoder::new(out);
    encoder.push(message).ok()?;
    encoder.push(&crc32(message).to_le_bytes()).ok()?;
    let end = encoder.finalize();
    *out.get_mut(end)? = DELIMITER;
    out.get(..=end)
}

/// The CRC that a message has in its frame.
#[inline(never)]
#[must_use]
pub fn crc32(message: &[u8]) -> u32 {
    CRC_32.checksum(message)
}

/// Why a frame was not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameError {
    /// It holds more than the accumulator has room for.
    Overlong,
    /// It ended before its COBS code said so: bytes were lost, or a 0x00 came in.
    CutShort,
    /// It holds less than a message of one byte and the CRC.
    TooShort,
    /// The CRC is not that of the message.
    WrongCrc,
}

/// Collects the frames of a stream, byte by byte. `N`: room for a message and its CRC, bytes.
///
/// COBS is undone as the bytes come in and the message stays where it was collected: nothing is
/// copied, and the work at a delimiter is the CRC alone.
///
/// Damage costs the frames that it touches, and the following one where it hit a delimiter. An error shows at the
/// next delimiter; up to there everything is discarded, so that the tail of an overlong frame is never taken for a
/// frame. Delimiters in a row are ignored.
///
/// ```
/// use pneudrive_protocol::frame::{Accumulator, FrameError, encode};
///
/// let mut room = [0; 32];
/// let length = encode(b"go", &mut room).expect("room for a frame").len();
/// let sound = room;
/// room[1] ^= 0x01; // A bit turns over on the line.
///
/// let mut line: Accumulator = Accumulator::new();
/// let mut last = |bytes: &[u8]| {
///     bytes.iter().filter_map(|byte| line.push(*byte).map(|message| message.map(<[u8]>::to_vec))).last()
/// };
/// assert_eq!(last(&room[..length]), Some(Err(FrameError::WrongCrc)));
/// assert_eq!(last(&sound[..length]), Some(Ok(b"go".to_vec())), "the next frame is taken");
/// assert_eq!(line.damaged, 1);
/// ```
#[derive(Debug)]
pub struct Accumulator<const N: usize = { MAX_MESSAGE + CRC_BYTES }> {
    /// Frames that were not taken; stays at the largest number once there.
    pub damaged: u32,
    content: [u8; N],
    /// Bytes the frame has had so far, those without room too.
    length: usize,
    cobs: DecoderState,
}

/// Two are equal that make the same of whatever comes next: bytes of a frame that is over do not count.
impl<const N: usize> PartialEq for Accumulator<N> {
    fn eq(&self, other: &Self) -> bool {
        self.damaged == other.damaged && self.standing() == other.standing()
    }
}

impl<const N: usize> Eq for Accumulator<N> {}

impl<const N: usize> core::hash::Hash for Accumulator<N> {
    fn hash<H: core::hash::Hasher>(&self, state: &mut H) {
        (self.damaged, self.standing()).hash(state);
    }
}

impl<const N: usize> Clone for Accumulator<N> {
    #[expect(clippy::needless_match, reason = "the decoder's state is not Clone")]
    fn clone(&self) -> Self {
        let cobs = match self.cobs {
            DecoderState::Idle => DecoderState::Idle,
            DecoderState::Grab(left) => DecoderState::Grab(left),
            DecoderState::GrabChain(left) => DecoderState::GrabChain(left),
        };
        Accumulator { damaged: self.damaged, content: self.content, length: self.length, cobs }
    }
}

impl<const N: usize> Default for Accumulator<N> {
    fn default() -> Self {
        Accumulator::new()
    }
}

impl<const N: usize> Accumulator<N> {
    /// An accumulator that has seen nothing yet.
    #[must_use]
    pub const fn new() -> Self {
        Accumulator { damaged: 0, content: [0; N], length: 0, cobs: DecoderState::Idle }
    }

    /// How the decoder stands in a frame, the frame's length so far, and those of its bytes that had room; None between
    /// two frames.
    fn standing(&self) -> Option<(bool, u8, usize, &[u8])> {
        let (chain, left) = match self.cobs {
            DecoderState::Idle => return None,
            DecoderState::Grab(left) => (false, left),
            DecoderState::GrabChain(left) => (true, left),
        };
        Some((chain, left, self.length, self.content.get(..self.length.min(N)).unwrap_or(&[])))
    }

    /// Takes the next byte. At a delimiter: the message, or why there is none.
    ///
    /// # Errors
    /// For a damaged frame; it is counted in `damaged` and needs no further care.
    pub fn push(&mut self, byte: u8) -> Option<Result<&[u8], FrameError>> {
        match self.cobs.feed(byte) {
            Ok(DecodeResult::NoData) => None,
            Ok(DecodeResult::DataStart) => {
                self.length = 0;
                None
            }
            Ok(DecodeResult::DataContinue(decoded)) => {
                self.store(decoded);
                None
            }
            Ok(DecodeResult::DataComplete) => Some(self.finish(true)),
            Err(_) => Some(self.finish(false)),
        }
    }

    fn store(&mut self, decoded: u8) {
        if let Some(slot) = self.content.get_mut(self.length) {
            *slot = decoded;
        }
        self.length = self.length.saturating_add(1);
    }

    fn finish(&mut self, whole: bool) -> Result<&[u8], FrameError> {
        let message = check(self.content.get(..self.length), whole);
        if message.is_err() {
            self.damaged = self.damaged.saturating_add(1);
        }
        message
    }
}

/// The message in what a frame held, if that had room and is whole.
fn check(content: Option<&[u8]>, whole: bool) -> Result<&[u8], FrameError> {
    let content = content.ok_or(FrameError::Overlong)?;
    if !whole {
        return Err(FrameError::CutShort);
    }
    let (message, crc) = content.split_last_chunk().ok_or(FrameError::TooShort)?;
    if message.is_empty() {
        return Err(FrameError::TooShort);
    }
    if crc32(message) == u32::from_le_bytes(*crc) { Ok(message) } else { Err(FrameError::WrongCrc) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MAX_FRAME;

    /// What the last byte of a stream brings.
    fn last<'a, const N: usize>(
        accumulator: &'a mut Accumulator<N>,
        stream: &[u8],
    ) -> Option<Result<&'a [u8], FrameError>> {
        let (last, before) = stream.split_last().expect("a stream");
        for &byte in before {
            let _ = accumulator.push(byte);
        }
        accumulator.push(*last)
    }

    #[test]
    fn accumulators_are_equal_where_they_go_on_in_the_same_way() {
        let after = |bytes: &[u8]| {
            let mut accumulator: Accumulator = Accumulator::new();
            for &byte in bytes {
                let _ = accumulator.push(byte);
            }
            accumulator
        };
        let mut room = [0; MAX_FRAME];
        let frame = encode(b"a message", &mut room).expect("short");
        assert_eq!(after(frame), after(&[]), "between two frames");
        assert_ne!(after(&frame[..3]), after(&[]), "within one");
        assert_ne!(after(&frame[..3]), after(&frame[..4]));
        assert_eq!(after(&frame[..3]), after(&frame[..3]).clone());
        assert_ne!(after(&[1, 1, 0]), after(&[]), "a damaged frame is counted");
    }

    #[test]
    fn a_frame_is_the_message_and_its_crc_without_a_zero_inside() {
        // CRC-32/ISO-HDLC of "123456789" is 0xCBF43926, the check value of the catalogue.
        let mut out = [0; MAX_FRAME];
        let frame = encode(b"123456789", &mut out).expect("fits");
        assert_eq!(frame, b"\x0e123456789\x26\x39\xf4\xcb\x00");
        assert_eq!(last(&mut Accumulator::<64>::new(), frame), Some(Ok(&b"123456789"[..])));
    }

    #[test]
    fn messages_of_every_length_fit_and_come_back() {
        let mut accumulator: Accumulator = Accumulator::new();
        for fill in [0x00, 0x01, 0xff] {
            for length in 1..=MAX_MESSAGE {
                let message = &[fill; MAX_MESSAGE][..length];
                let mut out = [0xaa; MAX_FRAME];
                let frame = encode(message, &mut out).expect("fits");
                assert_eq!(frame.iter().filter(|&&byte| byte == DELIMITER).count(), 1);
                assert_eq!(last(&mut accumulator, frame), Some(Ok(message)), "{length} of {fill}");
            }
        }
        assert_eq!(accumulator.damaged, 0);
    }

    #[test]
    fn what_does_not_fit_is_not_framed() {
        assert_eq!(encode(&[], &mut [0; MAX_FRAME]), None);
        assert_eq!(encode(&[1; MAX_MESSAGE + 1], &mut [0; 2 * MAX_FRAME]), None);
        for message in [&b"123456789"[..], &[0; 9]] {
            let length = encode(message, &mut [0; MAX_FRAME]).expect("fits").len();
            assert!(encode(message, &mut [0; MAX_FRAME][..length]).is_some());
            for short in 0..length {
                assert_eq!(encode(message, &mut [0; MAX_FRAME][..short]), None, "{short} of {length}");
            }
        }
    }

    #[test]
    fn delimiters_in_a_row_are_nothing_at_all() {
        let mut accumulator = Accumulator::<16>::new();
        for _ in 0..3 {
            assert_eq!(accumulator.push(DELIMITER), None);
        }
        assert_eq!(accumulator.damaged, 0);
    }

    #[test]
    fn damage_is_named_and_counted() {
        let cases: [(&[u8], FrameError); 5] = [
            (b"\x0e123456789\x26\x39\xf4\xca\x00", FrameError::WrongCrc),
            (b"\x0e12345678\x26\x39\xf4\xcb\x00", FrameError::CutShort),
            (b"\x04123\x00", FrameError::TooShort),
            (b"\x01\x01\x01\x01\x01\x00", FrameError::TooShort),
            (b"\x0e123456789\x26\x39\xf4\xcb\x04123\x00", FrameError::Overlong),
        ];
        let mut accumulator = Accumulator::<13>::new();
        for (count, (stream, error)) in (1..).zip(cases) {
            assert_eq!(last(&mut accumulator, stream), Some(Err(error)));
            assert_eq!(accumulator.damaged, count);
        }
        let whole = b"\x0e123456789\x26\x39\xf4\xcb\x00";
        assert_eq!(last(&mut accumulator, whole), Some(Ok(&b"123456789"[..])), "the next good frame");
        accumulator.damaged = u32::MAX;
        assert_eq!(last(&mut accumulator, b"\x02\x00"), Some(Err(FrameError::CutShort)));
        assert_eq!(accumulator.damaged, u32::MAX);
    }

    #[test]
    fn an_overlong_frame_that_is_cut_short_is_overlong() {
        let mut accumulator = Accumulator::<4>::new();
        assert_eq!(last(&mut accumulator, b"\xff12345\x00"), Some(Err(FrameError::Overlong)));
        assert_eq!(accumulator.damaged, 1);
    }
}
