//! How a step ended, by the true position of the piston.
//!
//! | figure | definition |
//! |---|---|
//! | within a band | from then on to the end of the move, which is at least [`REST_S`] later |
//! | overshoot | how far the piston goes beyond the target, in the direction of the step |
//! | limit cycle | as everywhere ([`LimitCycle`]) |
//! | still moves | by more than [`STILL_MM`] within the last second, whatever it does there |
//!
//! The target is the middle of the count that the step leads to.

use pneudrive_evaluate::evaluation::LimitCycle;
use pneudrive_records::words::fault_name;
use pneudrive_sim::Run;

/// How near to its target a step may end, mm.
pub const BANDS_MM: [f64; 3] = [1.0, 0.2, 0.05];

/// A drive has arrived if it stays for this long at least, s.
pub const REST_S: f64 = 1.5;

/// A piston that moves by more than this is not at rest, mm.
pub const STILL_MM: f64 = 0.05;

/// For this long at the end of a move the piston is to stand, s.
const LAST_S: f64 = 1.0;

/// The end of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// Time to each band of [`BANDS_MM`], s; None: the piston does not stay there.
    pub within_s: [Option<f64>; 3],
    /// Overshoot beyond the target, mm.
    pub beyond_mm: f64,
    /// Distance from the target at the end of its move, mm.
    pub error_mm: f64,
    /// From its lowest to its highest position in the last second, mm.
    pub range_mm: f64,
    /// Whether it ends in a limit cycle.
    pub limit_cycle: LimitCycle,
}

impl Arrival {
    /// The end of a step from the positions (mm) over time (s); the step begins with the first of them.
    #[must_use]
    pub fn of(time: &[f64], position: &[f64], [from, to]: [f64; 2], limit_cycle: LimitCycle) -> Arrival {
        let direction = (to - from).signum();
        let beyond = |x: &f64| direction * (x - to);
        let last = &position[time.partition_point(|t| *t < time.last().unwrap_or(&0.0) - LAST_S)..];
        let (low, high) = last
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
        Arrival {
            within_s: BANDS_MM.map(|band| within_s(time, position, to, band)),
            beyond_mm: position.iter().map(beyond).fold(0.0, f64::max),
            error_mm: position.last().map_or(f64::NAN, |x| x - to),
            range_mm: high - low,
            limit_cycle,
        }
    }

    /// Whether the piston still moves at the end.
    #[must_use]
    pub fn moves(&self) -> bool {
        self.range_mm > STILL_MM
    }
}

/// Whether a run has come to its end; otherwise the fault that ended it.
pub(super) fn to_its_end(run: &Run) -> Result<(), String> {
    match run.fault {
        Some((fault, k)) => Err(format!("{} at sample {k}", fault_name(fault))),
        None => Ok(()),
    }
}

/// When the positions come to stay within a band of the target, s from the first of them.
fn within_s(time: &[f64], position: &[f64], to: f64, band: f64) -> Option<f64> {
    let first = position.iter().rposition(|x| (x - to).abs() > band).map_or(0, |outside| outside + 1);
    let [begin, arrived, end] = [time.first()?, time.get(first)?, time.last()?];
    (end - arrived >= REST_S).then_some(arrived - begin)
}
