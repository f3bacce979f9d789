//! A byte link to a rig: serial port, pty or TCP.
//!
//! Known troubles of serial ports, and the measures against them:
//!
//! - *A read ignores its timeout.* A separate thread reads, and the program waits for it with its own clock: a read that
//!   returns at once, or never, does no harm.
//! - *Draining blocks forever* if nobody reads. Nothing is drained; requests that do not arrive are repeated.
//! - *DTR and RTS reset some boards.* The system sets both when a port is opened, and they stay set until it is closed. A
//!   board with its reset on one of them is reset by each program that opens the port; there is time for it to boot. The
//!   ST-LINK of a Nucleo board passes neither on.
//! - *Two programs on one port* each get half of the bytes. The port is locked, and a locked port is refused by name.
//! - *Noise at start-up* is not a frame and is skipped, whatever its bytes.

use std::io::{self, Read, Write};
use std::net::{SocketAddr, TcpStream, ToSocketAddrs};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};

/// Rate of the serial port, bits a second; a byte is ten.
pub const BAUD: u32 = 921_600;

/// How long a read waits for a byte.
pub const READ_WAIT: Duration = Duration::from_millis(20);

/// Time between two polls of a port that has no bytes and does not wait, or accepts none.
const LOOK_AGAIN: Duration = Duration::from_micros(200);

/// How long a write may be blocked.
const WRITE_WAIT: Duration = Duration::from_secs(1);

/// Bytes to and from a rig, and the clock by which answers are waited for.
pub trait Link: Send {
    /// Reads bytes, waiting for at most [`READ_WAIT`]; 0 if none came.
    ///
    /// # Errors
    /// When the port is gone.
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize>;

    /// Sends all the bytes.
    ///
    /// # Errors
    /// When the port is gone, or accepts nothing.
    fn write(&mut self, bytes: &[u8]) -> io::Result<()>;

    /// Time since some instant.
    fn now(&self) -> Duration;
}

/// Opens a port by its name: `tcp://HOST:PORT`, `pty:PATH`, or a serial device.
///
/// # Errors
/// When there is no such port, or another program holds it.
pub fn open(name: &str) -> Result<Box<dyn Link>> {
    if let Some(address) = address(name) {
        return open_tcp(address).with_context(|| {
            format!("cannot reach a rig at {name}; is one listening there (`pneudrive virtual ... --listen tcp:{address}`)?")
        });
    }
    open_serial(name.strip_prefix("pty:").unwrap_or(name))
}

/// A prefix before a colon that is not a host.
const OTHER_SCHEMES: [&str; 4] = ["pty", "udp", "unix", "serial"];

/// The address in the name of a port: `tcp://HOST:PORT`, `TCP:HOST:PORT` or `HOST:PORT`; None of a device.
#[must_use]
pub fn address(name: &str) -> Option<&str> {
    if let Some((scheme, rest)) = name.split_at_checked(4)
        && scheme.eq_ignore_ascii_case("tcp:")
    {
        return Some(rest.trim_start_matches('/'));
    }
    let (host, number) = name.rsplit_once(':')?;
    let is_scheme = OTHER_SCHEMES.iter().any(|scheme| host.eq_ignore_ascii_case(scheme));
    let is_host = !host.is_empty() && !is_scheme && !host.contains(['/', '\\']);
    (is_host && number.parse::<u16>().is_ok()).then_some(name)
}

/// The message about a name that belongs to another system.
fn of_another_system(path: &str) -> &'static str {
    let number = path.split_at_checked(3).filter(|(com, _)| com.eq_ignore_ascii_case("com"));
    let is_com = number.is_some_and(|(_, number)| number.trim_end_matches(':').parse::<u16>().is_ok());
    if is_com && !cfg!(windows) { ", a name of a port of Windows" } else { "" }
}

fn open_serial(path: &str) -> Result<Box<dyn Link>> {
    let port = serialport::new(path, BAUD).timeout(READ_WAIT).dtr_on_open(true).open();
    let port = port.map_err(|error| {
        if is_held(&error) {
            anyhow::anyhow!("another program has {path} open; close it first")
        } else {
            anyhow::Error::new(error).context(format!(
                "cannot open {path}{}{}",
                of_another_system(path),
                available()
            ))
        }
    })?;
    let reader = port.try_clone().with_context(|| format!("cannot read from {path}"))?;
    Ok(Box::new(Wire::new(reader, port)))
}

/// Whether a port could not be opened because another program holds it, by a lock or exclusively (EBUSY).
fn is_held(error: &serialport::Error) -> bool {
    let text = error.description.to_lowercase();
    text.contains("lock") || text.contains("busy")
}

fn open_tcp(address: &str) -> Result<Box<dyn Link>> {
    let stream = first_that_answers(address)?;
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(READ_WAIT))?;
    stream.set_write_timeout(Some(READ_WAIT))?;
    Ok(Box::new(Wire::new(stream.try_clone()?, stream)))
}

/// Connects to the first address of a name that answers: a name may have an IPv6 address on which nobody listens.
fn first_that_answers(name: &str) -> Result<TcpStream> {
    let addresses: Vec<SocketAddr> = name.to_socket_addrs()?.collect();
    connected(name, &addresses)
}

fn connected(name: &str, addresses: &[SocketAddr]) -> Result<TcpStream> {
    let mut last = None;
    for address in addresses {
        match TcpStream::connect_timeout(address, Duration::from_secs(3)) {
            Ok(stream) => return Ok(stream),
            Err(error) => last = Some(error),
        }
    }
    let Some(last) = last else { bail!("{name} has no address") };
    let tried: Vec<String> = addresses.iter().map(SocketAddr::to_string).collect();
    Err(anyhow::Error::new(last).context(format!("no answer from {}", tried.join(", "))))
}

/// The available serial ports, for the end of an error message.
fn available() -> String {
    let ports = serialport::available_ports().unwrap_or_default();
    if ports.is_empty() {
        return " (no serial port was found on this machine)".to_owned();
    }
    let names: Vec<String> = ports.into_iter().map(|port| port.port_name).collect();
    format!(" (serial ports here: {})", names.join(", "))
}

/// A message of the reading thread: bytes, or the error that ends it.
type Heard = io::Result<Vec<u8>>;

/// A system stream, read by a separate thread.
pub struct Wire<W> {
    stream: W,
    heard: Receiver<Heard>,
    /// Bytes that were read and not yet returned.
    rest: Vec<u8>,
    closed: Arc<AtomicBool>,
    since: Instant,
}

impl<W: Write> Wire<W> {
    /// A wire of two ends of the same stream.
    pub fn new(reader: impl Read + Send + 'static, writer: W) -> Wire<W> {
        // Bounded: a program that does not read blocks the other side, as without the thread.
        let (say, heard) = sync_channel(16);
        let closed = Arc::new(AtomicBool::new(false));
        let watched = Arc::clone(&closed);
        std::thread::spawn(move || listen(reader, &say, &watched));
        Wire { stream: writer, heard, rest: Vec::new(), closed, since: Instant::now() }
    }
}

/// Reads until the stream ends or the wire is closed.
fn listen(mut reader: impl Read, say: &SyncSender<Heard>, closed: &AtomicBool) {
    let mut bytes = [0; 4096];
    while !closed.load(Ordering::Relaxed) {
        let heard = match read_some(&mut reader, &mut bytes) {
            Ok(0) => {
                // Negligible for a read that keeps its timeout, and needed for one that returns at once.
                std::thread::sleep(LOOK_AGAIN);
                continue;
            }
            Ok(count) => Ok(bytes[..count].to_vec()),
            Err(error) => Err(error),
        };
        let over = heard.is_err();
        if say.send(heard).is_err() || over {
            break;
        }
    }
}

impl<W: Write + Send> Link for Wire<W> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.rest.is_empty() {
            match self.heard.recv_timeout(READ_WAIT) {
                Ok(heard) => self.rest = heard?,
                Err(RecvTimeoutError::Timeout) => return Ok(0),
                Err(RecvTimeoutError::Disconnected) => return Err(closed_by_the_rig()),
            }
        }
        let count = self.rest.len().min(buffer.len());
        buffer[..count].copy_from_slice(&self.rest[..count]);
        self.rest.drain(..count);
        Ok(count)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        write_within(&mut self.stream, bytes, WRITE_WAIT)
    }

    fn now(&self) -> Duration {
        self.since.elapsed()
    }
}

impl<W> Drop for Wire<W> {
    /// The port is free again once the thread has released its end; a thread that hangs is not waited for.
    fn drop(&mut self) {
        self.closed.store(true, Ordering::Relaxed);
        let deadline = Instant::now() + 5 * READ_WAIT;
        while let Some(left) = deadline.checked_duration_since(Instant::now()) {
            if matches!(self.heard.recv_timeout(left), Err(RecvTimeoutError::Disconnected)) {
                break;
            }
        }
    }
}

/// Reads available bytes; 0 when the wait is over.
///
/// # Errors
/// When the port is gone.
pub fn read_some(stream: &mut (impl Read + ?Sized), buffer: &mut [u8]) -> io::Result<usize> {
    match stream.read(buffer) {
        Ok(0) => Err(closed_by_the_rig()),
        Ok(count) => Ok(count),
        Err(error) if is_wait(&error) => Ok(0),
        Err(error) => Err(error),
    }
}

fn closed_by_the_rig() -> io::Error {
    io::Error::new(io::ErrorKind::UnexpectedEof, "the rig closed the connection")
}

/// Writes everything, waiting for a slow reader, but not for longer than this.
///
/// # Errors
/// When the port is gone, or accepts nothing for too long: then a part may have been sent.
pub(crate) fn write_within(
    stream: &mut (impl Write + ?Sized),
    mut bytes: &[u8],
    wait: Duration,
) -> io::Result<()> {
    let deadline = Instant::now() + wait;
    while !bytes.is_empty() {
        let taken = match stream.write(bytes) {
            Ok(0) => Err(io::ErrorKind::TimedOut.into()),
            taken => taken,
        };
        match taken {
            Ok(count) => bytes = &bytes[count..],
            Err(error) if is_wait(&error) && Instant::now() < deadline => std::thread::sleep(LOOK_AGAIN),
            Err(error) => return Err(error),
        }
    }
    Ok(())
}

/// Whether an error only means that there is nothing now.
#[must_use]
pub fn is_wait(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted)
}

#[cfg(test)]
mod tests {
    use std::net::TcpListener;

    use super::*;

    #[test]
    fn an_address_is_known_however_it_is_written_and_a_device_is_none() {
        for name in ["tcp://rig:4000", "TCP://rig:4000", "tcp:rig:4000", "Tcp:rig:4000", "rig:4000"] {
            assert_eq!(address(name), Some("rig:4000"), "{name}");
        }
        assert_eq!(address("[::1]:4000"), Some("[::1]:4000"));
        for name in
            ["/dev/ttyACM0", "COM3", "COM10", "pty:/tmp/rig", "pty:4", "C:\\x:1", "rig", ":4000", "rig:x"]
        {
            assert_eq!(address(name), None, "{name}");
        }
    }

    /// localhost is ::1 first on many systems, and a rig listens on one of its addresses.
    #[test]
    fn every_address_of_a_name_is_tried() {
        let listening = || TcpListener::bind("127.0.0.1:0").expect("a port");
        let nobody = listening().local_addr().expect("an address");
        let somebody = listening();
        let addresses = [nobody, somebody.local_addr().expect("an address")];
        assert!(connected("rig", &addresses[..1]).is_err());
        assert!(connected("rig", &addresses).is_ok());
    }

    #[test]
    fn a_port_of_another_system_is_called_one() {
        let refusal = open("COM10").err().expect("no such port").to_string();
        assert!(
            cfg!(windows) || refusal.starts_with("cannot open COM10, a name of a port of Windows"),
            "{refusal}"
        );
    }
}
