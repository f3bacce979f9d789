//! Rigs that are not there: the firmware's application on the simulated plant. Boards with such a plant are `hil-tests`'.
//!
//! | module | holds |
//! |---|---|
//! | [`virtual_rig`] | the firmware's application on the simulated plant |
//! | [`persistent_flash`] | its flash, which outlives it |
//! | [`noise`] | the noise of its sensors, run by run |
//! | [`timing`] | its timing faults |
//! | [`wiring`] | wires that are not where they belong, and the hand that pushes a slide |
//!
//! Nothing is printed.

#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod noise;
pub mod persistent_flash;
pub mod timing;
pub mod virtual_rig;
pub mod wiring;
