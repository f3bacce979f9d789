//! How a virtual rig serves the programs at its port, and takes its samples in between.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use anyhow::{Context, Result};
use pneudrive_app::inputs;
use pneudrive_protocol::Presence;

use super::VirtualRig;
use super::caller::Caller;
use super::gate;
use super::listener::Listener;

/// The most samples between two polls of the port.
const SAMPLES_AT_ONCE: u32 = 64;

/// The most samples to catch up after the computer was busy with something else.
const MAX_BEHIND: u64 = 1000;

/// Time after which the port is polled before another sample is taken: a computer that was busy has kept requests waiting, and
/// their hosts were not silent.
const UNPOLLED: Duration = Duration::from_millis(50);

impl VirtualRig {
    /// Serves a port until `stop` is set, or the power is cut.
    ///
    /// # Errors
    /// When the simulation fails.
    pub fn serve(&mut self, listener: &mut Listener, stop: &AtomicBool) -> Result<()> {
        while !stop.load(Ordering::Relaxed) {
            listener.admit(Instant::now());
            let heard = self.hear(&mut listener.callers);
            self.shed(&mut listener.callers);
            if self.board.store.flash().is_powered_off() {
                return Ok(());
            }
            let sampled = self.catch_up(&mut listener.callers)?;
            let _ = self.control.tidy_up(&mut self.board);
            self.obey_watchdog(&mut listener.callers)?;
            if !heard && !sampled {
                std::thread::sleep(Duration::from_micros(500));
            }
        }
        Ok(())
    }

    /// Executes the requests that have arrived, and drops callers that have gone. Whether anything has arrived.
    pub(super) fn hear(&mut self, callers: &mut Vec<Caller>) -> bool {
        let mut heard = false;
        callers.retain_mut(|caller| {
            let count = caller.hear(&mut self.control, &mut self.board);
            if self.board.store.flash().is_powered_off() {
                return false;
            }
            let served = count.and_then(|count| caller.speak().map(|()| count));
            heard |= served.as_ref().is_ok_and(|count| *count > 0);
            if served.is_err() {
                caller.server.host_goes(&mut self.control);
            }
            served.is_ok()
        });
        self.polled = Instant::now();
        heard
    }

    /// Sends programs away that are too many, but not the one that commands the drive.
    fn shed(&mut self, callers: &mut Vec<Caller>) {
        let owner = self.control.owner(&self.board);
        let commanding = (owner.presence != Presence::Nobody).then_some(owner.session);
        for caller in gate::shed(callers, |caller| Some(caller.server.session()) == commanding) {
            caller.server.host_goes(&mut self.control);
        }
    }

    /// Takes the samples that are due; whether any moved the plant.
    pub(super) fn catch_up(&mut self, callers: &mut [Caller]) -> Result<bool> {
        if self.board.pace.fast && callers.iter().any(|caller| caller.server.waits_for_host()) {
            return Ok(false);
        }
        if self.board.pace.fast {
            // Nothing waits for a drive that holds.
            let moves = self.board.is_on_its_way() || self.board.pace.live;
            for _ in 0..if moves { SAMPLES_AT_ONCE } else { 1 } {
                self.tick(callers)?;
            }
            return Ok(moves);
        }
        let now_us = self.board.since.elapsed().as_micros() as u64;
        let period = self.board.period_us;
        if now_us > self.board.time_us + MAX_BEHIND * period {
            // The computer slept: the rig's clock continues from its present value.
            self.board.since += Duration::from_micros(now_us - self.board.time_us);
        }
        let due = self.board.time_us <= now_us;
        // A few at a time: the port is polled in between, even if the computer is behind.
        for _ in 0..SAMPLES_AT_ONCE {
            if self.board.time_us > now_us || self.polled.elapsed() > UNPOLLED {
                break;
            }
            self.tick(callers)?;
        }
        Ok(due && self.board.moves())
    }

    /// One sample and its output, which each caller's server then attends to.
    fn tick(&mut self, callers: &mut [Caller]) -> Result<()> {
        if !self.board.pace.live {
            self.board.period_us = u64::from(self.control.config().timing.period_us.get());
        }
        self.control.on_sample(&mut self.board);
        self.board.since_sample_us = u64::from(self.control.config().timing.delay_us.get());
        self.control.on_output(&mut self.board);
        self.board.since_sample_us = 0;
        for caller in callers {
            caller.server.attend(&mut self.control);
        }
        inputs::attend(&mut (&mut *self.control, &mut self.board));
        self.board.mode = self.control.state().supervisor.mode();
        self.board.next_sample();
        self.board.failed.map_or(Ok(()), |error| Err(error).context("the virtual rig stopped"))
    }
}
