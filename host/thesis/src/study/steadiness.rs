//! Whether a drive is steady or vibrates at the end of its moves, as a graph of the thesis would show it.
//!
//! The position is cut into three intervals of 0.4 s before the end of each move of at least 2 s. A drive vibrates if
//! it swings by more than 1 mm in each of them, and is steady if it does so in none; a graph over the stroke of 300
//! mm shows nothing smaller. Otherwise it starts or ceases to vibrate, or jumps now and then.
//!
//! The limit cycle of [`pneudrive_evaluate::evaluation`] asks for more, a constant swing: a drive that hunts irregularly has
//! none.

/// The motion of a drive at the end of its moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Steadiness {
    /// It swings by less than a graph shows.
    Steady,
    /// It keeps swinging.
    Vibrates,
    /// Both, at different times.
    Neither,
}

/// How far a drive swings at the end of its moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swing {
    /// Whether that can be seen.
    pub steadiness: Steadiness,
    /// Mean over the intervals, from peak to peak, mm.
    pub mean_mm: f64,
}

/// A drive that swings less, from peak to peak, is steady for the eye, mm.
pub(super) const SEEN_MM: f64 = 1.0;

/// Length of an interval, s: a cycle of 2.5 Hz or more is in it as a whole.
const WINDOW_S: f64 = 0.4;

/// Stretches at the end of a move.
const WINDOWS: usize = 3;

/// Moves that last for less end before their transient does, s.
const LASTS_S: f64 = 2.0;

impl Swing {
    /// Of positions (mm) over time (s) at the end of moves, each given by its beginning and end; None if none of them is
    /// long enough.
    pub(super) fn of(time: &[f64], position: &[f64], moves: &[[f64; 2]]) -> Option<Swing> {
        let long = moves.iter().filter(|[begin, end]| end - begin >= LASTS_S);
        let windows: Vec<f64> = long
            .flat_map(|[_, end]| (1..=WINDOWS).map(move |number| end - WINDOW_S * number as f64))
            .map(|begin| swing(time, position, [begin, begin + WINDOW_S]))
            .collect();
        let vibrating = windows.chunks(WINDOWS).any(|ends| ends.iter().all(|swing| *swing > SEEN_MM));
        let steadiness = match vibrating {
            true => Steadiness::Vibrates,
            false if windows.iter().all(|swing| *swing <= SEEN_MM) => Steadiness::Steady,
            false => Steadiness::Neither,
        };
        let mean_mm = windows.iter().sum::<f64>() / windows.len() as f64;
        (!windows.is_empty()).then_some(Swing { steadiness, mean_mm })
    }
}

/// The range of a position from one time to another, from peak to peak, mm.
pub(super) fn swing(time: &[f64], position: &[f64], [from, to]: [f64; 2]) -> f64 {
    let part = &position[time.partition_point(|t| *t < from)..time.partition_point(|t| *t < to)];
    let [low, high] = [f64::min as fn(f64, f64) -> f64, f64::max].map(|of| part.iter().copied().reduce(of));
    high.zip(low).map_or(0.0, |(high, low)| high - low)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a move of 3 s, the position being this function of time.
    fn of(position: impl Fn(f64) -> f64) -> Swing {
        let time: Vec<f64> = (0..3000).map(|k| f64::from(k) * 1e-3).collect();
        let position: Vec<f64> = time.iter().map(|t| position(*t)).collect();
        Swing::of(&time, &position, &[[0.0, 3.0]]).expect("a long move")
    }

    #[test]
    fn a_sine_of_more_than_a_millimetre_vibrates_and_one_of_less_is_steady() {
        let sine = |mm: f64| move |t: f64| 0.5 * mm * (std::f64::consts::TAU * 8.0 * t).sin();
        assert_eq!(of(sine(1.2)).steadiness, Steadiness::Vibrates);
        assert!((of(sine(1.2)).mean_mm - 1.2).abs() < 1e-3);
        assert_eq!(of(sine(0.8)).steadiness, Steadiness::Steady);
    }

    #[test]
    fn a_drive_that_ceases_to_vibrate_or_jumps_once_is_neither() {
        let dies = |t: f64| if t < 2.2 { 3.0 * (50.0 * t).sin() } else { 0.0 };
        let jumps = |t: f64| if t < 2.5 { 0.0 } else { 2.0 };
        assert_eq!([of(dies).steadiness, of(jumps).steadiness], [Steadiness::Neither; 2]);
    }

    #[test]
    fn a_drive_that_vibrates_in_one_of_its_moves_vibrates_and_short_moves_do_not_count() {
        let time: Vec<f64> = (0..5000).map(|k| f64::from(k) * 1e-3).collect();
        let position: Vec<f64> =
            time.iter().map(|t| if *t < 2.5 { 2.0 * (50.0 * t).sin() } else { 0.0 }).collect();
        let found = |moves: &[[f64; 2]]| Swing::of(&time, &position, moves).map(|swing| swing.steadiness);
        assert_eq!(found(&[[0.0, 2.5], [2.5, 5.0]]), Some(Steadiness::Vibrates));
        assert_eq!(found(&[[0.0, 1.9], [2.5, 5.0]]), Some(Steadiness::Steady));
        assert_eq!(found(&[[0.0, 1.9]]), None);
    }
}
