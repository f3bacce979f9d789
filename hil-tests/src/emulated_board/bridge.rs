//! Bridges the plant bus of an emulated board to a TCP port; a real board has the bus on a second serial port.

use std::io::{Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::mpsc::Sender;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use pneudrive_link::port::is_wait;

use super::pipes::Pipes;
use crate::plant_server::Bus;

/// How long the plant may take to connect.
const CALL_WAIT: Duration = Duration::from_secs(20);

/// Carries the bus for one program that connects, until the board or that program has gone. Signals `greet` when the
/// board has sent its hello.
pub(super) fn carry(mut pipes: Pipes, listener: &TcpListener, greet: &Sender<()>) -> Result<()> {
    let hello = pipes.hello()?.context("the image ended before its hello")?;
    // Nobody may be waiting any more.
    let _ = greet.send(());
    let mut caller = wait_for_caller(listener)?;
    caller.write_all(&hello)?;
    let (mut to_board, mut from_board) = pipes.ends();
    let mut to_caller = caller.try_clone()?;
    let outputs = std::thread::spawn(move || copy(&mut from_board, &mut to_caller));
    copy(&mut caller, &mut to_board);
    let _ = caller.shutdown(Shutdown::Both);
    // It ends with the emulator.
    let _ = outputs.join();
    Ok(())
}

fn wait_for_caller(listener: &TcpListener) -> Result<TcpStream> {
    listener.set_nonblocking(true)?;
    let deadline = Instant::now() + CALL_WAIT;
    while Instant::now() < deadline {
        match listener.accept() {
            Ok((caller, _)) => {
                caller.set_nonblocking(false)?;
                caller.set_nodelay(true)?;
                return Ok(caller);
            }
            Err(error) if is_wait(&error) => std::thread::sleep(Duration::from_millis(10)),
            Err(error) => return Err(error.into()),
        }
    }
    bail!("no plant connected within {} s", CALL_WAIT.as_secs())
}

/// Copies until either side has gone.
fn copy(from: &mut impl Read, to: &mut impl Write) {
    let mut bytes = [0; 64];
    while let Ok(count @ 1..) = from.read(&mut bytes) {
        if to.write_all(&bytes[..count]).is_err() {
            break;
        }
    }
}
