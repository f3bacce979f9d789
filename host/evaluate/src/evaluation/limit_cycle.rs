//! Whether a move ends in a limit cycle: an oscillation that continues to the end of the move with a constant swing.
//!
//! ```text
//! position -> swings -> cycles of two swings -> trend of ln(swing) over the cycles -> verdict
//! ```
//!
//! Two swings make a cycle, and their mean is its swing: a drift lengthens one and shortens the other. The line
//! `ln(swing) = a + b cycle` is fitted by least squares to the later half of the cycles, of which there must be at least
//! three. Over these n cycles the swing changes by `b n`, known to within twice its standard error. The
//! oscillation is a limit cycle if it loses less than a tenth or gains less than three tenths over them, or if its
//! change is not significant, and certainly less than a half. Where the later half still holds the end of a transient,
//! fewer cycles may show the limit cycle, if the swing changes at less than a third of the rate before them: a
//! ringing that dies out exponentially never does.
//!
//! The drive comes to rest if it does not move at the end of the move for a quarter of the move, for 0.2 s, and for the
//! length of the longest cycle before, if its pressures come to rest, too, and if what is still to come of them is small
//! beside what holds the load (`standstill.rs`): a drive that sticks while its pressures still change will jump. Unless
//! both pressures were measured, it cannot be told whether the drive comes to rest or sticks.
//!
//! Everything else cannot be decided: the record is too short.

mod standstill;
mod trend;

use std::fmt;

use super::noise;
use super::swings::{Swing, swings};
use crate::transient::FrictionUse;
use standstill::Standstill;
use trend::Trend;

/// A move's evidence of a limit cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LimitCycle {
    /// The drive comes to rest.
    None {
        /// It is at rest within this, mm: a smaller swing cannot be seen.
        below_mm: f64,
        /// For this long at the end of its move, s.
        for_s: f64,
    },
    /// It swings to the end of the move.
    Sustained(Oscillation),
    /// The move does not show it.
    Undecided(Doubt),
}

/// A sustained oscillation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oscillation {
    /// From its lowest to its highest position, mean over the cycles, mm.
    pub swing_mm: f64,
    /// The smallest and the largest swing of a cycle, mm.
    pub range_mm: [f64; 2],
    /// How often it swings, Hz.
    pub frequency_hz: f64,
    /// On how many cycles this rests.
    pub cycles: usize,
    /// When the first and the last of them begins and ends, s.
    pub during_s: [f64; 2],
}

/// Why a limit cycle cannot be decided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Doubt {
    /// The move is too short to show a rest.
    TooShort,
    /// The drive is at rest, but not for long enough.
    JustStopped,
    /// The drive is at rest, but its pressures still change.
    Sticking {
        /// How fast, kPa/s.
        kpa_s: f64,
        /// How much longer it would have to stand to be known to rest, by how the pressures change, s.
        still_s: f64,
    },
    /// The drive is at rest, but its pressures were not both measured: it may stick now and jump later.
    PressuresUnknown,
    /// It moves, and has not turned back lately.
    Moving,
    /// Too few cycles to distinguish a sustained oscillation from one that decays.
    FewCycles,
    /// Its swing is still on the way down.
    DyingOut {
        /// The swing of the last cycle, mm.
        last_mm: f64,
    },
    /// Its swing is still on the way up.
    Growing {
        /// The swing of the last cycle, mm.
        last_mm: f64,
    },
    /// Its swing changes too much from cycle to cycle.
    Irregular,
    /// There is no move: the run broke off.
    NoMove,
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Doubt::TooShort => write!(f, "it lasts for less than {REST_S} s"),
            Doubt::JustStopped => f.write_str("it is at rest at the end, but not for long enough"),
            Doubt::Sticking { kpa_s, still_s } => write!(
                f,
                "it is at rest at the end, but its pressures still change by {kpa_s:.1} kPa/s and may make it jump: watch it for {:.0} s more",
                still_s.ceil().max(1.0)
            ),
            Doubt::PressuresUnknown => f.write_str(
                "it is at rest at the end, but without its pressures it is not known whether it only sticks",
            ),
            Doubt::Moving => f.write_str("it still moves at the end"),
            Doubt::FewCycles => {
                write!(f, "it oscillates at the end, but for fewer than {FEWEST} whole cycles")
            }
            Doubt::DyingOut { last_mm } => {
                write!(f, "its oscillation is still decaying, {last_mm:.3} mm peak to peak in the last cycle")
            }
            Doubt::Growing { last_mm } => {
                write!(f, "its oscillation is still growing, {last_mm:.3} mm peak to peak in the last cycle")
            }
            Doubt::Irregular => f.write_str("its amplitude varies too much from cycle to cycle"),
            Doubt::NoMove => f.write_str("the run broke off"),
        }
    }
}

/// Fewest cycles that show a limit cycle.
const FEWEST: usize = 3;

/// The drive must be at rest for this long, s; otherwise a slow swing at its turning point would count as rest.
const REST_S: f64 = 0.2;

/// And for this part of its move.
const REST_PART: f64 = 0.25;

/// A drive on the edge of a count is at rest: it moves by two counts at most.
const REST_COUNTS: f64 = 2.5;

/// The noise of an encoder, too, in its standard deviations: of 100,000 draws the range is 8.7.
const REST_DEVIATIONS: f64 = 9.0;

/// A swing that loses less than this part over the cycles is constant.
const MAX_LOSS: f64 = 0.1;

/// And one that gains less than this: it does not die out, and is at least as large as it was.
const MAX_GAIN: f64 = 0.3;

/// A change of the swing over the cycles must be known to be less than this part.
const KNOWN: f64 = 0.5;

/// Beyond a transient, a swing changes by less than this part of its rate before.
const MAX_TREND: f64 = 1.0 / 3.0;

/// Standard deviation of a cycle's swing by the counts at its turning points, counts: two swings of two ends each.
const ROUNDING_COUNTS: f64 = 0.3;

impl LimitCycle {
    /// The verdict on the positions of a move (mm) over time (s), and the pressures of its chambers (kPa). The drive
    /// moves by `still_mm` at most while it rests ([`still_band`]). `grip` is known for simulated runs, at the same
    /// instants.
    pub(super) fn of(
        time: &[f64],
        position: &[f64],
        pressures: [&[f64]; 2],
        grip: Option<&FrictionUse>,
        mm_per_count: f64,
        still_mm: f64,
    ) -> LimitCycle {
        if duration(time) < REST_S {
            return LimitCycle::Undecided(Doubt::TooShort);
        }
        let rest_s = rest(time, position, still_mm);
        let earlier = swings(time, position, still_mm);
        let slowest = cycles(&earlier).map(|cycle| cycle.duration_s()).fold(0.0, f64::max);
        if rest_s >= REST_S.max(REST_PART * duration(time)).max(slowest) {
            let still_since = time.partition_point(|t| *t < time[time.len() - 1] - rest_s);
            let standstill = Standstill::of(pressures, grip, still_since..time.len(), rest_s);
            return match standstill.doubt() {
                Some(doubt) => LimitCycle::Undecided(doubt),
                None => LimitCycle::None { below_mm: still_mm, for_s: rest_s },
            };
        }
        let range_mm = range_beside_drift(last_quarter(time), last_quarter(position));
        let seen = |band_mm: f64| LimitCycle::in_swings(time, position, band_mm, mm_per_count);
        match seen(still_mm.max(range_mm / 3.0)) {
            LimitCycle::Undecided(Doubt::Moving) if rest_s > 0.5 * REST_S => {
                LimitCycle::Undecided(Doubt::JustStopped)
            }
            // Of a swing that changes fast only some cycles are that large.
            few @ LimitCycle::Undecided(Doubt::FewCycles) => match seen(still_mm) {
                LimitCycle::Undecided(doubt) => LimitCycle::Undecided(doubt),
                _ => few,
            },
            found => found,
        }
    }

    /// The verdict on swings that exceed a band.
    fn in_swings(time: &[f64], position: &[f64], band_mm: f64, mm_per_count: f64) -> LimitCycle {
        let swings = swings(time, position, band_mm);
        let all: Vec<Cycle> = cycles(&swings).collect();
        let (Some(last), Some(end_s)) = (swings.last(), time.last()) else {
            return LimitCycle::Undecided(Doubt::Moving);
        };
        let longest = all.iter().rev().take(FEWEST).map(Cycle::duration_s).fold(0.0, f64::max);
        if end_s - last.to_s > longest.max(2.0 * (last.to_s - last.from_s)) {
            return LimitCycle::Undecided(Doubt::Moving);
        }
        if all.len() < FEWEST {
            return LimitCycle::Undecided(Doubt::FewCycles);
        }
        let half = all.len().div_ceil(2).max(FEWEST);
        let constant = (FEWEST..=half).rev().find(|&count| is_constant(&all, count, half, mm_per_count));
        match constant {
            Some(count) => LimitCycle::Sustained(Oscillation::of(&all[all.len() - count..], &swings)),
            None => LimitCycle::Undecided(doubt(&all[all.len() - half..], mm_per_count)),
        }
    }

    /// The worse of two moves: an undecided one is worse than any swing.
    #[must_use]
    pub fn or_worse(self, other: LimitCycle) -> LimitCycle {
        let rank = |one: &LimitCycle| one.swing_mm().unwrap_or(f64::INFINITY);
        if rank(&other) > rank(&self) { other } else { self }
    }

    /// How often it swings, Hz; None unless it does.
    #[must_use]
    pub fn frequency_hz(&self) -> Option<f64> {
        match self {
            LimitCycle::Sustained(seen) => Some(seen.frequency_hz),
            LimitCycle::None { .. } | LimitCycle::Undecided(_) => None,
        }
    }

    /// The swing from peak to peak, mm: 0 of a drive at rest, None where it is not decided.
    #[must_use]
    pub fn swing_mm(&self) -> Option<f64> {
        match self {
            LimitCycle::None { .. } => Some(0.0),
            LimitCycle::Sustained(oscillation) => Some(oscillation.swing_mm),
            LimitCycle::Undecided(_) => None,
        }
    }
}

/// Largest motion of a resting drive, mm.
pub(super) fn still_band(position: &[f64], mm_per_count: f64) -> f64 {
    (REST_COUNTS * mm_per_count).max(REST_DEVIATIONS * noise::deviation(position))
}

/// For how long before its end the position lies within a band, s.
pub(super) fn rest(time: &[f64], position: &[f64], band_mm: f64) -> f64 {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let still = |position: &&f64| {
        (low, high) = (low.min(**position), high.max(**position));
        high - low <= band_mm
    };
    let samples = position.iter().rev().take_while(still).count();
    duration(&time[time.len() - samples..])
}

fn duration(time: &[f64]) -> f64 {
    time.last().zip(time.first()).map_or(0.0, |(last, first)| last - first)
}

fn last_quarter(values: &[f64]) -> &[f64] {
    &values[values.len() * 3 / 4..]
}

/// How far positions are from their straight line over time at most, to both sides together.
fn range_beside_drift(time: &[f64], position: &[f64]) -> f64 {
    let drift = Trend::through(time, position);
    let beside = time.iter().zip(position).map(|(t, x)| x - drift.at(*t));
    let (low, high) =
        beside.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    (high - low).max(0.0)
}

/// Two swings.
#[derive(Clone, Copy, Debug)]
struct Cycle {
    from_s: f64,
    to_s: f64,
    swing_mm: f64,
}

impl Cycle {
    fn duration_s(&self) -> f64 {
        self.to_s - self.from_s
    }
}

/// Whole cycles up to the last turning point; a first swing that has no partner is left out.
fn cycles(swings: &[Swing]) -> impl Iterator<Item = Cycle> {
    swings[swings.len() % 2..].chunks_exact(2).map(|pair| Cycle {
        from_s: pair[0].from_s,
        to_s: pair[1].to_s,
        swing_mm: (pair[0].size_mm + pair[1].size_mm) / 2.0,
    })
}

/// The trend of the logarithms of swings, a cycle each.
fn trend(cycles: &[Cycle], mm_per_count: f64) -> Trend {
    let numbers: Vec<f64> = (0..cycles.len()).map(|number| number as f64).collect();
    let logarithms: Vec<f64> = cycles.iter().map(|cycle| cycle.swing_mm.ln()).collect();
    let mean = cycles.iter().map(|cycle| cycle.swing_mm).sum::<f64>() / cycles.len() as f64;
    Trend::through(&numbers, &logarithms).with_readings_within(ROUNDING_COUNTS * mm_per_count / mean)
}

/// Whether the swing of the last cycles is constant. Fewer than `half` must have levelled off, too.
fn is_constant(all: &[Cycle], count: usize, half: usize, mm_per_count: f64) -> bool {
    let (before, last) = all.split_at(all.len() - count);
    let now = trend(last, mm_per_count);
    let [change, unknown] = [now.slope, 2.0 * now.deviation].map(|rate| rate * count as f64);
    let constant =
        ((-MAX_LOSS..MAX_GAIN).contains(&change) || change.abs() < unknown) && change.abs() + unknown < KNOWN;
    let is_level = || {
        let earlier = &before[before.len() - count.min(before.len())..];
        earlier.len() >= 2 && now.slope.abs() < MAX_TREND * trend(earlier, mm_per_count).slope.abs()
    };
    constant && (count == half || is_level())
}

/// Why the swing of cycles is not constant.
fn doubt(cycles: &[Cycle], mm_per_count: f64) -> Doubt {
    let Trend { slope, deviation, .. } = trend(cycles, mm_per_count);
    let last_mm = cycles.last().map_or(0.0, |cycle| cycle.swing_mm);
    if slope.abs() < 2.0 * deviation {
        Doubt::Irregular
    } else if slope < 0.0 {
        Doubt::DyingOut { last_mm }
    } else {
        Doubt::Growing { last_mm }
    }
}

impl Oscillation {
    /// The last cycles, and all swings.
    fn of(cycles: &[Cycle], swings: &[Swing]) -> Oscillation {
        let during_s = [cycles[0].from_s, cycles[cycles.len() - 1].to_s];
        let sizes = || cycles.iter().map(|cycle| cycle.swing_mm);
        let of_them = &swings[swings.len() - 2 * cycles.len()..];
        let periods: Vec<f64> =
            of_them.windows(3).map(|three| three[2].middle_s - three[0].middle_s).collect();
        Oscillation {
            swing_mm: sizes().sum::<f64>() / cycles.len() as f64,
            range_mm: [sizes().fold(f64::INFINITY, f64::min), sizes().fold(0.0, f64::max)],
            frequency_hz: periods.len() as f64 / periods.iter().sum::<f64>(),
            cycles: cycles.len(),
            during_s,
        }
    }
}

#[cfg(test)]
mod tests;
