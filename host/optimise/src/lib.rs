//! Many runs of one drive, as a library: no command line and no port; nothing is printed.
//!
//! | module | holds |
//! |---|---|
//! | [`ensemble`] | a run with its perturbed runs |
//! | [`sweep`] | many runs of one rig: what varies, what is collected, on all cores |
//! | [`tuning`] | gains for a step, on rigs within a spread |
//! | [`positioning`] | how well a control law positions: steps and sines on drawn rigs, and the bound on the time of a step |
//! | [`sensitivity`] | which value that nobody has measured moves the transient most |
//! | [`runnable`] | which value keeps a rig from running |
//! | [`ladder`] | what each model of a component costs, and what it changes |
//! | `runners` | runs in the memory of those before |

#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod ensemble;
pub mod ladder;
pub mod positioning;
pub mod runnable;
mod runners;
pub mod sensitivity;
pub mod sweep;
pub mod tuning;
