//! Which record the inputs may and must begin, by the words of docs/howto/without-a-pc.md, from the readings of the inputs and
//! from what else has happened: it knows nothing of the drive but whether it moves.

use pneudrive_protocol::io::input::{ACKNOWLEDGE, ENABLE, NUMBER, RUN, START};

use super::PERIOD_US;

/// By default of the parameters, microseconds.
const DEBOUNCE_US: u64 = 10_000;
const SETTLING_US: u64 = 20_000;
/// Records of the table.
const RECORDS: [u8; 3] = [1, 2, 3];

/// A start that has gone on, and what is known of it.
#[derive(Clone, Copy, Debug)]
struct Edge {
    inputs: u8,
    /// For how long all inputs had been the same, and so the start counted, microseconds.
    counted_us: Option<u64>,
}

/// What the drive may do.
#[derive(Debug, Default)]
pub struct Oracle {
    /// The last reading, and for how long it has been the same.
    read: u8,
    steady_us: u64,
    edge: Option<Edge>,
    /// Start and acknowledge, as far as they have counted as off since they were last on, also since a stop or a trip.
    open: u8,
    /// Run was on once.
    has_run: bool,
    /// Run and enable are on, as they count: as the inputs stood when they had last been the same for the debounce time.
    permits: bool,
    /// A stop or a trip has yet to be acknowledged.
    pub to_acknowledge: bool,
    /// The drive has tripped, and nothing was begun since.
    pub tripped: bool,
    /// The record in force: it moves to its target, or holds it.
    pub in_force: Option<u8>,
    /// It was begun with the last reading: the first sample of a run has none before it that it could be late behind.
    pub begins: bool,
}

impl Oracle {
    /// A host stops the drive.
    pub fn stop(&mut self) {
        self.trip();
    }

    /// The drive trips.
    pub fn trip(&mut self) {
        (self.edge, self.in_force) = (None, None);
        self.open &= !self.read;
        (self.to_acknowledge, self.tripped) = (true, true);
    }

    /// A reading of the inputs, of a drive that moves or does not: the record that begins now.
    pub fn reads(&mut self, now: u8, moves: bool) -> Option<u8> {
        self.begins = false;
        let before = std::mem::replace(&mut self.read, now);
        self.steady_us = if now == before { self.steady_us + PERIOD_US } else { 0 };
        self.acknowledges(now);
        let due = self.starts(now, before);
        if self.has_run && now & RUN == 0 && self.in_force.is_some() {
            self.trip();
        }
        if now & ENABLE == 0 {
            self.in_force = None;
        }
        // The rest of it is without effect while the axis moves, before an acknowledgement, or without a record.
        let number = due.filter(|number| !moves && !self.to_acknowledge && RECORDS.contains(number))?;
        (self.in_force, self.tripped, self.begins) = (Some(number), false, true);
        Some(number)
    }

    fn acknowledges(&mut self, now: u8) {
        if self.steady_us < DEBOUNCE_US {
            return;
        }
        self.has_run |= now & RUN != 0;
        if now & self.open & ACKNOWLEDGE != 0 {
            self.to_acknowledge = false;
        }
        self.open = self.open & !ACKNOWLEDGE | !now & ACKNOWLEDGE;
    }

    /// The number of a start that has settled.
    fn starts(&mut self, now: u8, before: u8) -> Option<u8> {
        let permitted = both(now & before);
        if !permitted && now & START != 0 {
            // It has gone on without run and enable: it has to go off first, for as long as that takes to count.
            self.open &= !START;
        }
        if let Some(edge) = &mut self.edge {
            let counted = edge.counted_us.is_some();
            let changed = (now ^ edge.inputs) & !ACKNOWLEDGE;
            // Before it counts, a number may come late, but run, enable and start must be on.
            if counted && changed != 0 || changed & !NUMBER != 0 {
                self.edge = None;
            } else {
                edge.inputs = now;
                edge.counted_us = edge.counted_us.map(|us| us + PERIOD_US);
            }
        }
        if permitted && now & !before & START != 0 {
            self.edge = Some(Edge { inputs: now, counted_us: None });
        }
        let counts = self.steady_us >= DEBOUNCE_US;
        let permitted = if counts { std::mem::replace(&mut self.permits, both(now)) } else { self.permits };
        if counts && now & START == 0 {
            self.open |= START;
        }
        let edge = self.edge.as_mut()?;
        if counts && edge.counted_us.is_none() {
            if !permitted || self.open & START == 0 {
                self.edge = None;
                return None;
            }
            (edge.counted_us, self.open) = (Some(0), self.open & !START);
        }
        edge.counted_us.filter(|&us| us >= SETTLING_US)?;
        self.edge = None;
        Some(now & NUMBER)
    }
}

/// Whether run and enable are on.
fn both(inputs: u8) -> bool {
    inputs & (RUN | ENABLE) == RUN | ENABLE
}
