//! A PLC at the digital inputs of the drive: contacts that close and open at any time, one at a time, and what the properties
//! of the moves that they begin are judged by.
//!
//! A contact that bounces is one that changes more than once. A sample comes between two changes, or does not. Time is in
//! samples: inputs count once they have been the same for one ([`TIMES_MS`] is shorter), and a start settles in another.

use pneudrive_protocol::io::input::{ACKNOWLEDGE, ENABLE, NUMBER, RUN, START};

/// Debounce and settling time of the inputs, ms: shorter than a sample, the least that there is.
pub const TIMES_MS: i32 = 1;

/// Samples of the same inputs after which a start begins its record: one that it counts after, one to settle.
const SETTLED: u8 = 2;

/// The contacts that change. Of the number one line does: that of the second bit, so that there are records 1 and 3.
pub const CONTACTS: [u8; 5] = [RUN, ENABLE, START, ACKNOWLEDGE, 0x02];

/// Changes with which the inputs can begin a record after a stop: acknowledge on, start on.
pub const TO_BEGIN_ANEW: u8 = 2;

/// The contacts at first: the drive may move, and record 1 is selected.
const AT_FIRST: u8 = RUN | ENABLE | 0x01;

/// The contacts, and what they have asked for since.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Plc {
    /// As they are.
    pub contacts: u8,
    /// As they were at the last sample, and for how many samples they were so, with acknowledge and without it, up to
    /// [`SETTLED`].
    read: u8,
    steady: u8,
    unchanged: u8,
    /// A start has gone on since the last record began and since the last stop, and is on.
    edge: bool,
    /// A stop by a host, and a trip, since which acknowledge has not gone on. A host that arms ends the trip.
    stop_pending: bool,
    trip_pending: bool,
    /// A host has stopped the drive.
    pub stopped: bool,
    /// The hosts that have stopped it since the reset. Each asks for that once: what comes later is a copy, which a rig answers
    /// and does not carry out.
    stopped_by: [bool; 2],
}

/// What is wrong with a record that the inputs have begun.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Wrong {
    /// No start has gone on for it since the last stop, or run or enable is off.
    Unasked,
    /// A stop or a trip was not acknowledged.
    Unacknowledged,
    /// The number is another one, or has not stayed.
    Other,
}

impl Default for Plc {
    fn default() -> Plc {
        Plc {
            contacts: AT_FIRST,
            read: 0,
            steady: 0,
            unchanged: 0,
            edge: false,
            stop_pending: false,
            trip_pending: false,
            stopped: false,
            stopped_by: [false; 2],
        }
    }
}

impl Plc {
    /// The drive is reset: it knows of no start, and of no fault. The contacts stay.
    #[must_use]
    pub fn reset(&self) -> Plc {
        Plc { contacts: self.contacts, stopped: self.stopped, ..Plc::default() }
    }

    /// A contact changes.
    pub fn toggle(&mut self, contact: u8) {
        self.contacts ^= contact;
    }

    /// Whether another sample of the same contacts may change something.
    #[must_use]
    pub fn is_settling(&self) -> bool {
        self.steady < SETTLED || self.read != self.contacts
    }

    /// A sample reads the contacts.
    pub fn is_read(&mut self) {
        let (now, before) = (self.contacts, self.read);
        let count = |same: bool, samples: u8| if same { SETTLED.min(samples + 1) } else { 0 };
        self.steady = count(now == before, self.steady);
        self.unchanged = count((now ^ before) & !ACKNOWLEDGE == 0, self.unchanged);
        let rising = now & !before;
        let permitted = now & before & (RUN | ENABLE) == RUN | ENABLE;
        self.edge = permitted && now & START != 0 && (self.edge || rising & START != 0);
        if rising & ACKNOWLEDGE != 0 {
            (self.stop_pending, self.trip_pending) = (false, false);
        }
        self.read = now;
    }

    /// A host has stopped the drive: nothing counts that was asked for before.
    pub fn is_stopped_by(&mut self, host: usize) {
        if std::mem::replace(&mut self.stopped_by[host], true) {
            return;
        }
        (self.edge, self.stop_pending, self.stopped) = (false, true, true);
    }

    /// The drive has tripped.
    pub fn trips(&mut self) {
        (self.edge, self.trip_pending) = (false, true);
    }

    /// A host arms the drive.
    pub fn is_armed_by_host(&mut self) {
        self.trip_pending = false;
    }

    /// The record of this name begins. What is wrong with that.
    pub fn begins(&mut self, name: &str) -> Option<Wrong> {
        let asked = std::mem::take(&mut self.edge);
        let number = format!("record {:02}", self.contacts & NUMBER);
        match (asked, self.stop_pending || self.trip_pending) {
            (false, _) => Some(Wrong::Unasked),
            (_, true) => Some(Wrong::Unacknowledged),
            _ => (self.unchanged < SETTLED || name != number).then_some(Wrong::Other),
        }
    }
}
