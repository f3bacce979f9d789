//! A byte link to a rig: serial port, pty or TCP.
//!
//! Known troubles of serial ports, and what is done about them here:
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
use std::net::{TcpStream, ToSocketAddrs};
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
    if let Some(address) = name.strip_prefix("tcp://") {
        return open_tcp(address).with_context(|| {
            format!("cannot reach a rig at {name}; is one listening there (`pneudrive virtual ... --listen tcp:{address}`)?")
        });
    }
    open_serial(name.strip_prefix("pty:").unwrap_or(name))
}

fn open_serial(path: &str) -> Result<Box<dyn Link>> {
    let port = serialport::new(path, BAUD).timeout(READ_WAIT).dtr_on_open(true).open();
    let port = port.map_err(|error| {
        if is_held(&error) {
            anyhow::anyhow!("another program has {path} open; close it first")
        } else {
            anyhow::Error::new(error).context(format!("cannot open {path}{}", available()))
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
    let Some(address) = address.to_socket_addrs()?.next() else { bail!("{address} has no address") };
    let stream = TcpStream::connect_timeout(&address, Duration::from_secs(3))?;
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(READ_WAIT))?;
    stream.set_write_timeout(Some(READ_WAIT))?;
    Ok(Box::new(Wire::new(stream.try_clone()?, stream)))
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
pub fn write_within(stream: &mut (impl Write + ?Sized), mut bytes: &[u8], wait: Duration) -> io::Result<()> {
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
