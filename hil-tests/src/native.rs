//! Programs that talk to an application which runs natively: TCP replaces the serial port.

use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};

use anyhow::Result;
use pneudrive_app::{Board, Control, Server};

/// A port of this machine that nobody else has.
pub(crate) fn listener() -> Result<TcpListener> {
    let listener = TcpListener::bind("127.0.0.1:0")?;
    listener.set_nonblocking(true)?;
    Ok(listener)
}

/// Its name for a client.
pub(crate) fn port_name(listener: &TcpListener) -> Result<String> {
    Ok(format!("tcp://{}", listener.local_addr()?))
}

/// Whoever calls next, if anybody does.
pub(crate) fn accepted(listener: &TcpListener) -> Option<TcpStream> {
    let (caller, _) = listener.accept().ok()?;
    caller.set_nonblocking(true).ok()?;
    caller.set_nodelay(true).ok()?;
    Some(caller)
}

/// How many bytes have come; None once the other side has gone.
pub(crate) fn read(from: &mut TcpStream, bytes: &mut [u8]) -> Option<usize> {
    match from.read(bytes) {
        Ok(0) if !bytes.is_empty() => None,
        Ok(count) => Some(count),
        Err(error) if error.kind() == ErrorKind::WouldBlock => Some(0),
        Err(_) => None,
    }
}

/// Those who have called, each with a server of its own.
pub(crate) struct Callers {
    listener: TcpListener,
    callers: Vec<(TcpStream, Server)>,
}

impl Callers {
    pub fn new(listener: TcpListener) -> Callers {
        Callers { listener, callers: Vec::new() }
    }

    /// Carries out the requests that have come.
    pub fn listen(&mut self, control: &mut Control, board: &mut impl Board) {
        if let Some(caller) = accepted(&self.listener) {
            self.callers.push((caller, Server::default()));
        }
        self.callers.retain_mut(|(caller, server)| {
            let (mut bytes, mut replies) = ([0; 1024], Vec::new());
            let Some(count) = read(caller, &mut bytes) else { return false };
            let Ok(()) = server.receive(&bytes[..count], control, board, &mut replies);
            server.attend(control);
            let Ok(()) = server.speak(&mut replies);
            caller.write_all(&replies).is_ok()
        });
    }

    /// The streams take a sample.
    pub fn attend(&mut self, control: &mut Control) {
        self.callers.iter_mut().for_each(|(_, server)| server.attend(control));
    }

    /// Whether a stream would lose samples if the run went on now.
    pub fn wait_for_host(&self) -> bool {
        self.callers.iter().any(|(_, server)| server.waits_for_host())
    }
}
