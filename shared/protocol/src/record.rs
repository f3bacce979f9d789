//! The transient record as it travels: fourteen bytes a sample, in chunks, under one CRC.

use crate::frame::CRC_32;

/// One stored sample, in the raw units of the hardware.
///
/// ```
/// use pneudrive_protocol::RecordedSample;
///
/// let stored = [100, 105, 117].map(|position| RecordedSample { position, error: -3, ..RecordedSample::default() });
/// let chunk = stored.map(|sample| sample.to_bytes()).concat();
/// assert_eq!(chunk.len(), 3 * RecordedSample::BYTES);
/// assert!(RecordedSample::read(&chunk).expect("whole samples").eq(stored));
/// assert!(RecordedSample::read(&chunk[1..]).is_none(), "it ends within a sample");
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct RecordedSample {
    /// Encoder count; positive means extension. Unit: counts.
    pub position: i32,
    /// Chamber 1 (blind side) pressure as converted.
    pub pressure_1: i16,
    /// Chamber 2 (rod side) pressure as converted.
    pub pressure_2: i16,
    /// The command computed from this sample, -2048 to 2048 counts.
    pub command: i16,
    /// Setpoint less position, saturated to 16 bits. Unit: counts.
    pub error: i16,
    /// Spool displacement as converted.
    pub spool: i16,
}

impl RecordedSample {
    /// Length of a sample in memory and in messages, bytes.
    pub const BYTES: usize = 14;

    /// The sample as it is stored and sent: the fields in order, little endian.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; Self::BYTES] {
        let mut bytes = [0; Self::BYTES];
        bytes[..4].copy_from_slice(&self.position.to_le_bytes());
        bytes[4..6].copy_from_slice(&self.pressure_1.to_le_bytes());
        bytes[6..8].copy_from_slice(&self.pressure_2.to_le_bytes());
        bytes[8..10].copy_from_slice(&self.command.to_le_bytes());
        bytes[10..12].copy_from_slice(&self.error.to_le_bytes());
        bytes[12..].copy_from_slice(&self.spool.to_le_bytes());
        bytes
    }

    /// The sample in these bytes. Any bytes are some sample.
    #[must_use]
    pub fn from_bytes(bytes: &[u8; Self::BYTES]) -> RecordedSample {
        let [n0, n1, n2, n3, a0, a1, b0, b1, c0, c1, e0, e1, s0, s1] = *bytes;
        RecordedSample {
            position: i32::from_le_bytes([n0, n1, n2, n3]),
            pressure_1: i16::from_le_bytes([a0, a1]),
            pressure_2: i16::from_le_bytes([b0, b1]),
            command: i16::from_le_bytes([c0, c1]),
            error: i16::from_le_bytes([e0, e1]),
            spool: i16::from_le_bytes([s0, s1]),
        }
    }

    /// The samples in the bytes of a chunk; None if they end within a sample.
    #[must_use]
    pub fn read(bytes: &[u8]) -> Option<impl ExactSizeIterator<Item = RecordedSample> + Clone + '_> {
        let (samples, rest) = bytes.as_chunks();
        rest.is_empty().then(|| samples.iter().map(Self::from_bytes))
    }
}

/// The CRC-32/ISO-HDLC of a record, over the bytes of its samples from the oldest on.
///
/// It takes them in pieces of any length: the recorder its ring in two, the PC a chunk at a time. The CRC
/// of nothing is zeros in memory, so a recorder needs no start values.
#[derive(Clone, PartialEq, Eq)]
pub struct RecordCrc(u32);

impl core::fmt::Debug for RecordCrc {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "RecordCrc({:08x})", self.clone().finish())
    }
}

impl Default for RecordCrc {
    fn default() -> Self {
        RecordCrc::new()
    }
}

impl RecordCrc {
    /// The CRC of no samples at all.
    #[must_use]
    pub const fn new() -> RecordCrc {
        RecordCrc(0)
    }

    /// Takes the bytes that follow.
    #[inline(never)]
    pub fn update(&mut self, bytes: &[u8]) {
        // The register behind a CRC is its complement, and `digest_with_initial` reflects what it is given.
        let mut digest = CRC_32.digest_with_initial((!self.0).reverse_bits());
        digest.update(bytes);
        self.0 = digest.finalize();
    }

    /// The CRC of all that was taken.
    #[must_use]
    pub fn finish(self) -> u32 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAMPLE: RecordedSample = RecordedSample {
        position: 8192,
        pressure_1: 1638,
        pressure_2: 2412,
        command: -2048,
        error: -1,
        spool: 2047,
    };
    const BYTES: [u8; 14] =
        [0x00, 0x20, 0x00, 0x00, 0x66, 0x06, 0x6c, 0x09, 0x00, 0xf8, 0xff, 0xff, 0xff, 0x07];

    #[test]
    fn a_sample_is_fourteen_bytes_little_endian() {
        assert_eq!(SAMPLE.to_bytes(), BYTES);
        assert_eq!(RecordedSample::from_bytes(&BYTES), SAMPLE);
    }

    #[test]
    fn a_chunk_holds_whole_samples() {
        let chunk = [BYTES, RecordedSample::default().to_bytes()];
        let chunk = chunk.as_flattened();
        assert!(RecordedSample::read(chunk).expect("two").eq([SAMPLE, RecordedSample::default()]));
        assert_eq!(RecordedSample::read(&[]).expect("none").len(), 0);
        for end in [1, 13, 15, 27] {
            assert!(RecordedSample::read(&chunk[..end]).is_none(), "{end} bytes");
        }
    }

    #[test]
    fn the_crc_of_a_record_does_not_depend_on_its_pieces() {
        // The check value of CRC-32/ISO-HDLC.
        for split in 0..=9 {
            let (head, tail) = b"123456789".split_at(split);
            let mut crc = RecordCrc::new();
            crc.update(head);
            crc.update(tail);
            assert_eq!(crc.finish(), 0xcbf4_3926);
        }
        assert_eq!(RecordCrc::new().finish(), 0);
    }
}
