//! Rungs that run the firmware, behind one trait: tests are written once ([`body`]) and run on
//! each.
//!
//! | rung | is |
//! |---|---|
//! | [`VirtualTarget`] | the virtual rig, over TCP and over a pty |
//! | [`QemuTarget`] | the image for a Cortex-M4, in the emulator |
//!
//! The board will be a further implementation of [`Target`].

pub mod body;
#[cfg(unix)]
pub mod cost;
#[cfg(unix)]
mod emulated;

use anyhow::Result;
use pneudrive::client::Client;
use pneudrive::virtual_rig::{Background, Door, Pace, VirtualRig};
use pneudrive_sim::Rig;

#[cfg(unix)]
pub use emulated::{QemuTarget, image, program};

/// A rung with a port to talk to.
pub trait Target {
    /// Name for messages.
    fn name(&self) -> &str;
    /// A new connection to it.
    ///
    /// # Errors
    /// When nobody answers.
    fn connect(&self) -> Result<Client>;

    /// What its runs have cost, where that is known.
    fn cost(&self) -> Option<String> {
        None
    }
}

/// The firmware's application natively, its plant simulated.
pub struct VirtualTarget {
    name: String,
    rig: Background,
}

impl VirtualTarget {
    /// A virtual rig that is its model exactly, listening at `door` (`tcp:127.0.0.1:0` or `pty`), as
    /// fast as it goes.
    ///
    /// # Errors
    /// When the door cannot be opened.
    pub fn start(rig: &Rig, door: &str) -> Result<VirtualTarget> {
        let virtual_rig = VirtualRig::new(rig.clone(), 0, Pace { fast: true, live: false })?;
        let rig = Background::start(virtual_rig, Door::open(door)?);
        Ok(VirtualTarget { name: format!("virtual rig on {}", rig.port()), rig })
    }
}

impl Target for VirtualTarget {
    fn name(&self) -> &str {
        &self.name
    }

    fn connect(&self) -> Result<Client> {
        Client::connect(self.rig.port())
    }
}
