//! Homing, the moves, stored configuration, fault log.

use anyhow::Result;
use pneudrive_protocol::{ConfigState, Event, MAX_EVENTS, Motion, ReplyBody, RequestBody, Spread};

use super::Client;
use super::answer::unexpected;

impl Client {
    /// Homes the axis; [`Client::status`] has the mode `Homing` until it is done.
    ///
    /// # Errors
    /// When it is refused or not answered.
    pub fn home(&mut self) -> Result<()> {
        self.take_over()?;
        self.ask_done(RequestBody::Home)
    }

    /// The progress of the moves.
    ///
    /// # Errors
    /// When the rig does not answer.
    pub fn motion(&mut self) -> Result<Motion> {
        self.ask(RequestBody::Motion, |reply| match reply {
            ReplyBody::Motion(motion) => Ok(*motion),
            other => Err(unexpected(other)),
        })
    }

    /// Stores the parameters for the next reset.
    ///
    /// # Errors
    /// When it is refused, or the flash does not take them.
    pub fn save_parameters(&mut self) -> Result<()> {
        self.ask_done(RequestBody::ConfigSave)
    }

    /// The origin of the parameters.
    ///
    /// # Errors
    /// When the rig does not answer.
    pub fn config_state(&mut self) -> Result<ConfigState> {
        self.ask(RequestBody::ConfigState, |reply| match reply {
            ReplyBody::ConfigState(state) => Ok(*state),
            other => Err(unexpected(other)),
        })
    }

    /// The spread of two intervals: from a sample to the next, and from a sample to its output.
    ///
    /// # Errors
    /// When the rig does not answer.
    pub fn timing(&mut self) -> Result<[Spread; 2]> {
        self.ask(RequestBody::Timing, |reply| match reply {
            ReplyBody::Timing { interval, latency } => Ok([*interval, *latency]),
            other => Err(unexpected(other)),
        })
    }

    /// The fault log, newest event first.
    ///
    /// # Errors
    /// When the rig does not answer.
    pub fn events(&mut self) -> Result<Vec<Event>> {
        let mut events: Vec<Event> = Vec::new();
        let mut place = 0;
        loop {
            let request = RequestBody::Events { first: place, count: MAX_EVENTS as u8 };
            let (total, more) = self.ask(request, |reply| match reply {
                ReplyBody::Events { total, first, events } if *first == place => {
                    Ok((*total, Event::all(events).collect::<Vec<_>>()))
                }
                other => Err(unexpected(other)),
            })?;
            place = place.saturating_add(more.len().min(MAX_EVENTS) as u8);
            let none = more.is_empty();
            // An event that is logged meanwhile shifts the others: one comes twice.
            let oldest = events.last().map_or(u64::MAX, |event| event.number.into());
            events.extend(more.into_iter().filter(|event| u64::from(event.number) < oldest));
            if none || place >= total {
                return Ok(events);
            }
        }
    }
}
