//! A run of a study, with the quantities that its statements need.

use pneudrive_sim::{Rig, Run};

use super::steadiness::{Steadiness, Swing, swing};
use pneudrive_evaluate::deviation::deviations;
use pneudrive_evaluate::evaluation::{Motion, Move, moves, tolerance_mm};
use pneudrive_evaluate::transient::{COMMAND, POSITION, SETPOINT, Transient};

/// A run and its figures.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The drive's name in its study.
    pub name: &'static str,
    /// Its run.
    pub transient: Transient,
    /// Its moves, measured.
    pub moves: Vec<Move>,
    /// Evaluations of the model's right-hand side that it took.
    pub evaluations: u64,
    /// The sample at which the supervisor tripped, if it did.
    pub tripped: Option<usize>,
}

impl Outcome {
    pub(super) fn of(name: &'static str, rig: &Rig, run: &Run) -> Outcome {
        let transient = Transient::of_simulation(name, rig, run);
        Outcome {
            name,
            moves: moves(&transient, &Motion::of(&transient), None, tolerance_mm(Some(rig))),
            transient,
            evaluations: run.work.integrator.n_rhs_evaluations,
            tripped: run.fault.map(|(_, sample)| sample as usize),
        }
    }

    /// The moves but the first, which begins at rest and stays where it is.
    pub(super) fn asked(&self) -> &[Move] {
        self.moves.get(1..).unwrap_or_default()
    }

    pub(super) fn last(&self) -> &Move {
        self.moves.last().expect("a run has a move")
    }

    /// How far it swings at the end of its long moves; None if it has none, or was stopped.
    pub(super) fn swing(&self) -> Option<Swing> {
        if self.tripped.is_some() {
            return None;
        }
        let spans: Vec<[f64; 2]> = self.spans().collect();
        Swing::of(&self.transient.time, &self.transient.channels[POSITION], &spans)
    }

    /// When each of its moves begins and ends, s.
    fn spans(&self) -> impl Iterator<Item = [f64; 2]> {
        let end_s = self.transient.time.last().copied().unwrap_or(0.0);
        let ends = self.moves.iter().skip(1).map(|one| one.start_s).chain([end_s]);
        self.moves.iter().zip(ends).map(|(one, end)| [one.start_s, end])
    }

    /// Whether it vibrates; None if that comes or goes, or its runs do not show it.
    pub(super) fn vibrates(&self) -> Option<bool> {
        match self.swing()?.steadiness {
            Steadiness::Vibrates => Some(true),
            Steadiness::Steady => Some(false),
            Steadiness::Neither => None,
        }
    }

    /// Its swing from peak to peak, mm.
    pub(super) fn swing_mm(&self) -> Option<f64> {
        Some(self.swing()?.mean_mm)
    }

    /// Its swing in a sentence.
    pub(super) fn rest(&self) -> String {
        format!("{} swings by {}", self.name, formatted(self.swing_mm(), 2, "mm"))
    }

    /// The largest overshoot of a move, mm; None if a move does not show it.
    pub(super) fn overshoot_mm(&self) -> Option<f64> {
        self.asked().iter().map(|one| one.overshoot_mm).reduce(|a, b| Some(a?.max(b?))).flatten()
    }

    /// Mean rise time of its moves, s; None if a move does not show it.
    pub(super) fn rise_s(&self) -> Option<f64> {
        let rises: Option<Vec<f64>> = self.asked().iter().map(|one| one.rise_s).collect();
        rises.and_then(|rises| mean(&rises))
    }

    /// Mean of the errors without their signs, mm, over the last quarters of some moves, whether the drive stands
    /// there or not.
    pub(super) fn mean_error_mm(moves: &[Move]) -> Option<f64> {
        let errors: Option<Vec<f64>> = moves.iter().map(|one| Some(one.mean_error_mm?.abs())).collect();
        errors.and_then(|errors| mean(&errors))
    }

    /// Mean of a channel over the last quarter of the last move.
    pub(super) fn settled(&self, channel: usize) -> f64 {
        let begin = self.transient.time.partition_point(|&time| time < self.last().start_s);
        let values = &self.transient.channels[channel][begin..];
        let tail = &values[values.len() * 3 / 4..];
        tail.iter().sum::<f64>() / tail.len() as f64
    }

    /// The swing of the position, from peak to peak, in each interval of `seconds` from a time on, mm.
    pub(super) fn swings(&self, from: f64, seconds: f64) -> Vec<f64> {
        let end = self.transient.time.last().copied().unwrap_or(0.0);
        let windows = ((end - from) / seconds) as usize;
        let begins = (0..windows).map(|number| from + seconds * number as f64);
        let (time, position) = (&self.transient.time, &self.transient.channels[POSITION]);
        begins.map(|begin| swing(time, position, [begin, begin + seconds])).collect()
    }

    /// Mean distance from the setpoint in the first half second of the selected moves, mm.
    pub(super) fn lag_mm(&self) -> Option<f64> {
        let [setpoint, position] = [SETPOINT, POSITION].map(|channel| &self.transient.channels[channel]);
        let place = |time_s: f64| self.transient.time.partition_point(|time| *time < time_s);
        let lag = |one: &Move| {
            let during = place(one.start_s)..place(one.start_s + 0.5);
            let distances: Vec<f64> = during.map(|k| (setpoint[k] - position[k]).abs()).collect();
            mean(&distances)
        };
        let lags: Option<Vec<f64>> = self.asked().iter().map(lag).collect();
        lags.and_then(|lags| mean(&lags))
    }

    /// The largest change of the command from a sample to the next while the setpoint holds and the
    /// supervisor has not tripped, counts.
    pub(super) fn jerk(&self) -> f64 {
        let [setpoint, command] = [SETPOINT, COMMAND].map(|channel| &self.transient.channels[channel]);
        let end = self.tripped.unwrap_or(command.len()).min(command.len());
        let holds = (1..end).filter(|&k| setpoint[k] == setpoint[k - 1]);
        holds.map(|k| (command[k] - command[k - 1]).abs()).fold(0.0, f64::max)
    }

    /// From the beginning of its last move until the drive has gone a hundredth of the way, s.
    pub(super) fn delay_s(&self) -> Option<f64> {
        let one = self.last();
        let distance = one.to_mm? - one.from_mm;
        let samples = self.transient.time.iter().zip(&self.transient.channels[POSITION]);
        let gone = |position: f64| (position - one.from_mm) / distance >= 0.01;
        let mut after = samples.skip_while(|(time, _)| **time < one.start_s);
        Some(after.find(|(_, position)| gone(**position))?.0 - one.start_s)
    }

    /// Root mean square of a channel's deviation from another run's, as a share of the channel's range.
    pub(super) fn deviation(&self, other: &Outcome, channel: usize) -> f64 {
        let found = deviations(&self.transient, &other.transient);
        let name = pneudrive_evaluate::transient::CHANNELS[channel].0;
        found.iter().find(|one| one.channel == name).map_or(f64::NAN, |one| one.fraction_of_range)
    }
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// A figure in words.
pub(super) fn formatted(value: Option<f64>, decimals: usize, unit: &str) -> String {
    value.map_or_else(
        || "nothing that can be decided".to_owned(),
        |value| format!("{value:.decimals$} {unit}"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half a second at rest, then a step of 100 mm that goes straight to 100 mm in 0.2 s, from 0.6 s on.
    fn outcome() -> Outcome {
        let time: Vec<f64> = (0..2000).map(|k| f64::from(k) * 1e-3).collect();
        let setpoint = |t: f64| if t < 0.5 { 0.0 } else { 100.0 };
        let position = |t: f64| ((t - 0.6) * 500.0).clamp(0.0, 100.0);
        let command = |k: usize| if k == 700 { 900.0 } else { f64::from(k as u32) };
        let mut transient = Transient { mm_per_count: 0.01, windows: [5, 3], ..Transient::default() };
        transient.channels = std::array::from_fn(|_| vec![0.0; time.len()]);
        transient.channels[SETPOINT] = time.iter().map(|&t| setpoint(t)).collect();
        transient.channels[POSITION] = time.iter().map(|&t| position(t)).collect();
        transient.channels[COMMAND] = (0..time.len()).map(command).collect();
        transient.counts = transient.channels[POSITION].iter().map(|mm| (mm * 100.0) as i32).collect();
        transient.time = time;
        let moves = moves(&transient, &Motion::of(&transient), None, tolerance_mm(None));
        Outcome { name: "straight", transient, moves, evaluations: 1, tripped: None }
    }

    #[test]
    fn the_delay_is_from_the_step_to_a_hundredth_of_the_way() {
        let delay = outcome().delay_s().expect("it moves");
        assert!((delay - 0.102).abs() < 1.1e-3, "{delay}");
    }

    #[test]
    fn the_largest_jump_of_the_command_counts_only_before_a_trip() {
        assert_eq!(outcome().jerk(), 201.0, "from 699 to 900");
        assert_eq!(Outcome { tripped: Some(650), ..outcome() }.jerk(), 1.0);
    }

    #[test]
    fn swings_are_what_the_position_covers_in_each_stretch() {
        let swings = outcome().swings(0.5, 0.25);
        assert_eq!(swings.len(), 5);
        assert!((swings[0] - 75.0).abs() < 0.6 && (swings[1] - 25.0).abs() < 0.6, "{swings:?}");
        assert!(swings[2..].iter().all(|swing| *swing == 0.0), "{swings:?}");
    }

    /// For 0.1 s it is 100 mm away, then for 0.2 s 50 mm in the mean: 40 mm over half a second.
    #[test]
    fn the_lag_is_the_mean_distance_from_the_setpoint_after_a_step() {
        let lag = outcome().lag_mm().expect("it moves");
        assert!((lag - 40.0).abs() < 0.2, "{lag}");
    }

    #[test]
    fn a_drive_whose_moves_are_short_or_that_was_stopped_has_no_swing() {
        assert_eq!(outcome().swing(), None);
        assert_eq!(outcome().settled(POSITION), 100.0);
        assert_eq!(outcome().rest(), "straight swings by nothing that can be decided");
        assert_eq!(Outcome { tripped: Some(3), ..outcome() }.swing(), None);
    }
}
