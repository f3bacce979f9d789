//! The controller of a servo-pneumatic drive. The thesis ran it in two interrupts of a 68000. Here it uses integers,
//! so it gives the same bits in the simulator, in an emulator and on the board.
//!
//! There are two calls per sample, as the thesis has two interrupts (section 6.3.2):
//!
//! 1. [`sample`] at `k * period`: estimate, error, law, supervise;
//! 2. [`output`] at `k * period + delay`: drive the valve.
//!
//! Data flows one way, a module a stage (`pipeline`):
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
//! | [`profile`] | the path of a setpoint while a move is under way |
//! | [`sequence`] | the moves of a test: when, where to, on which path |
//! | [`sequencer`] | which setpoint is in force, and whether it is reached |
//! | [`law`] | reference and measured motion to an unlimited demand: a file a law |
//! | [`learning`] | the command at which the valve is at its null, learned at rest |
//! | [`homing`] | the run that gives counts their meaning |
//! | [`pressure`] | the quasi-transient part of the pressure difference |
//! | [`limits`] | the limits of an axis, and the checks against them |
//! | [`supervisor`] | modes and fault latch: the last word on every command |
//! | [`drive`] | the drive stages: counts of a DAC, pulses of a stepper |
//! | `state` | what changes while the controller runs, and the requests to it |
//! | `pipeline` | the stages in their order |
//! | `spool` | where a stepper's spool is, and whether that can be relied on |
//!
//! A drive at 100 counts that is told to go to 1000 opens its valve at once, and a stop shuts it at the output of the same
//! sample:
//!
//! ```
//! use pneudrive_controller::{Command, Config, Fault, Move, Sample, Sequence, State, output, sample};
//!
//! let config = Config::default();
//! let mut sequence = Sequence::new(2000);
//! sequence.push(Move::step(0, 1000)).expect("room for a move");
//! let mut state = State::default();
//! state.reference(100); // What the encoder counts now is position 100.
//! state.arm(&config).expect("no run is on");
//! state.start(&config, &sequence).expect("armed and referenced");
//!
//! let measured = Sample { pressure_1: 2000, pressure_2: 2000, ..Sample::default() };
//! sample(&config, &sequence, &mut state, &measured);
//! assert_eq!(state.observation().error, 900);
//! assert!(output(&config, &mut state).counts > 0, "it extends");
//! state.supervisor.trip(Fault::Stop);
//! assert_eq!(output(&config, &mut state), Command::OFF);
//! ```
//!
//! `examples/step_controller.rs` runs it sample by sample.
//!
//! # Guarantees
//!
//! No float, no allocation, no `unsafe`, no panicking path, no required dependency. Every sum and product of the law
//! is exact in `i64` and saturated once to `i32`. The two calls take constant time but for the few branches of the
//! law; neither waits for anything. This crate knows nothing of messages, hardware or wall time.
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
mod pipeline;
pub mod pressure;
pub mod profile;
pub mod sequence;
pub mod sequencer;
pub mod signal;
mod spool;
mod standstill;
mod state;
pub mod supervisor;

pub use config::Config;
pub use fault::Fault;
pub use parameters::Parameters;
pub use pipeline::{output, sample};
pub use profile::Profile;
pub use sequence::{Move, Sequence};
pub use signal::{Command, Observation, Sample};
pub use state::State;
pub use supervisor::{Mode, Refusal};
