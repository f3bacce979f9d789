//! The Nucleo-F446RE.
//!
//! | module | holds |
//! |---|---|
//! | [`flash`] | which sectors hold what |
//! | [`options`] | the supply voltage below which the chip is held in reset |
//! | [`oscillator`] | what is shown while the board's clock is missing |
//! | [`watchdog`] | the independent watchdog's times |

pub mod flash;
pub mod options;
pub mod oscillator;
pub mod watchdog;
