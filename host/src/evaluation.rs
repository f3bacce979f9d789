//! What a transient tells about its moves (the thesis's EVAL.PR, and the figures a machine builder asks for).
//!
//! A move begins where the setpoint changes, or, in open loop, the command; it ends where the next one
//! begins, or with the transient. With `x0` the position at its beginning, `r` the setpoint and `h = r - x0`:
//!
//! | figure | is |
//! |---|---|
//! | rise time | from 10 % to 90 % of `h`, for the first time each |
//! | overshoot | how far the position goes beyond `r`, in the direction of `h` |
//! | settling time | from the beginning until the position stays within the tolerance of `r` |
//! | steady error | mean of `r - x` over the move's last quarter |
//! | limit cycle | half the swing of the position in that quarter, and how often it swings |
//! | top speed | largest of the velocities, as the controller estimates them |

mod air;
mod limit_cycle;
mod motion;

pub use air::Chambers;
pub use limit_cycle::LimitCycle;
pub use motion::Motion;

use crate::page::Table;
use crate::transient::{COMMAND, POSITION, SETPOINT, Transient};

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
    /// The limit cycle; None if the drive stands.
    pub limit_cycle: Option<LimitCycle>,
    /// Top speed, mm/s.
    pub top_speed_mm_s: f64,
    /// Air that went into the chambers, litres (ANR); None where neither flows nor chambers are known.
    pub air_l: Option<f64>,
}

/// The moves of a transient, in their order.
///
/// `tolerance_mm` is the distance from the setpoint that counts as there; `motion` has the velocities at the
/// transient's instants; `chambers` tell the air of a record.
#[must_use]
pub fn moves(
    transient: &Transient,
    motion: &Motion,
    chambers: Option<&Chambers>,
    tolerance_mm: f64,
) -> Vec<Move> {
    let begins = beginnings(transient);
    let ends = begins.iter().skip(1).copied().chain([transient.time.len()]);
    let let_in = air::let_in(transient, chambers);
    let air_l = |stretch: &Stretch| Some(air::litres(&let_in.as_ref()?[stretch.begin..stretch.end]));
    begins
        .iter()
        .zip(ends)
        .map(|(&begin, end)| Stretch { transient, begin, end })
        .map(|stretch| Move { air_l: air_l(&stretch), ..measured(&stretch, motion, tolerance_mm) })
        .collect()
}

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

/// The samples of a move.
struct Stretch<'a> {
    transient: &'a Transient,
    begin: usize,
    end: usize,
}

impl Stretch<'_> {
    fn time(&self) -> &[f64] {
        &self.transient.time[self.begin..self.end]
    }

    fn position(&self) -> &[f64] {
        &self.transient.channels[POSITION][self.begin..self.end]
    }

    fn setpoint(&self) -> Option<f64> {
        Some(self.transient.channels[SETPOINT][self.begin]).filter(|value| value.is_finite())
    }

    /// The last quarter of it: time and position.
    fn tail(&self) -> (&[f64], &[f64]) {
        let first = self.time().len() * 3 / 4;
        (&self.time()[first..], &self.position()[first..])
    }

    /// When the position has gone a share of the way from `from` to `to`, s.
    fn passes(&self, from: f64, to: f64, share: f64) -> Option<f64> {
        let level = from + share * (to - from);
        let there = |position: f64| (position - level) * (to - from).signum() >= 0.0;
        let at = self.position().iter().position(|&position| there(position))?;
        Some(self.time()[at])
    }

    /// From its beginning until the position stays within `tolerance` of `to`, s.
    fn settling(&self, to: f64, tolerance: f64) -> Option<f64> {
        let outside = |position: &f64| (position - to).abs() > tolerance;
        let first_inside = self.position().iter().rposition(outside).map_or(0, |last| last + 1);
        Some(self.time().get(first_inside)? - self.time()[0])
    }
}

fn measured(stretch: &Stretch, motion: &Motion, tolerance_mm: f64) -> Move {
    let position = stretch.position();
    let from = position[0];
    let to = stretch.setpoint();
    let (tail_time, tail) = stretch.tail();
    let beyond = |to: f64| {
        let passed = position.iter().map(|x| (x - to) * (to - from).signum()).fold(0.0, f64::max);
        (to != from).then_some(passed)
    };
    let speeds = &motion.velocity_mm_s[stretch.begin..stretch.end];
    Move {
        start_s: stretch.time()[0],
        from_mm: from,
        to_mm: to,
        end_mm: position[position.len() - 1],
        rise_s: to.and_then(|to| Some(stretch.passes(from, to, 0.9)? - stretch.passes(from, to, 0.1)?)),
        overshoot_mm: to.and_then(beyond),
        settling_s: to.and_then(|to| stretch.settling(to, tolerance_mm)),
        steady_error_mm: to.map(|to| to - mean(tail)),
        limit_cycle: LimitCycle::of(tail_time, tail, stretch.transient.mm_per_count),
        top_speed_mm_s: speeds.iter().map(|speed| speed.abs()).fold(0.0, f64::max),
        air_l: None,
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// The moves as a table.
#[must_use]
pub fn table(moves: &[Move], tolerance_mm: f64) -> Table {
    let columns = [
        "move",
        "begins, s",
        "from, mm",
        "to, mm",
        "ends at, mm",
        "rise, s",
        "overshoot, mm",
        "settled, s",
        "steady error, mm",
        "limit cycle, mm",
        "at, Hz",
        "top speed, mm/s",
        "air, l (ANR)",
    ];
    Table {
        heading: format!("moves; settled means within {tolerance_mm} mm"),
        columns: columns.map(str::to_owned).to_vec(),
        rows: (1..).zip(moves).map(|(number, one)| row(number, one)).collect(),
    }
}

fn row(number: usize, one: &Move) -> Vec<String> {
    let said = |value: Option<f64>, decimals: usize| {
        value.map_or_else(|| "-".to_owned(), |value| format!("{value:.decimals$}"))
    };
    vec![
        number.to_string(),
        said(Some(one.start_s), 4),
        said(Some(one.from_mm), 3),
        said(one.to_mm, 3),
        said(Some(one.end_mm), 3),
        said(one.rise_s, 4),
        said(one.overshoot_mm, 3),
        said(one.settling_s, 4),
        said(one.steady_error_mm, 3),
        said(one.limit_cycle.map(|cycle| cycle.amplitude_mm), 3),
        said(one.limit_cycle.map(|cycle| cycle.frequency_hz), 2),
        said(Some(one.top_speed_mm_s), 1),
        said(one.air_l, 3),
    ]
}

#[cfg(test)]
mod tests;
