//! A host: the program's own client, run anew from its beginning for each input that is added.
//!
//! The client waits in calls that block, so it has no state that could be stored. What it does depends on its inputs
//! alone, though: its session, the number of its first request and its clock are given. So its state is the list of
//! inputs that it has had, and what it does next is found by running it with them up to where it waits again.
//!
//! The answer to `Info` is the same at every time, so it is there as soon as the client asks: neither goes over the line.
//!
//! The list is as short as it can be told ([`Host::after`]). A reply that the client passes over is left out, and so is, once a
//! request is answered, that it had to be sent more than once. Repeats of a question that only reads have numbers of their
//! own, so later requests have higher ones: the client is run from a higher first number then, and its answers are those to
//! whatever it has asked last. Of a client that has ended, only what came of it is kept. `tests/hosts.rs` runs clients with and
//! without repeats to the end.

use std::collections::VecDeque;
use std::io;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use anyhow::{Result, bail};
use pneudrive_app::Server;
use pneudrive_controller::parameters::id;
use pneudrive_link::client::{Client, Pieces};
use pneudrive_link::port::Link;
use pneudrive_protocol::{MAX_FRAME, Reply, RequestBody, decode_reply, decode_request, encode};
use pneudrive_records::record::Record;
use pneudrive_sim::Rig as RigFile;

use crate::line::message;
use crate::pair::Pair;
use crate::rig::{Rig, Run};

/// What a host experiences.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Input {
    /// A reply comes.
    Reply(Vec<u8>),
    /// An answer to what it has asked last, without its number.
    Answer(Vec<u8>),
    /// Nothing has come for as long as it waits.
    Silence,
    /// The run that it has started is over.
    RunOver,
}

/// What a host waits for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Waits {
    /// For an answer.
    #[default]
    Answer,
    /// For the end of its run.
    RunOver,
    /// For nothing: it has ended.
    Nothing,
}

/// How a host stands after its inputs.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Standing {
    /// The frames that it has sent since the last input.
    pub sent: Vec<Vec<u8>>,
    /// What it waits for.
    pub waits: Waits,
    /// Whether it means the drive to be armed: from before it asks for that until the drive is disarmed, or it ends.
    pub means_to_command: bool,
    /// The record that it was given.
    pub record: Option<Run>,
    /// Whether its homing run has come to its end, and the drive is disarmed.
    pub homed: bool,
}

/// What a host does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Job {
    /// Sets its parameters and saves them.
    Configures,
    /// States its test, arms, starts, disarms when the run is over, and pulls the record.
    Runs,
    /// The one, then the other.
    Both,
    /// Arms, homes, and disarms when that is over.
    Homes,
    /// As one that runs, but asks twice how the drive stands once it has started, and pulls no record.
    Follows,
    /// Runs its test, and leaves the drive as it holds.
    Holds,
    /// Stops the drive.
    Stops,
    /// Nothing: it does not even connect.
    Rests,
}

/// What a host is to do.
#[derive(Clone, Debug)]
pub struct Plan {
    /// What it does.
    pub job: Job,
    /// Its session.
    pub session: u32,
    /// The number before that of its first request.
    pub sequence: u16,
    /// The test, by its name, that it runs.
    pub test: Arc<RigFile>,
    /// The parameters that it sets.
    pub pair: Pair,
    /// Whether it believes what comes of a record without looking at the CRC-32 of the whole.
    pub trusts_pieces: bool,
}

impl Plan {
    /// A plan with a test of three samples.
    #[must_use]
    pub fn new(job: Job, test: &str, session: u32, sequence: u16, pair: Pair) -> Plan {
        let text = format!(
            "name = \"{test}\"\n[test]\nmoves = [[0, {}]]\nduration_s = 0.0026\nposition_m = 1.2e-3\n",
            100 + pair[0]
        );
        let test = Arc::new(RigFile::read("model", &text).expect("a rig file"));
        Plan { job, session, sequence, test, pair, trusts_pieces: false }
    }
}

/// A host's inputs so far, or what came of it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Host {
    inputs: Vec<Input>,
    /// Repeats that had numbers of their own, before the last answer.
    repeats: u16,
    ended: Option<Box<Standing>>,
}

impl Host {
    /// The host after an input, as short as it can be told, and how it stands then; None if it passes over the input.
    #[must_use]
    pub fn after(&self, input: Input, plan: &Plan) -> Option<(Host, Standing)> {
        let before = self.standing(plan);
        let whole = self.with(input.clone());
        let standing = whole.standing(plan);
        let goes_on = !standing.sent.is_empty() || standing.waits != before.waits;
        let after = match input {
            Input::Reply(_) if !goes_on => return None,
            _ if standing.waits == Waits::Nothing => {
                Host { ended: Some(Box::new(standing.clone())), ..Host::default() }
            }
            Input::Reply(bytes) => {
                self.answered(&bytes, before.sent.iter().any(|frame| is_idempotent(frame)))
            }
            _ => whole,
        };
        Some((after, standing))
    }

    /// The host with one more input.
    #[must_use]
    pub fn with(&self, input: Input) -> Host {
        Host { inputs: self.inputs.iter().cloned().chain([input]).collect(), ..self.clone() }
    }

    /// The host after an answer, by which its silences since the one before are over.
    fn answered(&self, bytes: &[u8], is_idempotent: bool) -> Host {
        let asked = self.inputs.iter().rposition(|input| *input != Input::Silence).map_or(0, |last| last + 1);
        let silences = (self.inputs.len() - asked) as u16;
        let answer = [Input::Answer(numbered(bytes, 0))];
        let inputs = self.inputs[..asked].iter().cloned().chain(answer).collect();
        Host { inputs, repeats: self.repeats + if is_idempotent { silences } else { 0 }, ended: None }
    }

    /// How it stands: found by running the client with these inputs.
    #[must_use]
    pub fn standing(&self, plan: &Plan) -> Standing {
        if let Some(standing) = &self.ended {
            return Standing::clone(standing);
        }
        if plan.job == Job::Rests {
            return Standing { waits: Waits::Nothing, ..Standing::default() };
        }
        let script = Script::new(&self.inputs);
        let link = Scripted(script.clone());
        // Why a program ends does not matter here.
        let _ = Client::in_session(Box::new(link), "model", plan.session, plan.sequence + self.repeats)
            .and_then(|mut client| work(&mut client, plan, &script));
        let mut played = script.played();
        if !played.blocked {
            played.standing.waits = Waits::Nothing;
            played.standing.means_to_command = false;
        }
        std::mem::take(&mut played.standing)
    }
}

/// What the program does.
fn work(client: &mut Client, plan: &Plan, script: &Script) -> Result<()> {
    match plan.job {
        Job::Homes => return home(client, script),
        Job::Stops => return client.stop(),
        _ => {}
    }
    if matches!(plan.job, Job::Configures | Job::Both) {
        client.set_parameters(id::VELOCITY_GAIN, &plan.pair)?;
        client.save_parameters()?;
    }
    if plan.job == Job::Configures { Ok(()) } else { run(client, plan, script) }
}

fn run(client: &mut Client, plan: &Plan, script: &Script) -> Result<()> {
    client.download_test(&plan.test)?;
    script.played().standing.means_to_command = true;
    client.arm()?;
    client.start()?;
    if plan.job == Job::Follows {
        client.status()?;
        client.status()?;
    }
    script.wait_for_the_end_of_the_run()?;
    if plan.job == Job::Holds {
        return Ok(());
    }
    client.disarm()?;
    script.played().standing.means_to_command = false;
    if plan.job == Job::Follows {
        return Ok(());
    }
    let record = pull(client, plan)?;
    script.played().standing.record = Some(record);
    Ok(())
}

fn home(client: &mut Client, script: &Script) -> Result<()> {
    script.played().standing.means_to_command = true;
    client.arm()?;
    client.home()?;
    script.wait_for_the_end_of_the_run()?;
    client.disarm()?;
    let mut played = script.played();
    (played.standing.means_to_command, played.standing.homed) = (false, true);
    Ok(())
}

fn pull(client: &mut Client, plan: &Plan) -> Result<Run> {
    if !plan.trusts_pieces {
        let Record { head, samples } = client.record(|_, _| ())?;
        return Ok(Run { test: head.test, samples });
    }
    let head = client.record_head()?;
    let mut bytes = Vec::new();
    // The error that tells of another record is passed over.
    let _ = client.download(&head, Pieces::none(head.samples), |_, samples| {
        bytes.extend_from_slice(samples);
        Ok(())
    });
    let samples = pneudrive_protocol::RecordedSample::read(&bytes).into_iter().flatten().collect();
    Ok(Run { test: head.test, samples })
}

/// The inputs that a client is run with, and what came of it.
#[derive(Clone)]
struct Script(Arc<Mutex<Played>>);

struct Played {
    inputs: VecDeque<Input>,
    /// Replies that came while the program did not read.
    unread: VecDeque<Vec<u8>>,
    now: Duration,
    /// Whether the inputs are over; nothing counts from then on.
    blocked: bool,
    standing: Standing,
}

impl Script {
    fn new(inputs: &[Input]) -> Script {
        let played = Played {
            inputs: inputs.iter().cloned().collect(),
            unread: VecDeque::new(),
            now: Duration::ZERO,
            blocked: false,
            standing: Standing::default(),
        };
        Script(Arc::new(Mutex::new(played)))
    }

    fn played(&self) -> std::sync::MutexGuard<'_, Played> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait_for_the_end_of_the_run(&self) -> Result<()> {
        let mut played = self.played();
        loop {
            match played.next(Waits::RunOver) {
                Some(Input::RunOver) => return Ok(()),
                Some(Input::Reply(bytes) | Input::Answer(bytes)) => played.unread.push_back(bytes),
                Some(Input::Silence) => {}
                None => bail!("no more inputs"),
            }
        }
    }
}

impl Played {
    /// The next input; without one the client waits from here on.
    fn next(&mut self, waits: Waits) -> Option<Input> {
        let mut next = self.inputs.pop_front();
        if let (Some(Input::Answer(bytes)), Some(asked)) = (&mut next, self.standing.sent.last()) {
            *bytes = numbered(bytes, number(asked));
        }
        if next.is_some() {
            self.standing.sent.clear();
        } else if !self.blocked {
            self.blocked = true;
            self.standing.waits = waits;
        }
        next
    }
}

/// The link of a client that is run with a script.
struct Scripted(Script);

impl Link for Scripted {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut played = self.0.played();
        let unread = played.unread.pop_front().map(Input::Reply);
        match unread.or_else(|| played.next(Waits::Answer)) {
            Some(Input::Reply(bytes) | Input::Answer(bytes)) => {
                buffer[..bytes.len()].copy_from_slice(&bytes);
                Ok(bytes.len())
            }
            Some(_) => {
                played.now += Duration::from_millis(100);
                Ok(0)
            }
            None => Err(io::ErrorKind::BrokenPipe.into()),
        }
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        let mut played = self.0.played();
        // What only opens the line is no request.
        if played.blocked || bytes == [0] {
            return Ok(());
        }
        match answer_to_info(bytes) {
            Some(reply) => played.unread.push_back(reply),
            None => played.standing.sent.push(bytes.to_vec()),
        }
        Ok(())
    }

    fn now(&self) -> Duration {
        self.0.played().now
    }
}

/// Whether the request in a frame changes nothing.
fn is_idempotent(frame: &[u8]) -> bool {
    decode_request(&message(frame)).is_ok_and(|request| request.body.is_idempotent())
}

/// The number of the request in a frame.
fn number(frame: &[u8]) -> u16 {
    decode_request(&message(frame)).expect("a request").sequence
}

/// The reply in a frame under another number.
fn numbered(frame: &[u8], sequence: u16) -> Vec<u8> {
    let message = message(frame);
    let reply = decode_reply(&message).expect("a reply of this version");
    let mut room = [0; MAX_FRAME];
    encode(&Reply { sequence, ..reply }, &mut room).expect("it came in a frame").to_vec()
}

/// What the firmware answers if this is the question who it is.
fn answer_to_info(frame: &[u8]) -> Option<Vec<u8>> {
    let asked = message(frame);
    if !decode_request(&asked).is_ok_and(|request| request.body == RequestBody::Info) {
        return None;
    }
    let (mut rig, mut reply) = (Rig::new(None), Vec::new());
    let Ok(()) = Server::default().receive(frame, &mut rig.control, &mut rig.board, &mut reply);
    Some(reply)
}
