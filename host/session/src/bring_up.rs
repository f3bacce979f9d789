//! Bring-up: the checks of a new board and its wires, first those that move nothing.
//!
//! | check | moves | shows |
//! |---|---|---|
//! | board | | firmware, stored parameters, latched and logged faults |
//! | samples | | a clock that is uneven |
//! | sensors at rest | | open, shorted and floating inputs |
//! | encoder by hand | by hand | direction of the encoder, and whether it counts; the valve is shut |
//! | enable line | nothing should | whether `drive_enable` gates the amplifier; the converter's ramp against a voltmeter |
//! | rest when enabled | nothing should | a valve that is not shut at its null |
//! | pulses | a few mm | the signs of valve, tubes, encoder and transmitters against each other ([`signs`]) |
//! | watchdog | nothing should; the slide may jerk | whether the watchdog resets the board |
//!
//! A pulse is an open-loop test: a command for a tenth of a second, which the board ends by itself. Commands rise
//! from a few percent of the valve until the slide has moved both ways. Anything unexpected ends the bring-up, with
//! the drive disarmed.

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

/// Shortest and longest wait for a push of the slide, s.
pub const PUSH_WAIT_S: [u16; 2] = [0, 600];

/// Smallest and largest limit on the command, percent.
pub const MAX_PERCENT: [u8; 2] = [3, 50];

/// The limits of a bring-up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// How long to wait for a push of the slide by hand; zero: no push is requested.
    pub push_wait: Duration,
    /// The largest command of a pulse, percent of the valve.
    pub most_percent: u8,
    /// A slide that moves further than this is stopped, mm (counts if their length is unknown).
    pub reach_mm: f64,
    /// How long the board may take to answer after its watchdog was last fed, and then to log the reason. The
    /// watchdog bites within half a second; an emulated board counts virtual time.
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

/// The operator at the drive.
pub trait Operator {
    /// Announces the next step.
    fn tell(&mut self, text: &str);

    /// Reports a finished check.
    fn done(&mut self, check: &Check);

    /// Whether the cylinder may move now.
    fn lets_it_move(&mut self, question: &str) -> bool;

    /// Answers a question; None without an operator.
    fn answers(&mut self, question: &str) -> Option<bool>;

    /// Called repeatedly while the bring-up waits for the drive.
    ///
    /// # Errors
    /// When the operator ends the bring-up.
    fn goes_on(&mut self) -> Result<()>;

    /// Shows the drive at each look.
    fn sees(&mut self, _: &Status) {}
}

/// The drive, the facts about it, and the findings.
struct BringUp<'a> {
    client: &'a mut Client,
    operator: &'a mut dyn Operator,
    options: Options,
    parameters: RigParameters,
    units: Units,
    report: Report,
}

/// Runs the checks in order. Afterwards the drive is disarmed, with the parameters that it had; its test is gone.
///
/// # Errors
/// When the drive is enabled, another host commands it, the rig does not answer, or the operator ends the bring-up. A
/// check that finds something wrong is not an error.
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

    /// Whether the findings so far allow the drive to be enabled. An encoder that counts the wrong way does, because
    /// time ends the pulses.
    fn allows_motion(&self) -> bool {
        self.report.wrong().all(|check| check.name == hand::NAME)
    }

    /// Whether there are pressure sensors, according to the parameters.
    fn measures_pressures(&self) -> bool {
        self.parameter(id::PRESSURE_SENSORS) != Some(0)
    }

    /// The value of a parameter; None if the firmware does not have it.
    fn parameter(&self, id: u16) -> Option<i32> {
        self.parameters.values.get(id).filter(|_| !self.parameters.lacking.contains(&id))
    }

    /// Millimetres in counts; the same number of counts if their length is unknown.
    fn counts(&self, mm: f64) -> i32 {
        self.units.count_at(mm).unwrap_or(mm as i32).max(1)
    }

    /// The checks with the drive enabled, in open loop. Parameters are put back whatever happens to the checks or to
    /// this program.
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

    /// Pulses are commands, and none exits early.
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
