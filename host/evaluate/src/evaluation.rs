//! The figures of the moves of a transient (the thesis's EVAL.PR, and those that a machine builder needs).
//!
//! A move begins where the setpoint changes, or, in open loop, the command; it ends where the next one
//! begins, or with the transient. Five changes and more, none later than 0.05 s after the one before, are the profile of one
//! move, whose setpoint is the one that it ends at. With `x0` the position at its beginning, `r` the setpoint and `h = r - x0`:
//!
//! Rise, overshoot and settling are left out of a profile whose setpoint leaves the range from start to `r`, as a sine does.
//!
//! | figure | definition | left out |
//! |---|---|---|
//! | rise time | from 10 % to 90 % of `h`, each for the first time | for a distance of less than 10 counts |
//! | overshoot | how far the position goes beyond `r`, in the direction of `h` | for a distance of less than 2.5 counts, and while the drive still moves on |
//! | settling time | from the beginning until the position stays within the tolerance of `r` | if it is not there throughout the last quarter of the move |
//! | steady error | mean of `r - x` over the move's last quarter, or over the cycles of a limit cycle | while the drive still moves |
//! | limit cycle | swing from peak to peak and frequency ([`LimitCycle`]) | says so itself |
//! | tracking | largest size, and root of the mean square, of the setpoint less the position along a profile | of a step, and in open loop |
//! | top speed | largest of the velocities, as the controller estimates them | |
//! | air | the flow into the chambers (`evaluation/air.rs`) | without flows and cylinder |

mod air;
mod figures;
mod interval;
mod limit_cycle;
mod motion;
mod noise;
mod other_rig;
mod swings;
mod table;
mod verdict;

pub use air::{Air, Chambers};
pub use figures::to_json;
pub use limit_cycle::{Doubt, LimitCycle, Oscillation};
pub use motion::Motion;
pub use other_rig::refuse_other_rig;
pub use table::{remarks, table};
pub use verdict::verdict;

use pneudrive_sim::schedule::USUAL_TOLERANCE_MM;
use pneudrive_sim::{Rig, Run, keys};

use crate::transient::Transient;
use interval::Interval;

/// How a drive follows a profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tracking {
    /// Largest size of the setpoint less the position while the setpoint moves, mm.
    pub most_mm: f64,
    /// Root of its mean square, mm.
    pub rms_mm: f64,
}

/// A move and its measurements. A figure that the transient does not show is None.
#[derive(Clone, Debug, PartialEq)]
pub struct Move {
    /// 1 for the first move of the test.
    pub number: usize,
    /// Whether the transient begins in the midst of it: then only its end is known.
    pub is_cut: bool,
    /// When it begins, or the transient if it is cut, s.
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
    /// Mean of the setpoint less the position over the last quarter, mm, whether the drive rests there or moves;
    /// None in open loop.
    pub mean_error_mm: Option<f64>,
    /// From the lowest to the highest position in the last quarter, mm, whatever the drive does there.
    pub range_mm: f64,
    /// How the drive follows its profile; None of a step, and in open loop.
    pub tracking: Option<Tracking>,
    /// The verdict on whether it ends in a limit cycle.
    pub limit_cycle: LimitCycle,
    /// Top speed, mm/s.
    pub top_speed_mm_s: f64,
    /// Air that was let into the chambers; None where neither flows nor chambers are known.
    pub air: Option<Air>,
}

impl Move {
    /// Without the figures that are of its beginning.
    fn without_its_beginning(self) -> Move {
        Move {
            is_cut: true,
            rise_s: None,
            overshoot_mm: None,
            settling_s: None,
            tracking: None,
            air: None,
            ..self
        }
    }

    /// A figure that takes the beginning of the move; None of one that is cut.
    fn of_whole(&self, figure: f64) -> Option<f64> {
        (!self.is_cut).then_some(figure)
    }
}

/// The moves of a transient, in their order. Of a part of a longer transient, the move in whose midst it begins has
/// only the figures of its end.
///
/// `tolerance_mm` is the distance from the setpoint that counts as arrived. `motion` has the velocities at the
/// transient's instants. `chambers` give the air of a record, and whether the dither hides the air of either. Without
/// them the rows of a run are assumed to follow its dither.
#[must_use]
pub fn moves(
    transient: &Transient,
    motion: &Motion,
    chambers: Option<&Chambers>,
    tolerance_mm: f64,
) -> Vec<Move> {
    let begins = transient.beginnings();
    let ends = begins.iter().skip(1).copied().chain([transient.time.len()]);
    let course = air::Inflow::of(transient, chambers);
    let air = |interval: &Interval| course.as_ref()?.between(interval.begin, interval.end);
    let first = transient.cut.moves_before + usize::from(!transient.cut.at_start);
    (first..)
        .zip(begins.iter().zip(ends))
        .map(|(number, (&begin, end))| {
            let interval = Interval::new(transient, begin, end);
            let one = Move { number, air: air(&interval), ..measured(&interval, motion, tolerance_mm) };
            if number > transient.cut.moves_before { one } else { one.without_its_beginning() }
        })
        .collect()
}

/// The moves of a simulated run, settled within the tolerance of its rig.
#[must_use]
pub fn moves_of_run(rig: &Rig, run: &Run) -> Vec<Move> {
    let transient = Transient::of_simulation(rig.name(), rig, run);
    moves(&transient, &Motion::of(&transient), Some(&Chambers::of(rig)), tolerance_mm(Some(rig)))
}

/// Distance from its setpoint within which a move has settled, mm: that of the rig, or the usual one of a transient without a
/// rig.
#[must_use]
pub fn tolerance_mm(rig: Option<&Rig>) -> f64 {
    rig.map_or(USUAL_TOLERANCE_MM, |rig| rig.get(&keys::test::TOLERANCE_MM))
}

fn measured(interval: &Interval, motion: &Motion, tolerance_mm: f64) -> Move {
    let position = interval.position();
    let (to, straight_to) = (interval.setpoint(), interval.straight_to());
    let limit_cycle = interval.limit_cycle();
    let speeds = &motion.velocity_mm_s[interval.begin..interval.end];
    Move {
        number: 0,
        is_cut: false,
        start_s: interval.time()[0],
        from_mm: position[0],
        to_mm: to,
        end_mm: position[position.len() - 1],
        rise_s: straight_to.and_then(|to| interval.rise(to)),
        overshoot_mm: straight_to.and_then(|to| interval.overshoot(to, &limit_cycle)),
        settling_s: straight_to.and_then(|to| interval.settling(to, tolerance_mm)),
        steady_error_mm: to.and_then(|to| interval.steady_error(to, &limit_cycle)),
        mean_error_mm: to.map(|to| interval.mean_error(to)),
        range_mm: interval.range(),
        tracking: interval.tracking(),
        limit_cycle,
        top_speed_mm_s: speeds.iter().map(|speed| speed.abs()).fold(0.0, f64::max),
        air: None,
    }
}

#[cfg(test)]
mod tests;
