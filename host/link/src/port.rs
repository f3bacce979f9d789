//! A link of bytes to a rig: serial port, pty or TCP.
//!
//! What serial ports are known for, and what is made of it here:
//!
//! - *A read does not keep its time-out.* Reading has a thread of its own, and the program waits for that
//!   with a clock of its own: a read that comes back at once, or never, changes nothing.
//! - *Draining waits for ever* where nobody reads. Nothing is drained; what does not arrive is asked again.
//! - *DTR and RTS reset some boards.* The system sets both when a port is opened, and so they stay until it
//!   is closed. A board that hangs its reset on one of them is reset by each program that opens the port;
//!   there is time for it to come up. The ST-LINK of a Nucleo board passes neither on.
//! - *Two programs on one port* each get a half of what comes. The port is locked, and a port that is
//!   locked is refused by name.
//! - *Noise at start-up* is no frame and is passed over, whatever bytes it is made of.

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

/// Time between two looks at a port that has nothing and does not wait, or takes nothing.
const LOOK_AGAIN: Duration = Duration::from_micros(200);

/// How long a write may be held up.
const WRITE_WAIT: Duration = Duration::from_secs(1);

/// Bytes to and from a rig, and the clock by which answers are waited for.
pub trait Link: Send {
    /// Bytes that have come, at most [`READ_WAIT`] later: none when none came.
    ///
    /// # Errors
    /// When the port is gone.
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize>;

    /// Sends all the bytes.
    ///
    /// # Errors
    /// When the port is gone, or takes nothing.
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
            anyhow::anyhow!("another program has {path} open; end it first")
        } else {
            anyhow::Error::new(error).context(format!("cannot open {path}{}", available()))
        }
    })?;
    let reader = port.try_clone().with_context(|| format!("cannot read from {path}"))?;
    Ok(Box::new(Wire::new(reader, port)))
}

/// Whether a port could not be opened because another program has it: by its lock, or by its claim to be
/// alone (EBUSY).
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

/// The serial ports there are, for the end of an error message.
fn available() -> String {
    let ports = serialport::available_ports().unwrap_or_default();
    if ports.is_empty() {
        return " (no serial port was found on this machine)".to_owned();
    }
    let names: Vec<String> = ports.into_iter().map(|port| port.port_name).collect();
    format!(" (serial ports here: {})", names.join(", "))
}

/// What the reading thread has to say at once: bytes, or why there will be none.
type Heard = io::Result<Vec<u8>>;

/// A stream of the system's, read by a thread of its own.
pub struct Wire<W> {
    stream: W,
    heard: Receiver<Heard>,
    /// Bytes that were heard and not yet taken.
    rest: Vec<u8>,
    closed: Arc<AtomicBool>,
    since: Instant,
}

impl<W: Write> Wire<W> {
    /// A wire of two ends of the same stream.
    pub fn new(reader: impl Read + Send + 'static, writer: W) -> Wire<W> {
        // Bounded: who reads nothing holds up the other side, as without the thread.
        let (say, heard) = sync_channel(16);
        let closed = Arc::new(AtomicBool::new(false));
        let watched = Arc::clone(&closed);
        std::thread::spawn(move || listen(reader, &say, &watched));
        Wire { stream: writer, heard, rest: Vec::new(), closed, since: Instant::now() }
    }
}

/// Reads until the stream ends or nobody wants it any more.
fn listen(mut reader: impl Read, say: &SyncSender<Heard>, closed: &AtomicBool) {
    let mut bytes = [0; 4096];
    while !closed.load(Ordering::Relaxed) {
        let heard = match read_some(&mut reader, &mut bytes) {
            Ok(0) => {
                // Nothing for one that keeps its time-out, much for one that comes back at once.
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
    /// The port is free again once the thread has let go of its end; one that hangs is not waited for.
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

/// Bytes that are there: none when the wait is over.
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
    io::Error::new(io::ErrorKind::UnexpectedEof, "the rig closed the link")
}

/// Writes everything, waiting where the other side is slow, but not for longer than this.
///
/// # Errors
/// When the port is gone, or takes nothing for too long: then a part may have gone.
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

/// Whether an error only says that there is nothing now.
#[must_use]
pub fn is_wait(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted)
}
