//! Bring-up: the checks of a new board and of the wires around it, from those that move nothing to those that do.
//!
//! | check | moves | what shows there |
//! |---|---|---|
//! | board | | firmware, stored parameters, faults that are latched or logged |
//! | samples | | a clock that is uneven |
//! | sensors at rest | | open, shorted and floating inputs |
//! | encoder by hand | by hand | direction and life of the encoder, valve shut |
//! | enable line | nothing may | whether `drive_enable` gates the amplifier; the converter's ramp against a voltmeter |
//! | rest when enabled | nothing may | a valve that is not shut at its null |
//! | pulses | a few mm | the signs of valve, tubes, encoder and transmitters against each other ([`signs`]) |
//! | watchdog | nothing may; the slide may jerk | whether the watchdog resets the board |
//!
//! A pulse is an open-loop test of its own: a command for a tenth of a second, which the board ends by itself. Commands rise
//! from a few percent of the valve until the slide has moved both ways. Whatever surprises ends the bring-up, with the
//! drive disarmed.

mod board;
mod enable;
mod hand;
mod pulses;
mod report;
mod response;
mod rest;
pub mod signs;
mod silence;
mod watchdog;

use std::time::Duration;

use anyhow::Result;
use pneudrive_controller::parameters::id;
use pneudrive_protocol::{Mode, Status};
use pneudrive_records::rig_info::RigParameters;
use pneudrive_records::units::Units;

use crate::borrowed::Borrowed;
use pneudrive_link::client::Client;
use pneudrive_link::failure::Failure;
pub use report::{Check, Report, Verdict};

/// How long the slide may be waited for, s: the least and the most.
pub const PUSH_WAIT_S: [u16; 2] = [0, 600];

/// What may be allowed as the largest command, percent: the least and the most.
pub const MAX_PERCENT: [u8; 2] = [3, 50];

/// What the bring-up may do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// How long to wait for the slide to be pushed by hand; zero: it is not asked for.
    pub push_wait: Duration,
    /// The largest command of a pulse, percent of the valve.
    pub most_percent: u8,
    /// A slide that goes further than this from where it stood is stopped, mm (counts where their length is unknown).
    pub reach_mm: f64,
    /// How long an answer may take after the watchdog was last fed, and then the reason in the fault log. The watchdog bites
    /// within half a second; an emulated board counts virtual time.
    pub reset_wait: Duration,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            push_wait: Duration::from_secs(20),
            most_percent: 30,
            reach_mm: 40.0,
            reset_wait: Duration::from_secs(15),
        }
    }
}

/// Who stands at the drive.
pub trait Operator {
    /// Is told what comes next.
    fn tell(&mut self, text: &str);

    /// Reports a check that is over.
    fn done(&mut self, check: &Check);

    /// Whether the cylinder may move now.
    fn lets_it_move(&mut self, question: &str) -> bool;

    /// Answers a question; None: nobody is there.
    fn answers(&mut self, question: &str) -> Option<bool>;

    /// Asked again and again while the drive is waited for.
    ///
    /// # Errors
    /// When the operator ends the bring-up.
    fn goes_on(&mut self) -> Result<()>;

    /// Is shown the drive at every look at it.
    fn sees(&mut self, _: &Status) {}
}

/// The drive, what is known of it, and what was found.
struct BringUp<'a> {
    client: &'a mut Client,
    operator: &'a mut dyn Operator,
    options: Options,
    parameters: RigParameters,
    units: Units,
    report: Report,
}

/// Runs the checks in their order. The drive is disarmed afterwards, with the parameters that it had; its test is gone.
///
/// # Errors
/// When the drive is enabled, another host commands it, the rig does not answer, or the operator ends it. What a check
/// finds wrong is no error.
pub fn bring_up(client: &mut Client, operator: &mut dyn Operator, options: Options) -> Result<Report> {
    refuse_an_enabled_drive(client)?;
    let parameters = client.parameters()?;
    let units = Units::of(&parameters);
    let report = Report::of(&client.info()?);
    let mut bring_up = BringUp { client, operator, options, parameters, units, report };
    bring_up.check_board()?;
    bring_up.check_samples()?;
    bring_up.check_rest()?;
    let pushed = bring_up.check_hand()?;
    if bring_up.allows_motion() {
        bring_up.move_it(pushed)?;
    } else {
        bring_up.leave_out_motion("what is wrong above comes first");
    }
    bring_up.check_watchdog()?;
    Ok(bring_up.report)
}

fn refuse_an_enabled_drive(client: &mut Client) -> Result<()> {
    match client.status()?.mode {
        Mode::Disarmed | Mode::Fault => Ok(()),
        Mode::Armed | Mode::Homing | Mode::Running | Mode::Done => Err(Failure::Refused.error(
            "the drive is enabled; make sure that it is safe, and disarm it first (`pneudrive device disarm`)",
        )),
    }
}

impl BringUp<'_> {
    /// Looks at the drive, unless the operator has ended the bring-up.
    fn look(&mut self) -> Result<Status> {
        self.operator.goes_on()?;
        let status = self.client.status()?;
        self.operator.sees(&status);
        Ok(status)
    }

    /// Adds a check to the report and reports it.
    fn note(&mut self, check: Check) {
        self.operator.done(&check);
        self.report.checks.push(check);
    }

    /// Whether nothing so far forbids to enable the drive. An encoder that counts the wrong way does not: pulses are ended
    /// by time.
    fn allows_motion(&self) -> bool {
        self.report.wrong().all(|check| check.name == hand::NAME)
    }

    /// Whether there are pressure sensors, as far as the parameters say.
    fn measures_pressures(&self) -> bool {
        self.parameter(id::PRESSURE_SENSORS) != Some(0)
    }

    /// The value of a parameter; None where the firmware does not have it.
    fn parameter(&self, id: u16) -> Option<i32> {
        self.parameters.values.get(id).filter(|_| !self.parameters.lacking.contains(&id))
    }

    /// So many millimetres in counts; as many counts where their length is unknown.
    fn counts(&self, mm: f64) -> i32 {
        self.units.count_at(mm).unwrap_or(mm as i32).max(1)
    }

    /// The checks for which the drive is enabled, in open loop. Parameters are put back whatever becomes of them, or of this
    /// program.
    fn move_it(&mut self, pushed: Option<i32>) -> Result<()> {
        let question = format!(
            "The cylinder will move: pulses of up to {}, until the slide has moved both ways; it is stopped beyond {:.0} mm. Air on, nobody in reach, emergency stop at hand. At the end the watchdog resets the board; the slide may jerk then. Enable the drive?",
            self.pulse_in_words(i32::from(self.options.most_percent)),
            self.options.reach_mm
        );
        if !self.operator.lets_it_move(&question) {
            self.leave_out_motion("the operator did not let the cylinder move");
            return Ok(());
        }
        let borrowed = Borrowed::of(self.client, &[id::OPEN_LOOP, id::ON_ARRIVAL])?;
        let moved = self.set_for_pulses().and_then(|()| self.check_enabled(pushed));
        borrowed.end(self.client, moved)
    }

    /// Pulses are commands, and none is exited early.
    fn set_for_pulses(&mut self) -> Result<()> {
        for (id, value) in [(id::OPEN_LOOP, 1), (id::ON_ARRIVAL, 0)] {
            if self.parameter(id).is_some() {
                self.client.set_parameters(id, &[value])?;
            }
        }
        Ok(())
    }

    fn check_enabled(&mut self, pushed: Option<i32>) -> Result<()> {
        self.check_enable_line()?;
        if self.allows_motion() && self.check_enabled_rest()? {
            self.check_pulses(pushed)
        } else {
            self.note(Check::left_out(pulses::NAME, "what is wrong above comes first"));
            Ok(())
        }
    }

    fn leave_out_motion(&mut self, why: &str) {
        for name in [enable::LINE, "rest when enabled", pulses::NAME] {
            self.note(Check::left_out(name, why));
        }
    }
}
