//! The controller of a servo-pneumatic drive: what the thesis ran in two interrupts of a 68000, here
//! in integers that come out the same in every bit in the simulator, in an emulator and on the board.
//!
//! Two calls a sample, as the thesis has two interrupts (section 6.3.2):
//!
//! 1. [`sample`] at `k * period`: estimate, error, law, supervise;
//! 2. [`output`] at `k * period + delay`: what to drive now.
//!
//! Data flows one way, a module a stage:
//!
//! ```text
//! Sample -> estimator -> (sequencer: setpoint) -> law -> supervisor -> drive -> Command
//! ```
//!
//! | module | holds |
//! |---|---|
//! | [`signal`] | what goes in and what comes out: [`Sample`], [`Command`] |
//! | [`parameters`] | the one table of parameters: id, unit, range, default, rig key, meaning, thesis name |
//! | [`choice`] | what parameters choose among, by its words; the list of the laws |
//! | [`config`] | the validated, immutable form of the parameters that the law runs on |
//! | [`estimator`] | velocity and acceleration as differences of counts |
//! | [`profile`] | the way of a setpoint while a move is under way |
//! | [`sequence`] | the moves of a test: when, where to, on which way |
//! | [`sequencer`] | which setpoint is in force, and whether it is reached |
//! | [`law`] | error, velocity and acceleration to an unlimited demand |
//! | [`learning`] | the command at which the valve is at its null, learned at rest |
//! | [`homing`] | the run that gives counts their meaning |
//! | [`pressure`] | the quasi-transient part of the pressure difference |
//! | [`limits`] | what an axis may do |
//! | [`supervisor`] | modes and fault latch: the last word on every command |
//! | [`drive`] | the drive stages: counts of a DAC, pulses of a stepper |
//! | `spool` | where a stepper's spool is, and whether that can be relied on |
//!
//! # What is promised
//!
//! No float, no allocation, no `unsafe`, no panicking path, no required dependency. Every sum and
//! product of the law is exact in `i64` and saturated once to `i32`. The two calls take constant
//! time but for the few branches of the law; neither waits for anything. What is not known here:
//! messages, hardware, wall time.
#![no_std]
#![forbid(unsafe_code)]

pub mod choice;
pub mod config;
pub mod drive;
pub mod estimator;
mod fault;
mod fixed;
pub mod homing;
pub mod law;
pub mod learning;
pub mod limits;
pub mod parameters;
pub mod pressure;
pub mod profile;
pub mod sequence;
pub mod sequencer;
pub mod signal;
mod spool;
mod standstill;
pub mod supervisor;

pub use config::Config;
pub use fault::Fault;
pub use parameters::Parameters;
pub use profile::Profile;
pub use sequence::{Move, Sequence};
pub use signal::{Command, Observation, Sample};
pub use supervisor::{Mode, Refusal};

use drive::{DriveConfig, SpoolLocation};
use estimator::{Estimator, Motion};
use homing::{Homing, Progress};
use law::{Aim, LawConfig, Loop, Memory};
use limits::Evidence;
use sequencer::Sequencer;
use spool::Spool;
use supervisor::Supervisor;

/// Everything that changes while the controller runs. [`Config`] and [`Sequence`] do not.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct State {
    estimator: Estimator,
    sequencer: Sequencer,
    homing: Homing,
    /// Modes, faults and the reference flag; requests go to it directly (`arm`, `disarm`, `trip`).
    pub supervisor: Supervisor,
    law: Memory,
    observation: Observation,
    spool: Spool,
    /// The encoder's own count, and what is taken off it to make a position.
    encoder: i32,
    origin: i32,
}

impl State {
    /// What the last sample was made into: the record of the six channels is taken from it.
    #[must_use]
    pub fn observation(&self) -> &Observation {
        &self.observation
    }

    /// SPLLOC: where the pulses have taken the spool of a stepper valve since mid-travel.
    #[must_use]
    pub fn spool_location(&self) -> SpoolLocation {
        self.spool.counted()
    }

    /// What a board keeps of a stepper's spool through a reset, once the pulse of this command has begun; None where
    /// nothing is known that it does not keep already. A spool that arrives counts as open until its last pulse is over.
    #[must_use]
    pub fn spool_to_keep(&self, config: &Config, command: &Command) -> Option<SpoolLocation> {
        let now = self.spool.sure().filter(|_| config.drive.is_stepper())?;
        let arrives = command.step != 0 && now == SpoolLocation::default();
        Some(if arrives { SpoolLocation::at(-i16::from(command.step)) } else { now })
    }

    /// Whether the valve has a stepper whose spool is known to be away from mid-travel.
    #[must_use]
    pub fn spool_is_open(&self, config: &Config) -> bool {
        config.drive.is_stepper() && self.spool.is_open()
    }

    /// After a reset: where the spool was before it, if the board has kept that.
    pub fn take_up_spool(&mut self, kept: Option<SpoolLocation>) {
        self.spool = Spool::after_reset(kept);
    }

    /// Enables the drive with the valve at null; leaves the fault mode.
    ///
    /// # Errors
    /// While a run is on, and when it is not known where a stepper's spool is.
    pub fn arm(&mut self, config: &Config) -> Result<(), Refusal> {
        self.check_spool(config)?;
        self.supervisor.arm()
    }

    /// Whether it is known where a stepper's spool is.
    ///
    /// # Errors
    /// When it is not since a reset.
    pub fn check_spool(&self, config: &Config) -> Result<(), Refusal> {
        if config.drive.is_stepper() { self.spool.check() } else { Ok(()) }
    }

    /// Walks a stepper's spool back from where it was before a reset, one pulse a sample; its translator is enabled
    /// until it is at mid-travel. The drive must be disabled; who calls this sees to it.
    ///
    /// # Errors
    /// When it is not known where it was.
    pub fn seek_null(&mut self) -> Result<(), Refusal> {
        self.spool.seek()
    }

    /// A stepper's spool is at mid-travel. The drive must be disabled; who calls this sees to it.
    ///
    /// # Errors
    /// While it is on its way there.
    pub fn at_null(&mut self) -> Result<(), Refusal> {
        self.spool.at_null()
    }

    /// How the moves of the run stand.
    #[must_use]
    pub fn sequencer(&self) -> &Sequencer {
        &self.sequencer
    }

    /// What this run has learned of the valve's null, counts: the next run starts with the null offset
    /// of the parameters, so it is to be added there.
    #[must_use]
    pub fn learned_null_offset(&self) -> i32 {
        self.law.null_offset.counts()
    }

    /// What was learned has become part of the parameters.
    pub fn forget_null_offset(&mut self) {
        self.law = Memory::default();
    }

    /// Runs from k = 0 at the next sample, or says why not.
    ///
    /// # Errors
    /// The [`Refusal`] that names what forbids the start.
    pub fn start(&mut self, config: &Config, sequence: &Sequence) -> Result<(), Refusal> {
        if self.supervisor.mode() == Mode::Armed {
            sequence.check(&config.limits, config.law.control_loop == Loop::Closed)?;
        }
        self.supervisor.start(config.law.control_loop, self.spool_is_open(config))?;
        self.begin_anew(Sequencer::new(sequence, config.law.control_loop == Loop::Closed));
        Ok(())
    }

    /// The moves are over before the end of the run: a closed loop holds the last setpoint.
    pub fn finish(&mut self) {
        self.supervisor.finish();
        self.sequencer.stand();
        self.sequencer.close();
    }

    /// While a run is on: from the next sample on its setpoint is `target`, as if a step of its sequence began there.
    /// Moves of the sequence that become due later still hold. It is for loops whose setpoints are not known
    /// beforehand: counts in closed loop, valve counts in open loop.
    ///
    /// # Errors
    /// When no run is on, or the setpoint of a closed loop lies beyond a software end position.
    pub fn redirect(&mut self, config: &Config, target: i32) -> Result<(), Refusal> {
        if self.supervisor.mode() != Mode::Running {
            return Err(Refusal::NoMoves);
        }
        if config.law.control_loop == Loop::Closed && !config.limits.allows(target) {
            return Err(Refusal::BeyondEnd);
        }
        if self.sequencer.redirect(target) {
            let LawConfig { learning_gain, scale, .. } = config.law;
            self.law.null_offset.learn(learning_gain, self.observation.error, scale);
        }
        Ok(())
    }

    /// Homes the axis from the next sample on, or says why not.
    ///
    /// # Errors
    /// The [`Refusal`] that names what forbids it.
    pub fn home(&mut self, config: &Config) -> Result<(), Refusal> {
        self.supervisor.home(self.spool_is_open(config))?;
        self.homing = Homing::default();
        self.begin_anew(Sequencer::default());
        Ok(())
    }

    /// Works out the next setpoint of a profile between two samples. Otherwise [`sample`] does so itself, and takes longer.
    pub fn prepare(&mut self, config: &Config, sequence: &Sequence) {
        self.sequencer.prepare(&config.motion, sequence);
    }

    fn begin_anew(&mut self, sequencer: Sequencer) {
        self.sequencer = sequencer;
        self.estimator.forget();
        self.law = Memory::default();
        self.observation = Observation::default();
    }

    /// The axis stands at `position` now: counts mean positions from here on. The drive must be
    /// disabled; who calls this sees to it.
    pub fn reference(&mut self, position: i32) {
        self.set_origin(position);
        self.supervisor.set_referenced();
    }

    /// The encoder is absolute, and reads 0 at this position: counts mean positions from here on, wherever the axis
    /// stands. A homing run ends before its first sample.
    pub fn locate(&mut self, zero: i32) {
        self.reference(self.encoder.wrapping_add(zero));
        if self.supervisor.mode() == Mode::Homing {
            self.supervisor.homed();
        }
    }

    fn set_origin(&mut self, position: i32) {
        self.origin = self.encoder.wrapping_sub(position);
        self.observation.position = position;
        self.estimator.forget();
    }
}

/// The first interrupt: takes the sensor sample of instant k and decides the command that
/// [`output`] will drive `delay` later.
///
/// Before the first sample after a start the drive stood where that one found it: velocity and
/// acceleration of a drive at rest are zero from the first sample on.
pub fn sample(config: &Config, sequence: &Sequence, state: &mut State, input: &Sample) {
    let motion = state.estimate(config, input);
    let target = state.target(config, sequence, motion.position);
    state.watch(config, input, &motion);
    let demand = state.demand(config, &target, &motion, input);
    let command = state.supervisor.permit(&config.law, config.limits.command(demand));
    let Target { running, setpoint, error } = target;
    state.observation = Observation { running, setpoint, error, command, ..state.observation };
}

/// Where the drive shall be at a sample.
struct Target {
    running: bool,
    setpoint: i32,
    error: i32,
}

/// The stages of [`sample`], in their order. What was seen goes into the observation at once; what the
/// sample before was made into stands there until it is replaced.
impl State {
    fn estimate(&mut self, config: &Config, input: &Sample) -> Motion {
        self.encoder = input.position;
        let position = input.position.wrapping_sub(self.origin);
        let motion = self.estimator.update(&config.estimator, position);
        self.observation = Observation {
            position,
            velocity: motion.velocity,
            acceleration: motion.acceleration,
            pressure_1: input.pressure_1,
            pressure_2: input.pressure_2,
            spool: match config.drive {
                DriveConfig::Dac(_) => input.spool,
                DriveConfig::Stepper { .. } => self.spool.counted().steps(),
            },
            ..self.observation
        };
        motion
    }

    fn target(&mut self, config: &Config, sequence: &Sequence, position: i32) -> Target {
        let was_running = self.supervisor.mode() == Mode::Running;
        let over = was_running && self.sequencer.is_over(&config.motion, sequence);
        let running = was_running && !over;
        let rested = if over {
            self.supervisor.finish();
            self.sequencer.stand();
            self.sequencer.close()
        } else if running {
            self.observation.index = self.sequencer.taken();
            self.sequencer.advance(&config.motion, sequence, position)
        } else {
            false
        };
        if rested {
            let LawConfig { learning_gain, scale, .. } = config.law;
            self.law.null_offset.learn(learning_gain, self.observation.error, scale);
        }
        let setpoint = self.sequencer.setpoint();
        let error = law::error(&config.law, setpoint, position);
        if running {
            self.sequencer.judge(&config.motion, error);
        }
        Target { running, setpoint, error }
    }

    fn watch(&mut self, config: &Config, input: &Sample, motion: &Motion) {
        let holds_or_runs = matches!(self.supervisor.mode(), Mode::Running | Mode::Done);
        let from_null = if holds_or_runs && config.law.control_loop == Loop::Closed {
            i32::from(self.observation.command).abs_diff(i32::from(config.law.null_offset))
        } else {
            0
        };
        let evidence = Evidence { motion, input, referenced: self.supervisor.is_referenced(), from_null };
        self.supervisor.watch(&config.limits, &evidence);
    }

    fn demand(&mut self, config: &Config, target: &Target, motion: &Motion, input: &Sample) -> i32 {
        if !matches!(self.supervisor.mode(), Mode::Running | Mode::Done) {
            return self.demand_without_moves(config, motion.position, input.home_switch);
        }
        let aim = Aim {
            setpoint: target.setpoint,
            error: target.error,
            feed_forward: self.sequencer.feed_forward(),
        };
        let demand = law::demand(&config.law, &mut self.law, &aim, motion, input);
        if config.law.control_loop == Loop::Open {
            self.demand_in_open_loop(config, demand, motion.position)
        } else if config.motion.on_arrival && target.running && self.sequencer.is_at_exit(&config.motion) {
            self.demand_at_exit(config)
        } else {
            demand
        }
    }

    /// Without moves the valve is at its null, but for a homing run.
    #[cold]
    #[inline(never)]
    fn demand_without_moves(&mut self, config: &Config, position: i32, home_switch: bool) -> i32 {
        match self.supervisor.mode() {
            Mode::Homing => self.seek(config, position, home_switch),
            Mode::Armed => self.stand(config, position),
            _ => 0,
        }
    }

    /// An enabled drive whose valve is at its null.
    fn stand(&mut self, config: &Config, position: i32) -> i32 {
        self.supervisor.watch_null(&config.limits, position, self.spool_is_open(config));
        0
    }

    fn demand_in_open_loop(&mut self, config: &Config, demand: i32, position: i32) -> i32 {
        match self.supervisor.mode() {
            Mode::Done => self.stand(config, position),
            _ if self.supervisor.is_referenced() => config.limits.hold_back(demand, position),
            _ => demand,
        }
    }

    /// At an exit (thesis 6.3.2) the valve of a closed loop stays as it is, and a stepper gets no pulse.
    #[cold]
    fn demand_at_exit(&self, config: &Config) -> i32 {
        i32::from(match config.drive {
            DriveConfig::Dac(_) => self.observation.command,
            DriveConfig::Stepper { .. } => self.spool.counted().steps(),
        })
    }

    /// A sample of the homing run.
    fn seek(&mut self, config: &Config, position: i32, home_switch: bool) -> i32 {
        let from_null = i32::from(self.observation.command).abs_diff(i32::from(config.law.null_offset));
        let effort = config.limits.no_motion.effort(from_null).unwrap_or(0);
        if self.homing.pushed_for(&config.homing, position, effort) > config.limits.no_motion.most {
            self.supervisor.trip(Fault::NoMotion);
            return 0;
        }
        match self.homing.advance(&config.homing, position, home_switch) {
            Progress::Seeking(command) => return i32::from(command),
            Progress::Found => {
                self.set_origin(config.homing.position);
                self.supervisor.homed();
            }
            Progress::TimedOut => self.supervisor.trip(Fault::HomingFailed),
        }
        0
    }
}

/// The second interrupt: what the drive stage does now, `delay` after the sample.
///
/// The supervisor is asked again, since requests come between the two calls: after a stop the output
/// is disabled, after an arming it is null, whatever the sample was made into. A stepper then walks to
/// mid-travel one pulse a sample; its translator stays enabled until the spool is there, for a spool
/// left open would go on moving the cylinder. A spool whose location is in doubt gets no pulse.
#[must_use]
pub fn output(config: &Config, state: &mut State) -> Command {
    let drives = state.supervisor.drives();
    let counts = state.supervisor.permit(&config.law, state.observation.command);
    match config.drive {
        DriveConfig::Dac(_) => Command { counts, step: 0, drive_enable: drives },
        DriveConfig::Stepper { .. } => {
            let drive_enable = drives || state.spool.walks();
            Command { counts, step: state.spool.step_toward(counts), drive_enable }
        }
    }
}
