//! Events of the fault log as they are stored and travel: plain little endian bytes.

/// A trip of the supervisor, and when it was.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Event {
    /// Events before it, ever.
    pub number: u32,
    /// Resets before it, and this one: 1 for the first.
    pub boot: u32,
    /// When, since that reset. Unit: microseconds.
    pub time_us: u64,
    /// Index k of the sample. Unit: samples.
    pub index: u32,
    /// Where the rod was. Unit: counts.
    pub position: i32,
    /// The controller's code of the fault.
    pub code: u8,
}

impl Event {
    /// Length of an event, bytes.
    pub const BYTES: usize = 25;

    /// The event's bytes: the fields in order.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; Self::BYTES] {
        let mut bytes = [0; Self::BYTES];
        bytes[..4].copy_from_slice(&self.number.to_le_bytes());
        bytes[4..8].copy_from_slice(&self.boot.to_le_bytes());
        bytes[8..16].copy_from_slice(&self.time_us.to_le_bytes());
        bytes[16..20].copy_from_slice(&self.index.to_le_bytes());
        bytes[20..24].copy_from_slice(&self.position.to_le_bytes());
        bytes[24] = self.code;
        bytes
    }

    /// The event in these bytes. Any bytes are some event.
    #[must_use]
    pub fn from_bytes(bytes: &[u8; Self::BYTES]) -> Event {
        #[rustfmt::skip]
        let [n0, n1, n2, n3, b0, b1, b2, b3, t0, t1, t2, t3, t4, t5, t6, t7,
            i0, i1, i2, i3, p0, p1, p2, p3, code] = *bytes;
        Event {
            number: u32::from_le_bytes([n0, n1, n2, n3]),
            boot: u32::from_le_bytes([b0, b1, b2, b3]),
            time_us: u64::from_le_bytes([t0, t1, t2, t3, t4, t5, t6, t7]),
            index: u32::from_le_bytes([i0, i1, i2, i3]),
            position: i32::from_le_bytes([p0, p1, p2, p3]),
            code,
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
        let event = Event { number: 9, boot: 3, time_us: 1 << 40, index: 70_000, position: -17, code: 7 };
        let bytes = event.to_bytes();
        assert_eq!(bytes[..8], [9, 0, 0, 0, 3, 0, 0, 0]);
        assert_eq!(bytes[20..], [0xef, 0xff, 0xff, 0xff, 7]);
        assert_eq!(Event::from_bytes(&bytes), event);
        let two = [bytes, bytes].concat();
        assert!(Event::all(&two).eq([event, event]));
        assert_eq!(Event::all(&two[..30]).count(), 1);
    }
}
