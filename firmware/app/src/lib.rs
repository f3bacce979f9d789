//! The firmware of the drive without its board: everything except pins, clocks and interrupts.
//!
//! A board owns an [`App`] and calls it from four places:
//!
//! | call | from | priority | deadline |
//! |---|---|---|---|
//! | [`Control::on_sample`] | timer, at k * period | highest | before the output |
//! | [`Control::on_output`] | timer, `delay` later | highest | before the next sample |
//! | [`Server::receive_beside`] | serial port | below | none; a request locks out the two above for short pieces of its work ([`SharedDrive`]) |
//! | [`inputs::attend`] | idle task, once a sample | below | none; a stop by an input waits for it |
//! | [`Server::attend`], [`Server::speak`] | idle task | below | none; streams lose the samples for which it is late |
//!
//! A sample that comes later than the configuration allows trips the supervisor; it is never made up for. The [`Control`]
//! half and the [`Server`] half share only the requests that the server hands to the control half, one at a time.
//!
//! The same code runs natively as the virtual rig and on the microcontroller. A board with a simulated plant
//! exchanges data with it over the [`plant_bus`] and is a [`LockStep`].
//!
//! Long functions that neither interrupt calls are marked cold. The compiler then makes them small and does not
//! inline them.
#![no_std]
#![forbid(unsafe_code)]

pub mod board;
pub mod change;
pub mod configuration;
pub mod control;
mod duplicate_filter;
pub mod fault_log;
pub mod flash_bus;
pub mod inputs;
pub mod lamp;
pub mod lock_step;
mod log;
pub mod move_records;
pub mod moves;
pub mod name;
pub mod ownership;
pub mod plant_bus;
pub mod plant_link;
pub mod ram_flash;
pub mod recorder;
pub mod runtime;
pub mod selector;
pub mod server;
pub mod shared_drive;
pub mod storage;
pub mod store;
pub mod stream;
pub mod timing;

pub use board::Board;
pub use control::Control;
pub use lock_step::LockStep;
pub use recorder::Recorder;
pub use server::Server;
pub use shared_drive::SharedDrive;
pub use store::Store;

/// The build and its sources: the version, and the commit if it is known.
pub const BUILD: &str = env!("PNEUDRIVE_BUILD");

/// Both halves, for boards that run them from one thread.
#[derive(Debug, Default)]
pub struct App {
    /// The half with a deadline.
    pub control: Control,
    /// The half that talks.
    pub server: Server,
}
