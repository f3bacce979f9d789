//! The stream of a rig: samples of a run while it is on (version 3 of the protocol).

use std::collections::VecDeque;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use anyhow::Result;
use pneudrive_protocol::{MAX_ROWS, Reply, ReplyBody, RequestBody, Status, StreamedSample};

use super::{Client, unexpected};
use crate::stream::Arrivals;

/// Rows that may come before the next grant: several times what comes until then, so that one is lost
/// without harm; few enough for a rig to fall silent soon after its host has gone.
const GRANTED: u32 = 4096;

/// How long rows are waited for at once.
const LISTEN: Duration = Duration::from_millis(20);

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
}

/// What has come unasked and was not looked at yet.
#[derive(Debug, Default)]
pub(super) struct Unasked {
    /// Number of the request that began the stream.
    stream: Option<u16>,
    rows: VecDeque<Rows>,
}

impl Unasked {
    /// Sets a reply aside if it is part of the stream.
    pub(super) fn takes(&mut self, reply: &Reply<'_>) -> bool {
        match Rows::of(&reply.body) {
            Some(rows) if self.stream == Some(reply.sequence) => {
                self.rows.push_back(rows);
                true
            }
            _ => false,
        }
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
        self.unasked = Unasked { stream: Some(self.sequence.wrapping_add(1)), rows: VecDeque::new() };
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
        self.ask_done(RequestBody::StreamGrant { until })
    }

    /// Follows a run as [`Client::follow`] does, and gives each sample of its stream to `take`, in order and
    /// to the last one, whatever ends the run. Tells the status at the end, and how many rows the link has
    /// lost for good.
    ///
    /// # Errors
    /// As [`Client::follow`], or what `take` says.
    pub fn follow_streamed(
        &mut self,
        interrupted: &AtomicBool,
        progress: impl FnMut(&Status),
        mut take: impl FnMut(&StreamedSample) -> Result<()>,
    ) -> Result<(Status, u64)> {
        let mut arrivals = Arrivals::default();
        let mut drain =
            |arrivals: &mut Arrivals| std::iter::from_fn(|| arrivals.take()).try_for_each(|row| take(&row));
        let followed = self.follow_and(interrupted, progress, |client| {
            client.stream_on(&mut arrivals)?;
            drain(&mut arrivals)
        });
        let rest = self.stream_rest(&mut arrivals).and_then(|()| drain(&mut arrivals));
        followed.and_then(|status| rest.map(|()| (status, arrivals.lost())))
    }

    /// Listens for a moment, has the rows again that were lost on the way, and lets as many more come.
    fn stream_on(&mut self, arrivals: &mut Arrivals) -> Result<()> {
        let deadline = self.link.now() + LISTEN;
        self.hear(deadline, |_| None::<()>)?;
        for Rows { first, rows } in std::mem::take(&mut self.unasked.rows) {
            arrivals.came(first, rows);
        }
        while let Some((first, count)) = arrivals.missing() {
            let again = self.stream_read(first, count)?;
            arrivals.came(again.first, again.rows);
            // What is not among them, the rig does not hold any more.
            arrivals.gone(first + u32::from(count));
        }
        self.stream_grant(arrivals.next().saturating_add(GRANTED))
    }

    /// The last rows of a stream whose run is over: nothing came after them that would have told that they
    /// are missing. No more than the rig holds, so it comes to an end, and is not to be interrupted.
    fn stream_rest(&mut self, arrivals: &mut Arrivals) -> Result<()> {
        loop {
            self.stream_on(arrivals)?;
            let end = arrivals.end();
            let again = self.stream_read(end, MAX_ROWS as u8)?;
            if again.rows.is_empty() && again.first <= end {
                return Ok(());
            }
            arrivals.came(again.first, again.rows);
            arrivals.gone(again.first);
        }
    }

    fn stream_read(&mut self, first: u32, count: u8) -> Result<Rows> {
        self.ask(RequestBody::StreamRead { first, count }, |reply| {
            Rows::of(reply).ok_or_else(|| unexpected(reply))
        })
    }
}
