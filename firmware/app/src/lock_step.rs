//! A board whose plant is simulated elsewhere, in lock step. A sample is the data that came over the plant bus, a
//! command is the data that goes out. Its clock is the plant's.

use core::borrow::BorrowMut;

use pneudrive_controller::{Command, Config, Mode, Sample};

use crate::board::Board;
use crate::control::Control;
use crate::plant_bus::{Inputs, Next, Outputs, Tempo, Ticks};
use crate::recorder::Recorder;
use crate::store::Store;

/// A counter that measures work.
pub trait Stopwatch {
    /// The counter.
    fn now(&self) -> u32;

    /// Ticks since a reading.
    fn since(&self, reading: u32) -> u32;
}

/// One sample and its output, and the ticks that each took, without inputs and outputs of the bus. Not inlined, so
/// that the cost of the calls does not depend on the rest of an image.
#[inline(never)]
pub fn run_control<S: Store>(
    control: &mut Control<impl BorrowMut<Recorder>>,
    board: &mut LockStep<S>,
    stopwatch: &impl Stopwatch,
) -> Ticks {
    let begun = stopwatch.now();
    control.on_sample(board);
    let sample = stopwatch.since(begun);
    board.passes(control.config().timing.delay_us.get());
    let waited = stopwatch.now();
    control.on_output(board);
    Ticks { sample, output: stopwatch.since(waited) }
}

/// The board.
#[derive(Debug)]
pub struct LockStep<S> {
    name: &'static str,
    has_watchdog: bool,
    store: S,
    sample: Sample,
    tempo: Tempo,
    command: Command,
    /// The digital inputs, which a request sets.
    inputs: u8,
    begin: Option<Next>,
    /// Microseconds since the reset; with the lateness of a sample, until its outputs go.
    now_us: u64,
    /// The same without the lateness, as whole milliseconds, and the remainder: no instruction divides 64 bits.
    now_ms: u64,
    rest_us: u32,
}

impl<S: Store> LockStep<S> {
    /// A board of this name, with its store.
    pub fn new(name: &'static str, store: S) -> LockStep<S> {
        LockStep {
            name,
            has_watchdog: false,
            store,
            sample: Sample::default(),
            tempo: Tempo::default(),
            command: Command::OFF,
            inputs: 0,
            begin: None,
            now_us: 0,
            now_ms: 0,
            rest_us: 0,
        }
    }

    /// The same board with a watchdog, which its caller feeds.
    #[must_use]
    pub fn with_watchdog(self) -> LockStep<S> {
        LockStep { has_watchdog: true, ..self }
    }

    /// Takes the plant's answer.
    pub fn latch(&mut self, inputs: &Inputs, tempo: Tempo) {
        self.sample = inputs.sample;
        self.tempo = tempo;
        self.now_us += u64::from(tempo.late_us);
    }

    /// Advances the time to the output or to the next sample.
    pub fn passes(&mut self, time_us: u32) {
        let rest_us = self.rest_us.saturating_add(time_us);
        self.now_us += u64::from(time_us);
        self.now_ms += u64::from(rest_us / 1000);
        self.rest_us = rest_us % 1000;
    }

    /// The data for the plant after an output and the requests since.
    pub fn outputs(
        &mut self,
        control: &Control<impl BorrowMut<Recorder>>,
        next: Next,
        ticks: Ticks,
    ) -> Outputs {
        let next = self.begin.take().unwrap_or(next);
        let timing = &control.config().timing;
        self.now_us -= u64::from(self.tempo.late_us);
        self.passes(timing.period_us.get().saturating_sub(timing.delay_us.get()));
        Outputs { command: self.command, next, ticks }
    }

    /// The data for the plant instead of a sample's outputs, if a run was started after those had gone: their inputs
    /// belong to the plant before the start. None otherwise.
    pub fn begins(&mut self) -> Option<Outputs> {
        let next = self.begin.take()?;
        Some(Outputs { command: self.command, next, ticks: Ticks::default() })
    }

    /// The plant's next action in the mode after a sample.
    #[must_use]
    pub fn next(mode: Mode) -> Next {
        match mode {
            Mode::Running | Mode::Homing => Next::Advance,
            Mode::Done => Next::Hold,
            Mode::Disarmed | Mode::Armed | Mode::Fault(_) => Next::Stay,
        }
    }
}

impl<S: Store> Board for LockStep<S> {
    type Store = S;

    fn store(&mut self) -> &mut S {
        &mut self.store
    }

    fn name(&self) -> &'static str {
        self.name
    }

    fn build(&self) -> &'static str {
        crate::BUILD
    }

    fn read_sensors(&mut self, _: &Config) -> Sample {
        self.sample
    }

    fn drive(&mut self, _: &Config, command: Command) {
        self.command = command;
    }

    fn now_us(&self) -> u64 {
        self.now_us
    }

    /// Silence means nothing where time stands still between two samples.
    fn host_clock_ms(&self) -> Option<u64> {
        self.tempo.in_step.then_some(self.now_ms)
    }

    fn inputs(&mut self) -> u8 {
        self.inputs
    }

    fn emulate_inputs(&mut self, inputs: u8) -> bool {
        self.inputs = inputs;
        true
    }

    fn has_watchdog(&self) -> bool {
        self.has_watchdog
    }

    fn run_begins(&mut self, config: &Config) {
        let (period_us, delay_us) = (config.timing.period_us.get(), config.timing.delay_us.get());
        self.begin = Some(Next::Begin { period_us, delay_us });
    }

    fn starts_referenced(&self) -> bool {
        true
    }
}
