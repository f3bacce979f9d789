//! How the drive is moved for a page: tests, moves to a place, jogs.

use std::time::Instant;

use anyhow::{Result, anyhow, bail};
use pneudrive_controller::parameters::id;
use pneudrive_link::failure::Failure;
use pneudrive_protocol::{Mode, Status};
use pneudrive_records::rig_info::RigParameters;
use pneudrive_session::slow_move::{self, GO_MM_PER_S, JOG_REACH_MM, slow_move};
use pneudrive_session::test_run::{refuse_what_it_would, wait_for_null};
use pneudrive_sim::Rig;
use pneudrive_sim::component::controller::Loop;
use pneudrive_sim::keys;

use super::{Pilot, REST_OF_STREAM};
use crate::commission::approach::Approach;
use crate::commission::live::Live;
use crate::commission::order::{Direction, JOG_SILENCE, Orders};

/// What a test is run for.
#[derive(Clone, Copy, Debug)]
enum Purpose {
    /// The page has a simulation of it.
    Test,
    /// To go to a place.
    Place,
    /// To jog while a button is held that was heard at this time.
    Jog(Direction, Instant),
}

impl Pilot<'_> {
    /// The approach of the drive to the start of a test; None in open loop.
    pub(super) fn approach(&mut self, rig: &Rig) -> Result<Option<Approach>> {
        if rig.get(&keys::controller::LOOP) == Loop::Open {
            return Ok(None);
        }
        let status = self.look()?;
        if status.mode.moves() {
            return Err(Failure::Refused.error("not run: the drive is moving; wait until it rests"));
        }
        let from_mm = self.place(&status)?;
        Ok(Approach::of(rig, from_mm))
    }

    /// Runs a test; from elsewhere than its start the drive goes there slowly before, if the page has agreed to that.
    pub(super) fn run_from_start(&mut self, rig: Box<Rig>, agreed_mm: Option<f64>) -> Result<()> {
        // A test that would be refused at its start is refused before anything moves.
        self.refuse_unready(&rig)?;
        match self.approach(&rig)? {
            Some(approach) if approach.is_to_go(agreed_mm)? => {
                let slow = slow_move(&rig, approach.from_mm, approach.to_mm, GO_MM_PER_S)?;
                self.run(&slow, Purpose::Place)?;
                self.tell(format!("going to {:.1} mm, where the test starts", approach.to_mm));
                self.follows_with(Some(rig));
                Ok(())
            }
            _ => self.run(&rig, Purpose::Test),
        }
    }

    /// What is run once the drive has come to its start.
    pub(super) fn follows_with(&mut self, next: Option<Box<Rig>>) {
        self.reporter.seen().approaches = next.is_some();
        self.next = next;
    }

    /// Runs the test to whose start the drive has come.
    pub(super) fn go_on(&mut self, status: &Status) {
        if status.mode == Mode::Armed || status.mode.moves() {
            return;
        }
        let Some(rig) = self.next.take() else { return };
        let has_come = || -> Result<()> {
            let approach = Approach::of(&rig, self.place(status)?);
            approach.map_or(Ok(()), |approach| approach.check_end())
        };
        let done = match status.mode {
            Mode::Done => has_come().and_then(|()| self.run(&rig, Purpose::Test)),
            // The page knows already why the approach ended.
            _ => Ok(()),
        };
        self.follows_with(None);
        match done {
            Ok(()) if status.mode == Mode::Done => self.tell(""),
            Ok(()) => {}
            Err(error) => self.tell(format!("{error:#}")),
        }
    }

    /// Where the drive stands, mm.
    fn place(&self, status: &Status) -> Result<f64> {
        let place = self.reporter.units.millimetres(status.position);
        place.ok_or_else(|| anyhow!("the rig does not tell how long a count of its encoder is"))
    }

    /// Downloads a test, arms and starts. What the drive would refuse is refused before it is disarmed.
    fn run(&mut self, rig: &Rig, purpose: Purpose) -> Result<()> {
        let parameters = self.refuse_unready(rig)?;
        self.disarm()?;
        for _ in 0..REST_OF_STREAM {
            self.stream(false);
        }
        self.client.prepare(rig, rig.last_sample(), None)?;
        still_wanted(&mut self.orders, purpose)?;
        self.arm()?;
        match self.start(rig, purpose, &parameters) {
            Ok(()) => {
                self.begin_samples(purpose);
                Ok(())
            }
            Err(error) => {
                self.live = None;
                self.disarm().and(Err(error))
            }
        }
    }

    /// Starts the test once a stepper's spool is at its null, unless the page wants it no more.
    fn start(&mut self, rig: &Rig, purpose: Purpose, parameters: &RigParameters) -> Result<()> {
        wait_for_null(&mut self.client, rig, &mut || still_wanted(&mut self.orders, purpose))?;
        // A rig that refuses a stream is asked for its status instead.
        self.live = Live::begin(&mut self.client, parameters).ok();
        still_wanted(&mut self.orders, purpose)?;
        self.client.start()
    }

    /// The test has begun now, behind all samples so far.
    fn begin_samples(&mut self, purpose: Purpose) {
        let now_s = self.reporter.now_s();
        let mut seen = self.reporter.seen();
        let began_s = now_s.max(seen.samples.last());
        seen.run_began_s = matches!(purpose, Purpose::Test).then_some(began_s);
        if let Some(live) = &mut self.live {
            live.begins(began_s);
        }
    }

    /// Refuses a drive in a fault, one whose moves mean something else than on the page, and a test that it would refuse itself.
    /// Its parameters.
    fn refuse_unready(&mut self, rig: &Rig) -> Result<RigParameters> {
        let status = self.look()?;
        if status.mode == Mode::Fault {
            bail!("the drive has tripped: make sure that it is safe, then arm it");
        }
        let (there, here) = (self.client.parameters()?, rig.parameters());
        for (id, what) in [
            (id::OPEN_LOOP, keys::controller::LOOP.path),
            (id::PERIOD_US, keys::controller::PERIOD_S.path),
            (id::STEPPER, keys::operator::MODEL.path),
            (id::ON_ARRIVAL, keys::controller::EXIT_ON_DEAD_BAND.path),
            (id::ENCODER_PM_PER_COUNT, keys::encoder::MM_PER_COUNT.path),
        ] {
            if there.values.get(id) != here.get(id) {
                bail!(
                    "{what} of the rig at the port is not that of the page: start the studio with the rig's own file"
                );
            }
        }
        refuse_what_it_would(rig, &there, status.referenced)?;
        Ok(there)
    }

    /// Moves slowly to a place.
    pub(super) fn go(&mut self, to_mm: f64, rig: &Rig) -> Result<()> {
        let status = self.look()?;
        let from_mm = self.place(&status)?;
        let test = slow_move::go(rig, &self.client.parameters()?, from_mm, to_mm)?;
        self.run(&test, Purpose::Place)
    }

    /// Begins to jog, goes on, or has the next stretch follow; `at`: when the button was heard.
    pub(super) fn jog(&mut self, direction: Direction, mm_per_s: f64, at: Instant, rig: &Rig) -> Result<()> {
        let goes_on = self.jog.is_some_and(|(before, _)| before == direction);
        let status = self.look()?;
        if !goes_on || status.mode == Mode::Done {
            let reach_mm = if direction == Direction::Extend { JOG_REACH_MM } else { -JOG_REACH_MM };
            let from_mm = self.place(&status)?;
            let test = slow_move::jog(rig, &self.client.parameters()?, from_mm, reach_mm, mm_per_s)?;
            self.run(&test, Purpose::Jog(direction, at))?;
        }
        self.jog = Some((direction, self.orders.confirmed(direction).unwrap_or(at)));
        Ok(())
    }
}

/// Refuses to start what the page has ended meanwhile, and to jog without a button that is held.
fn still_wanted(orders: &mut Orders<'_>, purpose: Purpose) -> Result<()> {
    orders.still_wants(matches!(purpose, Purpose::Jog(..)))?;
    if let Purpose::Jog(direction, at) = purpose
        && orders.confirmed(direction).unwrap_or(at).elapsed() > JOG_SILENCE
    {
        bail!("not started: the jog button was not confirmed");
    }
    Ok(())
}
