//! Two transients on one time: by the start of their tests, by their first move, or by the shift at which
//! their positions agree best.

use anyhow::{Context, Result};

use crate::transient::{COMMAND, POSITION, SETPOINT, Transient};

/// The largest shift that is tried, s.
const MAX_SHIFT_S: f64 = 1.0;

/// How transients are laid over each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Align {
    /// By the start of their tests.
    #[default]
    Start,
    /// By the beginning of their first move.
    Move,
    /// By the shift at which their positions agree best.
    Correlation,
}

impl Align {
    /// How far `other` has to be shifted to lie over the reference, s.
    ///
    /// # Errors
    /// When one of them has no move to align by, or when they have too little time in common.
    pub fn shift(self, reference: &Transient, other: &Transient) -> Result<f64> {
        let move_of =
            |of: &Transient| first_move(of).with_context(|| format!("{} has no move to align by", of.name));
        match self {
            Align::Start => Ok(0.0),
            Align::Move => Ok(move_of(reference)? - move_of(other)?),
            Align::Correlation => best_shift(reference, other).with_context(|| {
                format!("{} and {} have too little time in common to align", reference.name, other.name)
            }),
        }
    }
}

/// When the first move of a transient begins, s: where the setpoint, or in open loop the command, changes for
/// the first time, or where the position leaves the counts that it begins on.
#[must_use]
pub fn first_move(transient: &Transient) -> Option<f64> {
    let asked = &transient.channels[if transient.is_open_loop() { COMMAND } else { SETPOINT }];
    let leaves = |values: &[f64], by: f64| {
        let first = *values.first()?;
        values.iter().position(|value| (value - first).abs() > by)
    };
    let position = &transient.channels[POSITION];
    let begin = leaves(asked, 1e-9).or_else(|| leaves(position, 2.5 * transient.mm_per_count))?;
    Some(transient.time[begin])
}

/// The shift of `other`, s, at which its position agrees best with the reference's: the least mean square,
/// among whole samples of the reference first, then on the parabola through the best and its neighbours.
#[must_use]
pub fn best_shift(reference: &Transient, other: &Transient) -> Option<f64> {
    let period = reference.period_s();
    let most = (MAX_SHIFT_S / period).round();
    let shifts = most.is_finite().then_some(most as i64)?;
    let misfits: Vec<(i64, f64)> = (-shifts..=shifts)
        .filter_map(|step| Some((step, misfit(reference, other, step as f64 * period)?)))
        .collect();
    let best = (0..misfits.len()).min_by(|&a, &b| misfits[a].1.total_cmp(&misfits[b].1))?;
    let at = |index: usize| misfits.get(index).map(|(_, misfit)| *misfit);
    let between = match (best.checked_sub(1).and_then(at), at(best + 1)) {
        (Some(before), Some(after)) => vertex(before, misfits[best].1, after),
        _ => 0.0,
    };
    Some((misfits[best].0 as f64 + between) * period)
}

/// Mean square of the positions' difference with `other` shifted, over at least half of the shorter one.
fn misfit(reference: &Transient, other: &Transient, shift: f64) -> Option<f64> {
    let both = reference.time.iter().zip(&reference.channels[POSITION]);
    let squares: Vec<f64> = both
        .filter_map(|(time, position)| Some((other.at(POSITION, time - shift)? - position).powi(2)))
        .collect();
    let enough = squares.len() * 2 >= reference.time.len().min(other.time.len());
    (enough && !squares.is_empty()).then(|| squares.iter().sum::<f64>() / squares.len() as f64)
}

/// Where the parabola through three values one apart has its end, from the middle one.
fn vertex(before: f64, middle: f64, after: f64) -> f64 {
    let curvature = before - 2.0 * middle + after;
    if curvature > 0.0 { ((before - after) / (2.0 * curvature)).clamp(-0.5, 0.5) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A smooth move that begins at `start`, sampled each `period` s.
    fn smooth(start: f64, period: f64) -> Transient {
        let time: Vec<f64> = (0..(2.0 / period) as usize).map(|k| k as f64 * period).collect();
        let position = |t: f64| 60.0 / (1.0 + (-(t - start) / 0.05).exp());
        let mut transient = Transient { mm_per_count: 0.01, ..Transient::default() };
        transient.channels[SETPOINT] = time.iter().map(|&t| if t < start { 0.0 } else { 60.0 }).collect();
        transient.channels[POSITION] = time.iter().map(|&t| position(t)).collect();
        transient.time = time;
        transient
    }

    #[test]
    fn correlation_finds_a_shift_between_samples() {
        let shift = best_shift(&smooth(0.8, 0.001), &smooth(0.5503, 0.0013)).expect("in common");
        assert!((shift - 0.2497).abs() < 2e-5, "{shift}");
    }

    #[test]
    fn each_way_of_aligning_finds_its_shift_or_says_why_there_is_none() {
        let [late, early] = [smooth(0.8, 0.001), smooth(0.5, 0.001)];
        assert_eq!(Align::Start.shift(&late, &early).expect("always"), 0.0);
        for align in [Align::Move, Align::Correlation] {
            let shift = align.shift(&late, &early).expect("both move");
            assert!((shift - 0.3).abs() < 2e-5, "{align:?}: {shift}");
        }
        let mut still = smooth(0.5, 0.001);
        for channel in [SETPOINT, POSITION] {
            still.channels[channel].fill(60.0);
        }
        still.name = "still".to_owned();
        let error = Align::Move.shift(&late, &still).expect_err("no move");
        assert_eq!(error.to_string(), "still has no move to align by");
    }

    #[test]
    fn transients_without_enough_time_in_common_have_no_shift() {
        let mut far = smooth(0.5, 0.001);
        far.time.iter_mut().for_each(|time| *time += 10.0);
        assert_eq!(best_shift(&smooth(0.5, 0.001), &far), None);
    }

    #[test]
    fn the_first_move_is_where_the_setpoint_changes_or_else_where_the_drive_leaves() {
        let mut transient = smooth(0.8, 0.001);
        assert_eq!(first_move(&transient), Some(0.8));
        transient.channels[SETPOINT].fill(60.0);
        let leaves = first_move(&transient).expect("it moves");
        assert!((0.1..0.8).contains(&leaves), "{leaves}");
        transient.channels[POSITION].fill(60.0);
        assert_eq!(first_move(&transient), None);
    }
}
