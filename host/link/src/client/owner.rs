//! The owner of the drive: the session that armed it, while it is heard. And the boot of the rig.

use std::hash::{BuildHasher, RandomState};

use anyhow::{Context, Result};
use pneudrive_controller::config::unwatched;
use pneudrive_controller::{Fault, Parameters};
use pneudrive_protocol::session::{self, NO_BOOT};
use pneudrive_protocol::{Owner, Presence, ReplyBody, RequestBody};
use pneudrive_records::untrusted::{NAME, sanitised};
use pneudrive_records::words;

use super::Client;
use super::answer::unexpected;
use crate::failure::Failure;

/// The host that commands a drive.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Commander {
    /// Whether a host commands the drive.
    pub presence: Presence,
    /// Its session.
    pub session: u32,
    /// Time since it was last heard, milliseconds; 0 if the rig has no clock for that.
    pub silent_ms: u32,
    /// Its name, as it states it.
    pub host: String,
}

impl From<&Owner<'_>> for Commander {
    fn from(owner: &Owner<'_>) -> Commander {
        let Owner { presence, session, silent_ms, host } = *owner;
        Commander { presence, session, silent_ms, host: sanitised(host, NAME) }
    }
}

/// A random session number, unlikely to be that of another host.
pub(super) fn any_session() -> u32 {
    let drawn = RandomState::new().hash_one(std::process::id()) as u32;
    session::FIRST + drawn % (session::INPUTS - session::FIRST)
}

/// The name of this program.
fn host_name() -> String {
    format!("pneudrive, process {}", std::process::id())
}

/// Names the checks that are off, and the remedy.
fn checks_are_off(name: &str, off: &[Fault]) -> String {
    let names: Vec<&str> = off.iter().map(|check| words::fault_name(*check)).collect();
    let names = names.join(",");
    format!(
        "{name}: its parameters switch checks off, so the drive would never trip with: {names}. Set them again (the keys safety.* of the rig file, for sensor-range sensors.pressure_max_pa; `pneudrive rig check` says why), or arm it with `--without {names}` if that is meant (`pneudrive device --without {names} --port ...`)"
    )
}

impl Client {
    /// The number of the rig's boot.
    pub(super) fn number_of_boot(&mut self) -> Result<u32> {
        self.ask(RequestBody::Boot, |reply| match reply {
            ReplyBody::Boot { number } => Ok(*number),
            other => Err(unexpected(other)),
        })
    }

    /// The number of the boot of the rig that its requests are meant for; 0 where the rig does not count them.
    #[must_use]
    pub fn boot(&self) -> u32 {
        self.boot
    }

    /// The name of the port, as it was opened.
    #[must_use]
    pub fn port_name(&self) -> &str {
        &self.name
    }

    /// Whether its requests name the boot of the rig, so that a delayed copy of one is refused after a reset.
    #[must_use]
    pub fn names_its_boot(&self) -> bool {
        self.boot != NO_BOOT
    }

    /// Who commands the drive.
    ///
    /// # Errors
    /// When the rig does not answer.
    pub fn owner(&mut self) -> Result<Commander> {
        self.ask(RequestBody::Owner, |reply| match reply {
            ReplyBody::Owner(owner) => Ok(owner.into()),
            other => Err(unexpected(other)),
        })
    }

    /// Whether this client has armed the drive, or taken it over, and has not disarmed it since.
    #[must_use]
    pub fn commands(&self) -> bool {
        self.commands
    }

    /// From now on [`Client::arm`] enables a drive whose parameters switch these checks off.
    pub fn accept_without(&mut self, checks: &[Fault]) {
        self.without.extend(checks);
    }

    /// The checks that these parameters switch off ([`unwatched`]), as [`Client::arm`] judges them.
    ///
    /// # Errors
    /// When a check is switched off that it was not told to do without.
    pub fn refuse_unwatched(&self, parameters: &Parameters) -> Result<Vec<Fault>> {
        let off: Vec<Fault> = unwatched(parameters).collect();
        if off.iter().any(|check| !self.without.contains(check)) {
            return Err(Failure::Refused.error(checks_are_off(&self.name, &off)));
        }
        Ok(off)
    }

    /// Enables the drive, and returns the checks that its parameters switch off ([`unwatched`]). This client commands it
    /// until it is disarmed or trips, or the client is dropped.
    ///
    /// # Errors
    /// When a check is switched off that it was not told to do without, when the drive refuses, for instance because
    /// another host commands it, or does not answer.
    pub fn arm(&mut self) -> Result<Vec<Fault>> {
        let parameters = self.scalars()?.values;
        let off = self.refuse_unwatched(&parameters)?;
        self.ask_done(RequestBody::Arm { host: &host_name() })?;
        self.commands = true;
        Ok(off)
    }

    /// Takes command of a drive that another host armed and left. A drive without an owner stays as it is.
    ///
    /// # Errors
    /// When another host commands it, or the rig does not answer.
    pub fn take_over(&mut self) -> Result<()> {
        let owner = self.owner()?;
        match owner.presence {
            Presence::There if owner.session != self.session => {
                let owned = words::owned(owner.presence, &owner.host, owner.silent_ms);
                Err(Failure::Refused.error(format!("{}: {owned}", self.name)))
            }
            Presence::Gone => {
                self.ask_done(RequestBody::TakeOver { host: &host_name() })?;
                self.commands = true;
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// Sends the token to a rig. A rig that needs none goes on without.
    pub(super) fn send_token(&mut self, token: &str) -> Result<()> {
        let name = self.name.clone();
        let recent = self.ask_for_any(RequestBody::Token { token }, |reply| match reply {
            ReplyBody::Done => Ok(()),
            other => Err(unexpected(other)),
        });
        recent.with_context(|| format!("{name}: was it started with another PNEUDRIVE_TOKEN?"))
    }

    /// Stops at once.
    ///
    /// # Errors
    /// When it is not answered.
    pub fn stop(&mut self) -> Result<()> {
        self.ask_done(RequestBody::Stop)
    }

    /// Disables the drive.
    ///
    /// # Errors
    /// When another host commands it, or it is not answered.
    pub fn disarm(&mut self) -> Result<()> {
        self.ask_done(RequestBody::Disarm)?;
        self.commands = false;
        Ok(())
    }
}

impl Drop for Client {
    /// Tells the rig that its owner leaves, so that the next program need not wait for the timeout.
    fn drop(&mut self) {
        if self.commands {
            self.sequence = self.sequence.wrapping_add(1);
            // If the link is broken, the rig notices that itself a moment later.
            let _ = self.send(self.sequence, RequestBody::Leave);
        }
    }
}
