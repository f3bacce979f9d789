//! Servo-pneumatic drives as FMUs: models that other simulators load, under co-simulation of FMI 3.0 (Functional Mock-up
//! Interface Specification 3.0, chapters 2 and 4) or 2.0 (chapters 2 and 4, too).
//!
//! An FMU holds one shared library, with the functions of this crate, and the rig file that makes it one drive. host/fmu/library builds
//! the library. There are three parts:
//!
//! ```text
//! plant       command at sample k -> sample k + 1, and the state in SI units
//! controller  sample k -> command at sample k
//! drive       setpoint at sample k -> both of them, joined as in `pneudrive simulate`
//! ```
//!
//! A step passes the samples that lie in it; where it ends between two of them, the model stands at the last one. The
//! controller goes first: `command = controller(sample)`, then `sample = plant(command)`; both take the step from k to k + 1.
//! The plant has the command take effect `controller.delay_s` after the sample, so that the loop of the two repeats
//! `pneudrive simulate` bit for bit.
//!
//! | module | holds |
//! |---|---|
//! | [`part`] | which part an FMU is, and the token by which library and rig know each other |
//! | [`standard`] | FMI 2.0 or 3.0 |
//! | [`signal`] | types and values of the inputs and outputs of a model |
//! | [`model`] | plant, controller and drive, a sample at a time |
//! | [`variable`] | the variables of an FMU: names, numbers, units, whether they may be set |
//! | [`instance`] | a model in the states of the standard: which calls are allowed when |
//! | [`description`] | modelDescription.xml |
//! | [`documentation`] | the page that explains them |
//! | [`library`] | the shared library, of one system or another |
//! | [`archive`] | the FMU as a file |
//! | [`c_api`] | the functions of the standard, with unsafe code: pointers of a program in C |

#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod archive;
pub mod c_api;
pub mod description;
pub mod documentation;
pub mod instance;
pub mod library;
pub mod model;
pub mod part;
pub mod signal;
pub mod standard;
mod tunable;
pub mod variable;

pub use instance::Instance;
pub use library::Library;
pub use part::Part;
pub use standard::Standard;
