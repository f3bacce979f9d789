//! The line to the host: the board's USART2 as a TCP port, one host at a time as at a serial port.

use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};

use anyhow::{Context, Result};

/// The line.
pub struct Line {
    listener: TcpListener,
    host: Option<TcpStream>,
}

impl Line {
    /// A line at a free port.
    ///
    /// # Errors
    /// When there is none.
    pub fn open() -> Result<Line> {
        let listener = TcpListener::bind("127.0.0.1:0").context("no port for the board's line")?;
        listener.set_nonblocking(true)?;
        Ok(Line { listener, host: None })
    }

    /// The port's name for a client.
    ///
    /// # Errors
    /// When the system does not tell it.
    pub fn port(&self) -> Result<String> {
        Ok(format!("tcp://{}", self.listener.local_addr()?))
    }

    /// What the host has said meanwhile.
    pub fn heard(&mut self) -> Vec<u8> {
        if self.host.is_none() {
            self.host = self.listener.accept().ok().and_then(|(host, _)| ready(host).ok());
        }
        let Some(host) = &mut self.host else { return Vec::new() };
        let mut bytes = [0; 4096];
        match host.read(&mut bytes) {
            Ok(count) if count > 0 => return bytes[..count].to_vec(),
            Err(error) if error.kind() == ErrorKind::WouldBlock => {}
            _ => self.host = None,
        }
        Vec::new()
    }

    /// Says something to the host; one that does not take it has gone.
    pub fn say(&mut self, bytes: &[u8]) {
        if !bytes.is_empty() && self.host.as_mut().is_some_and(|host| host.write_all(bytes).is_err()) {
            self.host = None;
        }
    }

    /// The board has no power: whoever is connected notices.
    pub fn hang_up(&mut self) {
        self.host = None;
    }
}

fn ready(host: TcpStream) -> Result<TcpStream> {
    host.set_nonblocking(true)?;
    host.set_nodelay(true)?;
    Ok(host)
}
