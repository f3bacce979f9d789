//! The watchdog: when it is no longer fed, it must reset the board, and the fault log must name it.
//!
//! This check comes last, because the reset loses the reference of the axis and everything that was not stored.
//! Parameters and move records are put back. In a reset the converter of the valve may give any command. So the check is
//! skipped if the amplifier was seen to need no `drive_enable`, and if no pulses were given. With an enable line that
//! nobody has tested the slide may jerk in the reset; the operator was told so before the cylinder was allowed to move.

use std::time::{Duration, Instant};

use anyhow::Result;
use pneudrive_controller::Fault;
use pneudrive_protocol::{Event, Mode};
use pneudrive_records::move_records::MoveRecord;
use pneudrive_records::rig_info::RigParameters;
use pneudrive_records::words;

use super::{BringUp, Check, Verdict, enable, pulses};
use pneudrive_link::client::Trial;

const NAME: &str = "watchdog";

/// Time between two looks at the fault log.
const LOOK_AGAIN: Duration = Duration::from_millis(50);

const DID: &str = "had the board feed its watchdog no more, drive disabled";
const MUST: &str = "a reset, which the fault log puts down to the watchdog";

/// The state of a drive that a reset loses unless it is stored.
struct Unstored {
    parameters: RigParameters,
    records: Vec<MoveRecord>,
    referenced: bool,
}

impl BringUp<'_> {
    /// Tries the watchdog of a drive that may move.
    pub(super) fn check_watchdog(&mut self) -> Result<()> {
        if let Some(why) = self.why_no_trial()? {
            self.note(Check::left_out(NAME, &why));
            return Ok(());
        }
        self.operator.goes_on()?;
        let unstored = Unstored {
            parameters: self.client.parameters()?,
            records: self.client.move_records()?,
            referenced: self.client.status()?.referenced,
        };
        self.operator.tell("the board feeds its watchdog no more: it must reset; stay out of reach");
        let trial = self.client.try_watchdog(self.options.reset_wait, &mut || self.operator.goes_on())?;
        match trial {
            Trial::NoWatchdog => self.note(Check::left_out(NAME, "this board has no watchdog")),
            Trial::Reset(after) => self.judge_reset(after, &unstored)?,
            Trial::NotReset => self.note_failed("still answers, without a reset,", DEAD),
            Trial::Silent => self.note_failed("does not answer", GONE),
        }
        Ok(())
    }

    fn note_failed(&mut self, how: &str, advice: &str) {
        let saw = format!("{how} after {:.0} s", self.options.reset_wait.as_secs_f64());
        self.note(Check::of(NAME, DID, saw, MUST, vec![advice.to_owned()]));
    }

    /// The reason not to try the watchdog.
    fn why_no_trial(&mut self) -> Result<Option<String>> {
        let check = |name: &str| self.report.checks.iter().find(|check| check.name == name);
        let is_ungated = check(enable::LINE).is_some_and(|check| check.verdict == Verdict::Wrong);
        let was_let = check(pulses::NAME).is_some_and(|check| check.verdict != Verdict::NotChecked);
        Ok(if is_ungated || !was_let {
            Some("a reset may move the cylinder: what is open or wrong above comes first".to_owned())
        } else if !self.client.names_its_boot() {
            Some("the board cannot tell one boot from the next: its flash has failed".to_owned())
        } else {
            let status = self.client.status()?;
            let fault = || {
                format!(
                    "the drive is in the fault {}: that comes first",
                    words::fault_code_name(status.fault)
                )
            };
            (status.mode == Mode::Fault).then(fault)
        })
    }

    /// The fault log's report of the reset. Afterwards the drive is as before.
    fn judge_reset(&mut self, after: Duration, unstored: &Unstored) -> Result<()> {
        let newest = self.newest_of_this_boot();
        // Whatever becomes of the log: the drive is as it was, or the report says that it is not.
        let lost = self.put_back(unstored).unwrap_or(NOT_PUT_BACK);
        self.leave_fault()?;
        let newest = newest?;
        let reason = newest.map_or("nothing".to_owned(), |event| words::fault_code_name(event.code));
        let advice = match newest {
            Some(event) if event.code == Fault::Watchdog.code() => Vec::new(),
            _ => vec![OTHER_REASON.to_owned()],
        };
        let saw =
            format!("answers again after {:.2} s; the fault log says {reason}{lost}", after.as_secs_f64());
        self.note(Check::of(NAME, DID, saw, MUST, advice));
        Ok(())
    }

    /// The newest event of the new boot. The fault that caused the reset is logged with the first samples, which may
    /// take seconds on an emulated board.
    fn newest_of_this_boot(&mut self) -> Result<Option<Event>> {
        let begun = Instant::now();
        loop {
            self.operator.goes_on()?;
            let newest = self.client.events().ok().and_then(|events| events.first().copied());
            let of_this_boot = newest.filter(|event| self.client.is_of_this_boot(event));
            if of_this_boot.is_some() || begun.elapsed() > self.options.reset_wait {
                return Ok(of_this_boot);
            }
            std::thread::sleep(LOOK_AGAIN);
        }
    }

    /// Puts parameters and move records back. Returns what is lost, in words.
    fn put_back(&mut self, unstored: &Unstored) -> Result<&'static str> {
        if self.client.parameters()? != unstored.parameters {
            self.client.import_parameters(&unstored.parameters.values)?;
        }
        if self.client.move_records()? != unstored.records {
            self.client.replace_move_records(&unstored.records)?;
        }
        let referenced = self.client.status()?.referenced;
        Ok(if unstored.referenced && !referenced { "; the axis has lost its reference" } else { "" })
    }

    /// Leaves the fault that caused the reset.
    fn leave_fault(&mut self) -> Result<()> {
        // A stepper's spool may have to be sought first; then the fault stays, and says so.
        if self.client.arm().is_ok() {
            self.client.disarm()?;
        }
        Ok(())
    }
}

/// Whether an event says that the watchdog has reset the board in a trial: the event before it announces the trial.
pub(super) fn was_tried(events: &[Event], place: usize) -> bool {
    let older = events.get(place + 1);
    older.is_some_and(|older| {
        older.code == Fault::WatchdogTried.code() && older.boot.wrapping_add(1) == events[place].boot
    })
}

const DEAD: &str = "the watchdog does not bite: a program that hangs would leave the valve as it is. Do not run this board: flash the firmware anew, take off a debugger that holds the watchdog, or change the board. `pneudrive device arm` ends the trial";
const GONE: &str = "the board does not come back: switch its supply off and on, and try again; if it stays so, look at its boot pins (BOOT0 low on the Nucleo), at what its reset line is wired to, and flash the firmware anew. Once it is back, parameters and move records that were not stored are lost: import them again";
const NOT_PUT_BACK: &str = "; parameters and move records could not be put back: import them again";
const OTHER_REASON: &str = "the board was reset by something else: its supply, its reset line or a debugger; look at `pneudrive device faults`, and try again without a debugger";

#[cfg(test)]
mod tests {
    use super::*;

    fn event(code: Fault, boot: u32) -> Event {
        Event { code: code.code(), boot, ..Event::default() }
    }

    #[test]
    fn a_watchdog_that_was_tried_is_told_from_one_that_bit() {
        let tried = [event(Fault::Watchdog, 3), event(Fault::WatchdogTried, 2)];
        assert!(was_tried(&tried, 0));
        let later = [event(Fault::Watchdog, 4), event(Fault::WatchdogTried, 2)];
        assert!(!was_tried(&later, 0), "the trial had ended before");
        let bit = [event(Fault::Watchdog, 3), event(Fault::Stop, 2)];
        assert!(!was_tried(&bit, 0) && !was_tried(&bit[..1], 0));
    }
}
