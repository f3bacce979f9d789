//! A link for rungs whose time is not the wall clock's.
//!
//! A program gives a rig 1.5 s of silence. A rung in lock step with its plant is silent for as long as a busy machine lets its
//! threads and processes wait: on the clock of this link that is an eighth of it.

use std::io;
use std::time::Duration;

use anyhow::Result;
use pneudrive_link::client::Client;
use pneudrive_link::port::{self, Link};

/// Seconds on the wall for a second of the link.
const SLOWER: u32 = 8;

/// A client that waits longer for its answers.
pub fn connect(port: &str) -> Result<Client> {
    Client::over(Box::new(Unhurried(port::open(port)?)), port)
}

struct Unhurried(Box<dyn Link>);

impl Link for Unhurried {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.read(buffer)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.0.write(bytes)
    }

    fn now(&self) -> Duration {
        self.0.now() / SLOWER
    }
}
