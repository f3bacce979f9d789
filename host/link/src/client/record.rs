//! The record of a rig: its head, and its samples by a [`Download`].

use std::ops::RangeInclusive;
use std::time::Duration;

use anyhow::{Context, Result};
use pneudrive_protocol::{
    CHUNK_SAMPLES, Mode, RecordCrc, RecordedSample, Reply, ReplyBody, RequestBody, RequestRefusal,
};
use pneudrive_records::record::{Record, RecordHead};

use super::Client;
use super::answer::{refusal, unexpected};

use crate::download::Download;
use crate::failure::Failure;

/// How long a rig may take to compute the CRC of its record.
const DIGESTING: Duration = Duration::from_secs(5);

/// The rig has another record now than when the download began.
#[derive(Clone, Copy, Debug, thiserror::Error)]
#[error("the record changed while it was read; record again")]
pub struct RecordChanged;

/// The downloaded part of a record.
#[derive(Clone, Debug)]
pub struct Pieces {
    /// Up to the last chunk received; zeros where one is missing.
    bytes: Vec<u8>,
    /// Bytes of all samples.
    length: usize,
    download: Download,
}

impl Pieces {
    /// No chunk of a record with this number of samples.
    #[must_use]
    pub fn none(samples: usize) -> Pieces {
        Pieces {
            bytes: Vec::new(),
            length: samples * RecordedSample::BYTES,
            download: Download::new(samples.div_ceil(CHUNK_SAMPLES)),
        }
    }

    /// Adds a chunk, unless it is there already or does not belong to this record.
    pub fn take(&mut self, first: usize, samples: &[u8]) -> bool {
        let place = first.saturating_mul(RecordedSample::BYTES);
        let whole = CHUNK_SAMPLES * RecordedSample::BYTES;
        let end = place.saturating_add(whole).min(self.length);
        let fits = first.is_multiple_of(CHUNK_SAMPLES) && end.checked_sub(place) == Some(samples.len());
        if !fits || !self.download.arrived(first / CHUNK_SAMPLES) {
            return false;
        }
        self.bytes.resize(self.bytes.len().max(end), 0);
        self.bytes[place..end].copy_from_slice(samples);
        true
    }

    /// Number of samples that are there; until the record is complete, a short last chunk counts as a full one.
    #[must_use]
    pub fn samples(&self) -> usize {
        (self.download.arrivals() * CHUNK_SAMPLES).min(self.length / RecordedSample::BYTES)
    }

    /// The record, if its CRC matches the pieces.
    fn join(self, head: &RecordHead) -> Result<Record, RecordChanged> {
        let mut crc = RecordCrc::new();
        crc.update(&self.bytes);
        if crc.finish() != head.crc32 {
            return Err(RecordChanged);
        }
        let samples = RecordedSample::read(&self.bytes).into_iter().flatten().collect();
        Ok(Record { head: head.clone(), samples })
    }
}

/// An answer to the request for a chunk.
type Answer = Result<(usize, Vec<u8>)>;

impl Client {
    /// Downloads the recorded transient; `progress` is given the number of samples done and of all samples.
    ///
    /// # Errors
    /// When there is none yet, or the samples do not match its CRC.
    pub fn record(&mut self, mut progress: impl FnMut(usize, usize)) -> Result<Record> {
        let head = self.record_head()?;
        let mut done = 0;
        self.download(&head, Pieces::none(head.samples), |_, samples| {
            done += samples.len() / RecordedSample::BYTES;
            progress(done, head.samples);
            Ok(())
        })
    }

    /// Downloads the missing part of a record; `keep` is given each chunk: the position of its first sample, and its bytes.
    ///
    /// # Errors
    /// [`RecordChanged`], or when the rig falls silent or the link breaks.
    pub fn download(
        &mut self,
        head: &RecordHead,
        mut pieces: Pieces,
        mut keep: impl FnMut(usize, &[u8]) -> Result<()>,
    ) -> Result<Record> {
        // Chunks are known by their first sample: a repeat has a number of its own, as that of any question.
        let first = self.sequence.wrapping_add(1);
        let mut progress = self.link.now();
        while !pieces.download.is_complete() {
            while let Some(chunk) = pieces.download.ask() {
                self.ask_for_chunk(head, chunk)?;
            }
            let deadline = self.link.now() + self.answer_wait();
            let (rig, last) = (self.name.clone(), self.sequence);
            match self.hear(deadline, |reply| answer(reply, first..=last, &rig))?.transpose()? {
                Some((first, samples)) if pieces.take(first, &samples) => {
                    keep(first, &samples)?;
                    progress = self.link.now();
                }
                Some(_) => {}
                None => pieces.download.fell_silent(),
            }
            if self.link.now() > progress + self.patience {
                return Err(self.no_answer());
            }
        }
        self.repeats += pieces.download.repeats() as u32;
        Ok(pieces.join(head)?)
    }

    fn ask_for_chunk(&mut self, head: &RecordHead, chunk: usize) -> Result<()> {
        let first = chunk * CHUNK_SAMPLES;
        let count = (head.samples - first).min(CHUNK_SAMPLES) as u8;
        let first = first as u32;
        self.sequence = self.sequence.wrapping_add(1);
        self.send(self.sequence, RequestBody::RecordRead { crc32: head.crc32, first, count })
    }

    /// The head of the record, with its CRC.
    ///
    /// # Errors
    /// When there is none yet.
    pub fn record_head(&mut self) -> Result<RecordHead> {
        self.record_head_while(|| Ok(()))
    }

    /// The same, as long as `goes_on` allows it: it is called repeatedly while the rig computes the CRC.
    ///
    /// # Errors
    /// As [`Client::record_head`], and as `goes_on`.
    pub fn record_head_while(&mut self, mut goes_on: impl FnMut() -> Result<()>) -> Result<RecordHead> {
        let (mut head, mut complete) = self.ask_record_info()?;
        // The rig computes the CRC of its record piece by piece.
        let deadline = self.link.now() + DIGESTING;
        while !complete && self.link.now() < deadline {
            goes_on()?;
            if matches!(self.status()?.mode, Mode::Armed | Mode::Homing | Mode::Running) {
                break;
            }
            (head, complete) = self.ask_record_info()?;
        }
        if !complete {
            let why = match self.status()?.mode {
                Mode::Armed => "is armed: it has no record until a run has made one",
                _ => "is still recording; wait for the end of the run",
            };
            return Err(Failure::Refused.error(format!("{} {why}", self.name)));
        }
        if head.samples == 0 {
            return Err(refusal(&self.name, &RequestRefusal::NoRecord));
        }
        head.check(self.record_capacity as usize).with_context(|| self.name.clone())?;
        Ok(head)
    }

    fn ask_record_info(&mut self) -> Result<(RecordHead, bool)> {
        self.ask(RequestBody::RecordInfo, |reply| match reply {
            ReplyBody::RecordInfo(info) => Ok((info.into(), info.complete)),
            other => Err(unexpected(other)),
        })
    }
}

/// The answer for a chunk in a reply; None for a reply to none of the requests with these numbers, which wrap.
fn answer(reply: &Reply<'_>, asked: RangeInclusive<u16>, rig: &str) -> Option<Answer> {
    let (first, last) = asked.into_inner();
    if reply.sequence.wrapping_sub(first) > last.wrapping_sub(first) {
        return None;
    }
    match reply.body {
        ReplyBody::Chunk { first, samples } => Some(Ok((first as usize, samples.to_vec()))),
        ReplyBody::Refused(refused) => Some(Err(match refused {
            RequestRefusal::OtherRecord | RequestRefusal::NoRecord | RequestRefusal::RecordRange { .. } => {
                RecordChanged.into()
            }
            other => refusal(rig, &other),
        })),
        _ => None,
    }
}
