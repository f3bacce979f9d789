//! A drive without a PC: its digital inputs select a move record and start it, its outputs report the progress.
//!
//! | input | does |
//! |---|---|
//! | number | selects a record; 15: homing; 0, as open wires have it: nothing |
//! | start, from off to on | starts it, if the drive is ready; a start while the axis moves is ignored |
//! | run, off | stops any motion, whoever has enabled the drive: a trip (`stop`) |
//! | enable, off | disables a drive that the inputs have enabled, without a fault; nothing starts |
//! | acknowledge, from off to on | acknowledges a fault or a stop: the next start may enable the drive again |
//!
//! Run off and enable off count at once. Everything else counts once all inputs have been constant for
//! `input_debounce_ms`, so a contact that bounces is one edge. A start begins its record `input_settling_ms` later.
//! Start, run, enable and number must not change until then, so a number that comes late starts nothing. An edge
//! counts only if run and enable were on before it, so nothing starts when the power comes. A board whose run input
//! was never on since its reset counts as one without that input: it does not stop a drive that a host has enabled.
//!
//! There is one owner. The inputs start nothing while a host has enabled the drive, and while they have enabled it,
//! hosts may only read and stop. A stop or a trip withdraws the permission of the inputs, whatever the drive does,
//! including an edge that does not count yet. It must be acknowledged again before the next start.

use pneudrive_controller::config::Timing;
pub use pneudrive_protocol::io::{input, output};

/// The inputs without which nothing begins.
const BOTH: u8 = input::RUN | input::ENABLE;

/// The inputs' last order.
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

/// A start that waits for its number: the inputs at its edge, and for how long they have not changed since.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Pending {
    inputs: u8,
    waited_us: u32,
}

/// The events that a reading of the inputs completes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct InputEvents {
    /// The acknowledge contact has closed.
    pub acknowledges: bool,
    /// A start is valid: the number that was constant for the settling time.
    pub starts: Option<u8>,
    /// A start is void: an input has changed within the settling time.
    pub unsettled: bool,
}

/// The state of the inputs, and their last order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Selector {
    /// As last read, and for how long, up to the time after which they count.
    read: u8,
    steady_us: u32,
    /// As they count.
    settled: u8,
    pending: Option<Pending>,
    run_was_on: bool,
    /// A fault or a stop has been acknowledged.
    pub(crate) acknowledged: bool,
    /// A stop has yet to be acknowledged.
    stopped: bool,
    /// The drive had tripped when the inputs were looked at last.
    tripped: bool,
    pub(crate) phase: Phase,
    pub(crate) number: u8,
    pub(crate) refused: u8,
    pub(crate) outputs: u8,
}

impl Default for Selector {
    fn default() -> Self {
        Selector {
            read: 0,
            steady_us: 0,
            // On when the power comes is no edge.
            settled: input::START | input::ACKNOWLEDGE,
            pending: None,
            run_was_on: false,
            acknowledged: false,
            stopped: false,
            tripped: false,
            phase: Phase::Idle,
            number: 0,
            refused: 0,
            outputs: 0,
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

    /// The number that was started last.
    #[must_use]
    pub fn number(&self) -> u8 {
        self.number
    }

    /// Why the last start was not carried out; 0: it was.
    #[must_use]
    pub fn refused(&self) -> u8 {
        self.refused
    }

    /// Takes the reading of a sample.
    pub(crate) fn take(&mut self, read: u8, timing: &Timing) -> InputEvents {
        let period_us = timing.period_us.get();
        let debounce_us = timing.input_debounce_ms.saturating_mul(1000);
        let steady_us = self.steady_us.saturating_add(period_us).min(debounce_us);
        self.steady_us = if read == self.read { steady_us } else { 0 };
        if self.read & read & BOTH != BOTH {
            // Run and enable count at once: a start that goes on without them, or with them, is none.
            self.settled |= read & input::START;
        }
        self.read = read;
        let settled = self.settle(period_us, timing.input_settling_ms);
        if self.steady_us < debounce_us {
            return settled;
        }
        let before = core::mem::replace(&mut self.settled, read);
        self.run_was_on |= read & input::RUN != 0;
        let rising = read & !before;
        if rising & input::START != 0 && before & read & BOTH == BOTH {
            self.pending = Some(Pending { inputs: read & !input::ACKNOWLEDGE, waited_us: 0 });
        }
        InputEvents { acknowledges: rising & input::ACKNOWLEDGE != 0, ..settled }
    }

    /// The outcome of a start that has counted.
    fn settle(&mut self, period_us: u32, settling_ms: u32) -> InputEvents {
        let Some(pending) = &mut self.pending else { return InputEvents::default() };
        if self.read & !input::ACKNOWLEDGE != pending.inputs {
            self.pending = None;
            return InputEvents { unsettled: true, ..InputEvents::default() };
        }
        pending.waited_us = pending.waited_us.saturating_add(period_us);
        if pending.waited_us < settling_ms.saturating_mul(1000) {
            return InputEvents::default();
        }
        self.pending = None;
        InputEvents { starts: Some(self.read & input::NUMBER), ..InputEvents::default() }
    }

    /// A stop: nothing that was acknowledged or started before it counts any more.
    pub(crate) fn stop(&mut self) {
        self.withdraw();
        self.stopped = true;
    }

    /// Notes whether the drive has tripped. Acknowledgements and starts from before a trip are not meant for it.
    pub(crate) fn notice(&mut self, tripped: bool) {
        if tripped && !self.tripped {
            self.withdraw();
        }
        self.tripped = tripped;
    }

    /// The drive is armed, which uses up the acknowledgement of its fault.
    pub(crate) fn leave_fault(&mut self) {
        (self.acknowledged, self.tripped) = (false, false);
    }

    /// Edges that have yet to count, or to settle, are over.
    fn withdraw(&mut self) {
        (self.acknowledged, self.pending) = (false, None);
        self.settled |= self.read & (input::START | input::ACKNOWLEDGE);
    }

    /// Notes whether a fault or a stop is acknowledged.
    pub(crate) fn acknowledge(&mut self, tripped: bool, acknowledges: bool) {
        self.acknowledged = tripped && (self.acknowledged || acknowledges);
        self.stopped &= !acknowledges;
    }

    /// Whether a fault, if there is one, and a stop have yet to be acknowledged.
    pub(crate) fn awaits_acknowledgement(&self, tripped: bool) -> bool {
        self.stopped || tripped && !self.acknowledged
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
        self.read & self.settled & BOTH == BOTH
    }

    /// Sets an output.
    pub(crate) fn tell(&mut self, bit: u8, on: bool) {
        self.outputs = if on { self.outputs | bit } else { self.outputs & !bit };
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use super::*;

    /// A sample a millisecond; inputs count after 3 ms, and starts settle in 4 ms.
    fn timing() -> Timing {
        let period_us = 1000.try_into().expect("not 0");
        let timing = pneudrive_controller::Config::default().timing;
        Timing { period_us, input_debounce_ms: 3, input_settling_ms: 4, ..timing }
    }

    /// The orders from readings, each this many milliseconds long.
    fn taken(selector: &mut Selector, readings: &[(u8, usize)]) -> Vec<InputEvents> {
        let each = readings.iter().flat_map(|&(read, ms)| std::iter::repeat_n(read, ms));
        each.map(|read| selector.take(read, &timing())).collect()
    }

    /// The numbers that readings start, each this many milliseconds long.
    fn started(readings: &[(u8, usize)]) -> Vec<u8> {
        taken(&mut Selector::default(), readings).iter().filter_map(|taken| taken.starts).collect()
    }

    const START: u8 = BOTH | input::START;

    #[test]
    fn a_start_counts_after_its_debounce_and_begins_after_its_settling_time() {
        let mut selector = Selector::default();
        let all = taken(&mut selector, &[(BOTH, 4), (START | 5, 12)]);
        let begun: Vec<usize> = (0..all.len()).filter(|&k| all[k].starts == Some(5)).collect();
        // The edge is seen at 4 ms, counts at 7 and begins at 11.
        assert_eq!(begun, [11]);
    }

    /// Whatever the sample period: it is the time that counts.
    #[test]
    fn the_times_are_those_of_the_drive_and_no_numbers_of_samples() {
        for period_us in [100_u32, 500, 1300, 4000] {
            let timing = Timing {
                period_us: period_us.try_into().expect("not 0"),
                ..pneudrive_controller::Config::default().timing
            };
            let mut selector = Selector::default();
            let mut since = |read: u8, ms: u32| {
                let readings = (ms * 1000).div_ceil(period_us) + 1;
                (1..=readings)
                    .find(|_| selector.take(read, &timing).starts.is_some())
                    .map(|k| (k - 1) * period_us)
            };
            assert_eq!(since(BOTH, 50), None);
            let begun_us = since(START | 5, 100).expect("a start");
            assert!((30_000..30_000 + 3 * period_us).contains(&begun_us), "{period_us}: {begun_us}");
        }
    }

    #[test]
    fn a_contact_that_bounces_begins_its_record_once_and_no_other() {
        let bouncing = [(BOTH | 5, 4), (START | 5, 2), (BOTH | 5, 1), (START | 5, 20)];
        assert_eq!(started(&bouncing), [5]);
        // It bounces once more while the next number is set.
        let released = [(BOTH | 5, 4), (START | 5, 20), (BOTH | 7, 2), (START | 7, 2), (BOTH | 7, 20)];
        assert_eq!(started(&released), [5]);
    }

    #[test]
    fn a_number_that_comes_late_begins_nothing_or_the_record_that_is_meant() {
        assert_eq!(started(&[(BOTH, 4), (START, 2), (START | 5, 20)]), [5], "within the debounce");
        let mut selector = Selector::default();
        let late = taken(&mut selector, &[(BOTH, 4), (START | 4, 5), (START | 5, 40)]);
        assert!(late.iter().all(|taken| taken.starts.is_none()));
        assert_eq!(late.iter().filter(|taken| taken.unsettled).count(), 1);
    }

    #[test]
    fn a_start_that_ends_before_it_has_settled_begins_nothing() {
        assert_eq!(started(&[(BOTH | 5, 4), (START | 5, 6), (BOTH | 5, 20)]), []);
    }

    #[test]
    fn what_is_on_when_the_power_comes_is_no_edge() {
        let all = taken(&mut Selector::default(), &[(START | input::ACKNOWLEDGE, 40)]);
        assert!(all.iter().all(|taken| *taken == InputEvents::default()));
    }

    #[test]
    fn a_start_counts_only_if_run_and_enable_were_on_before_it() {
        for before in [0, input::RUN, input::ENABLE] {
            assert_eq!(started(&[(before, 6), (START | 5, 40)]), [], "{before:x}");
        }
    }

    #[test]
    fn a_stop_ends_a_start_that_has_yet_to_settle_and_asks_for_an_acknowledgement() {
        let mut selector = Selector::default();
        taken(&mut selector, &[(BOTH | 5, 4), (START | 5, 5)]);
        selector.stop();
        assert!(taken(&mut selector, &[(START | 5, 20)]).iter().all(|taken| taken.starts.is_none()));
        assert!(selector.awaits_acknowledgement(false));
        selector.acknowledge(false, true);
        assert!(!selector.awaits_acknowledgement(false));
    }

    /// However short it was: run and enable count at once.
    #[test]
    fn a_start_that_goes_on_while_run_or_enable_is_off_for_a_moment_is_none() {
        for off in [input::RUN, input::ENABLE] {
            let without = BOTH & !off;
            let start = input::START | 5;
            assert_eq!(
                started(&[(BOTH | 5, 9), (without | 5, 1), (without | start, 1), (BOTH | start, 40)]),
                []
            );
            assert_eq!(started(&[(BOTH | 5, 9), (without | 5, 1), (BOTH | start, 40)]), [], "with it");
            assert_eq!(started(&[(BOTH | 5, 9), (without | 5, 1), (BOTH | 5, 1), (BOTH | start, 40)]), [5]);
        }
    }

    #[test]
    fn edges_that_have_yet_to_count_at_a_stop_or_a_trip_never_count() {
        let ends: [fn(&mut Selector); 2] = [Selector::stop, |selector| selector.notice(true)];
        for end in ends {
            let mut selector = Selector::default();
            taken(&mut selector, &[(BOTH | 5, 9), (START | input::ACKNOWLEDGE | 5, 2)]);
            end(&mut selector);
            let later = taken(&mut selector, &[(START | input::ACKNOWLEDGE | 5, 40)]);
            assert!(later.iter().all(|taken| *taken == InputEvents::default()));
            let anew = taken(&mut selector, &[(BOTH | 5, 9), (START | input::ACKNOWLEDGE | 5, 40)]);
            assert_eq!(anew.iter().filter(|taken| taken.acknowledges).count(), 1);
            assert_eq!(anew.iter().filter_map(|taken| taken.starts).collect::<Vec<_>>(), [5]);
        }
    }

    #[test]
    fn a_run_input_that_was_never_on_stops_nothing_and_one_that_goes_off_stops_at_once() {
        let mut selector = Selector::default();
        taken(&mut selector, &[(0, 9)]);
        assert!(!selector.stops(), "it has no such contact");
        taken(&mut selector, &[(BOTH, 4)]);
        assert!(!selector.stops() && selector.enables());
        taken(&mut selector, &[(0, 1)]);
        assert!(selector.stops() && !selector.enables(), "at the first reading");
    }
}
