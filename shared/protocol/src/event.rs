//! Events of the fault log as they travel and as they are stored: plain little endian bytes.

/// A trip of the supervisor, and when it was.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Event {
    /// Resets of the board before it.
    pub boot: u32,
    /// Since that reset, microseconds.
    pub time_us: u64,
    /// The controller's code of the fault.
    pub fault: u8,
    /// k of the sample that tripped.
    pub index: u32,
    /// Position there, encoder counts.
    pub position: i32,
}

impl Event {
    /// Size of one event.
    pub const BYTES: usize = 21;

    /// The bytes of the event: boot, time, fault, index, position.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; Self::BYTES] {
        let mut bytes = [0; Self::BYTES];
        let fields = self.boot.to_le_bytes().into_iter();
        let fields = fields.chain(self.time_us.to_le_bytes()).chain([self.fault]);
        let fields = fields.chain(self.index.to_le_bytes()).chain(self.position.to_le_bytes());
        for (byte, field) in bytes.iter_mut().zip(fields) {
            *byte = field;
        }
        bytes
    }

    /// The event in these bytes.
    #[must_use]
    pub fn from_bytes(bytes: &[u8; Self::BYTES]) -> Event {
        let [b0, b1, b2, b3, t0, t1, t2, t3, t4, t5, t6, t7, fault, i0, i1, i2, i3, p0, p1, p2, p3] = *bytes;
        Event {
            boot: u32::from_le_bytes([b0, b1, b2, b3]),
            time_us: u64::from_le_bytes([t0, t1, t2, t3, t4, t5, t6, t7]),
            fault,
            index: u32::from_le_bytes([i0, i1, i2, i3]),
            position: i32::from_le_bytes([p0, p1, p2, p3]),
        }
    }

    /// The events in a run of bytes, in order; what is left of one is skipped.
    pub fn all(bytes: &[u8]) -> impl Iterator<Item = Event> + '_ {
        bytes.as_chunks().0.iter().map(Event::from_bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_event_comes_back_from_its_bytes() {
        let event = Event { boot: 3, time_us: 1 << 40, fault: 7, index: 70_000, position: -17 };
        let bytes = event.to_bytes();
        assert_eq!(bytes[..5], [3, 0, 0, 0, 0]);
        assert_eq!(bytes[12], 7);
        assert_eq!(bytes[17..], [0xef, 0xff, 0xff, 0xff]);
        assert_eq!(Event::from_bytes(&bytes), event);
        let two = [bytes, bytes].concat();
        assert!(Event::all(&two).eq([event, event]));
        assert_eq!(Event::all(&two[..30]).count(), 1);
    }
}
