//! A drive without a PC: its digital inputs select a move record and begin it, its outputs tell how that goes.
//!
//! | input | does |
//! |---|---|
//! | number | selects a record; 0: homing |
//! | start, from off to on | begins it, if the drive is ready; else nothing: a start while the axis moves is ignored |
//! | run, off | stops whatever moves, whoever has enabled it: a trip (`stop`) |
//! | enable, off | disables what the inputs have enabled, without a fault; nothing begins |
//! | acknowledge, from off to on | acknowledges a fault: the next start may enable the drive again |
//!
//! Run off and enable off count at once. Everything else counts once the inputs have been the same for [`STEADY`] samples,
//! so a contact that bounces is one edge. An edge counts only if run and enable were on before it, so nothing begins when the
//! power comes. A board whose run input was never on since its reset has none: it does not stop what a host has enabled.
//!
//! One owner: the inputs begin nothing that a host has enabled, and while they have enabled the drive, hosts may read and
//! stop.

pub use pneudrive_protocol::io::{input, output};

/// Samples on end for which the inputs are the same before they count.
pub const STEADY: u8 = 3;

/// What the inputs have begun.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Phase {
    /// Nothing, or it has ended.
    #[default]
    Idle,
    /// A record waits until the spool of a stepper is at its null.
    Waiting,
    /// The axis homes.
    Homing,
    /// A record is on its way; the sample at which it has arrived.
    Moving { dwell: u32, arrived_at: Option<u32> },
    /// It is done.
    InPosition,
}

/// What the inputs were, and what they have begun.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Selector {
    /// As last read, and for how many samples.
    read: u8,
    steady: u8,
    /// As they count.
    settled: u8,
    run_was_on: bool,
    pub(crate) acknowledged: bool,
    pub(crate) phase: Phase,
    pub(crate) number: u8,
    pub(crate) refused: u8,
    pub(crate) outputs: u8,
    /// For the lamp, microseconds, wrapping.
    pub(crate) time_us: u32,
}

impl Default for Selector {
    fn default() -> Self {
        Selector {
            read: 0,
            steady: 0,
            // On when the power comes is no edge.
            settled: input::START | input::ACKNOWLEDGE,
            run_was_on: false,
            acknowledged: false,
            phase: Phase::Idle,
            number: 0,
            refused: 0,
            outputs: 0,
            time_us: 0,
        }
    }
}

impl Selector {
    /// The inputs as last read.
    #[must_use]
    pub fn inputs(&self) -> u8 {
        self.read
    }

    /// The inputs as they count.
    #[must_use]
    pub fn settled(&self) -> u8 {
        self.settled
    }

    /// The outputs.
    #[must_use]
    pub fn outputs(&self) -> u8 {
        self.outputs
    }

    /// The number that was begun last.
    #[must_use]
    pub fn number(&self) -> u8 {
        self.number
    }

    /// Why the last start was not carried out; 0: it was.
    #[must_use]
    pub fn refused(&self) -> u8 {
        self.refused
    }

    /// Takes a reading, and tells the inputs that have gone on, once they count.
    pub(crate) fn take(&mut self, read: u8) -> u8 {
        self.steady = if read == self.read { self.steady.saturating_add(1) } else { 1 };
        self.read = read;
        if self.steady < STEADY {
            return 0;
        }
        let before = core::mem::replace(&mut self.settled, read);
        self.run_was_on |= read & input::RUN != 0;
        let both = input::RUN | input::ENABLE;
        let rising = read & !before;
        if before & read & both == both { rising } else { rising & !input::START }
    }

    /// Whether the run input stops the drive.
    pub(crate) fn stops(&self) -> bool {
        self.run_was_on && self.read & input::RUN == 0
    }

    /// Whether the inputs leave the drive enabled.
    pub(crate) fn enables(&self) -> bool {
        self.read & input::ENABLE != 0
    }

    /// Whether a start would be listened to, as far as the inputs go.
    pub(crate) fn permits(&self) -> bool {
        let both = input::RUN | input::ENABLE;
        self.read & self.settled & both == both
    }

    /// The number that is selected.
    pub(crate) fn selected(&self) -> u8 {
        self.settled & input::NUMBER
    }

    /// Sets an output.
    pub(crate) fn tell(&mut self, bit: u8, on: bool) {
        self.outputs = if on { self.outputs | bit } else { self.outputs & !bit };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const READY: u8 = input::RUN | input::ENABLE;

    /// What counts of readings that follow each other.
    fn counts<const N: usize>(readings: [u8; N]) -> [u8; N] {
        let mut selector = Selector::default();
        readings.map(|read| selector.take(read))
    }

    #[test]
    fn an_edge_counts_once_the_inputs_have_been_the_same_for_a_while() {
        let start = READY | input::START | 5;
        assert_eq!(
            counts([READY, READY, READY, start, start, start, start])[3..],
            [0, 0, input::START | 5, 0]
        );
        let bounces = counts([READY, READY, READY, start, READY, start, READY, READY, READY, READY]);
        assert!(bounces.iter().all(|rising| rising & input::START == 0), "{bounces:?}");
    }

    #[test]
    fn what_is_on_when_the_power_comes_is_no_edge() {
        let all = [READY | input::START | input::ACKNOWLEDGE; 6];
        assert!(counts(all).iter().all(|rising| rising & (input::START | input::ACKNOWLEDGE) == 0));
    }

    #[test]
    fn a_start_counts_only_if_run_and_enable_were_on_before_it() {
        for before in [0, input::RUN, input::ENABLE] {
            let [.., last] = counts([
                before,
                before,
                before,
                READY | input::START,
                READY | input::START,
                READY | input::START,
            ]);
            assert_eq!(last & input::START, 0, "{before:x}");
        }
    }

    #[test]
    fn a_run_input_that_was_never_on_stops_nothing_and_one_that_goes_off_stops_at_once() {
        let mut selector = Selector::default();
        assert_eq!([0; 9].map(|read| selector.take(read)), [0; 9]);
        assert!(!selector.stops(), "it has no such contact");
        assert_eq!([READY; 3].map(|read| selector.take(read)), [0, 0, READY]);
        assert!(!selector.stops() && selector.enables());
        selector.take(0);
        assert!(selector.stops() && !selector.enables(), "at the first reading");
    }
}
