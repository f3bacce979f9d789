//! Requests to a rig, each repeated until it is answered.

mod advance;
mod answer;
mod change;
mod io;
mod motion;
mod move_records;
mod owner;
mod parameters;
mod record;
mod stream;
mod test;
mod valve;
mod watchdog;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;
use std::time::{Duration, SystemTime};

use anyhow::{Context, Result, anyhow, bail};
use pneudrive_controller::Fault;
use pneudrive_protocol::session::NO_BOOT;
use pneudrive_protocol::{
    Accumulator, MAX_FRAME, Mode, Reply, ReplyBody, Request, RequestBody, Status, VERSION, decode_reply,
    encode,
};
use pneudrive_records::rig_info::{Info, RigParameters};
use pneudrive_records::untrusted::{NAME, sanitised};
use pneudrive_records::words;

pub use io::Io;
pub use owner::Commander;
pub use record::{Pieces, RecordChanged};
pub use watchdog::Trial;

use crate::failure::Failure;
use crate::port::{self, Link};
use advance::Advance;
use answer::refusal;
use answer::unexpected;

/// How often a request is sent before the rig counts as silent.
const ATTEMPTS: u32 = 15;

/// How long a rig may go without a useful answer. A fifteenth of it fits several times into the host silence that trips a
/// running move.
pub const SILENCE_TIMEOUT: Duration = Duration::from_millis(1500);

/// The token of this program, from the environment variable `PNEUDRIVE_TOKEN`; None where it is empty or not set.
///
/// # Errors
/// When it is not valid text.
pub fn token() -> Result<Option<String>> {
    match std::env::var("PNEUDRIVE_TOKEN") {
        Ok(token) => Ok(Some(token).filter(|token| !token.is_empty())),
        Err(std::env::VarError::NotPresent) => Ok(None),
        Err(error) => Err(error).context("PNEUDRIVE_TOKEN"),
    }
}

/// A connection to a rig.
pub struct Client {
    link: Box<dyn Link>,
    name: String,
    /// How long the rig may go without a useful answer.
    patience: Duration,
    accumulator: Accumulator,
    /// Bytes that were received and not examined yet.
    heard: std::vec::IntoIter<u8>,
    sequence: u16,
    /// Distinguishes its requests from those of other hosts.
    session: u32,
    /// The boot of the rig that its requests are meant for.
    boot: u32,
    /// Whether it has armed the drive, or taken it over.
    commands: bool,
    /// Checks without which it may arm the drive.
    without: Vec<Fault>,
    /// The test that it has downloaded, as a start request names it.
    test_crc32: Option<u32>,
    /// The parameters that it has read, and their fingerprint on the rig.
    known: Option<(u32, RigParameters)>,
    /// The parameters with which the downloaded test is to run, if known.
    meant: Option<RigParameters>,
    /// Samples that the rig says it has room for.
    record_capacity: u32,
    /// Last sample of the test that it has downloaded.
    last_sample: Option<u32>,
    repeats: u32,
    unasked: stream::Unasked,
}

impl Client {
    /// Opens a port and checks that a rig answers there.
    ///
    /// # Errors
    /// When the port cannot be opened, nothing answers, or the versions do not match.
    pub fn connect(name: &str) -> Result<Client> {
        Client::connect_patiently(name, SILENCE_TIMEOUT)
    }

    /// The same of a rig that may go without a useful answer for longer than [`SILENCE_TIMEOUT`], as one whose time is not the
    /// wall clock's. A request is repeated the more rarely: repeats that wait to be heard would delay the next one.
    ///
    /// # Errors
    /// As for [`Client::connect`].
    pub fn connect_patiently(name: &str, patience: Duration) -> Result<Client> {
        let opened = port::open(name).map_err(|error| Failure::NoAnswer.of(error))?;
        Client::begin(opened, name, patience)
    }

    /// Talks over an open link; `name` is for messages.
    ///
    /// # Errors
    /// When nothing answers, or the versions do not match.
    pub fn over(link: Box<dyn Link>, name: &str) -> Result<Client> {
        Client::begin(link, name, SILENCE_TIMEOUT)
    }

    fn begin(link: Box<dyn Link>, name: &str, patience: Duration) -> Result<Client> {
        // A different start for each program, so that a late reply to another program is not taken for ours.
        let clock = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        let begin = std::process::id() as u16 ^ (clock.subsec_nanos() >> 8) as u16;
        let mut client = Client::new(link, name, owner::any_session(), begin);
        client.patience = patience;
        client.greeted()
    }

    /// The same with a given session, and requests numbered from the one after `sequence`: such a run of the client can be
    /// repeated.
    ///
    /// # Errors
    /// As for [`Client::over`].
    pub fn in_session(link: Box<dyn Link>, name: &str, session: u32, sequence: u16) -> Result<Client> {
        Client::new(link, name, session, sequence).greeted()
    }

    fn new(link: Box<dyn Link>, name: &str, session: u32, sequence: u16) -> Client {
        Client {
            link,
            name: port::address(name).map_or_else(|| name.to_owned(), |address| format!("tcp://{address}")),
            patience: SILENCE_TIMEOUT,
            accumulator: Accumulator::new(),
            heard: Vec::new().into_iter(),
            sequence,
            session,
            boot: NO_BOOT,
            commands: false,
            without: Vec::new(),
            test_crc32: None,
            known: None,
            meant: None,
            record_capacity: 0,
            last_sample: None,
            repeats: 0,
            unasked: stream::Unasked::default(),
        }
    }

    /// Finds a rig at the other end.
    fn greeted(mut self) -> Result<Client> {
        self.greet()?;
        self.boot = self.number_of_boot()?;
        Ok(self)
    }

    /// The first words over a link.
    fn greet(&mut self) -> Result<()> {
        // Ends a frame that an earlier program left incomplete.
        self.link.write(&[0]).map_err(|error| failed(format!("cannot write to {}", self.name), error))?;
        if self.name.starts_with("tcp://")
            && let Some(token) = token()?
        {
            self.send_token(&token)?;
        }
        self.record_capacity = self.info()?.record_capacity;
        Ok(())
    }

    /// Damaged frames and repeated requests so far.
    #[must_use]
    pub fn losses(&self) -> (u32, u32) {
        (self.accumulator.damaged, self.repeats)
    }

    /// Sends a request until it is answered, and gives the answer to `take`, unless it is a refusal.
    fn ask<T>(&mut self, body: RequestBody<'_>, take: impl Fn(&ReplyBody<'_>) -> Result<T>) -> Result<T> {
        let name = self.name.clone();
        self.ask_for_any(body, |reply| match reply {
            ReplyBody::Refused(refused) => Err(refusal(&name, refused)),
            body => take(body),
        })
    }

    /// Sends a request until it is answered, and gives the answer to `take`.
    ///
    /// A repeat of a request that changes nothing has a number of its own: a rig takes copies for no sign of life, and the
    /// answers of a rig that hears everything may be lost. An answer to an earlier repeat is an answer, too.
    fn ask_for_any<T>(
        &mut self,
        body: RequestBody<'_>,
        take: impl Fn(&ReplyBody<'_>) -> Result<T>,
    ) -> Result<T> {
        let first = self.sequence.wrapping_add(1);
        for attempt in 0..ATTEMPTS {
            self.repeats += u32::from(attempt > 0);
            if attempt == 0 || body.is_idempotent() {
                self.sequence = self.sequence.wrapping_add(1);
            }
            let sequence = self.sequence;
            self.send(sequence, body)?;
            let deadline = self.link.now() + self.answer_wait();
            let since_first = sequence.wrapping_sub(first);
            let answer = self.hear(deadline, |reply| {
                let is_answer = reply.sequence.wrapping_sub(first) <= since_first;
                is_answer.then(|| take(&reply.body))
            })?;
            if let Some(answer) = answer {
                return answer;
            }
        }
        Err(self.no_answer())
    }

    /// How long an answer may take before the request is sent again.
    fn answer_wait(&self) -> Duration {
        self.patience / ATTEMPTS
    }

    fn no_answer(&self) -> anyhow::Error {
        Failure::NoAnswer.error(format!(
            "no answer from {} within {:.1} s; check that it is a rig, that it is powered and has this firmware, and that no other program uses the port",
            self.name,
            self.patience.as_secs_f64()
        ))
    }

    fn send(&mut self, sequence: u16, body: RequestBody<'_>) -> Result<()> {
        let mut frame = [0; MAX_FRAME];
        let request = Request { sequence, session: self.session, boot: self.boot, body };
        let frame = encode(&request, &mut frame).ok_or_else(|| anyhow!("a request is too long to send"))?;
        self.link.write(frame).map_err(|error| self.broken(error))
    }

    /// The failure of a link that can no longer be read or written, whatever its system says of it.
    fn broken(&self, error: std::io::Error) -> anyhow::Error {
        failed(format!("the link to {} broke", self.name), error)
    }

    /// Passes the rig's replies to `take` until it returns something, or the deadline has passed. Damaged frames and echoes
    /// of our own requests, which are no replies, are skipped; unsolicited rows are set aside.
    fn hear<T>(
        &mut self,
        deadline: Duration,
        mut take: impl FnMut(&Reply<'_>) -> Option<T>,
    ) -> Result<Option<T>> {
        loop {
            for byte in self.heard.by_ref() {
                let Some(Ok(message)) = self.accumulator.push(byte) else { continue };
                let Ok(reply) = decode_reply(message) else { continue };
                if !self.unasked.takes(&reply)
                    && let Some(taken) = take(&reply)
                {
                    return Ok(Some(taken));
                }
            }
            if self.link.now() >= deadline {
                return Ok(None);
            }
            let mut bytes = vec![0; 4096];
            let count = self.link.read(&mut bytes).map_err(|error| self.broken(error))?;
            bytes.truncate(count);
            self.heard = bytes.into_iter();
        }
    }

    fn ask_done(&mut self, body: RequestBody<'_>) -> Result<()> {
        self.ask(body, |reply| match reply {
            ReplyBody::Done => Ok(()),
            other => Err(unexpected(other)),
        })
    }

    /// The identity of the rig.
    ///
    /// # Errors
    /// When it does not answer, or speaks another version of the protocol.
    pub fn info(&mut self) -> Result<Info> {
        let name = self.name.clone();
        self.ask(RequestBody::Info, |reply| match *reply {
            ReplyBody::Info { version, firmware, build, board, record_capacity } => {
                if version != VERSION {
                    bail!("{}", other_version(&name, version));
                }
                Ok(Info {
                    version,
                    firmware: sanitised(firmware, NAME),
                    build: sanitised(build, NAME),
                    board: sanitised(board, NAME),
                    record_capacity,
                })
            }
            ref other => Err(unexpected(other)),
        })
    }

    /// The status of the rig.
    ///
    /// # Errors
    /// When it does not answer.
    pub fn status(&mut self) -> Result<Status> {
        self.ask(RequestBody::Status, |reply| match reply {
            ReplyBody::Status(status) => Ok(*status),
            other => Err(unexpected(other)),
        })
    }

    /// Sets the encoder's counter: the axis is at `position_counts` now.
    ///
    /// # Errors
    /// When it is refused or not answered.
    pub fn reference(&mut self, position_counts: i32) -> Result<()> {
        self.ask_done(RequestBody::Reference { position_counts })
    }

    /// Follows a run to its end; `progress` is given the newest status now and then, and may take its time. Stops the rig once
    /// `interrupted` is set; that is the end of a test that runs until it is stopped, and disarms it.
    ///
    /// # Errors
    /// When the drive trips, something else ends the run, its samples stop advancing or continue past its end, or the rig
    /// stops answering.
    pub fn follow(&mut self, interrupted: &AtomicBool, mut progress: impl FnMut(&Status)) -> Result<Status> {
        let (say, heard) = channel();
        std::thread::scope(|scope| {
            // A thread of its own: the rig hears its host also while `progress` waits, as for a terminal that is held.
            let following = scope.spawn(move || {
                let tell = |status: &Status| {
                    // The receiver outlives this thread.
                    let _ = say.send(*status);
                };
                self.follow_and(interrupted, tell, |_, _| {
                    std::thread::sleep(Duration::from_millis(20));
                    Ok(())
                })
            });
            while let Ok(status) = heard.recv() {
                progress(&heard.try_iter().last().unwrap_or(status));
            }
            following.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        })
    }

    /// Follows a run and calls `between` after each status.
    fn follow_and(
        &mut self,
        interrupted: &AtomicBool,
        mut progress: impl FnMut(&Status),
        mut between: impl FnMut(&mut Client, &Status) -> Result<()>,
    ) -> Result<Status> {
        let mut last = None;
        let mut advance = Advance::since(self.link.now());
        loop {
            if interrupted.load(Ordering::Relaxed) {
                return self.end_early(last);
            }
            let status = self.status()?;
            last = Some(status);
            progress(&status);
            match status.mode {
                // If the run can no longer be followed, the cylinder must not be left moving.
                Mode::Running => advance
                    .check(&status, self.last_sample, self.link.now())
                    .with_context(|| self.name.clone())
                    .and_then(|()| between(self, &status))
                    .inspect_err(|_| {
                        let _ = self.stop();
                    })?,
                Mode::Fault => return Err(self.tripped(&status)),
                Mode::Done => return Ok(status),
                Mode::Disarmed | Mode::Armed | Mode::Homing => bail!(
                    "{}: the run ended early; the rig was reset, or another program disarmed it",
                    self.name
                ),
            }
        }
    }

    fn tripped(&self, status: &Status) -> anyhow::Error {
        Failure::Tripped.error(format!(
            "{} tripped {}: {} ({}); `pneudrive device arm` clears the fault",
            self.name,
            self.index_in_run(status.index),
            words::fault_code_name(status.fault),
            words::fault_meaning(status.fault)
        ))
    }
}

/// Says which of the two to update.
fn other_version(name: &str, version: u16) -> String {
    let advice = match version < VERSION {
        true => "flash the firmware that belongs to this program",
        false => "use a later version of this program",
    };
    format!("{name} speaks version {version} of the protocol, this program version {VERSION}; {advice}")
}

/// Nothing can be heard from a rig whose link fails.
fn failed(what: String, error: std::io::Error) -> anyhow::Error {
    Failure::NoAnswer.of(anyhow::Error::new(error).context(what))
}
