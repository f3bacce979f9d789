//! The half with a deadline: sensors in, command out, record, watch the clock.

use core::borrow::BorrowMut;

use pneudrive_controller::config::ConfigError;
use pneudrive_controller::drive::{DriveConfig, MAX_COUNTS, SpoolLocation};
use pneudrive_controller::parameters::{SetError, id};
use pneudrive_controller::{Config, Fault, Mode, Move, Parameters, Refusal, Sequence, State, output, sample};
use pneudrive_protocol::Spread;

use crate::board::Board;
use crate::configuration::Configuration;
use crate::recorder::Recorder;
use crate::store::{NotStored, Store};
use crate::timing::Clock;

/// Bytes of a test's name.
pub const NAME_BYTES: usize = 32;

/// What was downloaded to be run.
#[derive(Clone, Debug, Default)]
pub struct Test {
    name: [u8; NAME_BYTES],
    name_len: usize,
    decimation: u16,
    pre_trigger: u16,
    sequence: Sequence,
}

impl Test {
    /// A test without moves yet. A longer name is cut.
    #[must_use]
    pub fn new(name: &str, duration_samples: u32, decimation: u16, pre_trigger: u16) -> Test {
        let mut test = Test { decimation, pre_trigger, ..Test::default() };
        test.sequence = Sequence::new(duration_samples);
        let cut = (0..=name.len().min(NAME_BYTES)).rev().find(|&end| name.is_char_boundary(end));
        let bytes = name.as_bytes().get(..cut.unwrap_or(0)).unwrap_or(&[]);
        for (to, from) in test.name.iter_mut().zip(bytes) {
            *to = *from;
        }
        test.name_len = bytes.len();
        test
    }

    /// The name.
    #[must_use]
    pub fn name(&self) -> &str {
        self.name.get(..self.name_len).and_then(|bytes| core::str::from_utf8(bytes).ok()).unwrap_or("")
    }

    /// The moves and the length of the run.
    #[must_use]
    pub fn sequence(&self) -> &Sequence {
        &self.sequence
    }
}

/// Why a change of the configuration was not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChangeError {
    /// Not now.
    Refused(Refusal),
    /// Not this value.
    Value(SetError),
    /// Not with the other parameters.
    Inconsistent(ConfigError),
}

/// The controller, its configuration, the test and the recorder: its own, or one that is lent, since
/// a microcontroller has no room to make it on the stack. By default: disarmed, with the thesis's
/// parameters and no test.
#[derive(Debug, Default)]
pub struct Control<R = Recorder> {
    configuration: Configuration,
    test: Test,
    state: State,
    /// The transient buffer.
    pub recorder: R,
    clock: Clock,
    /// The mode at the present sample, until that is recorded.
    sampled: Option<Mode>,
    host_heard_ms: Option<u64>,
    /// Whether the fault that the drive is in stands in the log.
    logged: bool,
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
            host_heard_ms: None,
            logged: false,
        }
    }

    /// Takes up what the board has kept, after a reset. A configuration that is lost is a fault: the drive
    /// is not armed before one is stored again.
    pub fn take_up(&mut self, board: &mut impl Board) {
        if !self.configuration.take_up(board.store()) {
            self.state.supervisor.trip(Fault::BadConfiguration);
        }
    }

    /// What waits for idle time: settles the timing, and stores what was logged once the drive is disarmed. The
    /// board calls it from where the port is served.
    ///
    /// # Errors
    /// When the flash does not take it.
    pub fn tidy_up(&mut self, board: &mut impl Board) -> Result<(), NotStored> {
        self.settle_timing();
        if self.state.supervisor.drives() || self.spool_walks() {
            return Ok(());
        }
        board.store().flush()
    }

    /// Whether the spool of a stepper is on its way to mid-travel: its translator is enabled until then, and
    /// a flash that stalls the processor would keep it open.
    fn spool_walks(&self) -> bool {
        self.state.spool_location() != SpoolLocation::default()
    }

    /// Logs the fault that the drive is in, once: only arming leaves it.
    fn log_fault(&mut self, board: &mut impl Board) {
        if let Mode::Fault(fault) = self.state.supervisor.mode()
            && !self.logged
        {
            let (seen, now_us) = (*self.state.observation(), board.now_us());
            board.store().log(fault.code(), seen.index, seen.position, now_us);
            self.logged = true;
        }
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
        let command = output(self.configuration.config(), &mut self.state);
        board.drive(self.configuration.config(), command);
        self.record();
        self.log_fault(board);
        self.clock.output(board.now_us() as u32);
    }

    /// Gives the present sample to the recorder, once, by what the mode was when it was taken: requests
    /// come between a sample and its output. Those after which the state forgets the sample call this first.
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

    fn watch_host(&mut self, board: &impl Board) {
        let (Some(now), Some(heard)) = (board.host_clock_ms(), self.host_heard_ms) else { return };
        let limit = u64::from(self.config().timing.host_silence_ms);
        if limit > 0 && now.saturating_sub(heard) > limit && self.state.supervisor.moves() {
            self.state.supervisor.trip(Fault::HostSilent);
        }
    }

    /// The host was heard just now.
    pub fn host_heard(&mut self, board: &impl Board) {
        self.host_heard_ms = board.host_clock_ms();
    }

    /// Mean interval of the samples since the clock was restarted, ns; the period before there are two.
    #[must_use]
    pub fn measured_period_ns(&mut self) -> u32 {
        self.settle_timing();
        let nominal = self.config().timing.period_us.get().saturating_mul(1000);
        self.clock.mean_interval_ns().unwrap_or(nominal)
    }

    /// How even the samples are: from one to the next, and from a sample to the end of its output.
    #[must_use]
    pub fn timing(&mut self) -> [Spread; 2] {
        self.settle_timing();
        self.clock.spreads()
    }

    /// Takes the times of the last sample into their histograms: what the control interrupt leaves to who is
    /// idle, before the next sample.
    pub fn settle_timing(&mut self) {
        self.clock.settle(&self.configuration.config().timing);
    }

    /// Mode, limits, fault latch.
    #[must_use]
    pub fn state(&self) -> &State {
        &self.state
    }

    /// What the law runs on.
    #[must_use]
    pub fn config(&self) -> &Config {
        self.configuration.config()
    }

    /// The parameters and where they come from.
    #[must_use]
    pub fn configuration(&self) -> &Configuration {
        &self.configuration
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

    /// Changes parameters with consecutive ids: all of them or none.
    ///
    /// # Errors
    /// When the drive is not disarmed, or with the id of the first value that is wrong.
    pub fn set_parameters(
        &mut self,
        first_id: u16,
        values: impl Iterator<Item = i32>,
    ) -> Result<(), (u16, ChangeError)> {
        self.must_be_disarmed().map_err(|refusal| (first_id, ChangeError::Refused(refusal)))?;
        let mut changed = self.parameters().clone();
        let mut id = first_id;
        for value in values {
            changed.set(id, value).map_err(|error| (id, ChangeError::Value(error)))?;
            id = id.saturating_add(1);
        }
        let config = Config::new(&changed).map_err(|error| (first_id, ChangeError::Inconsistent(error)))?;
        self.forget_what_depends(&changed, &config);
        self.configuration.replace(changed).map_err(|error| (first_id, ChangeError::Inconsistent(error)))?;
        self.clock = Clock::default();
        Ok(())
    }

    /// A new meaning of counts takes the reference with it, a new timing, loop or drive stage the moves,
    /// and a record is not to be read with parameters that it was not taken with.
    fn forget_what_depends(&mut self, changed: &Parameters, config: &Config) {
        let encoder = |p: &Parameters| (p.get(id::ENCODER_PM_PER_COUNT), p.get(id::ENCODER_INVERTED));
        if encoder(changed) != encoder(self.parameters()) {
            self.state.supervisor.clear_referenced();
        }
        let meaning = |c: &Config| (c.timing, c.law.control_loop, matches!(c.drive, DriveConfig::Dac(_)));
        if meaning(config) != meaning(self.config()) {
            self.test = Test::default();
        }
        if changed != self.parameters() {
            self.recorder.borrow_mut().empty();
        }
    }

    /// Takes over a whole set of parameters, as from storage after a reset.
    ///
    /// # Errors
    /// When they do not go together; nothing is changed then.
    pub fn load_parameters(&mut self, parameters: Parameters) -> Result<(), ConfigError> {
        self.configuration.replace(parameters)
    }

    /// Stores the parameters for the next reset.
    ///
    /// # Errors
    /// When the drive is enabled, or the flash does not take them.
    pub fn save_parameters(&mut self, board: &mut impl Board) -> Result<(), SaveRefused> {
        self.must_be_disarmed().map_err(SaveRefused::NotNow)?;
        if self.spool_walks() {
            return Err(SaveRefused::NotNow(Refusal::ValveNotAtNull));
        }
        self.configuration.save(board.store()).map_err(|NotStored| SaveRefused::NotStored)
    }

    /// Takes a new test, which has no moves yet.
    ///
    /// # Errors
    /// When the drive is not disarmed.
    pub fn set_test(&mut self, test: Test) -> Result<(), Refusal> {
        self.must_be_disarmed()?;
        self.test = test;
        self.recorder.borrow_mut().empty();
        Ok(())
    }

    /// Appends a move to the test.
    ///
    /// # Errors
    /// When the drive is not disarmed, the moves are too many or out of order.
    pub fn push_move(&mut self, next: Move) -> Result<(), MoveError> {
        self.must_be_disarmed().map_err(MoveError::Refused)?;
        self.test.sequence.push(next).map_err(MoveError::Sequence)
    }

    /// The test ends with this sample, and its moves come again every `round` samples; 0: once.
    ///
    /// # Errors
    /// When the drive is not disarmed, or a move lies behind the round.
    pub fn set_span(&mut self, last_sample: u32, round: u32) -> Result<(), MoveError> {
        self.must_be_disarmed().map_err(MoveError::Refused)?;
        self.test.sequence.repeat_every(round).map_err(MoveError::Sequence)?;
        self.test.sequence.duration_samples = last_sample;
        Ok(())
    }

    fn must_be_disarmed(&self) -> Result<(), Refusal> {
        if self.state.supervisor.drives() { Err(Refusal::NotDisarmed) } else { Ok(()) }
    }

    /// Enables the drive with the valve at null, and empties the recorder. What the last run has learned
    /// of the valve's null becomes part of the parameters, and of those that are stored.
    ///
    /// # Errors
    /// The supervisor's refusal, and that of a drive whose stored configuration is lost.
    pub fn arm(&mut self, board: &mut impl Board) -> Result<(), Refusal> {
        if self.configuration.is_lost() {
            return Err(Refusal::NoConfiguration);
        }
        self.log_fault(board);
        self.take_over_null_offset(board);
        self.state.supervisor.arm()?;
        self.logged = false;
        // Storing has stalled the processor: what was late while disarmed is no fault.
        self.clock = Clock::default();
        self.recorder.borrow_mut().arm(self.test.decimation, self.test.pre_trigger);
        Ok(())
    }

    /// The next run starts where the last one has learned to. Between runs only, and not before the next
    /// one: a record is read with the parameters that it was taken with.
    fn take_over_null_offset(&mut self, board: &mut impl Board) {
        let learned = self.state.learned_null_offset();
        if learned == 0 || matches!(self.state.supervisor.mode(), Mode::Running | Mode::Homing) {
            return;
        }
        let largest = i32::from(MAX_COUNTS);
        let mut changed = self.parameters().clone();
        let old = changed.get(id::NULL_OFFSET_COUNTS).unwrap_or(0);
        let new = old.saturating_add(learned).clamp(-largest, largest);
        let was_saved = self.configuration.is_saved();
        if changed.set(id::NULL_OFFSET_COUNTS, new).is_ok() && self.configuration.replace(changed).is_ok() {
            self.state.forget_null_offset();
        }
        if was_saved && !self.state.supervisor.drives() {
            // What cannot be stored is learned again after the next reset.
            let _ = self.configuration.save(board.store());
        }
    }

    /// Disables the drive.
    pub fn disarm(&mut self) {
        self.state.supervisor.disarm();
    }

    /// Runs the test from the next sample on.
    ///
    /// # Errors
    /// The controller's refusal.
    pub fn start(&mut self, board: &mut impl Board) -> Result<(), Refusal> {
        self.record();
        self.state.start(self.configuration.config(), &self.test.sequence)?;
        self.recorder.borrow_mut().start();
        self.clock = Clock::default();
        self.host_heard(board);
        board.run_begins(self.configuration.config());
        Ok(())
    }

    /// Stops at once: a fault that only arming leaves.
    pub fn stop(&mut self) {
        self.trip(Fault::Stop);
    }

    /// A fault that the board has found, such as why it was reset.
    pub fn trip(&mut self, fault: Fault) {
        self.state.supervisor.trip(fault);
    }

    /// The axis stands at `counts` now: counts mean positions from here on.
    ///
    /// # Errors
    /// When the drive is enabled.
    pub fn reference(&mut self, counts: i32) -> Result<(), Refusal> {
        self.must_be_disarmed()?;
        self.state.reference(counts);
        Ok(())
    }

    /// Homes the axis from the next sample on.
    ///
    /// # Errors
    /// The controller's refusal.
    pub fn home(&mut self, board: &mut impl Board) -> Result<(), Refusal> {
        self.record();
        self.state.home()?;
        self.host_heard(board);
        // What is kept from before has positions of another origin.
        self.recorder.borrow_mut().arm(self.test.decimation, self.test.pre_trigger);
        Ok(())
    }

    /// Counts mean positions as they are: a simulated rig.
    ///
    /// # Errors
    /// When the drive is enabled.
    pub fn set_referenced(&mut self) -> Result<(), Refusal> {
        self.must_be_disarmed()?;
        self.state.supervisor.set_referenced();
        Ok(())
    }
}

/// Why the parameters were not stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SaveRefused {
    /// Not now.
    NotNow(Refusal),
    /// The flash did not take them.
    NotStored,
}

/// Why a move was not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MoveError {
    /// Not now.
    Refused(Refusal),
    /// Not here.
    Sequence(pneudrive_controller::sequencer::SequenceError),
}
