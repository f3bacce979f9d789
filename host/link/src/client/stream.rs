//! The stream of a rig: samples of a run while it lasts.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use anyhow::{Result, bail};
use pneudrive_protocol::{MAX_ROWS, Reply, ReplyBody, RequestBody, Status, StreamedSample};

use super::Client;
use super::answer::unexpected;
use crate::stream::Arrivals;

/// Rows that a rig may send before the next grant: several times what it sends until then, so that a lost grant does no
/// harm; few enough that it falls silent soon after its host has gone.
const GRANTED: u32 = 4096;

/// How long to wait for rows at a time.
const LISTEN: Duration = Duration::from_millis(20);

/// How long the remaining rows may take when a run is over: the rig holds some hundred.
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

    /// Number of the row after the last one.
    fn end(&self) -> u64 {
        u64::from(self.first) + self.rows.len() as u64
    }
}

/// Unsolicited rows that were not examined yet.
#[derive(Debug, Default)]
pub(super) struct Unasked {
    /// Number of the request that began the stream.
    stream: Option<u16>,
    /// Every Nth sample becomes a row.
    every: u16,
    /// Number of the first row that is not granted.
    granted: u32,
    rows: VecDeque<Rows>,
    /// The end of rows that were not granted; they are not kept.
    beyond: Option<u64>,
}

impl Unasked {
    /// Sets a reply aside if it is part of the stream.
    pub(super) fn takes(&mut self, reply: &Reply<'_>) -> bool {
        let Some(rows) = Rows::of(&reply.body).filter(|_| self.stream == Some(reply.sequence)) else {
            return false;
        };
        // There can be at most as many messages as granted rows: more would be repetitions.
        if rows.end() > u64::from(self.granted) {
            self.beyond = Some(rows.end());
        } else if self.rows.len() < GRANTED as usize {
            self.rows.push_back(rows);
        }
        true
    }
}

impl Client {
    /// Begins a stream of every Nth sample of a run; `sample_hz` is the sample rate. Rows come a few times a second, or in
    /// full messages.
    ///
    /// # Errors
    /// When the rig does not answer.
    pub fn stream_begin(&mut self, every: u16, sample_hz: f64) -> Result<()> {
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

    /// Follows a run as [`Client::follow`] does, and gives each sample of its stream to `take`, in order and to the last
    /// one, whatever ends the run. Returns the final status, and the number of rows that the link has lost for good.
    ///
    /// # Errors
    /// As [`Client::follow`], those of `take`, or when the run cannot have these rows.
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
            // Rows beyond this status wait for the next one.
            drain(&mut arrivals, status.index)
        });
        let reached = match &followed {
            Ok(status) => status.index,
            Err(_) => self.status().map(|status| status.index).unwrap_or(0),
        };
        let rest = self.stream_rest(&mut arrivals, reached).and_then(|()| {
            drain(&mut arrivals, reached)?;
            match arrivals.waiting() {
                Some(sample) => {
                    bail!("{}: it streams sample {sample} of a run that reached sample {reached}", self.name)
                }
                None => Ok(()),
            }
        });
        followed.and_then(|status| rest.map(|()| (status, arrivals.lost())))
    }

    /// What has come of a stream since the last call, in order, for a program that does other things meanwhile. Lost rows
    /// are requested again; those that the rig no longer holds are missing in the indices. Once the run is over, the rows
    /// that remain are asked for, a message at a time: no rows then means that there are no more.
    ///
    /// # Errors
    /// When the rig does not answer, or sends rows that it was not granted, or whose samples go back.
    pub fn stream_take(&mut self, arrivals: &mut Arrivals, is_over: bool) -> Result<Vec<StreamedSample>> {
        let never = AtomicBool::new(false);
        if is_over {
            self.stream_listen(arrivals, &never)?;
            let end = arrivals.end();
            let again = self.stream_read(end, MAX_ROWS as u8)?;
            let gone = again.first;
            arrivals.came(again.first, again.rows);
            arrivals.gone(gone);
        } else {
            self.stream_on(arrivals, &never)?;
        }
        std::iter::from_fn(|| arrivals.take(u32::MAX).transpose()).collect()
    }

    /// Listens for a moment, requests lost rows again, and grants further rows.
    fn stream_on(&mut self, arrivals: &mut Arrivals, interrupted: &AtomicBool) -> Result<()> {
        self.stream_listen(arrivals, interrupted)?;
        self.stream_grant(arrivals.next().saturating_add(GRANTED))
    }

    /// Listens for a moment, and requests lost rows again.
    fn stream_listen(&mut self, arrivals: &mut Arrivals, interrupted: &AtomicBool) -> Result<()> {
        let deadline = self.link.now() + LISTEN;
        self.hear(deadline, |_| None::<()>)?;
        if let Some(end) = self.unasked.beyond {
            bail!(
                "{}: it streams up to row {end}, but only {} rows are granted",
                self.name,
                self.unasked.granted
            );
        }
        for Rows { first, rows } in std::mem::take(&mut self.unasked.rows) {
            arrivals.came(first, rows);
        }
        while let Some((first, count)) = arrivals.missing() {
            if interrupted.load(Ordering::Relaxed) {
                break;
            }
            let again = self.stream_read(first, count)?;
            // The rig no longer holds the rows that are not among them. Rows after the last received one may still come.
            let gone = again.first.min(arrivals.end()).max(first + u32::from(count));
            arrivals.came(again.first, again.rows);
            arrivals.gone(gone);
        }
        Ok(())
    }

    /// Requests the last rows of a stream whose run is over at the sample `reached`: no later row shows whether they are
    /// missing. They are no more than the rig holds, so this ends soon and cannot be interrupted.
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
        bail!("{}: the last rows of its stream did not arrive", self.name)
    }

    fn stream_read(&mut self, first: u32, count: u8) -> Result<Rows> {
        self.ask(RequestBody::StreamRead { first, count }, |reply| {
            Rows::of(reply).ok_or_else(|| unexpected(reply))
        })
    }
}
