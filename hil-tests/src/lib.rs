//! Execution levels that run the firmware, behind one trait: tests are written once ([`body`]) and run on
//! each.
//!
//! | execution level | is |
//! |---|---|
//! | [`VirtualTarget`] | the virtual rig, over TCP and over a pty |
//! | [`QemuTarget`] | the image for a Cortex-M4, in the emulator |
//! | [`linked::LinkedTarget`] | the application natively, its plant at a second port, over TCP |
//! | [`wired::WiredTarget`] | the application natively, on models of the chips of `pneudrive_interfaces::spi_board`, over TCP |
//! | [`board`] | the image on a board, where one is named: `cargo xtask hil` |
//!
//! [`emulated_board`] is that emulator with its plant, [`board_plant`] the plant of a board, over its second serial port.
//! [`converter`] is what converters of a board make of codes and voltages.

#[cfg(unix)]
pub mod board;
#[cfg(unix)]
pub mod board_plant;
pub mod body;
pub mod converter;
#[cfg(unix)]
pub mod cost;
#[cfg(unix)]
mod emulated;
#[cfg(unix)]
pub mod emulated_board;
pub mod golden;
pub mod linked;
mod native;
#[cfg(unix)]
mod plant_server;
#[cfg(unix)]
pub mod requests;
#[cfg(unix)]
pub mod rounding;
#[cfg(unix)]
mod sample_cost;
mod service;
#[cfg(unix)]
pub mod shell;
pub mod wired;

use std::time::Duration;

use anyhow::Result;
use pneudrive_link::client::Client;
use pneudrive_rigs::persistent_flash::PersistentFlash;
use pneudrive_rigs::timing::LateSample;
use pneudrive_rigs::virtual_rig::{Background, Listener, Pace, VirtualRig};
use pneudrive_sim::Rig;

#[cfg(unix)]
pub use emulated::{QemuTarget, board_runner, board_server, image, program};
pub use service::commission;

/// How long an execution level on this machine may keep silent: a busy machine lets its threads and processes wait.
const PATIENCE: Duration = Duration::from_secs(20);

/// An execution level with a port to talk to.
pub trait Target {
    /// Name for messages.
    fn name(&self) -> &str;

    /// The port's name for a client.
    fn port(&self) -> &str;

    /// A new connection to it.
    ///
    /// # Errors
    /// When nobody answers.
    fn connect(&self) -> Result<Client> {
        Client::connect_patiently(self.port(), PATIENCE)
    }

    /// Sets the digital inputs, as [`pneudrive_protocol::io::input`] has their bits: by a request, or at the pins of a board
    /// that has them.
    ///
    /// # Errors
    /// When it does not answer.
    fn set_inputs(&self, client: &mut Client, inputs: u8) -> Result<()> {
        client.set_inputs(inputs)
    }

    /// What its runs have cost, where that is known.
    fn cost(&self) -> Option<String> {
        None
    }
}

/// An execution level whose power can be cut.
pub trait Supplied: Target {
    /// The power goes in the middle of the nth write or erase of the flash from now; the next one is the
    /// first.
    fn cut_power_at(&self, nth: u64);

    /// Both slots of the stored configuration read otherwise than they were written.
    fn damage_configuration(&self);

    /// The power comes back, or goes and comes back.
    ///
    /// # Errors
    /// When the execution level does not come up again.
    fn power_up(&mut self) -> Result<()>;
}

/// An execution level that can be made late.
pub trait Delayed: Target {
    /// Sample k of each run comes this much later than it should, microseconds of the board's clock.
    fn delay_sample(&self, k: u64, late_us: u16);
}

/// The firmware's application natively, its plant simulated.
pub struct VirtualTarget {
    name: String,
    rig: Background,
    model: Rig,
    listener: String,
    pace: Pace,
    flash: PersistentFlash,
    late: LateSample,
}

impl VirtualTarget {
    /// A virtual rig that is its model exactly, listening at `listener` (`tcp:127.0.0.1:0` or `pty`), as
    /// fast as it goes.
    ///
    /// # Errors
    /// When the door cannot be opened.
    pub fn start(rig: &Rig, listener: &str) -> Result<VirtualTarget> {
        VirtualTarget::at_pace(rig, listener, Pace { fast: true, live: false })
    }

    /// The same in real time.
    ///
    /// # Errors
    /// When the door cannot be opened.
    pub fn start_in_step(rig: &Rig, listener: &str) -> Result<VirtualTarget> {
        VirtualTarget::at_pace(rig, listener, Pace { fast: false, live: false })
    }

    fn at_pace(model: &Rig, listener: &str, pace: Pace) -> Result<VirtualTarget> {
        let (flash, model, listener) = (PersistentFlash::default(), model.clone(), listener.to_owned());
        let virtual_rig = VirtualRig::with_flash(model.clone(), 0, pace, flash.clone())?;
        let late = virtual_rig.late_sample().clone();
        let rig = Background::start(virtual_rig, Listener::open(&listener)?);
        let name = format!("virtual rig on {}", rig.port());
        Ok(VirtualTarget { name, rig, model, listener, pace, flash, late })
    }
}

impl Delayed for VirtualTarget {
    fn delay_sample(&self, k: u64, late_us: u16) {
        self.late.set(k, late_us);
    }
}

impl Supplied for VirtualTarget {
    fn cut_power_at(&self, nth: u64) {
        self.flash.cut_power_at(nth);
    }

    fn damage_configuration(&self) {
        self.flash.damage_configuration();
    }

    fn power_up(&mut self) -> Result<()> {
        self.flash.switch_on();
        let rig = VirtualRig::with_flash(self.model.clone(), 0, self.pace, self.flash.clone())?;
        self.late = rig.late_sample().clone();
        self.rig = Background::start(rig, Listener::open(&self.listener)?);
        Ok(())
    }
}

impl Target for VirtualTarget {
    fn name(&self) -> &str {
        &self.name
    }

    fn port(&self) -> &str {
        self.rig.port()
    }
}
