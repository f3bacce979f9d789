//! What the Nucleo board computes for its hardware, without the hardware: the PC tests it, the image
//! writes the results into registers.
//!
//! | module | holds |
//! |---|---|
//! | [`flash`] | which sectors hold what |
//! | [`options`] | the supply voltage below which the chip is held in reset |
//! | [`oscillator`] | what is shown while the board's clock is missing |
//! | [`watchdog`] | the independent watchdog's times |
#![no_std]
#![forbid(unsafe_code)]

pub mod flash;
pub mod options;
pub mod oscillator;
pub mod watchdog;
