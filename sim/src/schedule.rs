//! The schedule of a rig's test: its clock and its moves.

use std::num::NonZeroU32;

use pneudrive_controller::Sequence;
use pneudrive_controller::sequencer::MAX_MOVES;

use crate::component::controller::{self, Loop};
use crate::key::{Key, Kind, Preset, keys};
use crate::values::{Fields, Findings, Rig, whole_microseconds};

mod check;
mod entry;
mod plan;
mod ramp;
#[cfg(test)]
mod tests;

use entry::ENTRIES;
pub use entry::Shape;
pub use plan::{Planned, Slip};

const COUNT: i64 = i32::MAX as i64;

/// Distance from its setpoint within which a move has settled, mm, where no rig file says another.
pub const USUAL_TOLERANCE_MM: f64 = 0.05;

keys! {
    MOVES: Vec<(f64, i64)> = other("test.moves", Kind::Moves, Preset::Moves(&[(0.0, 8192), (0.3, 16_384), (1.72, 8192)]), "L(6)", "[time in s, counts], in order of time: setpoints, or commands in open loop.");
    TARGETS: Option<Vec<i64>> = other("test.targets", Kind::Integers { min: -COUNT, max: COUNT, max_entries: 64 }, Preset::Absent("moves hold"), "L(6)", "Setpoints in counts, each for controller.forced_exit_s: the thesis's way, instead of moves.");
    MOVE: Option<Vec<Fields>> = other("test.move", Kind::Tables(&ENTRIES), Preset::Absent("moves or targets hold"), "", "Moves with a profile, in mm and s, one table [[test.move]] each, in order of time; instead of moves.");
    MOVES_MM: Option<Vec<Vec<f64>>> = other("test.moves_mm", Kind::Rows { columns: &["time in s", "mm"], max_rows: MAX_MOVES }, Preset::Absent("moves hold"), "", "[time in s, mm], in order of time: setpoints in closed loop, to the nearest count, whatever the encoder's resolution; instead of moves.");
    TARGETS_MM: Option<Vec<f64>> = other("test.targets_mm", Kind::Numbers { least: 1, most: MAX_MOVES }, Preset::Absent("moves hold"), "", "The same as targets, in mm and in closed loop.");
    PROFILE: Shape = choice("test.profile", "", "How the setpoint goes to each of moves and targets: at once, or within the limits below.");
    VELOCITY_MM_S: f64 = number("test.velocity_mm_s", 500.0, 1e-3, 1e5, "", "Limit of the setpoint's velocity in a profile; in open loop counts/s.");
    ACCELERATION_MM_S2: f64 = number("test.acceleration_mm_s2", 5000.0, 1e-3, 1e7, "", "Limit of the setpoint's acceleration in a profile; in open loop counts/s^2.");
    JERK_MM_S3: f64 = number("test.jerk_mm_s3", 100_000.0, 1e-3, 1e10, "", "Limit of the setpoint's jerk in an S-curve; in open loop counts/s^3.");
    DURATION_S: f64 = number("test.duration_s", 3.1, 1e-4, 3600.0, "", "Length of the test.");
    REPEAT_EVERY_S: Option<f64> = optional_number("test.repeat_every_s", 1e-4, 3600.0, "the moves run once", "", "Period at which the moves repeat, rounded up to whole samples, until the end of the test.");
    IMPULSE: Option<Vec<f64>> = optional_numbers("test.impulse", 3, "no impulse", "8.2.1", "[time in s, duration in s, counts]: raises the setpoint, or the command in open loop, by the counts for the duration.");
    TOLERANCE_MM: f64 = number("test.tolerance_mm", USUAL_TOLERANCE_MM, 1e-4, 1000.0, "", "A move has settled within this distance of its setpoint: for the figures of moves, tune and sweep. The controller does not know it.");
    TRACE_PERIOD_S: Option<f64> = optional_number("test.trace_period_s", 1e-6, 3600.0, "a row a sample", "", "Period of the rows of trace.csv; whole microseconds.");
    DECIMATION: i64 = integer("test.decimation", 1, 1, 10_000, "", "The recorder stores every Nth sample.");
    PRE_TRIGGER: i64 = integer("test.pre_trigger", 0, 0, 2000, "", "Stored samples from before the start.");
    POSITION_M: f64 = number("test.position_m", 98.719_625e-3, 0.0, 20.0, "", "Position at the start; 8192.5 counts, for a start on the edge of a count is ill-defined.");
    PRESSURE_1_PA: Option<f64> = optional_number("test.pressure_1_pa", 1e4, 5e6, "equilibrium with pressure_2_pa", "", "Chamber 1 at the start, absolute.");
    PRESSURE_2_PA: f64 = number("test.pressure_2_pa", 400_000.0, 1e4, 5e6, "", "Chamber 2 at the start, absolute.");
    TEMPERATURE_1_K: f64 = number("test.temperature_1_k", 294.0, 150.0, 600.0, "", "Chamber 1 at the start.");
    TEMPERATURE_2_K: f64 = number("test.temperature_2_k", 294.0, 150.0, 600.0, "", "Chamber 2 at the start.");
    RECEIVER_PRESSURE_PA: Option<f64> = optional_number("test.receiver_pressure_pa", 1e4, 5e6, "supply.pressure_pa", "", "Receiver of the supply, or volume behind its regulator, at the start, absolute.");
}

/// The forms in which a test gives its moves. A rig has one of them.
pub static MOVE_FORMS: [&Key; 5] =
    [&keys::MOVES.key, &keys::MOVES_MM.key, &keys::TARGETS.key, &keys::TARGETS_MM.key, &keys::MOVE.key];

impl Rig {
    /// The sample period.
    #[must_use]
    pub fn period_us(&self) -> NonZeroU32 {
        let period = u32::try_from(self.microseconds(&controller::keys::PERIOD_S)).ok();
        period.and_then(NonZeroU32::new).expect("checked to be 100 us at least")
    }

    /// The moves without their profiles: [time in s, counts]. Targets that wait for the end of the move before have
    /// no times of their own.
    #[must_use]
    pub fn moves(&self) -> Vec<(f64, i64)> {
        self.planned().into_iter().map(|one| (one.time_s, one.target)).collect()
    }

    /// The last sample number of the test.
    #[must_use]
    pub fn last_sample(&self) -> u32 {
        let period = u64::from(self.period_us().get());
        u32::try_from(self.microseconds(&keys::DURATION_S) / period).unwrap_or(u32::MAX)
    }

    /// The test in the form of the controller.
    #[must_use]
    pub fn sequence(&self) -> Sequence {
        let mut sequence = Sequence::new(self.last_sample());
        for planned in self.planned().into_iter().take(MAX_MOVES) {
            sequence.push(planned.in_force(self.period_us())).expect("checked to be in order and few enough");
        }
        sequence.repeat_every(self.round_samples()).expect("checked to be behind the last move");
        sequence
    }

    /// Length of a round, after which the moves repeat, samples; 0: they come once.
    fn round_samples(&self) -> u32 {
        let round_us = self.get(&keys::REPEAT_EVERY_S).and_then(whole_microseconds);
        let samples = round_us.unwrap_or(0).div_ceil(u64::from(self.period_us().get()));
        u32::try_from(samples).unwrap_or(u32::MAX)
    }
}

/// Most rows of a trace, which are kept in memory, 160 bytes each.
const MAX_ROWS: f64 = 1e7;

/// The constraints on a test by itself and with its controller.
pub(crate) fn check(rig: &Rig, findings: &mut Findings) {
    check_clock(rig, findings);
    check::check(rig, findings);
    check_impulse(rig, findings);
}

fn check_clock(rig: &Rig, findings: &mut Findings) {
    let optional = [&keys::TRACE_PERIOD_S, &keys::REPEAT_EVERY_S].map(|key| (&key.key, rig.get(key)));
    let times = [(&keys::DURATION_S.key, Some(rig.get(&keys::DURATION_S)))].into_iter().chain(optional);
    for (key, seconds) in times {
        if seconds.is_some_and(|seconds| whole_microseconds(seconds).is_none()) {
            findings.note(key, "must be a whole number of microseconds");
        }
    }
    let rows = rig.get(&keys::TRACE_PERIOD_S).map(|period| rig.get(&keys::DURATION_S) / period);
    if let Some(rows) = rows.filter(|rows| *rows > MAX_ROWS) {
        let message = format!(
            "makes {rows:.0} rows in test.duration_s; {MAX_ROWS:.0} at most fit: take a longer period or a shorter test"
        );
        findings.note(&keys::TRACE_PERIOD_S, message);
    }
}

fn check_impulse(rig: &Rig, findings: &mut Findings) {
    let Some(impulse) = rig.get(&keys::IMPULSE) else { return };
    if impulse[0] < 0.0 || impulse[1] <= 0.0 || impulse[2].fract() != 0.0 {
        let message = "is [time in s, duration in s, counts]: the duration above 0, whole counts";
        findings.note(&keys::IMPULSE, message);
    }
    // Before the first move a closed loop holds where it is, which no file knows.
    let closed = rig.get(&controller::keys::LOOP) == Loop::Closed;
    if let Some((first, _)) = rig.moves_listed().first()
        && closed
        && rig.targets().is_none()
        && impulse[0] < *first
    {
        let message =
            format!("begins before the first move, at {first} s: there is no setpoint for it to be added to");
        findings.note(&keys::IMPULSE, message);
    }
}
