//! A link of bytes to a rig: serial port, pty or TCP.

use std::io::{self, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::Duration;

use anyhow::{Context, Result, bail};

/// Rate of the serial port.
pub const BAUD: u32 = 921_600;

/// How long a read waits for a byte.
const READ_WAIT: Duration = Duration::from_millis(20);

/// A link that reads with a short wait: a read that finds nothing ends as timed out.
pub trait Link: Read + Write + Send {}

impl<T: Read + Write + Send> Link for T {}

/// Opens a port by its name: `tcp://HOST:PORT`, `pty:PATH`, or a serial device.
///
/// # Errors
/// When there is no such port, or another program holds it.
pub fn open(name: &str) -> Result<Box<dyn Link>> {
    if let Some(address) = name.strip_prefix("tcp://") {
        return open_tcp(address).with_context(|| {
            format!("cannot reach a rig at {name}; is one listening there (`pneudrive virtual ... --listen tcp:{address}`)?")
        });
    }
    let path = name.strip_prefix("pty:").unwrap_or(name);
    let port = serialport::new(path, BAUD).timeout(READ_WAIT).open();
    let port = port.map_err(|error| match error.kind() {
        serialport::ErrorKind::NoDevice if error.description.contains("lock") => {
            anyhow::anyhow!("another program has {path} open; end it first")
        }
        _ => anyhow::Error::new(error).context(format!("cannot open {path}{}", available())),
    })?;
    Ok(Box::new(port))
}

fn open_tcp(address: &str) -> Result<Box<dyn Link>> {
    let Some(address) = address.to_socket_addrs()?.next() else { bail!("{address} has no address") };
    let stream = TcpStream::connect_timeout(&address, Duration::from_secs(3))?;
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(READ_WAIT))?;
    Ok(Box::new(stream))
}

/// The serial ports there are, for the end of an error message.
fn available() -> String {
    let ports = serialport::available_ports().unwrap_or_default();
    if ports.is_empty() {
        return " (no serial port was found on this machine)".to_owned();
    }
    let names: Vec<String> = ports.into_iter().map(|port| port.port_name).collect();
    format!(" (serial ports here: {})", names.join(", "))
}

/// Bytes that are there: none when the wait is over.
///
/// # Errors
/// When the port is gone.
pub fn read_some(link: &mut dyn Link, buffer: &mut [u8]) -> io::Result<usize> {
    match link.read(buffer) {
        Ok(0) => Err(io::Error::new(io::ErrorKind::UnexpectedEof, "the rig closed the link")),
        Ok(count) => Ok(count),
        Err(error) if is_wait(&error) => Ok(0),
        Err(error) => Err(error),
    }
}

/// Whether an error only says that there is nothing now.
#[must_use]
pub fn is_wait(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted)
}
