//! The two kinds of marks of a fault log: numbers of boots, and events.

use pneudrive_protocol::Event;

use crate::storage::marks::{self, Mark};

const BOOT: &[u8] = b"PDbt";
const EVENT: &[u8] = b"PDe";

pub fn of_boot(number: u32) -> Mark {
    marks::of(BOOT, &number.to_le_bytes())
}

pub fn of_event(event: &Event) -> Mark {
    marks::of(EVENT, &event.to_bytes())
}

/// The number in a mark of a boot.
pub fn boot(mark: &Mark) -> Option<u32> {
    marks::entry(BOOT, mark).map(u32::from_le_bytes)
}

/// The event in a mark of one.
pub fn event(mark: &Mark) -> Option<Event> {
    marks::entry(EVENT, mark).map(|bytes| Event::from_bytes(&bytes))
}
