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
//! | [`parameters`] | the one table of parameters: id, unit, range, default, meaning, thesis name |
//! | [`config`] | the validated, immutable form of the parameters that the law runs on |
//! | [`estimator`] | velocity and acceleration as differences of counts |
//! | [`sequencer`] | timed moves: which setpoint is in force |
//! | [`law`] | error, velocity and acceleration to an unlimited demand |
//! | [`supervisor`] | modes, limits, fault latch: the last word on every command |
//! | [`drive`] | the drive stages: counts of a DAC, pulses of a stepper |
//!
//! # What is promised
//!
//! No float, no allocation, no `unsafe`, no panicking path, no required dependency. Every sum and
//! product of the law is exact in `i64` and saturated once to `i32`. The two calls take constant
//! time but for the few branches of the law; neither waits for anything. What is not known here:
//! messages, hardware, wall time.
#![no_std]
#![forbid(unsafe_code)]

pub mod config;
pub mod drive;
pub mod estimator;
mod fixed;
pub mod law;
pub mod parameters;
pub mod sequencer;
pub mod signal;
pub mod supervisor;

pub use config::Config;
pub use parameters::Parameters;
pub use sequencer::{Move, Sequence};
pub use signal::{Command, Observation, Sample};
pub use supervisor::{Fault, Mode, Refusal};

use drive::{DriveConfig, SpoolLocation};
use estimator::Estimator;
use law::Relay;
use sequencer::Sequencer;
use supervisor::Supervisor;

/// Everything that changes while the controller runs. [`Config`] and [`Sequence`] do not.
#[derive(Clone, Debug, Default)]
pub struct State {
    estimator: Estimator,
    sequencer: Sequencer,
    /// Modes, faults and the reference flag; requests go to it directly (`arm`, `start`, `stop`...).
    pub supervisor: Supervisor,
    relay: Relay,
    observation: Observation,
    location: SpoolLocation,
}

impl State {
    /// What the last sample was made into: the record of the six channels is taken from it.
    #[must_use]
    pub fn observation(&self) -> &Observation {
        &self.observation
    }

    /// SPLLOC: where the spool of a stepper valve is; mid-travel for a DAC.
    #[must_use]
    pub fn spool_location(&self) -> SpoolLocation {
        self.location
    }

    /// Runs from k = 0 at the next sample, or says why not.
    ///
    /// # Errors
    /// The [`Refusal`] that names what forbids the start.
    pub fn start(&mut self) -> Result<(), Refusal> {
        self.supervisor.start(self.location)?;
        self.sequencer = Sequencer::default();
        self.estimator = Estimator::default();
        self.relay = Relay::default();
        self.observation = Observation::default();
        Ok(())
    }
}

/// The first interrupt: takes the sensor sample of instant k and decides the command that
/// [`output`] will drive `delay` later.
///
/// The first sample after a start fills the estimator's history with its own count, so that the
/// velocity and acceleration of a drive at rest are zero from the first sample on.
pub fn sample(config: &Config, sequence: &Sequence, state: &mut State, input: &Sample) {
    let motion = state.estimator.update(&config.estimator, input);
    if state.sequencer.is_over(sequence) {
        state.supervisor.finish();
    }
    let running = state.supervisor.mode() == Mode::Running;
    let setpoint = if running { state.sequencer.advance(sequence) } else { state.sequencer.setpoint() };
    let error = law::error(&config.law, setpoint, motion.position);
    let demand = law::demand(&config.law, &mut state.relay, setpoint, error, &motion);
    state.supervisor.watch(&config.limits, &motion);
    let command = state.supervisor.permit(&config.law, config.drive.limit(demand));
    state.observation = Observation {
        running,
        index: state.sequencer.index(),
        position: motion.position,
        velocity: motion.velocity,
        acceleration: motion.acceleration,
        setpoint,
        error,
        command,
        pressure_1: input.pressure_1,
        pressure_2: input.pressure_2,
        spool: match config.drive {
            DriveConfig::Dac(_) => input.spool,
            DriveConfig::Stepper { .. } => state.location.steps(),
        },
    };
}

/// The second interrupt: what the drive stage does now, `delay` after the sample.
///
/// The supervisor is asked again, since requests come between the two calls: after a stop the output
/// is disabled, after an arming it is null, whatever the sample was made into. A stepper then walks to
/// mid-travel one pulse a sample; its translator stays enabled until the spool is there, for a spool
/// left open would go on moving the cylinder.
#[must_use]
pub fn output(config: &Config, state: &mut State) -> Command {
    let walking = state.location != SpoolLocation::default();
    let drive_enable = state.supervisor.drives() || walking;
    let counts = state.supervisor.permit(&config.law, state.observation.command);
    let step = match config.drive {
        DriveConfig::Dac(_) => {
            state.location = SpoolLocation::default();
            0
        }
        DriveConfig::Stepper { .. } => state.location.step_toward(counts),
    };
    Command { counts, step, drive_enable }
}
