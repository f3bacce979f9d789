//! The trial of a board's watchdog.

use std::io;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use pneudrive_protocol::{Accumulator, Event, ReplyBody, RequestBody, RequestRefusal, code};

use super::answer::{refusal, unexpected};
use super::{Client, stream};
use crate::port::{self, Link};

/// Between two attempts to open a port that has gone with its board.
const OPEN_AGAIN: Duration = Duration::from_millis(50);

/// A board that has answered this recently counts as present, although the last look at it was lost.
const STILL_THERE: Duration = Duration::from_secs(1);

const TRIAL_STAYS_ON: &str = "the trial of the watchdog stays on: the board is reset, or remains in the fault watchdog-tried; arming it ends the trial";

/// The outcome of a trial of the watchdog.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trial {
    /// It has no watchdog.
    NoWatchdog,
    /// It answered after a reset, this long after the request.
    Reset(Duration),
    /// It still answers, and was not reset.
    NotReset,
    /// It did not answer until the end.
    Silent,
}

/// A link that has been closed.
struct Closed(Instant);

impl Link for Closed {
    fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
        Err(io::ErrorKind::NotConnected.into())
    }

    fn write(&mut self, _: &[u8]) -> io::Result<()> {
        Err(io::ErrorKind::NotConnected.into())
    }

    fn now(&self) -> Duration {
        self.0.elapsed()
    }
}

impl Client {
    /// Has the board stop feeding its watchdog, and waits until it answers after the reset, at most for this long and
    /// while `goes_on` allows it. From then on this client talks to the new boot, which knows no test, no reference
    /// and only stored parameters.
    ///
    /// # Errors
    /// When the drive is not disarmed, another host commands it, or the board cannot tell one boot
    /// from the next; nothing is tried then. When `goes_on` ends the wait: the trial stays on.
    pub fn try_watchdog(&mut self, wait: Duration, goes_on: &mut dyn FnMut() -> Result<()>) -> Result<Trial> {
        if !self.names_its_boot() {
            bail!(
                "{}: the board cannot tell one boot from the next, so a reset by its watchdog would not be seen: its flash has failed",
                self.name
            );
        }
        Ok(match self.begins_trial()? {
            true => self.wait_for_reset(wait, goes_on)?,
            false => Trial::NoWatchdog,
        })
    }

    /// Requests the trial. Returns whether the board has a watchdog to try.
    fn begins_trial(&mut self) -> Result<bool> {
        let name = self.name.clone();
        self.ask_for_any(RequestBody::TryWatchdog, |reply| match reply {
            // The answer was lost, and the board was reset before it was asked again.
            ReplyBody::Done | ReplyBody::Refused(RequestRefusal::OtherBoot { .. }) => Ok(true),
            ReplyBody::Refused(RequestRefusal::NotNow(code::NO_WATCHDOG)) => Ok(false),
            ReplyBody::Refused(refused) => Err(refusal(&name, refused)),
            other => Err(unexpected(other)),
        })
    }

    /// Asks for the number of the boot until it changes.
    fn wait_for_reset(&mut self, wait: Duration, goes_on: &mut dyn FnMut() -> Result<()>) -> Result<Trial> {
        let begun = Instant::now();
        let mut answered = None;
        while begun.elapsed() < wait {
            goes_on().context(TRIAL_STAYS_ON)?;
            match self.boot_now() {
                Ok(Some(boot)) if boot != self.boot => {
                    let after = begun.elapsed();
                    self.begin_anew(boot)?;
                    return Ok(Trial::Reset(after));
                }
                Ok(Some(_)) => answered = Some(Instant::now()),
                Ok(None) => {}
                Err(_) => self.open_again(),
            }
        }
        Ok(without_reset(answered.map(|at| at.elapsed())))
    }

    /// Whether an event of the fault log belongs to the boot that this client talks to.
    #[must_use]
    pub fn is_of_this_boot(&self, event: &Event) -> bool {
        event.boot == self.boot
    }

    /// The number of the boot, asked for once; None without an answer.
    fn boot_now(&mut self) -> Result<Option<u32>> {
        self.sequence = self.sequence.wrapping_add(1);
        let sequence = self.sequence;
        self.send(sequence, RequestBody::Boot)?;
        let deadline = self.link.now() + self.answer_wait();
        self.hear(deadline, |reply| match reply.body {
            ReplyBody::Boot { number } if reply.sequence == sequence => Some(number),
            _ => None,
        })
    }

    /// Opens the port again, if it is there: the port of a board with USB disappears at its reset.
    fn open_again(&mut self) {
        // A port that is still held could not be opened again.
        self.link = Box::new(Closed(Instant::now()));
        std::thread::sleep(OPEN_AGAIN);
        let Ok(link) = port::open(&self.name) else { return };
        self.link = link;
        self.accumulator = Accumulator::new();
        self.heard = Vec::new().into_iter();
        // A board that does not answer yet is asked again.
        let _ = self.greet();
    }

    /// Nothing known about the boot before holds in this one.
    fn begin_anew(&mut self, boot: u32) -> Result<()> {
        self.boot = boot;
        (self.commands, self.test_crc32, self.last_sample) = (false, None, None);
        (self.known, self.meant) = (None, None);
        self.unasked = stream::Unasked::default();
        self.record_capacity = self.info()?.record_capacity;
        Ok(())
    }
}

/// The outcome for a board whose reset was not seen, by the time since its last answer; None: never.
fn without_reset(silent_for: Option<Duration>) -> Trial {
    match silent_for {
        Some(silent) if silent <= STILL_THERE => Trial::NotReset,
        _ => Trial::Silent,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_answer_that_was_lost_at_the_end_is_no_silence() {
        assert_eq!(without_reset(Some(Duration::from_millis(300))), Trial::NotReset);
        assert_eq!(without_reset(Some(Duration::from_secs(3))), Trial::Silent);
        assert_eq!(without_reset(None), Trial::Silent);
    }
}
