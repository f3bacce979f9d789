//! What the page sees of the drive.

use pneudrive_protocol::{Mode, Status};
use pneudrive_records::units::Units;
use pneudrive_records::words;
use serde::Serialize;

/// The drive as it was at the last look; figures are None where the rig does not tell their scale.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Seen {
    /// Counts the looks.
    pub look: u32,
    /// disarmed, armed, running, holding or fault; connecting before the first look.
    pub mode: &'static str,
    /// Why it tripped, and what that means; empty if it did not.
    pub fault: String,
    /// Whether its valve may move it.
    pub is_enabled: bool,
    /// Whether its axis is referenced.
    pub referenced: bool,
    /// How long its test has been running, s; None while none is.
    pub run_s: Option<f64>,
    /// mm.
    pub setpoint: Option<f64>,
    /// mm.
    pub position: Option<f64>,
    /// Counts.
    pub error: i32,
    /// Counts.
    pub command: i16,
    /// kPa.
    pub pressures: [Option<f64>; 2],
    /// mm.
    pub spool: Option<f64>,
    /// The last thing that the page must know; empty if there is none.
    pub message: String,
    /// Whether the link has ended.
    pub is_over: bool,
}

impl Seen {
    /// Takes what the rig says of itself.
    pub fn take(&mut self, status: &Status, units: &Units) {
        let is_fault = status.mode == Mode::Fault;
        let fault =
            || format!("{}: {}", words::fault_code_name(status.fault), words::fault_meaning(status.fault));
        self.look = self.look.wrapping_add(1);
        self.mode = mode_name(status.mode);
        self.fault = if is_fault { fault() } else { String::new() };
        self.is_enabled = is_enabled(status.mode);
        self.referenced = status.referenced;
        self.run_s = units.seconds(status.index).filter(|_| status.mode == Mode::Running);
        if has_sampled(status) {
            self.take_figures(status, units);
        }
    }

    fn take_figures(&mut self, status: &Status, units: &Units) {
        self.setpoint = units.millimetres(status.setpoint).filter(|_| self.is_enabled);
        self.position = units.millimetres(status.position);
        (self.error, self.command) = (status.error, status.command);
        self.pressures = [status.pressure_1, status.pressure_2].map(|raw| units.kilopascals(raw));
        self.spool = units.spool_millimetres(status.spool);
    }
}

/// Whether the figures of a status come from a sample. Between arming or a start and the first sample they are all zero.
fn has_sampled(status: &Status) -> bool {
    let raw = [status.pressure_1, status.pressure_2, status.spool, status.command];
    status.index > 0 || status.position != 0 || raw.iter().any(|raw| *raw != 0)
}

/// Whether a drive in a mode may be moved by its valve.
#[must_use]
pub fn is_enabled(mode: Mode) -> bool {
    matches!(mode, Mode::Armed | Mode::Running | Mode::Done)
}

fn mode_name(mode: Mode) -> &'static str {
    match mode {
        Mode::Disarmed => "disarmed",
        Mode::Armed => "armed",
        Mode::Running => "running",
        Mode::Done => "holding",
        Mode::Fault => "fault",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_from_before_the_first_sample_are_no_figures() {
        let units = Units::default();
        let mut seen = Seen { position: Some(98.7), ..Seen::default() };
        seen.take(&Status { mode: Mode::Armed, ..Status::default() }, &units);
        assert_eq!((seen.mode, seen.position, seen.look), ("armed", Some(98.7), 1));
        seen.take(&Status { mode: Mode::Running, index: 1, ..Status::default() }, &units);
        assert_eq!((seen.mode, seen.position), ("running", None), "a rig without scales tells no mm");
    }

    #[test]
    fn a_trip_is_told_in_words_and_a_disarmed_drive_has_no_setpoint() {
        let mut seen = Seen::default();
        let code = pneudrive_controller::Fault::HostSilent.code();
        seen.take(
            &Status { mode: Mode::Fault, fault: code, position: 5, ..Status::default() },
            &Units::default(),
        );
        assert!(
            seen.fault.starts_with("host-silent: the host was silent") && seen.setpoint.is_none(),
            "{seen:?}"
        );
    }
}
