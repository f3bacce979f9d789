//! The stream: samples of a run that go to the host while it is on, for as long as it lasts.
//!
//! It belongs to the half that talks. Every round of the idle task looks at the last sample, so the interrupts know
//! nothing of the stream. A sample that the idle task had no time for is missing in the indices. Rows are numbered,
//! so the host sees which ones the link has lost, and can request them again while they are held. Only granted rows
//! go out, so the stream soon stops when its host has gone.

use pneudrive_controller::Observation;
use pneudrive_protocol::{MAX_ROWS, ReplyBody, StreamedSample};

use crate::recorder::recorded;

/// Rows that are held: a third of a second of every sample at 1.3 ms.
const HELD: usize = 256;

/// The stream of one host.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Stream {
    rows: [u8; HELD * StreamedSample::BYTES],
    /// Number of the request that began it.
    name: u16,
    /// Every nth sample becomes a row; 0: none does.
    every: u32,
    /// Rows that go at once.
    batch: u32,
    /// Rows so far, so the number of the next one.
    gathered: u32,
    /// Rows that went unasked, or were overwritten before they could.
    sent: u32,
    /// Number of the first row that may not go.
    granted: u32,
    /// The sample that was last looked at; None between runs.
    seen: Option<u32>,
}

impl Default for Stream {
    fn default() -> Self {
        Stream {
            rows: [0; HELD * StreamedSample::BYTES],
            name: 0,
            every: 0,
            batch: 1,
            gathered: 0,
            sent: 0,
            granted: 0,
            seen: None,
        }
    }
}

impl Stream {
    /// Begins anew, under the number of the request that asks for it.
    pub fn begin(&mut self, name: u16, every: u16, batch: u8) {
        let batch = u32::from(batch).clamp(1, MAX_ROWS as u32);
        (self.name, self.every, self.batch) = (name, u32::from(every), batch);
        (self.gathered, self.sent, self.granted, self.seen) = (0, 0, 0, None);
    }

    /// Rows before this one may go unasked.
    pub fn grant(&mut self, until: u32) {
        self.granted = self.granted.max(until);
    }

    /// Looks at the last sample: a new one of a run may become a row.
    pub fn observe(&mut self, observation: &Observation) {
        let index = observation.running.then_some(observation.index);
        if self.every == 0 || index == self.seen {
            return;
        }
        self.seen = index;
        if let Some(index) = index.filter(|index| index.is_multiple_of(self.every)) {
            self.gather(StreamedSample { index, sample: recorded(observation) });
        }
    }

    fn gather(&mut self, row: StreamedSample) {
        let place = self.gathered as usize % HELD;
        if let Some(slot) = self.rows.as_chunks_mut().0.get_mut(place) {
            *slot = row.to_bytes();
        }
        self.gathered = self.gathered.wrapping_add(1);
    }

    fn oldest(&self) -> u32 {
        self.gathered.saturating_sub(HELD as u32)
    }

    /// Whether half of the room is taken by rows that wait, so that new ones might soon overwrite them. A rig that
    /// makes its own time can wait.
    #[must_use]
    pub fn is_full(&self) -> bool {
        self.gathered - self.sent.max(self.oldest()) > HELD as u32 / 2
    }

    /// The data to send unasked now: a batch, or the rest at the end of a run, under its number.
    pub fn due<'a>(&mut self, room: &'a mut [u8]) -> Option<(u16, ReplyBody<'a>)> {
        let first = self.sent.max(self.oldest());
        let waiting = self.gathered.min(self.granted).saturating_sub(first);
        if waiting == 0 || (waiting < self.batch && self.seen.is_some()) {
            return None;
        }
        let count = waiting.min(self.batch);
        self.sent = first + count;
        Some((self.name, self.read(first, count as u8, room)))
    }

    /// Rows from this number on, of those that are held.
    pub fn read<'a>(&self, first: u32, count: u8, room: &'a mut [u8]) -> ReplyBody<'a> {
        let count = u32::from(count).min(MAX_ROWS as u32);
        let from = first.clamp(self.oldest(), self.gathered);
        let until = first.saturating_add(count).clamp(from, self.gathered);
        let mut bytes = 0;
        for (slot, number) in room.as_chunks_mut().0.iter_mut().zip(from..until) {
            if let Some(row) =
                self.rows.as_chunks::<{ StreamedSample::BYTES }>().0.get(number as usize % HELD)
            {
                *slot = *row;
                bytes += StreamedSample::BYTES;
            }
        }
        ReplyBody::Rows { first: from, rows: room.get(..bytes).unwrap_or(&[]) }
    }
}
