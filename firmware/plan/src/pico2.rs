//! The Pico 2.
//!
//! | module | holds |
//! |---|---|
//! | [`clocks`] | the crystal's clock and the watchdog's, and whether they agree |
//! | [`flash`] | what is where in the flash |
//! | `quadrature` | the program of the state machine that counts the encoder's edges (feature `pio`) |

pub mod clocks;
pub mod flash;
#[cfg(any(test, feature = "pio"))]
pub mod quadrature;
