//! Makes the processor of an emulated board hang from outside, without support in the image.

use std::io::{self, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::Duration;

use anyhow::{Context, Result, bail};

/// The address of the loop: memory of the machine that the image does not use.
const LOOP_ADDRESS: u32 = 0x2003_0000;

/// `b .`, a branch to itself.
const LOOP: [u8; 2] = 0xe7fe_u16.to_le_bytes();

/// The debugger's answer to a request that it has executed.
const DONE: &[u8] = b"$OK#9a";

/// How long an answer may take, and how often a request is sent.
const ANSWER_WAIT: Duration = Duration::from_millis(200);
const ATTEMPTS: u32 = 25;

/// Stops the processor through the debugger's port, puts an endless loop into memory, and continues there.
pub(super) fn stall(debugger: &Path) -> Result<()> {
    let mut link = UnixStream::connect(debugger).context("the emulator's debugger port")?;
    link.set_read_timeout(Some(ANSWER_WAIT))?;
    ask(&mut link, &format!("M{LOOP_ADDRESS:x},{:x}:{}", LOOP.len(), hex(&LOOP)))?;
    // It continues there in Thumb state, and sends no answer before it stops again.
    Ok(send(&mut link, &format!("c{:x}", LOOP_ADDRESS | 1))?)
}

/// One request of the GDB remote protocol. While the processor runs, the emulator takes any bytes as a request to stop,
/// so the request is repeated.
fn ask(link: &mut UnixStream, request: &str) -> Result<()> {
    let mut heard = Vec::new();
    for _ in 0..ATTEMPTS {
        send(link, request)?;
        if is_done(link, &mut heard) {
            return Ok(link.write_all(b"+")?);
        }
    }
    bail!("the debugger did not execute {request}: {}", String::from_utf8_lossy(&heard))
}

fn send(link: &mut UnixStream, request: &str) -> io::Result<()> {
    let sum = request.bytes().fold(0u8, u8::wrapping_add);
    write!(link, "${request}#{sum:02x}")
}

/// Whether the emulator confirms the request in time.
fn is_done(link: &mut UnixStream, heard: &mut Vec<u8>) -> bool {
    let mut byte = [0];
    while !heard.ends_with(DONE) {
        if link.read_exact(&mut byte).is_err() {
            return false;
        }
        heard.extend(byte);
    }
    true
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
