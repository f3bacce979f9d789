//! The twin of a servo-pneumatic drive.
//!
//! ```text
//! rig file -> components -> assembly -> integrator -> trace
//! ```
//!
//! | module | holds |
//! |---|---|
//! | [`rig`] | rig files: the table of keys, reading, checking, explaining, the built-in rigs |
//! | [`gas`], [`air`] | the ideal gas and its flow through a restriction; the air in one place |
//! | [`operator`], [`valve`], [`tubing`], [`actuator`], [`leakage`], [`load`] | one physical part each, its equations on top |
//! | [`friction`], [`stop`], [`play`], [`dither`] | what several parts share: stiction, mechanical stops, hysteresis |
//! | [`flow_law`], [`discharge`], [`iso6358`], [`flow_force`] | laws of flow through a restriction, and its force on the spool |
//! | [`network`] | the flows that valve, tubes and chambers agree on |
//! | `number` | one number, or two at once |
//! | `build` | a rig's keys into its components |
//! | `assembly` | the parts put together as one event-driven system |
//! | [`faults`] | what goes wrong and when, and what it does to plant and sensors |
//! | [`sensors`], [`plant`] | what the controller sees: a command in, a sample out |
//! | [`continuous`] | the controller in real numbers, for comparison |
//! | [`positive_gain`] | the historical bug of the gain routine, for repetition |
//! | [`characteristics`] | the thesis's component tests, on these very parts |
//! | [`follow`](mod@follow) | the plant under commands that were recorded |
//! | [`decision`] | whether a transient is decided, or the error of its integration chose it |
//! | [`run`](mod@run), [`trace`] | the real controller on the plant, and what came out |
//!
//! Everything is SI after loading. Transcendental functions come from `libm`, or from sums and products
//! alone, so that a run gives the same bits on every machine.

pub mod actuator;
pub mod air;
mod assembly;
pub mod build;
pub mod characteristics;
pub mod continuous;
pub mod decision;
pub mod discharge;
pub mod dither;
pub mod faults;
pub mod flow_force;
pub mod flow_law;
pub mod follow;
pub mod friction;
pub mod gas;
pub mod iso6358;
pub mod leakage;
pub mod load;
pub mod network;
mod number;
pub mod operator;
pub mod plant;
pub mod play;
pub mod positive_gain;
pub mod rig;
pub mod run;
pub mod sensors;
pub mod stop;
pub mod trace;
pub mod tubing;
pub mod valve;
mod walls;

pub use assembly::ValveState;
pub use decision::{Decision, decide};
pub use follow::follow;
pub use plant::{Accuracy, Plant};
pub use pneudrive_solver::{IntegrationError, Method};
pub use rig::Rig;
pub use run::{Recording, Run, run, run_recorded, run_watched};
