//! The collected figure, and its move.

use pneudrive_evaluate::evaluation::{LimitCycle, Move};

/// A figure of a move (see [`pneudrive_evaluate::evaluation`]).
#[derive(Debug)]
pub struct Figure {
    /// Its name in a file, with its unit.
    pub name: &'static str,
    /// Its meaning.
    pub meaning: &'static str,
    /// Its value; None if the move does not show it.
    of: fn(&Move) -> Option<f64>,
    /// Whether only a move that goes somewhere has it; in a sum, others do not count.
    of_a_move: bool,
}

/// Another number each time a figure is computed or a draw integrated in another way: rows from before are then of another sweep.
pub(super) const REVISION: u32 = 4;

/// All of them.
pub const FIGURES: [Figure; 13] = [
    figure_of_a_move("rise_s", "from 10 % to 90 % of the distance", |one| one.rise_s),
    figure_of_a_move("overshoot_mm", "how far it goes beyond the setpoint", |one| one.overshoot_mm),
    figure_of_a_move("overshoot_percent", "the same, relative to the distance", |one| {
        Some(100.0 * one.overshoot_mm? / (one.to_mm? - one.from_mm).abs())
    }),
    figure(
        "settling_s",
        "until it stays within settled_mm of the setpoint, for at least the last quarter",
        |one| one.settling_s,
    ),
    figure(
        "steady_error_mm",
        "mean error of the last quarter, if it is at rest or in a limit cycle there",
        |one| one.steady_error_mm,
    ),
    figure("end_mm", "where it ends", |one| Some(one.end_mm)),
    figure(
        "limit_cycle_mm",
        "half its peak-to-peak swing; 0 at rest, empty if it cannot be decided",
        |one| Some(one.limit_cycle.swing_mm()? / 2.0),
    ),
    figure("limit_cycle_hz", "its frequency; 0 at rest, empty if it cannot be decided", |one| {
        match one.limit_cycle {
            LimitCycle::None { .. } => Some(0.0),
            LimitCycle::Sustained(seen) => Some(seen.frequency_hz),
            LimitCycle::Undecided(_) => None,
        }
    }),
    figure("top_speed_mm_s", "the largest velocity", |one| Some(one.top_speed_mm_s)),
    figure("air_l", "air let into the chambers, litres at 20 C, 100 kPa, 65 % humidity (ANR)", |one| {
        Some(one.air?.litres)
    }),
    figure(
        "limit_cycle_swing_mm",
        "its peak-to-peak swing; 0 at rest, empty if it cannot be decided",
        |one| one.limit_cycle.swing_mm(),
    ),
    figure("tracking_mm", "the largest error while a profile moves the setpoint; empty for a step", |one| {
        Some(one.tracking?.most_mm)
    }),
    figure(
        "tracking_rms_mm",
        "root of the mean square of the error while a profile moves the setpoint; empty for a step",
        |one| Some(one.tracking?.rms_mm),
    ),
];

const fn figure(name: &'static str, meaning: &'static str, of: fn(&Move) -> Option<f64>) -> Figure {
    Figure { name, meaning, of, of_a_move: false }
}

const fn figure_of_a_move(name: &'static str, meaning: &'static str, of: fn(&Move) -> Option<f64>) -> Figure {
    Figure { of_a_move: true, ..figure(name, meaning, of) }
}

/// Which move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MoveSelection {
    /// The one with this number, from 1.
    Number(usize),
    /// The largest in size of all moves that go further than the tolerance of settling.
    Worst,
    /// The sum over all moves; of rise and overshoot, over those that go further than the tolerance of settling.
    Sum,
}

/// The collected figures of each point.
#[derive(Clone, Debug)]
pub struct Metric {
    /// Its column.
    pub name: String,
    /// The figure.
    pub figure: &'static Figure,
    /// The move.
    pub which: MoveSelection,
}

impl Metric {
    /// Its value; None if a move that counts does not show it, such as a settling time of one that never settles.
    ///
    /// # Errors
    /// When there is no such move.
    pub fn value(&self, moves: &[Move], settled_mm: f64) -> Result<Option<f64>, String> {
        let of = self.figure.of;
        let goes = |one: &&Move| one.to_mm.is_none_or(|to| (to - one.from_mm).abs() > settled_mm);
        let worst = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
        match self.which {
            MoveSelection::Number(number) => {
                let one = number.checked_sub(1).and_then(|index| moves.get(index));
                let missing =
                    || format!("{}: there is no move {number}; the run has {}", self.name, moves.len());
                Ok(of(one.ok_or_else(missing)?))
            }
            MoveSelection::Worst => {
                let mut values = moves.iter().filter(goes).map(of);
                let first = values.next().ok_or_else(|| format!("{}: nothing moves", self.name))?;
                Ok(values.fold(first, |all, value| all.zip(value).map(|(a, b)| worst(a, b))))
            }
            MoveSelection::Sum => {
                Ok(moves.iter().filter(|one| goes(one) || !self.figure.of_a_move).map(of).sum())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneudrive_evaluate::evaluation::{Air, Doubt, Oscillation};

    fn air(litres: f64) -> Option<Air> {
        Some(Air { litres, least: litres, most: litres })
    }

    /// A step that settles.
    fn step() -> Move {
        Move {
            number: 1,
            is_cut: false,
            start_s: 0.3,
            from_mm: 0.0,
            to_mm: Some(60.0),
            end_mm: 60.0,
            rise_s: Some(0.2),
            overshoot_mm: Some(0.6),
            settling_s: Some(0.5),
            steady_error_mm: Some(0.01),
            mean_error_mm: Some(0.01),
            range_mm: 0.0,
            tracking: None,
            limit_cycle: LimitCycle::None { below_mm: 0.03, for_s: 0.5 },
            top_speed_mm_s: 500.0,
            air: air(1.0),
        }
    }

    /// A hold, a step that settles and one back that does not.
    fn moves() -> [Move; 3] {
        let step = step();
        let undecided = LimitCycle::Undecided(Doubt::JustStopped);
        let hold = Move {
            from_mm: 0.001,
            to_mm: Some(0.0),
            rise_s: None,
            overshoot_mm: None,
            limit_cycle: undecided,
            air: air(0.25),
            ..step.clone()
        };
        let cycle = Oscillation {
            swing_mm: 0.6,
            range_mm: [0.58, 0.62],
            frequency_hz: 4.0,
            cycles: 4,
            during_s: [2.0, 3.0],
        };
        let back = Move {
            from_mm: 60.0,
            to_mm: Some(0.0),
            settling_s: None,
            overshoot_mm: Some(3.0),
            steady_error_mm: Some(-0.2),
            limit_cycle: LimitCycle::Sustained(cycle),
            ..step.clone()
        };
        [hold, step, back]
    }

    fn value(name: &str, which: MoveSelection) -> Result<Option<f64>, String> {
        let figure = FIGURES.iter().find(|figure| figure.name == name).expect("a figure");
        Metric { name: "m".to_owned(), figure, which }.value(&moves(), 0.05)
    }

    #[test]
    fn the_worst_is_the_largest_in_size_of_all_that_move_and_none_if_one_has_none() {
        assert_eq!(value("rise_s", MoveSelection::Worst), Ok(Some(0.2)), "the hold does not count");
        assert_eq!(value("steady_error_mm", MoveSelection::Worst), Ok(Some(-0.2)));
        assert_eq!(value("overshoot_percent", MoveSelection::Worst), Ok(Some(5.0)));
        assert_eq!(value("limit_cycle_mm", MoveSelection::Worst), Ok(Some(0.3)));
        assert_eq!(value("limit_cycle_swing_mm", MoveSelection::Worst), Ok(Some(0.6)), "from peak to peak");
        assert_eq!(value("settling_s", MoveSelection::Worst), Ok(None));
    }

    #[test]
    fn one_move_and_the_sum_of_all_can_be_asked_for_and_a_move_that_is_not_there_is_an_error() {
        assert_eq!(value("settling_s", MoveSelection::Number(2)), Ok(Some(0.5)));
        assert_eq!(value("limit_cycle_hz", MoveSelection::Number(2)), Ok(Some(0.0)), "it stands");
        for name in ["limit_cycle_mm", "limit_cycle_hz", "limit_cycle_swing_mm"] {
            assert_eq!(value(name, MoveSelection::Number(1)), Ok(None), "{name} is not decidable");
            assert_eq!(value(name, MoveSelection::Sum), Ok(None), "{name}: nor is the sum");
        }
        assert_eq!(value("air_l", MoveSelection::Sum), Ok(Some(2.25)));
        assert_eq!(value("overshoot_mm", MoveSelection::Sum), Ok(Some(3.6)), "the hold shows none");
        assert_eq!(
            value("air_l", MoveSelection::Number(4)),
            Err("m: there is no move 4; the run has 3".to_owned())
        );
    }
}
