//! The runtime of every board that drives a real cylinder, whatever its chip.
//!
//! | module | holds |
//! |---|---|
//! | [`instants`] | when samples and outputs are due, in microseconds of a free-running counter |
//! | [`clock`] | those instants on a timer with two compare channels |
//! | [`drive`] | the control, its board and its clock: called by the control interrupt |
//! | [`talk`] | the idle task: requests, streams, storage, watchdog |
//! | [`ring`] | the bytes in a circular buffer that the hardware fills |
//! | [`pulse`] | the step pulse of a translator as values of a one-pulse timer |
//! | [`reset`] | why the board was reset |
//! | [`spool`] | the spool location of a stepper valve, as words of memory that a reset leaves as they are |
//!
//! A board adds its start-up, the [`clock::Timer`], the [`talk::Port`], the [`talk::Watchdog`] and a flash
//! (`embedded_storage::nor_flash::NorFlash`).

pub mod clock;
pub mod drive;
pub mod instants;
pub mod pulse;
pub mod reset;
pub mod ring;
pub mod spool;
pub mod talk;
