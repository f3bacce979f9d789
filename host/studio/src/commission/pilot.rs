//! The thread that talks to the rig on behalf of one page.
//!
//! It looks at the rig 20 times a second, which also tells the rig that its host is there. The drive is disarmed
//!
//! - when the page goes: its tab is closed, its connection is lost,
//! - when the page is silent for [`PAGE_SILENCE`] although its connection stands,
//! - when a jog button is not confirmed for [`JOG_SILENCE`].
//!
//! When the whole program goes, the rig trips for want of its host (`safety.host_silence_s`).

use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use anyhow::{Result, bail};
use pneudrive_controller::parameters::id;
use pneudrive_link::client::Client;
use pneudrive_protocol::{Mode, Status};
use pneudrive_records::units::Units;
use pneudrive_sim::Rig;

use super::ramp::slow_move;
use super::seen::{Seen, is_enabled};

/// Between two looks at the rig.
const LOOK: Duration = Duration::from_millis(50);

/// How long a page may say nothing while it has armed the drive.
pub const PAGE_SILENCE: Duration = Duration::from_millis(1500);

/// How long a held button may be unconfirmed.
pub const JOG_SILENCE: Duration = Duration::from_millis(300);

/// Rate of jogging, mm/s.
pub const JOG_MM_PER_S: f64 = 10.0;

/// How far one test of jogging goes, mm; a button that is held longer has another one follow.
const JOG_REACH_MM: f64 = 30.0;

/// Rate of a move to a place, mm/s.
pub const GO_MM_PER_S: f64 = 50.0;

/// How long a stepper's spool may take to its null after arming.
const WALK_TO_NULL: Duration = Duration::from_secs(2);

/// What a page asks of the drive.
#[derive(Debug)]
pub enum Order {
    /// The page is there.
    Alive,
    /// Enable the drive.
    Arm,
    /// Disable it.
    Disarm,
    /// Stop at once, with a fault.
    Stop,
    /// Find the stop or the switch.
    Home,
    /// Run the test of a rig.
    Run(Box<Rig>),
    /// Move slowly to a place, mm.
    Go(f64, Box<Rig>),
    /// A jog button is held.
    Jog(Direction, Box<Rig>),
    /// The jog button was let go.
    Release,
}

/// Which way to jog.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// To larger positions.
    Extend,
    /// To smaller ones.
    Retract,
}

/// Talks to the rig at a port until the page goes or the link breaks.
pub fn steer(port: &str, orders: &Receiver<Order>, seen: &Mutex<Seen>) {
    let ended = Pilot::connect(port, seen).and_then(|mut pilot| pilot.follow(orders));
    let mut seen = seen.lock().unwrap_or_else(PoisonError::into_inner);
    seen.is_over = true;
    if let Err(error) = ended {
        seen.message = format!("{error:#}");
    }
}

struct Pilot<'a> {
    client: Client,
    units: Units,
    seen: &'a Mutex<Seen>,
    /// Whether the page has enabled the drive.
    is_ours: bool,
    /// When the page was heard last.
    heard: Instant,
    /// The jog button that is held, and when it was confirmed last.
    jog: Option<(Direction, Instant)>,
}

impl<'a> Pilot<'a> {
    fn connect(port: &str, seen: &'a Mutex<Seen>) -> Result<Pilot<'a>> {
        let mut client = Client::connect(port)?;
        let units = Units::of(&client.parameters()?);
        Ok(Pilot { client, units, seen, is_ours: false, heard: Instant::now(), jog: None })
    }

    fn follow(&mut self, orders: &Receiver<Order>) -> Result<()> {
        loop {
            match orders.recv_timeout(LOOK) {
                Ok(order) => self.take(order),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return self.release(),
            }
            self.watch_page()?;
            self.look()?;
        }
    }

    fn look(&mut self) -> Result<Status> {
        let status = self.client.status()?;
        if !is_enabled(status.mode) {
            (self.is_ours, self.jog) = (false, None);
        }
        self.seen.lock().unwrap_or_else(PoisonError::into_inner).take(&status, &self.units);
        Ok(status)
    }

    fn tell(&self, message: impl Into<String>) {
        self.seen.lock().unwrap_or_else(PoisonError::into_inner).message = message.into();
    }

    /// Disarms a drive whose page or button is not heard any more.
    fn watch_page(&mut self) -> Result<()> {
        if self.jog.is_some_and(|(_, confirmed)| confirmed.elapsed() > JOG_SILENCE) {
            self.tell("disarmed: the jog button was not confirmed");
            self.release()?;
        } else if self.is_ours && self.heard.elapsed() > PAGE_SILENCE {
            self.tell("disarmed: the page was silent");
            self.release()?;
        }
        Ok(())
    }

    /// Disarms what the page has armed.
    fn release(&mut self) -> Result<()> {
        self.jog = None;
        if std::mem::take(&mut self.is_ours) { self.client.disarm() } else { Ok(()) }
    }

    /// Carries out an order; a refusal is told.
    fn take(&mut self, order: Order) {
        self.heard = Instant::now();
        if !matches!(order, Order::Alive | Order::Jog(..)) {
            self.tell("");
        }
        let done = match order {
            Order::Alive => Ok(()),
            Order::Arm => self.arm(),
            Order::Disarm => self.disarm(),
            Order::Stop => self.client.stop(),
            Order::Home => self.home(),
            Order::Run(rig) => self.run(&rig),
            Order::Go(to_mm, rig) => self.go(to_mm, GO_MM_PER_S, &rig),
            Order::Jog(direction, rig) => self.jog(direction, &rig),
            Order::Release if self.jog.is_some() => self.release(),
            Order::Release => Ok(()),
        };
        if let Err(error) = done {
            self.tell(format!("{error:#}"));
        }
    }

    fn arm(&mut self) -> Result<()> {
        self.client.arm()?;
        self.is_ours = true;
        Ok(())
    }

    fn disarm(&mut self) -> Result<()> {
        (self.is_ours, self.jog) = (false, None);
        self.client.disarm()
    }

    fn home(&mut self) -> Result<()> {
        if self.look()?.mode == Mode::Disarmed {
            self.arm()?;
        }
        self.client.home()
    }

    /// Downloads a test, arms and starts.
    fn run(&mut self, rig: &Rig) -> Result<()> {
        self.refuse_unready(rig)?;
        self.disarm()?;
        self.client.prepare(rig, rig.last_sample(), None)?;
        self.arm()?;
        let begun = Instant::now();
        while rig.parameters().get(id::STEPPER) == Some(1) && self.client.status()?.spool != 0 {
            if begun.elapsed() > WALK_TO_NULL {
                break;
            }
            std::thread::sleep(LOOK / 5);
        }
        self.client.start().or_else(|error| self.disarm().and(Err(error)))
    }

    /// Refuses a drive in a fault, and one whose moves mean something else than on the page.
    fn refuse_unready(&mut self, rig: &Rig) -> Result<()> {
        if self.look()?.mode == Mode::Fault {
            bail!("the drive has tripped: make sure that it is safe, then arm it");
        }
        let (there, here) = (self.client.parameters()?.values, rig.parameters());
        for (id, what) in [
            (id::OPEN_LOOP, "controller.loop"),
            (id::PERIOD_US, "controller.period_s"),
            (id::STEPPER, "operator.model"),
            (id::ENCODER_PM_PER_COUNT, "encoder.mm_per_count"),
        ] {
            if there.get(id) != here.get(id) {
                bail!(
                    "{what} of the rig at the port is not that of the page: start the studio with the rig's own file"
                );
            }
        }
        Ok(())
    }

    fn go(&mut self, to_mm: f64, mm_per_s: f64, rig: &Rig) -> Result<()> {
        let status = self.look()?;
        let Some(from_mm) = self.units.millimetres(status.position) else {
            bail!("the rig does not tell how long a count of its encoder is");
        };
        self.run(&slow_move(rig, from_mm, to_mm, mm_per_s)?)
    }

    /// Begins to jog, goes on, or has the next stretch follow.
    fn jog(&mut self, direction: Direction, rig: &Rig) -> Result<()> {
        let goes_on = self.jog.is_some_and(|(before, _)| before == direction);
        let status = self.look()?;
        if !goes_on || status.mode == Mode::Done {
            let way = if direction == Direction::Extend { JOG_REACH_MM } else { -JOG_REACH_MM };
            let from_mm = self.units.millimetres(status.position).unwrap_or_default();
            self.go(from_mm + way, JOG_MM_PER_S, rig)?;
        }
        self.jog = Some((direction, Instant::now()));
        Ok(())
    }
}
