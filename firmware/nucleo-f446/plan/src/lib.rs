//! What the Nucleo board computes for its hardware, without the hardware: the PC tests it, the image
//! writes the results into registers.
//!
//! | module | holds |
//! |---|---|
//! | [`time`] | microseconds of the timers: when the next sample and its output are due |
//! | [`pulse`] | the step pulse of a translator as values of a one-pulse timer |
//! | [`input`] | counts and conversions as a sample |
//! | [`flash`] | which sectors hold what |
//! | [`options`] | the supply voltage below which the chip is held in reset |
//! | [`oscillator`] | what is shown while the board's clock is missing |
//! | [`reset`] | why the board was reset |
//! | [`ring`] | what has come into a circular buffer |
//! | [`spool`] | where a stepper's spool is, through a reset |
//! | [`watchdog`] | the independent watchdog's times |
#![no_std]
#![forbid(unsafe_code)]

pub mod flash;
pub mod input;
pub mod options;
pub mod oscillator;
pub mod pulse;
pub mod reset;
pub mod ring;
pub mod spool;
pub mod time;
pub mod watchdog;
