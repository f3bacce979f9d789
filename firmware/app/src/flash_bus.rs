//! The flash bus: the PC keeps the flash of an emulated board. So the flash outlives the board's power, and the power
//! can be cut in the middle of an operation.
//!
//! The board sends a request and stands still until it is answered. A request is twelve bytes, little-endian: the
//! operation (0: read, 1: write, 2: erase), three zeros, the address, and the number of bytes. With a write, these
//! bytes follow. The answer is the bytes that were read, or [`DONE`].

/// The answer to a write or an erase that was carried out.
pub const DONE: u8 = 1;

/// A request to the flash.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    /// The bytes as they are.
    Read,
    /// Bits of erased bytes are cleared.
    Write,
    /// Whole sectors are set to ones.
    Erase,
}

/// One operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Request {
    /// The operation.
    pub operation: Operation,
    /// Address, bytes from the start of the flash.
    pub offset: u32,
    /// Number of bytes.
    pub length: u32,
}

impl Request {
    /// Length on the bus, bytes.
    pub const BYTES: usize = 12;

    /// As it travels.
    #[must_use]
    pub fn to_bytes(self) -> [u8; Self::BYTES] {
        let operation = match self.operation {
            Operation::Read => 0,
            Operation::Write => 1,
            Operation::Erase => 2,
        };
        let [o0, o1, o2, o3] = self.offset.to_le_bytes();
        let [l0, l1, l2, l3] = self.length.to_le_bytes();
        [operation, 0, 0, 0, o0, o1, o2, o3, l0, l1, l2, l3]
    }

    /// As it came; None for an operation that there is not.
    #[must_use]
    pub fn from_bytes(bytes: [u8; Self::BYTES]) -> Option<Request> {
        let [operation, _, _, _, o0, o1, o2, o3, l0, l1, l2, l3] = bytes;
        let operation = match operation {
            0 => Operation::Read,
            1 => Operation::Write,
            2 => Operation::Erase,
            _ => return None,
        };
        let (offset, length) = (u32::from_le_bytes([o0, o1, o2, o3]), u32::from_le_bytes([l0, l1, l2, l3]));
        Some(Request { operation, offset, length })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_request_is_these_bytes() {
        for (number, operation) in [(0, Operation::Read), (1, Operation::Write), (2, Operation::Erase)] {
            let request = Request { operation, offset: 0x0102_0304, length: 32 };
            let bytes = [number, 0, 0, 0, 4, 3, 2, 1, 32, 0, 0, 0];
            assert_eq!((request.to_bytes(), Request::from_bytes(bytes)), (bytes, Some(request)));
        }
        assert_eq!(Request::from_bytes([3; 12]), None);
    }
}
