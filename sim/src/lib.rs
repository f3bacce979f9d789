//! The digital twin of a servo-pneumatic drive.
//!
//! ```text
//! rig file -> components -> assembly -> integrator -> trace
//! ```
//!
//! | module | holds |
//! |---|---|
//! | [`rig`] | a rig: the table of its keys, checking, explaining, spreads |
//! | [`rigfile`] | rig files in TOML: reading, units, the built-in rigs |
//! | [`component`] | the physical parts, one file each: equations on top, then keys, checks and construction |
//! | [`network`] | the flow network of valve, tubes and chambers |
//! | `number` | one number, or two at once |
//! | `assembly` | the parts put together as one event-driven system |
//! | [`plant`] | the controller's view: a command in, a sample out |
//! | [`continuous`] | the controller in real numbers, for comparison |
//! | [`gain_bug`] | the historical bug of the gain routine, for repetition |
//! | [`follow`](mod@follow) | the plant under commands that were recorded |
//! | [`known`] | what the law that positions by a model knows, in engineering units |
//! | [`convergence`] | whether a run has converged |
//! | [`run`](mod@run), [`trace`] | the real controller on the plant, and the transient |
//!
//! A drive is a rig file, a run its test under the real controller:
//!
//! ```
//! use pneudrive_sim::{Accuracy, Rig, check_convergence, run};
//!
//! let press = Rig::builtin("press").expect("a built-in rig");
//! let rig = press.with_settings(&["load.mass_kg=12", "test.moves_mm=[[0.0, 120.0]]", "test.duration_s=1"])?;
//! let accuracy = Accuracy::of(&rig);
//! let run = run(&rig, accuracy)?;
//! assert_eq!(run.fault, None);
//! let end = run.rows.last().expect("a row a sample").plant;
//! assert!((end.position - 0.120).abs() < 50e-6, "it stands at {} m", end.position);
//! assert!(check_convergence(&rig, accuracy, &run)?.is_converged());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! `examples/friction_model.rs` tries a model of friction that is not the twin's.
//!
//! Everything is SI after loading. Transcendental functions come from `libm`, or from sums and products alone, so a
//! run gives the same bits on every machine.

mod assembly;
pub mod component;
pub mod continuous;
pub mod convergence;
pub mod follow;
pub mod gain_bug;
pub mod key;
pub mod keys;
pub mod known;
pub mod monotone;
pub mod network;
mod number;
pub mod plant;
mod random;
pub mod rig;
pub mod rigfile;
pub mod run;
pub mod schedule;
mod snapshot;
mod start;
pub mod trace;
mod values;

pub use assembly::ValveState;
pub use assembly::linear::{LinearModel, NotLinear};
pub use convergence::{Convergence, check_convergence};
pub use follow::follow;
pub use plant::{Accuracy, PERTURBATION, Plant};
pub use pneudrive_solver::{IntegrationError, Method};
pub use rig::Rig;
pub use run::{Record, Recording, Run, Runner, run, run_changing, run_keeping, run_recorded};
