//! The transient recorder: six channels of every Nth sample (thesis 5.5.1).
//!
//! Samples from k = 0 on are stored until the buffer is full. Before the start the newest
//! `pre_trigger` ones are kept in a ring, at the same decimation counted from the arming; their
//! indices are negative and exact.

use pneudrive_controller::Observation;
use pneudrive_protocol::{RecordCrc, RecordedSample};

/// Samples that the buffer holds: at 14 bytes each, just over 60 KiB.
pub const CAPACITY: usize = 4389;

/// Most samples from before the start.
pub const MAX_PRE_TRIGGER: u16 = 2000;

/// The recorded and streamed data of a sample: its six channels, the error limited to 16 bits.
#[inline]
#[must_use]
pub fn recorded(seen: &Observation) -> RecordedSample {
    let error = seen.error.clamp(i32::from(i16::MIN), i32::from(i16::MAX)) as i16;
    let Observation { position, pressure_1, pressure_2, command, spool, .. } = *seen;
    RecordedSample { position, pressure_1, pressure_2, command, error, spool }
}

type Stored = [u8; RecordedSample::BYTES];

/// The buffer and its state.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recorder {
    /// Flat: zeros in one piece are made where they stay.
    samples: [u8; CAPACITY * RecordedSample::BYTES],
    /// 0 counts as 1.
    decimation: u32,
    /// Length of the ring at the beginning of the buffer.
    ring: usize,
    /// Samples ever put into the ring since the arming.
    ringed: usize,
    /// Samples seen since the last one that was put into the ring.
    since_ringed: u32,
    /// Samples stored after the ring since the start.
    stored: usize,
    /// Index of the oldest stored sample.
    first_index: i32,
    started: bool,
    /// CRC-32 of the samples up to `digested`, and the sum of the spool channel of those of the run.
    crc: RecordCrc,
    spool_sum: i64,
    digested: usize,
}

impl Default for Recorder {
    fn default() -> Self {
        Recorder::new()
    }
}

impl Recorder {
    /// An empty recorder: zeros throughout, so that a board can lend [`Control`](crate::Control) one that
    /// stands in zeroed memory. One that is made elsewhere and moved takes its 60 KiB twice.
    #[must_use]
    pub const fn new() -> Recorder {
        Recorder {
            samples: [0; CAPACITY * RecordedSample::BYTES],
            decimation: 0,
            ring: 0,
            ringed: 0,
            since_ringed: 0,
            stored: 0,
            first_index: 0,
            started: false,
            spool_sum: 0,
            crc: RecordCrc::new(),
            digested: 0,
        }
    }

    /// Forgets the stored samples.
    pub fn empty(&mut self) {
        self.arm(1, 0);
    }

    /// Empties the buffer for a run: every `decimation`th sample (0 counts as 1), and up to
    /// `pre_trigger` from before the start.
    pub fn arm(&mut self, decimation: u16, pre_trigger: u16) {
        self.decimation = u32::from(decimation.max(1));
        self.ring = usize::from(pre_trigger.min(MAX_PRE_TRIGGER));
        self.ringed = 0;
        self.since_ringed = self.decimation;
        self.stored = 0;
        self.first_index = 0;
        self.started = false;
        self.spool_sum = 0;
        self.crc = RecordCrc::new();
        self.digested = 0;
    }

    /// A sample from before the start.
    pub(crate) fn before_start(&mut self, seen: &Observation) {
        if self.started || self.ring == 0 {
            return;
        }
        if self.since_ringed >= self.decimation {
            let place = self.ringed % self.ring;
            self.put(place, seen);
            self.ringed += 1;
            self.since_ringed = 0;
        }
        self.since_ringed += 1;
    }

    /// The next sample is k = 0.
    pub fn start(&mut self) {
        self.started = true;
        let kept = self.pre_triggered() as i64;
        if kept > 0 {
            let newest = i64::from(self.since_ringed);
            let oldest = newest + (kept - 1) * i64::from(self.decimation);
            self.first_index = i32::try_from(-oldest).unwrap_or(i32::MIN);
        }
    }

    /// A sample of the run, after its output.
    pub fn store(&mut self, seen: &Observation) {
        if !self.started || self.is_full() || !seen.index.is_multiple_of(self.decimation) {
            return;
        }
        self.put(self.ring + self.stored, seen);
        self.stored += 1;
    }

    fn put(&mut self, place: usize, seen: &Observation) {
        if let Some(slot) = self.samples.as_chunks_mut().0.get_mut(place) {
            *slot = recorded(seen).to_bytes();
        }
    }

    fn is_full(&self) -> bool {
        self.ring + self.stored >= CAPACITY
    }

    fn pre_triggered(&self) -> usize {
        self.ringed.min(self.ring)
    }

    /// Samples that can be read.
    #[must_use]
    pub fn len(&self) -> usize {
        if self.started { self.pre_triggered() + self.stored } else { 0 }
    }

    /// Whether there is nothing to read.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Every Nth sample is stored.
    #[must_use]
    pub fn decimation(&self) -> u32 {
        self.decimation.max(1)
    }

    /// Index k of the oldest sample; negative for one from before the start.
    #[must_use]
    pub fn first_index(&self) -> i32 {
        self.first_index
    }

    /// Samples from before the start.
    #[must_use]
    pub fn pre_trigger(&self) -> u16 {
        self.pre_triggered() as u16
    }

    /// Mean of the spool channel over the run, as far as it is [digested](Recorder::digest), rounded toward zero;
    /// 0 for an empty record.
    #[must_use]
    pub fn mean_spool(&self) -> i16 {
        let samples = self.digested.saturating_sub(self.pre_triggered());
        self.spool_sum.checked_div(samples as i64).unwrap_or(0) as i16
    }

    /// The stored bytes of sample `i`; 0 is the oldest.
    #[must_use]
    pub fn get(&self, i: usize) -> Option<&Stored> {
        if i >= self.len() {
            return None;
        }
        let kept = self.pre_triggered();
        let place = match i.checked_sub(kept) {
            Some(behind) => self.ring + behind,
            None => (self.ringed - kept + i).checked_rem(self.ring).unwrap_or(0),
        };
        self.samples.as_chunks().0.get(place)
    }

    /// Takes up to `samples` more samples of a finished record into its CRC and the mean of the spool, and tells
    /// the CRC once all are in: a whole record at once would keep the control interrupt waiting.
    pub fn digest(&mut self, samples: usize) -> Option<u32> {
        let end = self.len().min(self.digested.saturating_add(samples));
        for i in self.digested..end {
            if let Some(sample) = self.get(i).copied() {
                self.crc.update(&sample);
                let spool = i64::from(RecordedSample::from_bytes(&sample).spool);
                self.spool_sum += if i < self.pre_triggered() { 0 } else { spool };
            }
        }
        self.digested = end;
        (end == self.len()).then(|| self.crc.clone().finish())
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::boxed::Box;

    #[test]
    fn the_mean_of_the_spool_is_that_of_the_run_once_all_of_it_is_digested() {
        let mut recorder = Box::new(Recorder::new());
        recorder.arm(1, 2);
        let seen = |index, spool| Observation { index, spool, ..Observation::default() };
        for spool in [900, 1000, 1100] {
            recorder.before_start(&seen(0, spool));
        }
        recorder.start();
        for (index, spool) in [(0, 10), (1, 20), (2, -31)] {
            recorder.store(&seen(index, spool));
        }
        assert_eq!((recorder.digest(4), recorder.mean_spool()), (None, 15));
        assert!(recorder.digest(4).is_some(), "two from before and three of the run");
        assert_eq!(recorder.mean_spool(), 0, "-1 / 3, toward zero");
        recorder.empty();
        assert_eq!(recorder.mean_spool(), 0);
    }
}
