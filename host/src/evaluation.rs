//! What a transient tells about its moves (the thesis's EVAL.PR, and the figures a machine builder asks for).
//!
//! A move begins where the setpoint changes, or, in open loop, the command; it ends where the next one
//! begins, or with the transient. With `x0` the position at its beginning, `r` the setpoint and `h = r - x0`:
//!
//! | figure | is | there is none |
//! |---|---|---|
//! | rise time | from 10 % to 90 % of `h`, for the first time each | of a way of less than 10 counts |
//! | overshoot | how far the position goes beyond `r`, in the direction of `h` | of a way of less than 3 counts, and while the drive still goes on |
//! | settling time | from the beginning until the position stays within the tolerance of `r` | if it is not there throughout the last quarter of the move |
//! | steady error | mean of `r - x` over the move's last quarter, or over the cycles of a limit cycle | while the drive still moves |
//! | limit cycle | swing from peak to peak and frequency ([`LimitCycle`]) | says so itself |
//! | top speed | largest of the velocities, as the controller estimates them | |
//! | air | what flows into the chambers (`evaluation/air.rs`) | without flows and cylinder |

mod air;
mod figures;
mod limit_cycle;
mod motion;
mod noise;
mod stretch;
mod swings;
mod table;

pub use air::{Air, Chambers};
pub use figures::to_json;
pub use limit_cycle::{Doubt, LimitCycle, Oscillation};
pub use motion::Motion;
pub use table::{remarks, table};

use pneudrive_sim::{Rig, Run};

use crate::run_folder::StoredRun;
use crate::transient::{COMMAND, SETPOINT, Transient};
use stretch::Stretch;

/// A move and what was measured of it. What the transient does not show is None.
#[derive(Clone, Debug, PartialEq)]
pub struct Move {
    /// When it begins, s.
    pub start_s: f64,
    /// Where the drive is then, mm.
    pub from_mm: f64,
    /// Where it should go, mm; None in open loop.
    pub to_mm: Option<f64>,
    /// Where it is when the move ends, mm.
    pub end_mm: f64,
    /// Rise time, s.
    pub rise_s: Option<f64>,
    /// Overshoot, mm.
    pub overshoot_mm: Option<f64>,
    /// Settling time, s.
    pub settling_s: Option<f64>,
    /// Steady error, mm.
    pub steady_error_mm: Option<f64>,
    /// Mean of the setpoint less the position over the last quarter, mm, whether the drive stands there or moves;
    /// None in open loop.
    pub mean_error_mm: Option<f64>,
    /// From the lowest to the highest position in the last quarter, mm, whatever the drive does there.
    pub range_mm: f64,
    /// Whether it ends in a limit cycle.
    pub limit_cycle: LimitCycle,
    /// Top speed, mm/s.
    pub top_speed_mm_s: f64,
    /// Air that was let into the chambers; None where neither flows nor chambers are known.
    pub air: Option<Air>,
}

/// The moves of a transient, in their order.
///
/// `tolerance_mm` is the distance from the setpoint that counts as there; `motion` has the velocities at the
/// transient's instants; `chambers` tell the air of a record, and of both whether the dither hides it. Without them the
/// rows of a run are taken to follow its dither.
#[must_use]
pub fn moves(
    transient: &Transient,
    motion: &Motion,
    chambers: Option<&Chambers>,
    tolerance_mm: f64,
) -> Vec<Move> {
    let begins = beginnings(transient);
    let ends = begins.iter().skip(1).copied().chain([transient.time.len()]);
    let course = air::Course::of(transient, chambers);
    let air = |stretch: &Stretch| course.as_ref()?.between(stretch.begin, stretch.end);
    begins
        .iter()
        .zip(ends)
        .map(|(&begin, end)| Stretch { transient, begin, end })
        .map(|stretch| Move { air: air(&stretch), ..measured(&stretch, motion, tolerance_mm) })
        .collect()
}

/// The moves of a simulated run; `tolerance_mm` as in [`moves`].
#[must_use]
pub fn moves_of_run(rig: &Rig, run: &Run, tolerance_mm: f64) -> Vec<Move> {
    let transient = Transient::of_run(rig.name(), &StoredRun::of(rig, run));
    moves(&transient, &Motion::of(&transient), Some(&Chambers::of(rig)), tolerance_mm)
}

/// A move has settled within this distance of its setpoint, mm, unless a user says otherwise.
pub const TOLERANCE_MM: f64 = 0.05;

/// Indices of the first sample of each move. The first move begins at the start of the test, or with the
/// transient if that is later.
fn beginnings(transient: &Transient) -> Vec<usize> {
    let start = transient.time.partition_point(|&time| time < 0.0);
    let asked = &transient.channels[if transient.is_open_loop() { COMMAND } else { SETPOINT }];
    let changes = (start + 1..asked.len()).filter(|&k| {
        // A setpoint behind an error at the limit of its 16 bits cannot be known.
        (asked[k] - asked[k - 1]).abs() > SAME
    });
    (start < asked.len()).then_some(start).into_iter().chain(changes).collect()
}

/// Setpoints closer than this are one, mm or counts: they come from sums of rounded numbers.
const SAME: f64 = 1e-9;

fn measured(stretch: &Stretch, motion: &Motion, tolerance_mm: f64) -> Move {
    let position = stretch.position();
    let to = stretch.setpoint();
    let limit_cycle = stretch.limit_cycle();
    let speeds = &motion.velocity_mm_s[stretch.begin..stretch.end];
    Move {
        start_s: stretch.time()[0],
        from_mm: position[0],
        to_mm: to,
        end_mm: position[position.len() - 1],
        rise_s: to.and_then(|to| stretch.rise(to)),
        overshoot_mm: to.and_then(|to| stretch.overshoot(to, &limit_cycle)),
        settling_s: to.and_then(|to| stretch.settling(to, tolerance_mm)),
        steady_error_mm: to.and_then(|to| stretch.steady_error(to, &limit_cycle)),
        mean_error_mm: to.map(|to| stretch.mean_error(to)),
        range_mm: stretch.range(),
        limit_cycle,
        top_speed_mm_s: speeds.iter().map(|speed| speed.abs()).fold(0.0, f64::max),
        air: None,
    }
}

#[cfg(test)]
mod tests;
