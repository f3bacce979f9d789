//! The thread that talks to the rig for one page.
//!
//! It looks at the rig 20 times a second. The looks also tell the rig that its host is there. The thread disarms the
//! drive
//!
//! - when the page goes: its tab is closed, or its connection is lost;
//! - when the page is silent for [`PAGE_SILENCE`] although its connection stands, or for [`MOTION_SILENCE`] while the
//!   drive moves;
//! - when a jog button is not confirmed for [`JOG_SILENCE`].
//!
//! When the whole program ends, the rig trips because its host is silent (`safety.host_silence_s`).

mod motion;

use std::sync::mpsc::Receiver;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use anyhow::{Error, Result};
use axum::http::StatusCode;
use pneudrive_controller::parameters::id;
use pneudrive_link::client::Client;
use pneudrive_link::failure::Failure;
use pneudrive_page::refusal::HttpRefusal;
use pneudrive_protocol::{Mode, Status};
use pneudrive_records::rig_info::RigParameters;
use pneudrive_records::units::Units;
use pneudrive_session::bring_up::Options;
use pneudrive_sim::Rig;
use serde_json::Value;

use super::bring_up::bring_up;
use super::drive_view::{DriveView, End, Reporter, is_enabled};
use super::ended::Ended;
use super::live::Live;
use super::order::{Arrived, Direction, Gone, JOG_SILENCE, Order, Orders, Stopped, Task};
#[cfg(doc)]
use super::order::{MOTION_SILENCE, PAGE_SILENCE};
use super::parameters;
use super::record::record;

/// Time between two looks at the rig.
const LOOK: Duration = Duration::from_millis(50);

/// The same while samples are streamed: reading the stream takes time, too.
const LOOK_STREAMED: Duration = Duration::from_millis(20);

/// Time between two requests for the remaining rows when the next test follows at once.
const REST_OF_STREAM: usize = 8;

/// Talks to the rig at a port until the page goes or the link breaks.
pub fn steer(port: &str, orders: &Receiver<Arrived>, seen: &Mutex<DriveView>) {
    let _end = End(seen);
    let reporter = Reporter::new(seen, Units::default());
    let ended = Pilot::connect(port, reporter, Orders::of(orders)).and_then(|mut pilot| pilot.follow());
    if let Err(error) = ended {
        seen.lock().unwrap_or_else(PoisonError::into_inner).message = format!("{error:#}");
    }
}

/// The soft limits of a drive, mm; None where it has none.
fn limits_mm(parameters: &RigParameters) -> [Option<f64>; 2] {
    let units = Units::of(parameters);
    [id::END_MIN_COUNTS, id::END_MAX_COUNTS].map(|end| {
        let counts = parameters.values.get(end).filter(|_| !parameters.lacking.contains(&end));
        units.millimetres(counts?)
    })
}

struct Pilot<'a> {
    client: Client,
    reporter: Reporter<'a>,
    orders: Orders<'a>,
    /// Whether the page has enabled the drive.
    is_ours: bool,
    /// The jog button that is held, and when it was last confirmed.
    jog: Option<(Direction, Instant)>,
    /// The samples of the started test.
    live: Option<Live>,
    /// The test to whose start the drive is moving.
    next: Option<Box<Rig>>,
}

impl<'a> Pilot<'a> {
    fn connect(port: &str, reporter: Reporter<'a>, orders: Orders<'a>) -> Result<Pilot<'a>> {
        let client = Client::connect(port)?;
        let mut pilot = Pilot { client, reporter, orders, is_ours: false, jog: None, live: None, next: None };
        pilot.read_scales()?;
        Ok(pilot)
    }

    /// Reads the scales of the drive's figures.
    fn read_scales(&mut self) -> Result<()> {
        let parameters = self.client.parameters()?;
        self.reporter.units = Units::of(&parameters);
        let mut seen = self.reporter.seen();
        seen.stream_hz = Some(Live::rate_hz(&parameters));
        seen.limits_mm = limits_mm(&parameters);
        Ok(())
    }

    fn follow(&mut self) -> Result<()> {
        loop {
            match self.orders.next(if self.live.is_some() { LOOK_STREAMED } else { LOOK }) {
                Ok(Some(arrived)) => self.take(arrived),
                Ok(None) => {}
                Err(Gone) => return self.release(),
            }
            self.watch_page()?;
            let status = self.look()?;
            self.stream(status.mode.moves());
            self.go_on(&status);
        }
    }

    fn look(&mut self) -> Result<Status> {
        let status = self.client.status()?;
        if !is_enabled(status.mode) {
            (self.is_ours, self.jog) = (false, None);
        }
        self.orders.mind(status.mode.moves());
        self.reporter.look(&status, self.live.is_none());
        Ok(status)
    }

    /// Passes on the samples that have arrived.
    fn stream(&mut self, is_running: bool) {
        let Some(live) = &mut self.live else { return };
        match live.take(&mut self.client, !is_running) {
            Ok(Some(rows)) => live.put(&rows, &mut self.reporter.seen().samples, &self.reporter.units),
            Ok(None) => {
                self.live = None;
                // Between tests the rig streams nothing anyway.
                let _ = self.client.stream_end();
            }
            Err(error) => {
                self.live = None;
                self.reporter.tell(format!("the samples of this test are no longer streamed: {error:#}"));
            }
        }
    }

    fn tell(&self, message: impl Into<String>) {
        self.reporter.tell(message);
    }

    /// Disarms the drive if its page or button has been silent for too long.
    fn watch_page(&mut self) -> Result<()> {
        if let Some((direction, confirmed)) = &mut self.jog {
            *confirmed = self.orders.confirmed(*direction).unwrap_or(*confirmed);
        }
        if self.jog.is_some_and(|(_, confirmed)| confirmed.elapsed() > JOG_SILENCE) {
            self.tell("disarmed: the jog button was not confirmed");
            self.release()?;
        } else if self.is_ours && self.orders.is_silent() {
            self.tell("disarmed: the page was silent");
            self.release()?;
        }
        Ok(())
    }

    /// Disarms the drive if the page has armed it.
    fn release(&mut self) -> Result<()> {
        self.jog = None;
        self.follows_with(None);
        if std::mem::take(&mut self.is_ours) { self.client.disarm() } else { Ok(()) }
    }

    /// Carries out an order; the page is told of a refusal.
    fn take(&mut self, Arrived { order, at }: Arrived) {
        if !matches!(order, Order::Alive | Order::Jog(..) | Order::Ask(..)) {
            self.tell("");
        }
        if ends_approach(&order) {
            self.follows_with(None);
        }
        let done = match order {
            Order::Ask(task, reply) => {
                let answer = self.answer(task);
                // The page may have gone meanwhile.
                let _ = reply.send(answer);
                Ok(())
            }
            // Outside of a bring-up there is nothing to answer, and nothing to end.
            Order::Alive | Order::Answer(..) | Order::Abort => Ok(()),
            Order::Arm => self.arm(),
            Order::Disarm => self.disarm(),
            Order::Stop(stopped) => self.stop(vec![stopped]),
            Order::Home => self.home(),
            Order::Run(rig, agreed_mm) => self.run_from_start(rig, agreed_mm),
            Order::Go(to_mm, rig) => self.go(to_mm, &rig),
            Order::Jog(direction, mm_per_s, rig) => self.jog(direction, mm_per_s, at, &rig),
            Order::Release if self.jog.is_some() => self.release(),
            Order::Release => Ok(()),
        };
        if let Err(error) = done {
            self.tell(format!("{error:#}"));
        }
    }

    /// Carries out a task with an answer.
    fn answer(&mut self, task: Task) -> Result<Value, HttpRefusal> {
        let answer = match task {
            Task::Approach(rig) => {
                self.approach(&rig).map(|found| found.map_or(Value::Null, |approach| approach.question()))
            }
            Task::Parameters(rig) => parameters::table(&mut self.client, &rig),
            Task::Change(changes) => return self.change(&changes),
            Task::Save => self.client.save_parameters().map(|()| Value::Null),
            Task::Record => record(&mut self.client, &mut self.orders, &self.reporter),
            Task::BringUp(options) => self.bring_up(options),
        };
        answer.map_err(|error| {
            self.end(error.downcast_ref());
            refused(&error)
        })
    }

    /// Carries out the order that has ended a long task.
    fn end(&mut self, ended: Option<&Ended>) {
        let stops = self.orders.stops();
        let (what, done) = match ended {
            _ if !stops.is_empty() => ("stopped", self.stop(stops)),
            Some(Ended::Aborted) => ("disarmed", self.disarm()),
            // The page has gone; the next look notices that.
            _ => return,
        };
        if let Err(error) = done {
            self.tell(format!("the drive could not be {what}: {error:#}"));
        }
    }

    fn change(&mut self, changes: &[(String, String)]) -> Result<Value, HttpRefusal> {
        parameters::change(&mut self.client, changes)?;
        self.read_scales().map_err(|error| HttpRefusal::of(&error))?;
        Ok(Value::Null)
    }

    fn bring_up(&mut self, options: Options) -> Result<Value> {
        for _ in 0..REST_OF_STREAM {
            self.stream(false);
        }
        // Its pulses are recorded, too, but none of them is the test of the page.
        self.reporter.seen().run_began_s = None;
        let made = bring_up(&mut self.client, &mut self.orders, &self.reporter, options);
        // Its last request may have had no answer, so the drive may still be enabled.
        self.is_ours |= self.client.commands();
        made
    }

    /// Stops the drive and tells `waiting`. If it fails, `waiting` is dropped, which tells that it is not done.
    fn stop(&mut self, waiting: Vec<Stopped>) -> Result<()> {
        self.client.stop()?;
        for stopped in waiting {
            // A request whose sender has gone gets no answer.
            let _ = stopped.send(());
        }
        Ok(())
    }

    fn arm(&mut self) -> Result<()> {
        self.client.arm()?;
        self.is_ours = true;
        Ok(())
    }

    fn disarm(&mut self) -> Result<()> {
        let done = self.client.disarm();
        // Without an answer the drive may still be enabled.
        (self.is_ours, self.jog) = (self.client.commands(), None);
        done
    }

    /// Homes the drive. If it was armed for this and refuses, it is disarmed again.
    fn home(&mut self) -> Result<()> {
        let is_to_arm = self.look()?.mode == Mode::Disarmed;
        if is_to_arm {
            self.arm()?;
        }
        self.client.home().or_else(|error| if is_to_arm { self.disarm().and(Err(error)) } else { Err(error) })
    }
}

/// Whether an order ends the approach to the start of a test, so that no test follows.
fn ends_approach(order: &Order) -> bool {
    let goes_by = |task: &Task| matches!(task, Task::Approach(_) | Task::Parameters(_) | Task::Save);
    match order {
        Order::Alive | Order::Answer(..) | Order::Release => false,
        Order::Ask(task, _) => !goes_by(task),
        _ => true,
    }
}

/// A request that the drive refuses is a refusal; every other failure is an error.
fn refused(error: &Error) -> HttpRefusal {
    let is_refusal =
        error.is::<Ended>() || error.chain().any(|cause| Failure::of_cause(cause) == Some(Failure::Refused));
    let status = if is_refusal { StatusCode::CONFLICT } else { StatusCode::INTERNAL_SERVER_ERROR };
    HttpRefusal::new(status, format!("{error:#}"))
}
