//! The samples of a run as they are streamed: each with its index.

use crate::RecordedSample;

/// A sample of a run that is on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StreamedSample {
    /// k: samples since the start of the run.
    pub index: u32,
    /// What the recorder would store of it.
    pub sample: RecordedSample,
}

impl StreamedSample {
    /// Length of a row, bytes.
    pub const BYTES: usize = size_of::<u32>() + RecordedSample::BYTES;

    /// The row's bytes: index, then the sample, little endian.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; Self::BYTES] {
        let mut bytes = [0; Self::BYTES];
        let (index, sample) = bytes.split_at_mut(size_of::<u32>());
        index.copy_from_slice(&self.index.to_le_bytes());
        sample.copy_from_slice(&self.sample.to_bytes());
        bytes
    }

    /// The row in these bytes. Any bytes are some row.
    #[must_use]
    pub fn from_bytes(bytes: &[u8; Self::BYTES]) -> StreamedSample {
        let [k0, k1, k2, k3, sample @ ..] = *bytes;
        StreamedSample {
            index: u32::from_le_bytes([k0, k1, k2, k3]),
            sample: RecordedSample::from_bytes(&sample),
        }
    }

    /// The rows in the bytes of a message; None if they end within one.
    #[must_use]
    pub fn read(bytes: &[u8]) -> Option<impl ExactSizeIterator<Item = StreamedSample> + Clone + '_> {
        let (rows, rest) = bytes.as_chunks();
        rest.is_empty().then(|| rows.iter().map(Self::from_bytes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_its_index_and_the_sample_as_it_is_recorded() {
        let sample = RecordedSample { position: -2, spool: 7, ..RecordedSample::default() };
        let row = StreamedSample { index: 70_000, sample };
        let bytes = row.to_bytes();
        assert_eq!(bytes[..8], [0x70, 0x11, 0x01, 0x00, 0xfe, 0xff, 0xff, 0xff]);
        assert_eq!(bytes[16..], [7, 0]);
        assert_eq!(StreamedSample::from_bytes(&bytes), row);
        let two = [bytes, bytes].concat();
        assert!(StreamedSample::read(&two).expect("two").eq([row, row]));
        assert!(StreamedSample::read(&two[..35]).is_none());
    }
}
