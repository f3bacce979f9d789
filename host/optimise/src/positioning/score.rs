//! Arrivals and errors over all draws.

use std::fmt;

use pneudrive_evaluate::evaluation::LimitCycle;

use super::arrival::{Arrival, BANDS_MM};
use crate::tuning::Proportion;

/// A step overshoots if it goes further beyond its target, mm.
pub const OVERSHOOT_MM: f64 = 0.1;

/// A piston swings at its target if it moves by more than this within the last second, mm.
pub const SWING_MM: f64 = 0.1;

/// A sine is followed if the error stays below this, mm.
pub const FOLLOWED_MM: f64 = 0.6;

/// A step over all draws. One that does not come to its end has not arrived.
#[derive(Clone, Debug, PartialEq)]
pub struct StepScore {
    /// Number of steps that end within each band of [`BANDS_MM`].
    pub within: [Proportion; BANDS_MM.len()],
    /// Median time to each band, over the steps that end in it, s.
    pub median_s: [Option<f64>; BANDS_MM.len()],
    /// Largest overshoot, mm.
    pub beyond_mm: f64,
    /// Number of steps that overshoot by [`OVERSHOOT_MM`] at most.
    pub without_overshoot: Proportion,
    /// Number of steps that end in a limit cycle.
    pub limit_cycles: Proportion,
    /// Number of steps for which it cannot be decided whether they do.
    pub undecided: usize,
    /// Number of steps whose piston still moves in the last second.
    pub moving: usize,
    /// Number of those whose piston moves by more than [`SWING_MM`].
    pub swinging: usize,
    /// Runs that have converged.
    pub converged: Proportion,
    /// Why runs did not complete.
    pub failed: Vec<String>,
}

impl StepScore {
    /// The score of a step from each run and whether it has converged, or why it did not complete.
    pub(super) fn of<'a>(runs: impl Iterator<Item = Result<(&'a Arrival, bool), &'a String>>) -> StepScore {
        let all: Vec<_> = runs.collect();
        let steps: Vec<&Arrival> = all.iter().filter_map(|run| run.ok().map(|(step, _)| step)).collect();
        let share = |met: usize| Proportion { met, of: all.len() };
        let count = |holds: &dyn Fn(&Arrival) -> bool| steps.iter().filter(|step| holds(step)).count();
        let times = |band: usize| steps.iter().filter_map(|step| step.within_s[band]).collect::<Vec<f64>>();
        StepScore {
            within: [0, 1, 2].map(|band| share(times(band).len())),
            median_s: [0, 1, 2].map(|band| median(times(band))),
            beyond_mm: steps.iter().map(|step| step.beyond_mm).fold(0.0, f64::max),
            without_overshoot: share(count(&|step| step.beyond_mm <= OVERSHOOT_MM)),
            limit_cycles: share(count(&cycles)),
            undecided: count(&|step| matches!(step.limit_cycle, LimitCycle::Undecided(_))),
            moving: count(&Arrival::moves),
            swinging: count(&|step| step.range_mm > SWING_MM),
            converged: share(all.iter().filter(|run| matches!(run, Ok((_, true)))).count()),
            failed: all.iter().filter_map(|run| run.err().cloned()).collect(),
        }
    }
}

fn cycles(step: &Arrival) -> bool {
    matches!(step.limit_cycle, LimitCycle::Sustained(_))
}

/// A sine over all draws.
#[derive(Clone, Debug, PartialEq)]
pub struct SineScore {
    /// Number of sines that are followed within [`FOLLOWED_MM`].
    pub followed: Proportion,
    /// Median and largest of the largest errors of the runs that come to their end, mm.
    pub largest_mm: Option<[f64; 2]>,
    /// Runs that have converged.
    pub converged: Proportion,
    /// Why runs did not complete.
    pub failed: Vec<String>,
}

impl SineScore {
    /// The score of a sine from the largest error of each run, mm, and whether the run has converged.
    pub(super) fn of(runs: Vec<Result<(f64, bool), String>>) -> SineScore {
        let of = runs.len();
        let mut errors = Vec::new();
        let (mut converged, mut failed) = (0, Vec::new());
        for run in runs {
            match run {
                Ok((error, has_converged)) => {
                    errors.push(error);
                    converged += usize::from(has_converged);
                }
                Err(why) => failed.push(why),
            }
        }
        let followed = errors.iter().filter(|error| **error <= FOLLOWED_MM).count();
        let worst = errors.iter().copied().fold(0.0, f64::max);
        SineScore {
            followed: Proportion { met: followed, of },
            largest_mm: median(errors).map(|middle| [middle, worst]),
            converged: Proportion { met: converged, of },
            failed,
        }
    }
}

/// The middle value, or the mean of the two in the middle.
pub(super) fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let (low, high) = (values.get(values.len().checked_sub(1)? / 2)?, values.get(values.len() / 2)?);
    Some(f64::midpoint(*low, *high))
}

/// The cells of a step in a table: shares, their 95 % intervals in percent, median times, largest overshoot and how many have
/// no more than [`OVERSHOOT_MM`]; then how many end in a limit cycle, cannot be decided, still move (and by more than
/// [`SWING_MM`]), did not come to their end; and how many have converged.
impl fmt::Display for StepScore {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let join = |texts: [String; BANDS_MM.len()]| texts.join(" / ");
        let ends = |share: &Proportion| {
            let [low, high] = share.interval().map(|end| 100.0 * end);
            format!("{low:.0} to {high:.0}")
        };
        let shares = join(self.within.each_ref().map(|share| share.met.to_string()));
        let intervals = join(self.within.each_ref().map(ends));
        let times = join(self.median_s.map(|time| time.map_or("-".to_owned(), |s| format!("{s:.3}"))));
        write!(
            f,
            "{shares} | {intervals} | {times} | {:.3} ({}) | ",
            self.beyond_mm, self.without_overshoot.met
        )?;
        write!(f, "{}, {}, ", self.limit_cycles.met, self.undecided)?;
        write!(f, "{} ({}), {} | {}", self.moving, self.swinging, self.failed.len(), self.converged.met)
    }
}

/// The errors of a sine for a cell of a table: median, the largest, and how many are followed within [`FOLLOWED_MM`].
impl fmt::Display for SineScore {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self.largest_mm {
            Some([middle, worst]) => write!(f, "{middle:.2} ({worst:.2}), {}", self.followed.met),
            None => f.write_str("-"),
        }
    }
}
