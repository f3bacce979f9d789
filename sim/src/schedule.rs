//! When a rig's test does what: its clock and its moves.

use std::num::NonZeroU32;

use pneudrive_controller::sequencer::MAX_MOVES;
use pneudrive_controller::{Move, Sequence};

use crate::component::controller::{self, Loop};
use crate::component::{actuator, encoder, safety};
use crate::key::{Kind, Preset, keys};
use crate::values::{Findings, Rig, whole_microseconds};

const COUNT: i64 = i32::MAX as i64;

keys! {
    MOVES: Vec<(f64, i64)> = other("test.moves", Kind::Moves, Preset::Moves(&[(0.0, 8192), (0.3, 16_384), (1.72, 8192)]), "L(6)", "[time in s, counts], in order of time: setpoints, or commands in open loop.");
    TARGETS: Option<Vec<i64>> = other("test.targets", Kind::Integers { min: -COUNT, max: COUNT, max_entries: 64 }, Preset::Absent("moves hold"), "L(6)", "Setpoints in counts, each for controller.forced_exit_s: the thesis's way, instead of moves.");
    DURATION_S: f64 = number("test.duration_s", 3.1, 1e-4, 3600.0, "", "Length of the test.");
    REPEAT_EVERY_S: Option<f64> = optional_number("test.repeat_every_s", 1e-4, 3600.0, "the moves run once", "", "Period at which the moves repeat, rounded up to whole samples, until the end of the test.");
    IMPULSE: Option<Vec<f64>> = optional_numbers("test.impulse", 3, "no impulse", "8.2.1", "[time in s, duration in s, counts]: raises the setpoint, or the command in open loop, by the counts for the duration.");
    TRACE_PERIOD_S: Option<f64> = optional_number("test.trace_period_s", 1e-6, 3600.0, "a row a sample", "", "Period of the rows of trace.csv; whole microseconds.");
    DECIMATION: i64 = integer("test.decimation", 1, 1, 10_000, "", "The recorder stores every Nth sample.");
    PRE_TRIGGER: i64 = integer("test.pre_trigger", 0, 0, 2000, "", "Stored samples from before the start.");
    POSITION_M: f64 = number("test.position_m", 98.719_625e-3, 0.0, 20.0, "", "Position at the start; 8192.5 counts, for a start on the edge of a count is ill-defined.");
    PRESSURE_1_PA: Option<f64> = optional_number("test.pressure_1_pa", 1e4, 5e6, "equilibrium with pressure_2_pa", "", "Chamber 1 at the start, absolute.");
    PRESSURE_2_PA: f64 = number("test.pressure_2_pa", 400_000.0, 1e4, 5e6, "", "Chamber 2 at the start, absolute.");
    TEMPERATURE_1_K: f64 = number("test.temperature_1_k", 294.0, 150.0, 600.0, "", "Chamber 1 at the start.");
    TEMPERATURE_2_K: f64 = number("test.temperature_2_k", 294.0, 150.0, 600.0, "", "Chamber 2 at the start.");
}

impl Rig {
    /// The sample period.
    #[must_use]
    pub fn period_us(&self) -> NonZeroU32 {
        let period = u32::try_from(self.microseconds(&controller::keys::PERIOD_S)).ok();
        period.and_then(NonZeroU32::new).expect("checked to be 100 us at least")
    }

    /// The moves: [time in s, counts]. Targets that wait for the end of the one before have no times of
    /// their own.
    #[must_use]
    pub fn moves(&self) -> Vec<(f64, i64)> {
        let moves = match self.get(&keys::TARGETS) {
            Some(targets) => {
                let waits = self.get(&controller::keys::EXIT_ON_DEAD_BAND);
                let each = if waits { 0.0 } else { self.get(&controller::keys::FORCED_EXIT_S) };
                targets.iter().enumerate().map(|(i, &target)| (i as f64 * each, target)).collect()
            }
            None => self.get(&keys::MOVES),
        };
        match self.get(&keys::IMPULSE) {
            Some(impulse) => with_impulse(&moves, &impulse),
            None => moves,
        }
    }

    /// The last sample number of the test.
    #[must_use]
    pub fn last_sample(&self) -> u32 {
        let period = u64::from(self.period_us().get());
        u32::try_from(self.microseconds(&keys::DURATION_S) / period).unwrap_or(u32::MAX)
    }

    /// The test as the controller takes it.
    #[must_use]
    pub fn sequence(&self) -> Sequence {
        let mut sequence = Sequence::new(self.last_sample());
        for (time_s, target) in self.moves().into_iter().take(MAX_MOVES) {
            let time_us = u32::try_from(whole_microseconds(time_s).unwrap_or(0)).unwrap_or(u32::MAX);
            let target = i32::try_from(target).unwrap_or(i32::MAX);
            sequence
                .push(Move::at_time_us(time_us, self.period_us(), target))
                .expect("checked to be in order and few enough");
        }
        sequence.repeat_every(self.round_samples()).expect("checked to be behind the last move");
        sequence
    }

    /// After how many samples the moves come again; 0: never.
    fn round_samples(&self) -> u32 {
        let round_us = self.get(&keys::REPEAT_EVERY_S).and_then(whole_microseconds);
        let samples = round_us.unwrap_or(0).div_ceil(u64::from(self.period_us().get()));
        u32::try_from(samples).unwrap_or(u32::MAX)
    }
}

/// Moves with a pulse `[time, duration, counts]` on top of them (thesis 8.2.1).
fn with_impulse(moves: &[(f64, i64)], impulse: &[f64]) -> Vec<(f64, i64)> {
    let &[start, duration, counts] = impulse else { return moves.to_vec() };
    let end = ((start + duration) * 1e6).round() / 1e6;
    let in_force =
        |time: f64| moves.iter().rev().find(|(at, _)| *at <= time).map_or(0, |(_, target)| *target);
    let raised = |time: f64, target: i64| {
        (time, if (start..end).contains(&time) { target + counts as i64 } else { target })
    };
    let edges = [start, end].into_iter().filter(|edge| moves.iter().all(|(at, _)| at != edge));
    let mut all: Vec<_> = moves.iter().copied().chain(edges.map(|edge| (edge, in_force(edge)))).collect();
    all.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    all.into_iter().map(|(time, target)| raised(time, target)).collect()
}

/// Rows of a trace, which are kept in memory, 160 bytes each.
const MAX_ROWS: f64 = 1e7;

/// What a test must hold by itself and with its controller.
pub(crate) fn check(rig: &Rig, findings: &mut Findings) {
    check_clock(rig, findings);
    check_moves(rig, findings);
    if rig.get(&controller::keys::LOOP) == Loop::Closed {
        check_setpoints(rig, findings);
    }
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

fn check_moves(rig: &Rig, findings: &mut Findings) {
    let moves = rig.moves();
    if moves.is_empty() || moves.len() > MAX_MOVES {
        findings.note(&keys::MOVES, format!("must have 1 to {MAX_MOVES} moves, has {}", moves.len()));
    }
    if moves.iter().any(|(time, _)| whole_microseconds(*time).is_none_or(|us| us > u64::from(u32::MAX))) {
        findings.note(&keys::MOVES, "times must be whole microseconds from 0 to 4294 s");
    }
    if moves.windows(2).any(|pair| pair[1].0 < pair[0].0) {
        findings.note(&keys::MOVES, "must be in order of time");
    }
    let last = moves.last().map_or(0.0, |(time, _)| *time);
    // A whole sample between them, so that the last move is in force at one at least.
    let shortest = last + rig.get(&controller::keys::PERIOD_S);
    if rig.get(&keys::REPEAT_EVERY_S).is_some_and(|round| round < shortest) {
        let message = format!("must be a sample period longer than the time of the last move, {last} s");
        findings.note(&keys::REPEAT_EVERY_S, message);
    }
    if moves.iter().any(|(_, target)| i32::try_from(*target).is_err()) {
        findings.note(&keys::MOVES, "counts must fit 32 bits");
    }
    if rig.get(&controller::keys::EXIT_ON_DEAD_BAND) && rig.get(&keys::TARGETS).is_none() {
        let message = "needs test.targets: timed moves do not wait for the end of the one before";
        findings.note(&controller::keys::EXIT_ON_DEAD_BAND, message);
    }
}

/// A setpoint that the cylinder cannot reach is a slip of units as a rule.
fn check_setpoints(rig: &Rig, findings: &mut Findings) {
    let (moves, mm_per_count) = (rig.moves(), rig.get(&encoder::keys::MM_PER_COUNT));
    for (end, side) in [(&safety::keys::END_MIN_MM, -1.0), (&safety::keys::END_MAX_MM, 1.0)] {
        let Some(mm) = rig.get(end) else { continue };
        let beyond = |target: i64| side * (target as f64 * mm_per_count - mm) > 0.0;
        if let Some((_, target)) = moves.iter().find(|(_, target)| beyond(*target)) {
            findings.note(end, format!("setpoint {target} lies beyond it"));
        }
    }
    let stroke = (rig.get(&actuator::keys::STROKE_M) * 1e3 / mm_per_count) as i64;
    for (_, target) in moves.iter().filter(|(_, target)| *target < 0 || *target > stroke) {
        let message = format!("setpoint {target} is outside the stroke of 0 to {stroke} counts");
        match rig.get(&keys::TARGETS) {
            Some(_) => findings.note(&keys::TARGETS, message),
            None => findings.note(&keys::MOVES, message),
        }
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
    if let Some((first, _)) = rig.get(&keys::MOVES).first()
        && closed
        && rig.get(&keys::TARGETS).is_none()
        && impulse[0] < *first
    {
        let message =
            format!("begins before the first move, at {first} s: there is no setpoint for it to be added to");
        findings.note(&keys::IMPULSE, message);
    }
}
