//! What the Pico 2 board computes for its hardware, without the hardware: the PC tests it, the image writes the
//! results into registers.
//!
//! | module | holds |
//! |---|---|
//! | [`clocks`] | the crystal's clock and the watchdog's, and whether they agree |
//! | [`flash`] | where in the flash what is |
//! | [`quadrature`] | the program of the state machine that counts the encoder's edges |
#![no_std]
#![forbid(unsafe_code)]

pub mod clocks;
pub mod flash;
pub mod quadrature;
