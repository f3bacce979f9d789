//! The board's own reports: latched and logged faults, stored parameters, the evenness of its samples.

use anyhow::Result;
use pneudrive_controller::Fault;
use pneudrive_controller::parameters::id;
use pneudrive_protocol::{HISTOGRAM_BINS, Mode, Spread};
use pneudrive_records::words;

use super::watchdog::was_tried;
use super::{BringUp, Check};

/// Faults of the board itself. The log of a new board has none of them.
const OF_THE_BOARD: [Fault; 4] = [Fault::Watchdog, Fault::Panic, Fault::ClockFailed, Fault::BadConfiguration];

impl BringUp<'_> {
    /// Fault log and stored parameters.
    pub(super) fn check_board(&mut self) -> Result<()> {
        let status = self.client.status()?;
        let events = self.client.events()?;
        let state = self.client.config_state()?;
        let logged: Vec<String> = OF_THE_BOARD
            .iter()
            .map(|fault| fault.code())
            .filter(|code| (0..events.len()).any(|k| events[k].code == *code && !was_tried(&events, k)))
            .map(words::fault_code_name)
            .collect();
        let latched = match status.mode {
            Mode::Fault => format!("in the fault {}", words::fault_code_name(status.fault)),
            _ => "in no fault".to_owned(),
        };
        let stored = if state.source == 3 { "damaged" } else { "whole" };
        let mut advice = Vec::new();
        if !logged.is_empty() {
            advice.push(format!(
                "the board was reset by {}: look at its supply and at `pneudrive device faults`, which lists when",
                logged.join(", ")
            ));
        }
        if state.source == 3 {
            advice.push(
                "load parameters and store them: `pneudrive device config import FILE`, `config save`"
                    .to_owned(),
            );
        }
        let saw = format!("{latched}; {} events logged; stored parameters {stored}", events.len());
        self.note(Check::of(
            "board",
            "read fault log and stored parameters",
            saw,
            "no watchdog, panic or lost clock in the log",
            advice,
        ));
        Ok(())
    }

    /// Time from one sample to the next, by the board's own clock.
    pub(super) fn check_samples(&mut self) -> Result<()> {
        let [interval, latency] = self.client.timing()?;
        let period_us = self.parameter(id::PERIOD_US).unwrap_or(0).unsigned_abs();
        let late_us = self.parameter(id::LATE_SAMPLE_US).unwrap_or(0).unsigned_abs();
        let off_us = if interval.count == 0 {
            0
        } else {
            interval.most_us.abs_diff(period_us).max(interval.least_us.abs_diff(period_us))
        };
        let mut advice = Vec::new();
        if off_us > late_us {
            advice.push(
                "samples come unevenly: another interrupt or a flash write is in their way; try again after a reset"
                    .to_owned(),
            );
        }
        let saw = format!("{}; outputs {}", spread(&interval), spread(&latency));
        let must = format!("{period_us} us, off by {late_us} us at most");
        self.note(Check::of("samples", "read the board's clock", saw, &must, advice));
        Ok(())
    }
}

/// A spread in a few words.
fn spread(times: &Spread) -> String {
    let Spread { count, least_us, most_us, bins } = times;
    if *count == 0 {
        return "none measured".to_owned();
    }
    let exact = bins[..HISTOGRAM_BINS.min(2)].iter().sum::<u32>();
    format!("{least_us} to {most_us} us, {exact} of {count} exact within 1 us")
}
