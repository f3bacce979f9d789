//! The record of a rig: what it holds, and its samples by a [`Download`].

use std::time::Duration;

use anyhow::{Context, Result, anyhow, bail};
use pneudrive_protocol::{
    CHUNK_SAMPLES, Mode, RecordCrc, RecordInfo, RecordedSample, Refused, Reply, ReplyBody, Request,
    RequestBody,
};

use super::{ANSWER_WAIT, Client, PATIENCE, unexpected};
use crate::download::Download;
use crate::foreign::{NAME, cleaned};
use crate::words;

/// How long a rig may take to form the CRC of a record that it is asked for.
const DIGESTING: Duration = Duration::from_secs(5);

/// The most samples of a record: the number of a request, 16 bits, tells its chunk.
const MOST_SAMPLES: usize = u16::MAX as usize * CHUNK_SAMPLES;

/// What is known of a record before its samples are there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordHead {
    /// Name of the test.
    pub test: String,
    /// Stored samples.
    pub samples: usize,
    /// Index of the oldest sample.
    pub first_index: i32,
    /// Every Nth sample was stored.
    pub decimation: u16,
    /// Samples from before the start.
    pub pre_trigger: u16,
    /// Mean interval of the samples by the board's clock, ns. It goes on being measured after the record.
    pub measured_period_ns: u32,
    /// Mean of the spool channel, raw.
    pub mean_spool_raw: i16,
    /// CRC-32 of all samples.
    pub crc32: u32,
}

impl From<&RecordInfo<'_>> for RecordHead {
    fn from(info: &RecordInfo<'_>) -> RecordHead {
        RecordHead {
            test: cleaned(info.test, NAME),
            samples: info.samples as usize,
            first_index: info.first_index,
            decimation: info.decimation,
            pre_trigger: info.pre_trigger,
            measured_period_ns: info.measured_period_ns,
            mean_spool_raw: info.mean_spool_raw,
            crc32: info.crc32,
        }
    }
}

impl RecordHead {
    /// The message that tells it.
    #[must_use]
    pub fn info(&self) -> RecordInfo<'_> {
        RecordInfo {
            test: &self.test,
            samples: self.samples as u32,
            first_index: self.first_index,
            decimation: self.decimation,
            pre_trigger: self.pre_trigger,
            complete: true,
            measured_period_ns: self.measured_period_ns,
            mean_spool_raw: self.mean_spool_raw,
            crc32: self.crc32,
        }
    }

    /// Whether another head is that of the same record: all but what goes on being measured.
    #[must_use]
    pub fn is_of_the_same_record(&self, other: &RecordHead) -> bool {
        let measured_period_ns = self.measured_period_ns;
        *self == RecordHead { measured_period_ns, ..other.clone() }
    }

    /// The index k of each sample: those from before the start as the recorder says, then from 0 on.
    pub fn indices(&self) -> impl Iterator<Item = i64> {
        let (step, first) = (usize::from(self.decimation.max(1)), i64::from(self.first_index));
        (first..0).step_by(step).chain((0..).step_by(step)).take(self.samples)
    }

    /// The index of its last sample.
    fn last_index(&self) -> i64 {
        let (step, first) = (i64::from(self.decimation.max(1)), i64::from(self.first_index));
        let before = (-first).max(0) as u64;
        let before = before.div_ceil(step as u64) as i64;
        let samples = self.samples as i64;
        if samples > before { (samples - before - 1) * step } else { first + (samples - 1) * step }
    }

    /// Whether a rig with room for so many samples can have such a record, and a file can hold it.
    ///
    /// # Errors
    /// With what is impossible.
    pub fn check(&self, capacity: usize) -> Result<()> {
        let RecordHead { samples, first_index, .. } = *self;
        if samples > capacity.min(MOST_SAMPLES) {
            bail!("it says that its record has {samples} samples, and that it has room for {capacity}");
        }
        if first_index > 0 {
            bail!("it says that its record begins with sample {first_index}, after the start of the run");
        }
        if self.last_index() > i64::from(i32::MAX) {
            bail!(
                "its record ends with sample {}, and files count up to {}; record with a smaller test.decimation",
                self.last_index(),
                i32::MAX
            );
        }
        Ok(())
    }
}

/// A recorded transient with what is known about it.
#[derive(Clone, Debug)]
pub struct Record {
    /// What is known about it.
    pub head: RecordHead,
    /// The samples, oldest first.
    pub samples: Vec<RecordedSample>,
}

/// The rig has another record now than when the download began.
#[derive(Clone, Copy, Debug, thiserror::Error)]
#[error("the record changed while it was read; record again")]
pub struct RecordChanged;

/// What is there of a record.
#[derive(Clone, Debug)]
pub struct Pieces {
    /// Up to the last chunk that has come; zeros where one is missing.
    bytes: Vec<u8>,
    /// Bytes of all samples.
    length: usize,
    download: Download,
}

impl Pieces {
    /// Nothing of a record of so many samples.
    #[must_use]
    pub fn none(samples: usize) -> Pieces {
        Pieces {
            bytes: Vec::new(),
            length: samples * RecordedSample::BYTES,
            download: Download::new(samples.div_ceil(CHUNK_SAMPLES)),
        }
    }

    /// Takes a chunk, unless it is there already or is none of this record.
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

    /// Samples that are there, at least.
    #[must_use]
    pub fn samples(&self) -> usize {
        (self.download.arrivals() * CHUNK_SAMPLES).min(self.length / RecordedSample::BYTES)
    }

    /// The record, if its CRC is that of the pieces.
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
    /// Pulls the recorded transient; `progress` is given samples done and samples in all.
    ///
    /// # Errors
    /// When there is none yet, or what came is not what was recorded.
    pub fn record(&mut self, mut progress: impl FnMut(usize, usize)) -> Result<Record> {
        let head = self.record_head()?;
        let mut done = 0;
        self.download(&head, Pieces::none(head.samples), |_, samples| {
            done += samples.len() / RecordedSample::BYTES;
            progress(done, head.samples);
            Ok(())
        })
    }

    /// What is missing of a record; `keep` is given each chunk that comes: position of its first sample, and
    /// their bytes.
    ///
    /// # Errors
    /// [`RecordChanged`], or when the rig falls silent or the link breaks.
    pub fn download(
        &mut self,
        head: &RecordHead,
        mut pieces: Pieces,
        mut keep: impl FnMut(usize, &[u8]) -> Result<()>,
    ) -> Result<Record> {
        // The request for a chunk is the same whenever it is sent: its number is that of the chunk.
        let base = self.sequence.wrapping_add(1);
        let chunks = head.samples.div_ceil(CHUNK_SAMPLES);
        self.sequence = self.sequence.wrapping_add(chunks as u16);
        let mut progress = self.link.now();
        while !pieces.download.is_complete() {
            while let Some(chunk) = pieces.download.ask() {
                self.ask_for_chunk(head, base, chunk)?;
            }
            let deadline = self.link.now() + ANSWER_WAIT;
            let rig = self.name.clone();
            match self.hear(deadline, |reply| answer(reply, base, chunks, &rig))?.transpose()? {
                Some((first, samples)) if pieces.take(first, &samples) => {
                    keep(first, &samples)?;
                    progress = self.link.now();
                }
                Some(_) => {}
                None => pieces.download.fell_silent(),
            }
            if self.link.now() > progress + PATIENCE {
                return Err(self.no_answer());
            }
        }
        self.repeats += pieces.download.repeats() as u32;
        Ok(pieces.join(head)?)
    }

    fn ask_for_chunk(&mut self, head: &RecordHead, base: u16, chunk: usize) -> Result<()> {
        let first = chunk * CHUNK_SAMPLES;
        let count = (head.samples - first).min(CHUNK_SAMPLES) as u8;
        let first = first as u32;
        // Older firmware has no name for a record: what it sends of another one, the CRC finds at the end.
        let body = match self.version {
            ..3 => RequestBody::RecordRead { first, count },
            3.. => RequestBody::RecordChunk { crc32: head.crc32, first, count },
        };
        self.send(Request { sequence: base.wrapping_add(chunk as u16), body })
    }

    /// What the record holds, its CRC included.
    ///
    /// # Errors
    /// When there is none yet.
    pub fn record_head(&mut self) -> Result<RecordHead> {
        let (mut head, mut complete) = self.ask_record_info()?;
        // The rig forms the CRC of its record piece by piece.
        let deadline = self.link.now() + DIGESTING;
        while !complete && self.link.now() < deadline {
            if matches!(self.status()?.mode, Mode::Armed | Mode::Running) {
                break;
            }
            (head, complete) = self.ask_record_info()?;
        }
        if !complete {
            match self.status()?.mode {
                Mode::Armed => bail!("{} is armed: it has no record until a run has made one", self.name),
                _ => bail!("{} is still recording; wait for the end of the run", self.name),
            }
        }
        if head.samples == 0 {
            bail!("{}: {}", self.name, words::refusal(&Refused::NoRecord));
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

/// What a reply says of a chunk: None for a reply to something else.
fn answer(reply: &Reply<'_>, base: u16, chunks: usize, rig: &str) -> Option<Answer> {
    let chunk = reply.sequence.wrapping_sub(base);
    match reply.body {
        ReplyBody::Chunk { first, samples } if (first as usize / CHUNK_SAMPLES) as u16 == chunk => {
            Some(Ok((first as usize, samples.to_vec())))
        }
        ReplyBody::Refused(refused) if usize::from(chunk) < chunks => Some(Err(match refused {
            Refused::OtherRecord | Refused::NoRecord | Refused::RecordRange { .. } => RecordChanged.into(),
            other => anyhow!("{rig}: {}", words::refusal(&other)),
        })),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn head(samples: usize, decimation: u16, first_index: i32) -> RecordHead {
        let (test, pre_trigger, crc32) = (String::new(), 0, 0);
        let (measured_period_ns, mean_spool_raw) = (1_300_000, 0);
        RecordHead {
            test,
            samples,
            first_index,
            decimation,
            pre_trigger,
            measured_period_ns,
            mean_spool_raw,
            crc32,
        }
    }

    /// Once the index wrapped, at sample 32,769.
    #[test]
    fn a_record_that_goes_on_behind_what_files_count_to_is_refused() {
        let error = head(40_000, u16::MAX, 0).check(65_536).expect_err("too far").to_string();
        assert!(error.contains("ends with sample 2621334465"), "{error}");
        assert_eq!(head(40_000, u16::MAX, 0).indices().last(), Some(2_621_334_465));
        assert!(head(32_768, u16::MAX, 0).check(65_536).is_ok());
        assert!(head(32_770, u16::MAX, 0).check(65_536).is_err());
    }

    #[test]
    fn the_last_index_is_that_of_the_last_sample() {
        for (samples, decimation, first) in
            [(1, 1, 0), (5, 1, -2), (5, 3, -7), (5, 3, -15), (2, 3, -15), (4, 0, 0), (3, 9, i32::MIN)]
        {
            let head = head(samples, decimation, first);
            assert_eq!(head.indices().last(), Some(head.last_index()), "{samples} {decimation} {first}");
        }
    }

    #[test]
    fn a_record_that_no_rig_has_is_refused() {
        assert!(head(4390, 1, 0).check(4389).is_err(), "longer than the memory");
        assert!(head(usize::MAX, 1, 0).check(usize::MAX).is_err(), "more chunks than requests have numbers");
        assert!(head(5, 1, 1).check(4389).is_err(), "it begins after the start");
        assert!(head(4389, 1, -2000).check(4389).is_ok());
    }
}
