//! The state of the drive, for the page.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use pneudrive_protocol::{Mode, Status};
use pneudrive_records::units::Units;
use pneudrive_records::words;
use serde::Serialize;
use serde_json::{Value, json};

use super::samples::{Row, Samples};

/// The drive at the last look. Figures are None if the rig does not state their scale.
#[derive(Clone, Debug, Default, Serialize)]
pub struct DriveView {
    /// Counts the looks.
    pub look: u32,
    /// disarmed, armed, running, holding, fault; `approaching` while it goes to the start of a test; `connecting` before
    /// the first look.
    pub mode: &'static str,
    /// The cause of the trip and its meaning; empty without one.
    pub fault: String,
    /// Whether its valve may move it.
    pub is_enabled: bool,
    /// Whether its axis is referenced.
    pub referenced: bool,
    /// How long its test has been running, s; None without a test.
    pub run_s: Option<f64>,
    /// When the last test began, s on the time axis of the samples.
    pub run_began_s: Option<f64>,
    /// Samples per second during a test; None if the firmware has no streams.
    pub stream_hz: Option<f64>,
    /// Soft limits of the position, mm; None where the drive has none.
    pub limits_mm: [Option<f64>; 2],
    /// Setpoint, mm; None where no test has set one.
    pub setpoint: Option<f64>,
    /// Position, mm.
    pub position: Option<f64>,
    /// Error, counts.
    pub error: i32,
    /// Command, counts.
    pub command: i16,
    /// Pressures, kPa.
    pub pressures: [Option<f64>; 2],
    /// Spool position, mm.
    pub spool: Option<f64>,
    /// The last message for the page; empty without one.
    pub message: String,
    /// Whether the link has ended.
    pub is_over: bool,
    /// Whether it moves to the start of a test, which follows.
    #[serde(skip)]
    pub approaches: bool,
    /// Samples since the last line.
    #[serde(skip)]
    pub samples: Samples,
    /// The bring-up, if it has changed.
    #[serde(skip)]
    pub bring_up: Option<Value>,
}

impl DriveView {
    /// Takes over what the rig reports.
    pub fn take(&mut self, status: &Status, units: &Units) {
        let is_fault = status.mode == Mode::Fault;
        let fault =
            || format!("{}: {}", words::fault_code_name(status.fault), words::fault_meaning(status.fault));
        self.look = self.look.wrapping_add(1);
        let is_enabled = is_enabled(status.mode);
        self.mode = if self.approaches && is_enabled { "approaching" } else { mode_name(status.mode) };
        self.fault = if is_fault { fault() } else { String::new() };
        self.is_enabled = is_enabled;
        self.referenced = status.referenced;
        self.run_s = units.seconds(status.index).filter(|_| status.mode.moves());
        if has_sampled(status, units) {
            self.take_figures(status, units);
        }
    }

    fn take_figures(&mut self, status: &Status, units: &Units) {
        self.setpoint = units.millimetres(status.setpoint).filter(|_| has_setpoint(status.mode));
        self.position = units.millimetres(status.position);
        (self.error, self.command) = (status.error, status.command);
        self.pressures = [status.pressure_1, status.pressure_2].map(|raw| units.kilopascals(raw));
        self.spool = units.spool_millimetres(status.spool);
    }

    /// The figures of the last look.
    fn row(&self) -> Row {
        let DriveView { setpoint, position, pressures, spool, error, command, .. } = *self;
        Row { setpoint, position, pressures, spool, error, command }
    }

    /// A line for the page: the drive, and everything new since the last line.
    pub fn line(&mut self) -> Value {
        let mut line = json!(*self);
        if let Some(samples) = self.samples.told() {
            line["samples"] = json!(samples);
        }
        if let Some(bring_up) = self.bring_up.take() {
            line["bring_up"] = bring_up;
        }
        line
    }
}

/// Reports the drive to the page.
#[derive(Debug)]
pub struct Reporter<'a> {
    seen: &'a Mutex<DriveView>,
    begun: Instant,
    /// The scales of the drive.
    pub units: Units,
}

impl<'a> Reporter<'a> {
    /// Reports with these scales. The time axis begins now.
    pub fn new(seen: &'a Mutex<DriveView>, units: Units) -> Reporter<'a> {
        Reporter { seen, begun: Instant::now(), units }
    }

    /// What the page sees.
    pub fn seen(&self) -> MutexGuard<'a, DriveView> {
        self.seen.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Now, s on the time axis of the samples.
    pub fn now_s(&self) -> f64 {
        self.begun.elapsed().as_secs_f64()
    }

    /// Reports a look. `is_sample`: no stream delivers samples at this time.
    pub fn look(&self, status: &Status, is_sample: bool) {
        let now_s = self.now_s();
        let mut seen = self.seen();
        seen.take(status, &self.units);
        if is_sample && has_sampled(status, &self.units) {
            let row = seen.row();
            seen.samples.look(now_s, &row);
        }
    }

    /// Reports a message; an empty one removes the last.
    pub fn tell(&self, message: impl Into<String>) {
        self.seen().message = message.into();
    }
}

/// Tells the page when the link ends, for whatever reason.
pub struct End<'a>(pub &'a Mutex<DriveView>);

impl Drop for End<'_> {
    fn drop(&mut self) {
        let mut seen = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        seen.is_over = true;
        if std::thread::panicking() {
            "the studio has failed; the drive is left to itself, and trips".clone_into(&mut seen.message);
        }
    }
}

/// Whether the figures of a status come from a sample. Between arming or a start and the first sample they are all
/// zero. A drive without pressure sensors may report zeros at rest, too; these count as a sample.
fn has_sampled(status: &Status, units: &Units) -> bool {
    let raw = [status.pressure_1, status.pressure_2, status.spool, status.command];
    let measures_pressures = units.raw_pressure(0).is_some();
    !measures_pressures || status.index > 0 || status.position != 0 || raw.iter().any(|raw| *raw != 0)
}

/// Whether a test sets where the drive is to go: one that is armed or homes has no setpoint, or that of an earlier test.
fn has_setpoint(mode: Mode) -> bool {
    matches!(mode, Mode::Running | Mode::Done)
}

/// Whether the valve may move a drive in this mode.
#[must_use]
pub fn is_enabled(mode: Mode) -> bool {
    mode.moves() || matches!(mode, Mode::Armed | Mode::Done)
}

fn mode_name(mode: Mode) -> &'static str {
    match mode {
        Mode::Disarmed => "disarmed",
        Mode::Armed => "armed",
        Mode::Homing => "homing",
        Mode::Running => "running",
        Mode::Done => "holding",
        Mode::Fault => "fault",
    }
}

#[cfg(test)]
mod tests {
    use pneudrive_controller::parameters::id;
    use pneudrive_records::rig_info::RigParameters;

    use super::*;

    #[test]
    fn zeros_from_before_the_first_sample_are_no_figures() {
        let units = Units::default();
        let mut seen = DriveView { position: Some(98.7), ..DriveView::default() };
        seen.take(&Status { mode: Mode::Armed, ..Status::default() }, &units);
        assert_eq!((seen.mode, seen.position, seen.look), ("armed", Some(98.7), 1));
        seen.take(&Status { mode: Mode::Running, index: 1, ..Status::default() }, &units);
        assert_eq!((seen.mode, seen.position), ("running", None), "a rig without scales tells no mm");
    }

    #[test]
    fn a_drive_has_a_setpoint_from_the_start_of_a_test_on() {
        let units = Units::of(&RigParameters::default());
        let modes = [Mode::Disarmed, Mode::Armed, Mode::Homing, Mode::Running, Mode::Done, Mode::Fault];
        let told = modes.map(|mode| {
            let mut seen = DriveView::default();
            seen.take(&Status { mode, index: 1, position: 100, ..Status::default() }, &units);
            seen.setpoint
        });
        assert_eq!(told, [None, None, None, Some(0.0), Some(0.0), None]);
    }

    #[test]
    fn zeros_of_a_drive_without_pressure_sensors_are_figures() {
        let mut parameters = RigParameters::default();
        parameters.values.set(id::PRESSURE_SENSORS, 0).expect("a parameter");
        let seen = Mutex::new(DriveView::default());
        let mut reporter = Reporter::new(&seen, Units::of(&parameters));
        reporter.look(&Status { mode: Mode::Disarmed, ..Status::default() }, true);
        assert_eq!(reporter.seen().position, Some(0.0));
        assert_eq!(reporter.seen().pressures, [None; 2]);
        assert!(!reporter.seen().line()["samples"].is_null(), "its samples are shown");

        parameters.values.set(id::PRESSURE_SENSORS, 1).expect("a parameter");
        *reporter.seen() = DriveView::default();
        reporter.units = Units::of(&parameters);
        reporter.look(&Status { mode: Mode::Disarmed, ..Status::default() }, true);
        assert_eq!(reporter.seen().position, None);
        assert!(reporter.seen().line()["samples"].is_null());
    }

    #[test]
    fn a_trip_is_told_in_words_and_a_disarmed_drive_has_no_setpoint() {
        let mut seen = DriveView::default();
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

    #[test]
    fn the_page_is_told_of_a_link_whose_thread_has_failed() {
        let seen = Mutex::new(DriveView::default());
        std::thread::scope(|scope| {
            let failing = scope.spawn(|| {
                let _end = End(&seen);
                assert!(seen.is_poisoned(), "on purpose");
            });
            assert!(failing.join().is_err());
        });
        let seen = seen.lock().expect("nobody failed while it was held");
        assert!(seen.is_over && seen.message.contains("failed"), "{seen:?}");
    }
}
