//! When a rig's test does what: its clock and its moves.

use std::num::NonZeroU32;

use pneudrive_controller::sequencer::MAX_MOVES;
use pneudrive_controller::{Move, Sequence};

use super::{Rig, Value, whole_microseconds};

impl Rig {
    /// A value in whole microseconds, from a key in seconds.
    #[must_use]
    pub fn microseconds(&self, path: &str) -> u64 {
        whole_microseconds(self.number(path)).unwrap_or(0)
    }

    /// The sample period.
    #[must_use]
    pub fn period_us(&self) -> NonZeroU32 {
        let period = u32::try_from(self.microseconds("controller.period_s")).ok();
        period.and_then(NonZeroU32::new).expect("checked to be 100 us at least")
    }

    /// The moves: [time in s, counts]. Targets that wait for the end of the one before have no times of
    /// their own.
    #[must_use]
    pub fn moves(&self) -> Vec<(f64, i64)> {
        let moves = match (self.value("test.targets"), self.value("test.moves")) {
            (Some(Value::Integers(targets)), _) => {
                let waits = self.switch("controller.exit_on_dead_band");
                let each = if waits { 0.0 } else { self.number("controller.forced_exit_s") };
                targets.iter().enumerate().map(|(i, &target)| (i as f64 * each, target)).collect()
            }
            (_, Some(Value::Moves(moves))) => moves.clone(),
            _ => Vec::new(),
        };
        match self.value("test.impulse") {
            Some(Value::Numbers(impulse)) => with_impulse(&moves, impulse),
            _ => moves,
        }
    }

    /// The last sample number of the test.
    #[must_use]
    pub fn last_sample(&self) -> u32 {
        let period = u64::from(self.period_us().get());
        u32::try_from(self.microseconds("test.duration_s") / period).unwrap_or(u32::MAX)
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
        let round_us = self.optional_number("test.repeat_every_s").and_then(whole_microseconds);
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
