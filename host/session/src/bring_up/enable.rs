//! The enable line: with its wire off the amplifier nothing may move, whatever the converter says. Also the drive at
//! rest when it is enabled.

use std::time::{Duration, Instant};

use anyhow::Result;
use pneudrive_controller::drive::{DacCode, DacConfig, MAX_CODE};
use pneudrive_controller::parameters::id;
use pneudrive_protocol::Mode;
use pneudrive_records::words;

use super::pulses::surprised;
use super::{BringUp, Check};
use pneudrive_link::failure::Failure;

/// The names of the checks.
pub(super) const LINE: &str = "enable line";
const REST: &str = "rest when enabled";

/// Commands of the ramp, percent, and how long each lasts, s: time to read a voltmeter.
const RAMP: [i32; 5] = [-100, -50, 0, 50, 100];
const STANDS_S: f64 = 3.0;

/// The reference of the boards' converters, V.
const REFERENCE_V: f64 = 3.3;

/// How long an enabled drive is watched.
const WATCHED: Duration = Duration::from_millis(600);

/// A slide at rest stays within this, mm.
const STILL_MM: f64 = 0.5;

impl BringUp<'_> {
    /// Pulses and a ramp while the wire of `drive_enable` is off the amplifier.
    pub(super) fn check_enable_line(&mut self) -> Result<()> {
        let question = "Take the wire of drive_enable off the amplifier or translator, and tie its input to GND. Is it off?";
        match self.operator.answers(question) {
            None => {
                let why = "it needs a hand at the wire and a voltmeter: run it without --yes";
                self.note(Check::left_out(LINE, why));
                return Ok(());
            }
            Some(false) => {
                self.note(Check::left_out(LINE, "the wire stayed on"));
                return Ok(());
            }
            Some(true) => {}
        }
        let thresholds = self.thresholds();
        for percent in self.levels() {
            match self.pulses(percent)? {
                Ok(pair) if thresholds.heard(&pair) => {
                    let saw = format!(
                        "{:+.0} counts{} at {percent} %",
                        pair.counts(),
                        self.in_words(pair.pressures())
                    );
                    self.note(Check::of(LINE, PULSED, saw, NOTHING, vec![UNGATED.to_owned()]));
                    return Ok(());
                }
                Ok(_) => {}
                Err(surprise) => {
                    let did = format!("a pulse of {}", self.pulse_in_words(percent));
                    self.note(surprised(LINE, &did, &surprise));
                    return Ok(());
                }
            }
        }
        self.note(Check::of(LINE, PULSED, "nothing".to_owned(), NOTHING, Vec::new()));
        self.check_stage()?;
        if self.operator.answers("Put the wire of drive_enable back, and the air on. Is it so?") != Some(true)
        {
            self.operator.tell("without the enable line and the air nothing will answer");
        }
        Ok(())
    }

    /// The output of the converter or to the translator, checked with an instrument.
    fn check_stage(&mut self) -> Result<()> {
        const NAME: &str = "drive stage";
        if self.operator.answers("Shut off the air and vent the drive, for a slow ramp. Is the air off?")
            != Some(true)
        {
            self.note(Check::left_out(NAME, "the air stayed on"));
            return Ok(());
        }
        let expected: Vec<String> = RAMP.iter().map(|&percent| self.expected(percent)).collect();
        self.operator.tell(&format!("each for {STANDS_S:.0} s: {}", expected.join(", ")));
        let stands = self.samples(STANDS_S);
        let commands: Vec<(u32, i32)> =
            (0..).map(|place| place * stands).zip(RAMP.map(|percent| self.command(percent))).collect();
        let did = format!("a ramp: {}", expected.join(", "));
        let ended = self.run(&commands, stands * RAMP.len() as u32)?;
        if let Err(surprise) = ended {
            self.note(surprised(NAME, &did, &surprise));
            return Ok(());
        }
        let must = "as listed, within 0.05 V; a converter that does not reach 0 or 3.3 V stays 0.2 V short";
        let advice = "the converter's pin, its stage or the null code is not as the parameters have it; of a translator: step, direction, and the times pulse_width_us, direction_setup_us";
        match self.operator.answers("Did the instrument show that?") {
            Some(true) => self.note(Check::of(NAME, &did, "the same".to_owned(), must, Vec::new())),
            Some(false) => {
                self.note(Check::of(NAME, &did, "something else".to_owned(), must, vec![advice.to_owned()]));
            }
            None => self.note(Check::left_out(NAME, "nobody read the instrument")),
        }
        Ok(())
    }

    /// The reading of an instrument at a command.
    fn expected(&self, percent: i32) -> String {
        let command = self.command(percent);
        if self.is_stepper() {
            return format!("spool at {command:+} steps from its null");
        }
        let null_code =
            self.parameter(id::NULL_CODE).map_or(DacCode::MIDDLE, |code| DacCode::new(code as u16));
        let inverted = self.parameter(id::OUTPUT_INVERTED) == Some(1);
        let code = DacConfig { null_code, inverted, max_counts: self.largest() as i16 }.code(command as i16);
        let volts = f64::from(code.get()) / f64::from(MAX_CODE) * REFERENCE_V;
        format!("{command:+} counts = {volts:.2} V at the pin")
    }

    /// Arms the drive and checks that the slide stays. Returns false if the checks must not continue.
    pub(super) fn check_enabled_rest(&mut self) -> Result<bool> {
        // Whoever ends the bring-up at a question does not want the drive armed.
        self.look()?;
        if let Err(error) = self.client.arm() {
            if !error.chain().any(|cause| Failure::of_cause(cause) == Some(Failure::Refused)) {
                return Err(error);
            }
            let advice = vec!["do what the refusal says, and begin anew".to_owned()];
            self.note(Check::of(
                REST,
                "armed the drive",
                format!("it was refused: {error:#}"),
                "it arms",
                advice,
            ));
            return Ok(false);
        }
        let (furthest, fault) = self.watch_rest()?;
        self.client.disarm()?;
        let mut saw = format!("{furthest:+} counts ({})", self.units.length(furthest));
        let mut advice = Vec::new();
        if let Some(code) = fault {
            saw =
                format!("{saw}; tripped: {} ({})", words::fault_code_name(code), words::fault_meaning(code));
            advice.push("find the reason of the fault; `pneudrive device arm` clears it".to_owned());
        } else if furthest.saturating_abs() > self.counts(STILL_MM) {
            advice.push(
                "the slide moves though the command is null: set the null code (null_code) or the amplifier's zero, so that the valve is shut"
                    .to_owned(),
            );
        }
        let must = format!("the slide stays within {STILL_MM} mm for {} s", WATCHED.as_secs_f64());
        self.note(Check::of(REST, "armed the drive, valve at its null", saw, &must, advice));
        Ok(fault.is_none())
    }

    /// How far the slide of an armed drive moves, counts, and the fault that it trips with, if any.
    fn watch_rest(&mut self) -> Result<(i32, Option<u8>)> {
        let still = self.counts(STILL_MM);
        let from = self.client.status()?.position;
        let begun = Instant::now();
        let mut furthest: i32 = 0;
        while begun.elapsed() < WATCHED && furthest.saturating_abs() <= still {
            let status = self.look()?;
            let moved = status.position.saturating_sub(from);
            if moved.unsigned_abs() > furthest.unsigned_abs() {
                furthest = moved;
            }
            if status.mode == Mode::Fault {
                return Ok((furthest, Some(status.fault)));
            }
        }
        Ok((furthest, None))
    }
}

const PULSED: &str = "pulses both ways with the wire of drive_enable off";
const NOTHING: &str = "nothing moves";
const UNGATED: &str = "the amplifier drives the valve without drive_enable: wire drive_enable to its enable input, or to a relay in its supply. A board in reset commands full retraction";
