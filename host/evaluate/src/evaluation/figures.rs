//! The figures of a move, for a single run or over the run and its perturbed runs.

use serde_json::{Map, Value, json};

use super::{LimitCycle, Move};
use crate::range::Range;

/// A figure of a move: its format, and how it is read from a move.
pub(super) struct Figure {
    /// The head of its column.
    pub heading: &'static str,
    /// Its name in run.json.
    pub name: &'static str,
    /// The digits that are shown.
    pub decimals: usize,
    /// Its value for a move; None if the move does not show it.
    pub of: fn(&Move) -> Option<f64>,
}

/// Those in front of the limit cycle.
pub(super) const FIGURES: [Figure; 8] = [
    Figure { heading: "begins, s", name: "begins_s", decimals: 4, of: |one| one.of_whole(one.start_s) },
    Figure { heading: "from, mm", name: "from_mm", decimals: 3, of: |one| one.of_whole(one.from_mm) },
    Figure { heading: "to, mm", name: "to_mm", decimals: 3, of: |one| one.to_mm },
    Figure { heading: "ends at, mm", name: "ends_at_mm", decimals: 3, of: |one| Some(one.end_mm) },
    Figure { heading: "rise, s", name: "rise_s", decimals: 4, of: |one| one.rise_s },
    Figure { heading: "overshoot, mm", name: "overshoot_mm", decimals: 3, of: |one| one.overshoot_mm },
    Figure { heading: "settled, s", name: "settled_s", decimals: 4, of: |one| one.settling_s },
    Figure {
        heading: "steady error, mm",
        name: "steady_error_mm",
        decimals: 3,
        of: |one| one.steady_error_mm,
    },
];

/// After the limit cycle.
pub(super) const TOP_SPEED: Figure = Figure {
    heading: "top speed, mm/s",
    name: "top_speed_mm_s",
    decimals: 1,
    of: |one| one.of_whole(one.top_speed_mm_s),
};

/// A move in each of several runs, the run's own first; None where a run broke off before it.
pub(super) type InRuns<'a> = Vec<Option<&'a Move>>;

/// Each move of a run with the figures of its perturbed runs. `runs` has the moves of each, the run's own first.
pub(super) fn in_runs(runs: &[Vec<Move>]) -> impl Iterator<Item = InRuns<'_>> {
    let own = runs.first().map_or(0, Vec::len);
    (0..own).map(|number| runs.iter().map(|moves| moves.get(number)).collect())
}

/// A figure of one move over several runs.
pub(super) fn range(moves: &[Option<&Move>], figure: impl Fn(&Move) -> Option<f64>) -> Range {
    Range::of(&moves.iter().map(|one| one.and_then(&figure)).collect::<Vec<_>>())
}

/// How many runs end at rest, in a limit cycle, and in neither that is decidable.
pub(super) fn endings(moves: &[Option<&Move>]) -> [usize; 3] {
    let mut counts = [0; 3];
    for one in moves {
        counts[match one.map(|one| one.limit_cycle) {
            Some(LimitCycle::None { .. }) => 0,
            Some(LimitCycle::Sustained(_)) => 1,
            Some(LimitCycle::Undecided(_)) | None => 2,
        }] += 1;
    }
    counts
}

/// The moves of a run and of its perturbed runs as run.json has them; `runs` has the moves of each, the run's own first.
#[must_use]
pub fn to_json(runs: &[Vec<Move>]) -> Value {
    in_runs(runs).map(|moves| one_to_json(&moves)).collect()
}

fn one_to_json(moves: &[Option<&Move>]) -> Value {
    let ranged = |figure: &dyn Fn(&Move) -> Option<f64>| {
        let range = range(moves, figure);
        json!({
            "value": range.value,
            "least": range.ends.map(|[least, _]| least),
            "most": range.ends.map(|[_, most]| most),
            "runs_without": range.lacking,
        })
    };
    let figures = FIGURES.iter().chain([&TOP_SPEED]);
    let mut fields: Map<String, Value> =
        figures.map(|figure| (figure.name.to_owned(), ranged(&figure.of))).collect();
    fields.insert("limit_cycle_swing_mm".to_owned(), ranged(&|one| one.limit_cycle.swing_mm()));
    fields.insert("limit_cycle_hz".to_owned(), ranged(&|one| one.limit_cycle.frequency_hz()));
    let [at_rest, swinging, undecided] = endings(moves);
    fields.insert(
        "limit_cycle_runs".to_owned(),
        json!({ "none": at_rest, "sustained": swinging, "undecided": undecided }),
    );
    if moves.iter().flatten().any(|one| one.tracking.is_some()) {
        fields.insert("tracking_most_mm".to_owned(), ranged(&|one| Some(one.tracking?.most_mm)));
        fields.insert("tracking_rms_mm".to_owned(), ranged(&|one| Some(one.tracking?.rms_mm)));
    }
    fields.insert("air_litres_anr".to_owned(), ranged(&|one| Some(one.air?.litres)));
    fields.insert("air_litres_anr_at_least".to_owned(), ranged(&|one| Some(one.air?.least)));
    fields.insert("air_litres_anr_at_most".to_owned(), ranged(&|one| Some(one.air?.most)));
    Value::Object(fields)
}
