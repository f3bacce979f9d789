//! The figures of moves in words.

use super::figures::{FIGURES, Figure, InRuns, TOP_SPEED, endings, in_runs, range};
use super::{Air, Doubt, LimitCycle, Move};
use crate::range::Range;
use pneudrive_report::Table;

/// The moves of a run as a table. `runs` has the moves of the run and then those of each of its perturbed runs. Below
/// a move stand the least and the greatest values of all runs, if they differ from it in the digits shown.
#[must_use]
pub fn table(runs: &[Vec<Move>], tolerance_mm: f64) -> Table {
    let figures = FIGURES.iter().map(|figure| figure.heading);
    let limit_cycle = ["limit cycle, mm peak to peak", "at, Hz"];
    let columns = ["move"].into_iter().chain(figures).chain(limit_cycle);
    let columns = columns.chain([TOP_SPEED.heading, "air, l (ANR)"]);
    Table::new(
        format!("moves; settled: within {tolerance_mm} mm for the last quarter; -: not shown by the move"),
        columns,
        numbered(runs).flat_map(|(number, moves)| rows(number, &moves)),
    )
}

/// The row of a move, and the rows of the least and the greatest values if they differ.
fn rows(number: usize, moves: &InRuns) -> Vec<Vec<String>> {
    let cells: Vec<Cell> = FIGURES
        .iter()
        .map(|figure| Cell::of(figure, moves))
        .chain(limit_cycle(moves))
        .chain([Cell::of(&TOP_SPEED, moves), air(moves)])
        .collect();
    let row = |head: String, of: fn(&Cell) -> &String| {
        std::iter::once(head).chain(cells.iter().map(|cell| of(cell).clone())).collect::<Vec<String>>()
    };
    let ends = [row("  least".to_owned(), |cell| &cell.least), row("  most".to_owned(), |cell| &cell.most)];
    let differ = ends.iter().any(|row| row[1..].iter().any(|cell| !cell.is_empty()));
    let own = row(number.to_string(), |cell| &cell.own);
    std::iter::once(own).chain(ends.into_iter().filter(|_| differ)).collect()
}

/// A figure of a move; least and most are empty where they are the run's own in the digits shown.
#[derive(Default)]
struct Cell {
    own: String,
    least: String,
    most: String,
}

impl Cell {
    fn of(figure: &Figure, moves: &InRuns) -> Cell {
        Cell::of_range(range(moves, figure.of), figure.decimals)
    }

    fn of_range(range: Range, decimals: usize) -> Cell {
        let word = |value: f64| format!("{value:.decimals$}");
        let own = range.value.map_or_else(|| "-".to_owned(), word);
        let [least, most] = range.ends.map_or([(); 2].map(|()| own.clone()), |ends| ends.map(word));
        match range.lacking {
            0 if least == most => Cell { own, ..Cell::default() },
            0 => Cell { own, least, most },
            all if all == range.runs => Cell { own, ..Cell::default() },
            lacking => Cell { own, least, most: format!("{most} (- in {lacking} of {})", range.runs) },
        }
    }
}

/// Swing and frequency of a limit cycle.
fn limit_cycle(moves: &InRuns) -> [Cell; 2] {
    let broke_off = LimitCycle::Undecided(Doubt::NoMove);
    let all: Vec<LimitCycle> = moves.iter().map(|one| one.map_or(broke_off, |one| one.limit_cycle)).collect();
    // An undecidable swing may be any.
    let swing = |one: &&LimitCycle| one.swing_mm().unwrap_or(f64::INFINITY);
    let by_swing = |a: &&LimitCycle, b: &&LimitCycle| swing(a).total_cmp(&swing(b));
    let ends = all.iter().min_by(by_swing).zip(all.iter().max_by(by_swing));
    let Some((least, most)) = ends else { return Default::default() };
    let ends = [least, most].map(|one| match one {
        LimitCycle::Sustained(seen) => format!("{:.3}", seen.swing_mm),
        other => cycle(other),
    });
    let hertz: Vec<Option<f64>> = all.iter().map(LimitCycle::frequency_hz).collect();
    let frequency = Cell::of_range(Range::of(&hertz), 2);
    let [least, most] = if least == most { Default::default() } else { ends };
    [Cell { own: cycle(&all[0]), least, most }, frequency]
}

/// A swing with its smallest and largest cycle.
fn cycle(limit_cycle: &LimitCycle) -> String {
    match limit_cycle {
        LimitCycle::None { .. } => "none".to_owned(),
        LimitCycle::Sustained(seen) => {
            let [least, most] = seen.range_mm;
            format!("{:.3} ({least:.3} to {most:.3})", seen.swing_mm)
        }
        LimitCycle::Undecided(_) => "not decidable".to_owned(),
    }
}

/// Air with its bounds, to the digits that they leave.
fn air(moves: &InRuns) -> Cell {
    let Some(Air { litres, least, most }) = moves.first().copied().flatten().and_then(|one| one.air) else {
        return Cell { own: "-".to_owned(), ..Cell::default() };
    };
    let decimals = (2.0 - (most - least).max(1e-3).log10()).floor().clamp(0.0, 3.0) as usize;
    let own = format!("{litres:.decimals$} ({least:.decimals$} to {most:.decimals$})");
    let [least, most] = [range(moves, |one| Some(one.air?.least)), range(moves, |one| Some(one.air?.most))];
    let ends = least.ends.zip(most.ends).map(|([least, _], [_, most])| [least, most]);
    if moves.len() == 1 {
        return Cell { own, ..Cell::default() };
    }
    Cell { own, ..Cell::of_range(Range { ends, ..range(moves, |one| Some(one.air?.litres)) }, decimals) }
}

/// Remarks on the limit cycles of moves, a sentence each: why one is not decidable, the meaning of none, and where
/// perturbed runs end otherwise than the run. `runs` has the moves of each, the run's own first.
#[must_use]
pub fn remarks(runs: &[Vec<Move>]) -> Vec<String> {
    let Some(moves) = runs.first() else { return Vec::new() };
    let cut = moves
        .iter()
        .filter(|one| one.is_cut)
        .map(|one| format!("Move {} begins earlier: only the figures of its end are known.", one.number));
    let doubt = |one: &Move| match one.limit_cycle {
        LimitCycle::Undecided(doubt) => {
            let number = one.number;
            Some(format!("Move {number}: it cannot be decided whether it ends in a limit cycle; {doubt}."))
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
            "No limit cycle means that the drive is at rest within {below_mm:.3} mm for at least the last {for_s:.2} s."
        )
    });
    let divided = numbered(runs).filter_map(|(number, moves)| divided(number, &moves));
    let tracking = numbered(runs).filter_map(|(number, moves)| tracking(number, &moves));
    let commanded = moves.iter().any(|one| one.to_mm.is_none()).then(|| COMMANDED.to_owned());
    let doubts = moves.iter().filter_map(doubt);
    commanded.into_iter().chain(cut).chain(tracking).chain(doubts).chain(none).chain(divided).collect()
}

/// How a move follows its profile, with the range over all runs.
fn tracking(number: usize, moves: &InRuns) -> Option<String> {
    moves.first().copied().flatten()?.tracking?;
    let words = |figure: fn(&Move) -> Option<f64>| {
        let cell = Cell::of_range(range(moves, figure), 3);
        if cell.least.is_empty() {
            cell.own
        } else {
            format!("{} ({} to {})", cell.own, cell.least, cell.most)
        }
    };
    let most = words(|one| Some(one.tracking?.most_mm));
    let rms = words(|one| Some(one.tracking?.rms_mm));
    Some(format!(
        "Move {number} follows its profile: the error is {most} mm at most, and {rms} mm in the root of its mean square."
    ))
}

/// The moves over all runs with their numbers.
fn numbered(runs: &[Vec<Move>]) -> impl Iterator<Item = (usize, InRuns<'_>)> {
    let own = runs.first().into_iter().flatten().map(|one| one.number);
    own.zip(in_runs(runs))
}

/// Why moves have no setpoint.
const COMMANDED: &str = "In open loop a move is a command to the valve. It has no setpoint, so there is no rise, overshoot, settling or steady error.";

/// How the runs divide where they do not all end alike.
fn divided(number: usize, moves: &InRuns) -> Option<String> {
    let [at_rest, swinging, undecided] = endings(moves);
    let all = moves.len();
    if [at_rest, swinging, undecided].contains(&all) {
        return None;
    }
    Some(format!(
        "Move {number}: of {all} nearly identical runs, {at_rest} come to rest, {swinging} end in a limit cycle and {undecided} cannot be decided."
    ))
}
