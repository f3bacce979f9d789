//! Simulated rigs: the firmware's application, or its image, on the simulated plant.
//!
//! | module | holds |
//! |---|---|
//! | [`virtual_rig`] | the firmware's application on the simulated plant |
//! | [`emulated_board`] | the image of the firmware in QEMU, on the simulated plant |
//! | [`board_plant`] | the simulated plant of a real board, over its second serial port |
//! | [`persistent_flash`] | their flash, which outlives them |
//! | [`timing`] | their timing faults |
//! | [`wiring`] | wires that are not where they belong, and the hand that pushes a slide |
//!
//! Nothing is printed: notes go to the log.

#![deny(clippy::print_stdout, clippy::print_stderr)]

#[cfg(unix)]
pub mod board_plant;
#[cfg(unix)]
pub mod emulated_board;
mod noise;
pub mod persistent_flash;
#[cfg(unix)]
mod plant_server;
#[cfg(unix)]
mod sample_cost;
pub mod timing;
pub mod virtual_rig;
pub mod wiring;
