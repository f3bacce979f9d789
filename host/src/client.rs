//! Requests to a rig, each asked again until it is answered.

mod version_2;

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant, SystemTime};

use anyhow::{Context, Result, anyhow, bail};
use pneudrive_controller::Parameters;
use pneudrive_controller::parameters::TABLE;
use pneudrive_protocol::{
    Accumulator, CHUNK_SAMPLES, CURRENT_VERSION, MAX_FRAME, MAX_VALUES, MIN_VERSION, Mode, RecordCrc,
    RecordedSample, ReplyBody, Request, RequestBody, Status, Values, decode_reply, encode,
};
use pneudrive_sim::Rig;

use crate::port::{self, Link};
use crate::words;

/// How long an answer may take before the request is sent again.
/// Several fit into the silence of the host that trips a running move.
const ANSWER_WAIT: Duration = Duration::from_millis(100);

/// How often a request is sent.
const ATTEMPTS: u32 = 15;

/// Most questions for the CRC of a record before it must be there.
const MOST_DIGESTS: u32 = 1000;

/// A connection to a rig.
pub struct Client {
    link: Box<dyn Link>,
    name: String,
    accumulator: Accumulator,
    sequence: u16,
}

/// Who a rig is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Info {
    /// Newest protocol version that it speaks.
    pub version: u16,
    /// Version of the firmware.
    pub firmware: String,
    /// What it was built from.
    pub build: String,
    /// Kind of board.
    pub board: String,
    /// Samples that its buffer holds.
    pub record_capacity: u32,
}

/// A recorded transient with what is known about it.
#[derive(Clone, Debug)]
pub struct Record {
    /// Name of the test.
    pub test: String,
    /// Every Nth sample was stored.
    pub decimation: u16,
    /// Samples from before the start.
    pub pre_trigger: u16,
    /// Index of the oldest sample.
    pub first_index: i32,
    /// Mean interval of the samples by the board's clock, ns.
    pub measured_period_ns: u32,
    /// Mean of the spool channel, raw.
    pub mean_spool_raw: i16,
    /// The samples, oldest first.
    pub samples: Vec<RecordedSample>,
}

impl Client {
    /// Opens a port and makes sure that a rig answers there.
    ///
    /// # Errors
    /// When the port cannot be opened, nobody answers, or the versions do not fit.
    pub fn connect(name: &str) -> Result<Client> {
        Client::over(port::open(name)?, name)
    }

    /// Talks over an open link; `name` is for messages.
    ///
    /// # Errors
    /// When nobody answers, or the versions do not fit.
    pub fn over(link: Box<dyn Link>, name: &str) -> Result<Client> {
        // Not where the last program began, lest its last reply be taken for ours.
        let clock = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        let begin = std::process::id() as u16 ^ (clock.subsec_nanos() >> 8) as u16;
        let mut client =
            Client { link, name: name.to_owned(), accumulator: Accumulator::new(), sequence: begin };
        // Ends whatever an earlier program left half said.
        client.link.write_all(&[0]).with_context(|| format!("cannot write to {name}"))?;
        client.info()?;
        Ok(client)
    }

    /// Sends a request until it is answered, and gives the answer to `take`.
    fn ask<T>(&mut self, body: RequestBody<'_>, take: impl Fn(&ReplyBody<'_>) -> Result<T>) -> Result<T> {
        self.sequence = self.sequence.wrapping_add(1);
        let request = Request { sequence: self.sequence, body };
        let mut frame = [0; MAX_FRAME];
        let frame = encode(&request, &mut frame).ok_or_else(|| anyhow!("a request is too long to send"))?;
        for _ in 0..ATTEMPTS {
            self.link
                .write_all(frame)
                .and_then(|()| self.link.flush())
                .with_context(|| format!("the link to {} broke", self.name))?;
            if let Some(answer) = self.wait_for(request.sequence, &take)? {
                return answer;
            }
        }
        bail!(
            "no answer from {} within {:.1} s; is it a rig, powered and with this firmware, and does no other program talk to it?",
            self.name,
            (ANSWER_WAIT * ATTEMPTS).as_secs_f64()
        )
    }

    /// The answer to a request, if it comes in time. Damaged frames and answers to others are passed
    /// over.
    fn wait_for<T>(
        &mut self,
        sequence: u16,
        take: &impl Fn(&ReplyBody<'_>) -> Result<T>,
    ) -> Result<Option<Result<T>>> {
        let deadline = Instant::now() + ANSWER_WAIT;
        let mut bytes = [0; 1024];
        while Instant::now() < deadline {
            let count = port::read_some(&mut *self.link, &mut bytes)
                .with_context(|| format!("the link to {} broke", self.name))?;
            for &byte in &bytes[..count] {
                let Some(Ok(message)) = self.accumulator.push(byte) else { continue };
                match decode_reply(message) {
                    Ok(reply) if reply.sequence == sequence => {
                        return Ok(Some(match reply.body {
                            ReplyBody::Refused(refused) => {
                                Err(anyhow!("{}: {}", self.name, words::refusal(&refused)))
                            }
                            body => take(&body),
                        }));
                    }
                    _ => {}
                }
            }
        }
        Ok(None)
    }

    fn ask_done(&mut self, body: RequestBody<'_>) -> Result<()> {
        self.ask(body, |reply| match reply {
            ReplyBody::Done => Ok(()),
            other => Err(unexpected(other)),
        })
    }

    /// Who the rig is.
    ///
    /// # Errors
    /// When it does not answer, or speaks no version that this program knows.
    pub fn info(&mut self) -> Result<Info> {
        let name = self.name.clone();
        self.ask(RequestBody::Info, |reply| match *reply {
            ReplyBody::Info { min_version, version, firmware, build, board, record_capacity } => {
                if version < MIN_VERSION || min_version > CURRENT_VERSION {
                    bail!(
                        "{name} speaks protocol versions {min_version} to {version}, this program {MIN_VERSION} to {CURRENT_VERSION}; update the older of the two"
                    );
                }
                Ok(Info {
                    version,
                    firmware: firmware.to_owned(),
                    build: build.to_owned(),
                    board: board.to_owned(),
                    record_capacity,
                })
            }
            ref other => Err(unexpected(other)),
        })
    }

    /// How the rig is.
    ///
    /// # Errors
    /// When it does not answer.
    pub fn status(&mut self) -> Result<Status> {
        self.ask(RequestBody::Status, |reply| match reply {
            ReplyBody::Status(status) => Ok(*status),
            other => Err(unexpected(other)),
        })
    }

    /// Enables the drive.
    ///
    /// # Errors
    /// When it is refused or not answered.
    pub fn arm(&mut self) -> Result<()> {
        self.ask_done(RequestBody::Arm)
    }

    /// Disables the drive.
    ///
    /// # Errors
    /// When it is not answered.
    pub fn disarm(&mut self) -> Result<()> {
        self.ask_done(RequestBody::Disarm)
    }

    /// Stops at once.
    ///
    /// # Errors
    /// When it is not answered.
    pub fn stop(&mut self) -> Result<()> {
        self.ask_done(RequestBody::Stop)
    }

    /// States that the axis stands at `position_counts` now.
    ///
    /// # Errors
    /// When it is refused or not answered.
    pub fn reference(&mut self, position_counts: i32) -> Result<()> {
        self.ask_done(RequestBody::Reference { position_counts })
    }

    /// Starts the downloaded test.
    ///
    /// # Errors
    /// When it is refused or not answered.
    pub fn start(&mut self) -> Result<()> {
        self.ask_done(RequestBody::Start)
    }

    /// All parameters of the controller.
    ///
    /// # Errors
    /// When the rig does not answer, or has a value that this program does not know.
    pub fn parameters(&mut self) -> Result<Parameters> {
        let mut parameters = Parameters::default();
        for (first_id, count) in blocks() {
            let values: Vec<i32> =
                self.ask(RequestBody::ConfigGet { first_id, count }, |reply| match reply {
                    ReplyBody::Config { values, .. } if values.len() == usize::from(count) => {
                        Ok(values.iter().collect())
                    }
                    other => Err(unexpected(other)),
                })?;
            for (id, value) in (first_id..).zip(values) {
                parameters.set(id, value).map_err(|_| {
                    anyhow!("{} has {value} for parameter {id}, which is out of range here", self.name)
                })?;
            }
        }
        Ok(parameters)
    }

    /// Changes parameters with consecutive ids: all of them or none.
    ///
    /// # Errors
    /// When a value is refused, or the drive is not disarmed.
    pub fn set_parameters(&mut self, first_id: u16, values: &[i32]) -> Result<()> {
        let mut room = [0; 4 * MAX_VALUES];
        let values = Values::fill(&mut room, values.iter().copied())
            .ok_or_else(|| anyhow!("more than {MAX_VALUES} values at once"))?;
        self.ask_done(RequestBody::ConfigSet { first_id, values })
    }

    /// Downloads all parameters.
    ///
    /// # Errors
    /// When one is refused, or the drive is not disarmed.
    pub fn import_parameters(&mut self, parameters: &Parameters) -> Result<()> {
        for (first_id, count) in blocks() {
            let ids = first_id..first_id + u16::from(count);
            let values: Vec<i32> = ids.filter_map(|id| parameters.get(id)).collect();
            self.set_parameters(first_id, &values)?;
        }
        Ok(())
    }

    /// Downloads the test of a rig.
    ///
    /// # Errors
    /// When it is refused, or the drive is not disarmed.
    pub fn download_test(&mut self, rig: &Rig) -> Result<()> {
        self.ask_done(RequestBody::TestBegin {
            name: short(rig.name()),
            duration_us: u32::try_from(rig.microseconds("test.duration_s")).unwrap_or(u32::MAX),
            decimation: rig.integer("test.decimation") as u16,
            pre_trigger: rig.integer("test.pre_trigger") as u16,
        })?;
        for (time_s, target) in rig.moves() {
            let time_us = (time_s * 1e6).round() as u32;
            self.ask_done(RequestBody::TestMove { time_us, target: target as i32 })?;
        }
        Ok(())
    }

    /// Follows a run to its end; `progress` is given the status now and then. Stops the rig once
    /// `interrupted` is set.
    ///
    /// # Errors
    /// When the drive trips, the run is ended by someone else, or the rig stops answering.
    pub fn follow(&mut self, interrupted: &AtomicBool, mut progress: impl FnMut(&Status)) -> Result<Status> {
        loop {
            if interrupted.load(Ordering::Relaxed) {
                self.stop()?;
                bail!("{}: stopped, as you asked; `pneudrive device arm` leaves the fault", self.name);
            }
            let status = self.status()?;
            progress(&status);
            match status.mode {
                Mode::Running => std::thread::sleep(Duration::from_millis(20)),
                Mode::Fault => bail!(
                    "{} tripped at sample {}: {} ({}); `pneudrive device arm` leaves the fault",
                    self.name,
                    status.index,
                    words::fault_code_name(status.fault),
                    words::fault_meaning(status.fault)
                ),
                Mode::Done => return Ok(status),
                Mode::Disarmed | Mode::Armed => bail!(
                    "{}: the run did not come to its end; the rig was reset, or someone else disarmed it",
                    self.name
                ),
            }
        }
    }

    /// Pulls the recorded transient; `progress` is given samples done and samples in all.
    ///
    /// # Errors
    /// When there is none yet, or what came is not what was recorded.
    pub fn record(&mut self, mut progress: impl FnMut(usize, usize)) -> Result<Record> {
        let (mut record, count, expected_crc) = self.record_info()?;
        let mut crc = RecordCrc::new();
        while record.samples.len() < count {
            let first = record.samples.len();
            let wanted = (count - first).min(CHUNK_SAMPLES);
            let request = RequestBody::RecordRead { first: first as u32, count: wanted as u8 };
            let bytes: Vec<u8> = self.ask(request, |reply| match reply {
                ReplyBody::Chunk { first: at, samples }
                    if *at as usize == first && samples.len() == wanted * RecordedSample::BYTES =>
                {
                    Ok(samples.to_vec())
                }
                other => Err(unexpected(other)),
            })?;
            crc.update(&bytes);
            record.samples.extend(RecordedSample::read(&bytes).into_iter().flatten());
            progress(record.samples.len(), count);
        }
        if crc.finish() != expected_crc {
            bail!("the record changed while it was read (its CRC does not fit); record again");
        }
        Ok(record)
    }

    /// What the record holds, its number of samples and its CRC.
    fn record_info(&mut self) -> Result<(Record, usize, u32)> {
        let mut info = self.ask_record_info()?;
        // The rig forms the CRC of its record piece by piece.
        for _ in 0..MOST_DIGESTS {
            if info.3 || matches!(self.status()?.mode, Mode::Armed | Mode::Running) {
                break;
            }
            info = self.ask_record_info()?;
        }
        let (record, count, crc, complete) = info;
        if !complete {
            bail!("{} is still recording; wait for the end of the run", self.name);
        }
        if count == 0 {
            bail!("{}: {}", self.name, words::refusal(&pneudrive_protocol::Refused::NoRecord));
        }
        Ok((record, count, crc))
    }

    fn ask_record_info(&mut self) -> Result<(Record, usize, u32, bool)> {
        self.ask(RequestBody::RecordInfo, |reply| match reply {
            ReplyBody::RecordInfo(info) => {
                let record = Record {
                    test: info.test.to_owned(),
                    decimation: info.decimation,
                    pre_trigger: info.pre_trigger,
                    first_index: info.first_index,
                    measured_period_ns: info.measured_period_ns,
                    mean_spool_raw: info.mean_spool_raw,
                    samples: Vec::new(),
                };
                Ok((record, info.samples as usize, info.crc32, info.complete))
            }
            other => Err(unexpected(other)),
        })
    }
}

/// First id and length of the blocks in which all parameters are read and written.
fn blocks() -> impl Iterator<Item = (u16, u8)> {
    let scalars = TABLE.iter().filter(|p| p.len == 1).count() as u16;
    let runs = std::iter::once((TABLE[0].id, scalars))
        .chain(TABLE.iter().filter(|p| p.len > 1).map(|p| (p.id, p.len)));
    runs.flat_map(|(first, len)| {
        (0..len).step_by(MAX_VALUES).map(move |at| (first + at, (len - at).min(MAX_VALUES as u16) as u8))
    })
}

/// A name short enough for every message.
fn short(name: &str) -> &str {
    let end = (0..=name.len().min(pneudrive_app::control::NAME_BYTES))
        .rev()
        .find(|&end| name.is_char_boundary(end));
    &name[..end.unwrap_or(0)]
}

fn unexpected(reply: &ReplyBody<'_>) -> anyhow::Error {
    anyhow!("the rig gave an answer that does not fit the request: {reply:?}")
}
