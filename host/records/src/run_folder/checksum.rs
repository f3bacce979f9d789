//! Checksums of the files of a run.

use crc::{CRC_64_XZ, Crc};

/// A checksum in run.json: CRC-64 (XZ), in hexadecimal digits.
pub(super) fn checksum(text: &str) -> String {
    const CRC: Crc<u64> = Crc::<u64>::new(&CRC_64_XZ);
    format!("{:016x}", CRC.checksum(text.as_bytes()))
}
