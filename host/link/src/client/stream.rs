//! The stream of a rig: samples of a run while it is on (version 3 of the protocol).

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use anyhow::{Result, bail};
use pneudrive_protocol::{MAX_ROWS, Reply, ReplyBody, RequestBody, Status, StreamedSample};

use super::Client;
use super::answer::unexpected;
use crate::stream::Arrivals;

/// Rows that may come before the next grant: several times what comes until then, so that one is lost
/// without harm; few enough for a rig to fall silent soon after its host has gone.
const GRANTED: u32 = 4096;

/// How long rows are waited for at once.
const LISTEN: Duration = Duration::from_millis(20);

/// How long the rows may take that are left when a run is over: the rig holds some hundred.
const REST: Duration = Duration::from_secs(3);

/// Rows of a stream.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Rows {
    /// Number of the first one.
    pub first: u32,
    /// The rows.
    pub rows: Vec<StreamedSample>,
}

impl Rows {
    fn of(body: &ReplyBody<'_>) -> Option<Rows> {
        let ReplyBody::Rows { first, rows } = *body else { return None };
        Some(Rows { first, rows: StreamedSample::read(rows)?.collect() })
    }

    /// Number of the row behind the last one.
    fn end(&self) -> u64 {
        u64::from(self.first) + self.rows.len() as u64
    }
}

/// What has come unasked and was not looked at yet.
#[derive(Debug, Default)]
pub(super) struct Unasked {
    /// Number of the request that began the stream.
    stream: Option<u16>,
    /// Every how manyth sample becomes a row.
    every: u16,
    /// Number of the first row that may not come unasked.
    granted: u32,
    rows: VecDeque<Rows>,
    /// The end of a row that was not granted. It is not kept.
    beyond: Option<u64>,
}

impl Unasked {
    /// Sets a reply aside if it is part of the stream.
    pub(super) fn takes(&mut self, reply: &Reply<'_>) -> bool {
        let Some(rows) = Rows::of(&reply.body).filter(|_| self.stream == Some(reply.sequence)) else {
            return false;
        };
        // As many messages as rows are granted, at most: more repeat each other.
        if rows.end() > u64::from(self.granted) {
            self.beyond = Some(rows.end());
        } else if self.rows.len() < GRANTED as usize {
            self.rows.push_back(rows);
        }
        true
    }
}

impl Client {
    /// # Errors
    /// When the firmware has no streams: says so by name.
    pub fn needs_streams(&mut self) -> Result<()> {
        self.needs_version(3, "a stream")
    }

    /// Begins a stream of every Nth sample of a run; `sample_hz` is how many samples there are a second.
    /// Rows come a few times a second, or in full messages.
    ///
    /// # Errors
    /// When the firmware is too old, or does not answer.
    pub fn stream_begin(&mut self, every: u16, sample_hz: f64) -> Result<()> {
        self.needs_streams()?;
        let batch = (sample_hz / f64::from(every.max(1)) / 10.0).clamp(1.0, MAX_ROWS as f64) as u8;
        let stream = Some(self.sequence.wrapping_add(1));
        self.unasked = Unasked { stream, every, ..Unasked::default() };
        self.ask_done(RequestBody::StreamBegin { every, batch })?;
        self.stream_grant(GRANTED)
    }

    /// Ends the stream.
    ///
    /// # Errors
    /// When the rig does not answer.
    pub fn stream_end(&mut self) -> Result<()> {
        self.ask_done(RequestBody::StreamBegin { every: 0, batch: 1 })?;
        self.unasked = Unasked::default();
        Ok(())
    }

    fn stream_grant(&mut self, until: u32) -> Result<()> {
        self.unasked.granted = self.unasked.granted.max(until);
        self.ask_done(RequestBody::StreamGrant { until })
    }

    /// Follows a run as [`Client::follow`] does, and gives each sample of its stream to `take`, in order and
    /// to the last one, whatever ends the run. Tells the status at the end, and how many rows the link has
    /// lost for good.
    ///
    /// # Errors
    /// As [`Client::follow`], what `take` says, or when the rows are none that the run can have.
    pub fn follow_streamed(
        &mut self,
        interrupted: &AtomicBool,
        progress: impl FnMut(&Status),
        mut take: impl FnMut(&StreamedSample) -> Result<()>,
    ) -> Result<(Status, u64)> {
        let mut arrivals = Arrivals::default();
        let mut drain = |arrivals: &mut Arrivals, reached: u32| {
            while let Some(row) = arrivals.take(reached)? {
                take(&row)?;
            }
            Ok(())
        };
        let followed = self.follow_and(interrupted, progress, |client, status| {
            client.stream_on(&mut arrivals, interrupted)?;
            // Rows that came behind this status wait for the next one.
            drain(&mut arrivals, status.index)
        });
        let reached = match &followed {
            Ok(status) => status.index,
            Err(_) => self.status().map(|status| status.index).unwrap_or(0),
        };
        let rest = self.stream_rest(&mut arrivals, reached).and_then(|()| {
            drain(&mut arrivals, reached)?;
            match arrivals.waiting() {
                Some(sample) => bail!("{}: it streams sample {sample} of a run up to {reached}", self.name),
                None => Ok(()),
            }
        });
        followed.and_then(|status| rest.map(|()| (status, arrivals.lost())))
    }

    /// Listens for a moment, has the rows again that were lost on the way, and lets as many more come.
    fn stream_on(&mut self, arrivals: &mut Arrivals, interrupted: &AtomicBool) -> Result<()> {
        self.stream_listen(arrivals, interrupted)?;
        self.stream_grant(arrivals.next().saturating_add(GRANTED))
    }

    /// Listens for a moment, and has the rows again that were lost on the way.
    fn stream_listen(&mut self, arrivals: &mut Arrivals, interrupted: &AtomicBool) -> Result<()> {
        let deadline = self.link.now() + LISTEN;
        self.hear(deadline, |_| None::<()>)?;
        if let Some(end) = self.unasked.beyond {
            bail!("{}: it streams up to row {end}, of which {} are granted", self.name, self.unasked.granted);
        }
        for Rows { first, rows } in std::mem::take(&mut self.unasked.rows) {
            arrivals.came(first, rows);
        }
        while let Some((first, count)) = arrivals.missing() {
            if interrupted.load(Ordering::Relaxed) {
                break;
            }
            let again = self.stream_read(first, count)?;
            // What is not among them, the rig does not hold any more. Of what is behind the last row that has come, it
            // cannot say that yet.
            let gone = again.first.min(arrivals.end()).max(first + u32::from(count));
            arrivals.came(again.first, again.rows);
            arrivals.gone(gone);
        }
        Ok(())
    }

    /// The last rows of a stream whose run is over at the sample `reached`: nothing came after them that would have told
    /// that they are missing. No more than the rig holds, so it comes to an end, and is not to be interrupted.
    fn stream_rest(&mut self, arrivals: &mut Arrivals, reached: u32) -> Result<()> {
        let most = u64::from(reached / u32::from(self.unasked.every.max(1))) + 1;
        let deadline = self.link.now() + REST;
        while self.link.now() < deadline {
            self.stream_listen(arrivals, &AtomicBool::new(false))?;
            let end = arrivals.end();
            let again = self.stream_read(end, MAX_ROWS as u8)?;
            if again.end() > most || u64::from(end) > most {
                bail!("{}: its stream has more rows than the {most} that the run can have", self.name);
            }
            if again.rows.is_empty() && again.first <= end {
                return Ok(());
            }
            let gone = again.first;
            arrivals.came(again.first, again.rows);
            arrivals.gone(gone);
        }
        bail!("{}: the last rows of its stream do not come", self.name)
    }

    fn stream_read(&mut self, first: u32, count: u8) -> Result<Rows> {
        self.ask(RequestBody::StreamRead { first, count }, |reply| {
            Rows::of(reply).ok_or_else(|| unexpected(reply))
        })
    }
}
