//! Where a virtual rig listens, and its callers.

use std::net::{TcpListener, TcpStream};
use std::time::Instant;

use anyhow::{Context, Result, bail};

use super::caller::{Caller, Token};
use super::gate;

/// Programs that are accepted between two polls of those that are there.
const AT_ONCE: usize = 8;

/// A listening port.
pub struct Listener {
    listener: Option<TcpListener>,
    token: Option<Token>,
    pub(super) callers: Vec<Caller>,
    /// Callers that wait for a place at the gate.
    newcomer: Option<TcpStream>,
    name: String,
    /// The far end of a pty, held open so that ours stays open without a client.
    _far_end: Option<Box<dyn Send>>,
}

impl Listener {
    /// Listens at `pty` or `tcp:HOST:PORT`, for programs on this machine only.
    ///
    /// # Errors
    /// When it cannot listen at the address, the address can be reached from a network, or there are no ptys.
    pub fn open(at: &str) -> Result<Listener> {
        Listener::open_with(at, None)
    }

    /// The same, for programs that know the token. An address that can be reached from a network needs one.
    ///
    /// # Errors
    /// When it cannot listen at the address, the address needs a token, or there are no ptys.
    pub fn open_with(at: &str, token: Option<Token>) -> Result<Listener> {
        match at.strip_prefix("tcp:").map(|address| address.trim_start_matches("//")) {
            Some(address) => {
                let listener =
                    TcpListener::bind(address).with_context(|| format!("cannot listen at {at}"))?;
                listener.set_nonblocking(true)?;
                let local = listener.local_addr()?;
                if token.is_none() && !local.ip().is_loopback() {
                    bail!(
                        "{at} can be reached from the network, where anyone could move the drive: set the same PNEUDRIVE_TOKEN here and for the programs that may, or listen at tcp:127.0.0.1:{}",
                        local.port()
                    );
                }
                let name = format!("tcp://{local}");
                let (listener, callers) = (Some(listener), Vec::new());
                Ok(Listener { listener, token, callers, newcomer: None, name, _far_end: None })
            }
            None if at == "pty" => Listener::open_pty(),
            None => bail!("--listen takes pty or tcp:HOST:PORT, such as tcp:127.0.0.1:4000; not {at:?}"),
        }
    }

    #[cfg(unix)]
    fn open_pty() -> Result<Listener> {
        let (master, slave) = pty::pair().context("cannot open a pty")?;
        let path = nix::unistd::ttyname(&slave).context("the pty has no name")?;
        let name = format!("pty:{}", path.display());
        let callers = vec![Caller::new(master, None)];
        let _far_end: Option<Box<dyn Send>> = Some(Box::new(slave));
        Ok(Listener { listener: None, token: None, callers, newcomer: None, name, _far_end })
    }

    #[cfg(not(unix))]
    fn open_pty() -> Result<Listener> {
        bail!("there are no ptys on this system; listen at tcp:127.0.0.1:4000")
    }

    /// The port's name for a client.
    #[must_use]
    pub fn port_name(&self) -> &str {
        &self.name
    }

    /// Whether programs must know a token.
    #[must_use]
    pub fn asks_for_a_token(&self) -> bool {
        self.token.is_some()
    }

    /// Accepts waiting programs, as far as there is room at the gate.
    pub(super) fn admit(&mut self, now: Instant) {
        gate::send_away(&mut self.callers, now);
        for _ in 0..AT_ONCE {
            if self.newcomer.is_none() {
                self.newcomer = self
                    .listener
                    .as_ref()
                    .and_then(|listener| listener.accept().ok())
                    .map(|(stream, _)| stream);
            }
            if self.newcomer.is_none() || !gate::makes_room(&mut self.callers, now) {
                return;
            }
            let Some(stream) = self.newcomer.take() else { return };
            if stream.set_nonblocking(true).and(stream.set_nodelay(true)).is_ok() {
                self.callers.push(Caller::new(stream, self.token.clone()));
            }
        }
    }
}

#[cfg(unix)]
mod pty {
    use std::fs::File;
    use std::os::fd::OwnedFd;

    use nix::fcntl::{FcntlArg, FdFlag, OFlag, fcntl};
    use nix::pty::openpty;
    use nix::sys::termios::{SetArg, cfmakeraw, tcgetattr, tcsetattr};

    /// Both ends of a pty that carries every byte as it is. Reading or writing the first one does not wait. Programs that are started
    /// meanwhile get neither: one that lived on would keep a port open that has gone.
    pub fn pair() -> nix::Result<(File, OwnedFd)> {
        let pair = openpty(None, None)?;
        for end in [&pair.master, &pair.slave] {
            fcntl(end, FcntlArg::F_SETFD(FdFlag::FD_CLOEXEC))?;
        }
        fcntl(&pair.master, FcntlArg::F_SETFL(OFlag::O_NONBLOCK))?;
        let mut settings = tcgetattr(&pair.slave)?;
        cfmakeraw(&mut settings);
        tcsetattr(&pair.slave, SetArg::TCSANOW, &settings)?;
        Ok((pair.master.into(), pair.slave))
    }
}

#[cfg(all(test, unix))]
mod tests {
    use std::process::Command;

    use pneudrive_link::port;

    use super::*;

    #[test]
    fn a_port_goes_though_a_program_lives_on_that_was_started_meanwhile() {
        let listener = Listener::open("pty").expect("a pty");
        let mut other = Command::new("sleep").arg("60").spawn().expect("it starts");
        let mut link = port::open(listener.port_name()).expect("it is there");
        drop(listener);
        let is_gone = (0..100).any(|_| link.read(&mut [0; 8]).is_err());
        other.kill().and_then(|()| other.wait()).expect("it ends");
        assert!(is_gone);
    }
}
