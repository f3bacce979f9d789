//! The figures of moves in words.

use super::{LimitCycle, Move};
use crate::page::Table;

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
        "limit cycle, mm peak to peak",
        "at, Hz",
        "top speed, mm/s",
        "air, l (ANR)",
    ];
    Table {
        heading: format!(
            "moves; settled means within {tolerance_mm} mm for the last quarter, - that a move does not show it"
        ),
        columns: columns.map(str::to_owned).to_vec(),
        rows: (1..).zip(moves).map(|(number, one)| row(number, one)).collect(),
    }
}

fn row(number: usize, one: &Move) -> Vec<String> {
    let said = |value: Option<f64>, decimals: usize| {
        value.map_or_else(|| "-".to_owned(), |value| format!("{value:.decimals$}"))
    };
    let [swing, frequency] = cycle(&one.limit_cycle);
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
        swing,
        frequency,
        said(Some(one.top_speed_mm_s), 1),
        one.air.map_or_else(|| "-".to_owned(), |air| between(air.litres, air.least, air.most)),
    ]
}

/// A figure with its bounds, to the digits that they leave.
fn between(value: f64, least: f64, most: f64) -> String {
    let decimals = (2.0 - (most - least).max(1e-3).log10()).floor().clamp(0.0, 3.0) as usize;
    format!("{value:.decimals$} ({least:.decimals$} to {most:.decimals$})")
}

/// Swing and frequency of a limit cycle; the swing with its smallest and largest cycle.
fn cycle(limit_cycle: &LimitCycle) -> [String; 2] {
    match limit_cycle {
        LimitCycle::None { .. } => ["none".to_owned(), "-".to_owned()],
        LimitCycle::Sustained(seen) => {
            let [least, most] = seen.range_mm;
            [format!("{:.3} ({least:.3} to {most:.3})", seen.swing_mm), format!("{:.2}", seen.frequency_hz)]
        }
        LimitCycle::Undecided(_) => ["not decidable".to_owned(), "-".to_owned()],
    }
}

/// What the limit cycles of moves rest on, a sentence each: why one is not decidable, and what none means.
#[must_use]
pub fn remarks(moves: &[Move]) -> Vec<String> {
    let doubt = |(number, one): (usize, &Move)| match one.limit_cycle {
        LimitCycle::Undecided(doubt) => {
            Some(format!("Move {number}: whether it ends in a limit cycle is not decidable; {doubt}."))
        }
        _ => None,
    };
    let rests = moves.iter().filter_map(|one| match one.limit_cycle {
        LimitCycle::None { below_mm, for_s } => Some((below_mm, for_s)),
        _ => None,
    });
    let rests = rests.reduce(|(band, time), (below_mm, for_s)| (band.max(below_mm), time.min(for_s)));
    let none = rests.map(|(below_mm, for_s)| {
        format!(
            "No limit cycle means that the drive stands still within {below_mm:.3} mm, for the last {for_s:.2} s at least."
        )
    });
    (1..).zip(moves).filter_map(doubt).chain(none).collect()
}
