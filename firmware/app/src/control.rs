//! The half with a deadline: it samples, drives, records and watches the clock.

mod changes;
mod commands;
mod host;
mod records;
mod test;
mod transaction;
mod valve;

use core::borrow::BorrowMut;

use pneudrive_controller::law::cascade::kept::Kept;
use pneudrive_controller::{Config, Fault, Mode, Parameters, State, output, sample};
use pneudrive_protocol::Spread;

pub use changes::{ChangeError, SaveRefusal};
pub use test::{NAME_BYTES, Test};
pub use transaction::TakeError;

use crate::board::Board;
use crate::configuration::Configuration;
use crate::ownership::Ownership;
use crate::recorder::Recorder;
use crate::selector::Selector;
use crate::store::{NotStored, Store};
use crate::timing::Clock;

/// The controller, its configuration, the test and the recorder: its own, or one that is lent, since
/// a microcontroller has no room to make it on the stack. By default: disarmed, with the thesis's
/// parameters and no test.
///
/// The order matters, so it is kept: the data that a sample needs lie within reach of one load from the front. The long lists of
/// moves and samples, and what a host alone asks for, would move them out of reach.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct Control<R = Recorder> {
    state: State,
    clock: Clock,
    /// The mode at the present sample, until that is recorded.
    sampled: Option<Mode>,
    /// Whether the fault that the drive is in stands in the log.
    logged: bool,
    /// Whether the board's encoder may be absolute.
    may_know_position: bool,
    configuration: Configuration,
    test: Test,
    ownership: Ownership,
    /// The transient buffer.
    pub recorder: R,
    selector: Selector,
}

impl<R: BorrowMut<Recorder>> Control<R> {
    /// As by default, with this recorder.
    #[must_use]
    pub fn with_recorder(recorder: R) -> Control<R> {
        Control {
            configuration: Configuration::default(),
            test: Test::default(),
            state: State::default(),
            recorder,
            clock: Clock::default(),
            sampled: None,
            ownership: Ownership::default(),
            logged: false,
            may_know_position: false,
            selector: Selector::default(),
        }
    }

    /// Loads the board's store after a reset. A lost configuration is a fault: the drive cannot be armed before one
    /// is stored again. A stepper's spool that was not at mid-travel has to be sought. With an absolute encoder the
    /// axis is homed.
    pub fn take_up(&mut self, board: &mut impl Board) {
        self.state.take_up_spool(board.kept_spool());
        if !self.configuration.take_up(board.store()) {
            self.state.supervisor.trip(Fault::BadConfiguration);
        }
        self.may_know_position = board.may_know_position();
        self.locate();
    }

    /// Counts mean positions from here on, if the encoder is absolute.
    fn locate(&mut self) {
        if let Some(zero) = self.absolute_zero() {
            self.state.locate(zero);
        }
    }

    /// The position at count 0 of the encoder, if that is absolute.
    fn absolute_zero(&self) -> Option<i32> {
        self.parameters().absolute_zero().filter(|_| self.may_know_position)
    }

    /// The work for idle time: settles the timing, and stores logged faults, what was learned, and that nothing is kept of a run that has
    /// tripped, once the drive rests. The board calls it where it serves the port.
    ///
    /// # Errors
    /// When the flash does not take it.
    pub fn tidy_up(&mut self, board: &mut impl Board) -> Result<(), NotStored> {
        self.settle_timing();
        if !self.flash_may_be_written() {
            return Ok(());
        }
        // The log first: it says why the drive has tripped.
        board.store().flush()?;
        if let Some(kept) = self.kept_of_tripped() {
            self.configuration.save_afresh(&kept, board.store())?;
        }
        self.configuration.save_learned(board.store())
    }

    /// What is kept at the next arming of a drive in a fault, if a run has led to it.
    fn kept_of_tripped(&self) -> Option<Kept> {
        let is_tripped = matches!(self.state.supervisor.mode(), Mode::Fault(_));
        is_tripped.then(|| self.state.kept(self.config())).flatten()
    }

    /// Logs the fault that the drive is in, once: only arming leaves it.
    #[inline(always)] // In the control interrupt, where there is none as a rule.
    fn log_fault(&mut self, board: &mut impl Board) {
        if let Mode::Fault(fault) = self.state.supervisor.mode()
            && !self.logged
        {
            self.log(fault, board);
        }
    }

    #[cold]
    #[inline(never)]
    fn log(&mut self, fault: Fault, board: &mut impl Board) {
        let (seen, now_us) = (*self.state.observation(), board.now_us());
        board.store().log(fault.code(), seen.index, seen.position, now_us);
        self.logged = true;
    }

    /// The first interrupt: k * period. Must return before the output is due. Not inlined, as the second
    /// one: an interrupt has a frame of its own, whatever calls it.
    #[inline(never)]
    pub fn on_sample(&mut self, board: &mut impl Board) {
        self.judge_lateness(board.now_us() as u32);
        self.watch_host(board);
        self.sampled = Some(self.state.supervisor.mode());
        let input = board.read_sensors(self.configuration.config());
        sample(self.configuration.config(), &self.test.sequence, &mut self.state, &input);
    }

    /// The second interrupt: `delay` after the sample. The recorder is fed after the output.
    #[inline(never)]
    pub fn on_output(&mut self, board: &mut impl Board) {
        self.judge_output(board.now_us() as u32);
        let command = output(self.configuration.config(), &mut self.state);
        self.keep_spool(&command, board);
        board.drive(self.configuration.config(), command);
        self.record();
        self.log_fault(board);
        self.clock.output(board.now_us() as u32);
    }

    /// Gives the present sample to the recorder, once, by the mode in which it was taken: requests come between a
    /// sample and its output. Requests after which the state forgets the sample call this first.
    #[inline(always)]
    fn record(&mut self) {
        let seen = self.state.observation();
        match self.sampled.take() {
            Some(_) if seen.running => self.recorder.borrow_mut().store(seen),
            Some(Mode::Armed) => self.recorder.borrow_mut().before_start(seen),
            _ => {}
        }
    }

    /// A sample whose distance from the one before is off the period by more than the allowed time
    /// trips; so does one that is missing, since the next one is a whole period late.
    fn judge_lateness(&mut self, now_us: u32) {
        let timing = &self.configuration.config().timing;
        let Some(interval_us) = self.clock.sample(now_us, timing) else { return };
        let off_us = interval_us.abs_diff(timing.period_us.get());
        if off_us > timing.late_sample_us && self.state.supervisor.drives() {
            self.state.supervisor.trip(Fault::LateSample);
        }
    }

    /// An output that comes too late trips before it is driven.
    #[inline(always)]
    fn judge_output(&mut self, now_us: u32) {
        let timing = &self.configuration.config().timing;
        if self.clock.output_is_late(now_us, timing) && self.state.supervisor.drives() {
            self.state.supervisor.trip(Fault::LateOutput);
        }
    }

    /// Times of samples count from here on: the first one after this is neither early nor late.
    pub fn restart_clock(&mut self) {
        self.clock = Clock::default();
    }

    /// Mean interval of the samples since the clock was restarted, ns; the period before there are two.
    #[must_use]
    pub fn measured_period_ns(&mut self) -> u32 {
        self.settle_timing();
        let nominal = self.config().timing.period_us.get().saturating_mul(1000);
        self.clock.mean_interval_ns().unwrap_or(nominal)
    }

    /// Jitter of the samples: from one to the next, and from a sample to the end of its output.
    #[must_use]
    pub fn timing(&mut self) -> [Spread; 2] {
        self.settle_timing();
        self.clock.spreads()
    }

    /// The work that the control interrupt leaves to the idle task before the next sample: takes the times of the
    /// last sample into their histograms, and computes the next setpoint of a profile.
    pub fn settle_timing(&mut self) {
        let config = self.configuration.config();
        self.clock.settle(&config.timing);
        self.state.prepare(config, &self.test.sequence);
    }

    /// Mode, limits, fault latch.
    #[must_use]
    pub fn state(&self) -> &State {
        &self.state
    }

    /// The controller's configuration.
    #[must_use]
    pub fn config(&self) -> &Config {
        self.configuration.config()
    }

    /// The parameters and where they come from.
    #[must_use]
    pub fn configuration(&self) -> &Configuration {
        &self.configuration
    }

    /// The digital inputs and outputs, and the state of the inputs' last order.
    #[must_use]
    pub fn selector(&self) -> &Selector {
        &self.selector
    }

    /// The parameters, by id.
    #[must_use]
    pub fn parameters(&self) -> &Parameters {
        self.configuration.parameters()
    }

    /// The test that `start` will run.
    #[must_use]
    pub fn test(&self) -> &Test {
        &self.test
    }
}
