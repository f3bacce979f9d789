//! The page of a sweep: the best point, the allowed and the failed ones, and every metric over every axis.

use super::metric::MoveSelection;
use super::{Axis, Objective, Row, Sweep};
use pneudrive_evaluate::range;
use pneudrive_report::{COLOURS, Curve, Figure, Look, Page, Panel, Table};

/// Most panels of a figure, and most failures and curves that are shown one by one.
const PANELS: usize = 8;
const FAILURES: usize = 30;
const CURVES: usize = COLOURS.len();

/// Colours of points that are allowed, and that are not.
const ALLOWED: &str = "#1f4e9c";
const NOT_ALLOWED: &str = "#c0392b";

/// The page of all rows.
#[must_use]
pub fn page(sweep: &Sweep, rows: &[Row]) -> Page {
    let mut tables = vec![best(sweep, rows), combinations(sweep, rows)];
    tables.extend([constraints(sweep, rows), summary(sweep, rows), failures(sweep, rows)]);
    tables.retain(|table| !table.rows.is_empty());
    Page {
        title: format!("{}: {} runs", sweep.rig.name(), rows.len()),
        notes: notes(sweep, rows),
        tables,
        figures: sweep.axes.iter().flat_map(|axis| figures(sweep, axis, rows)).collect(),
        ..Page::default()
    }
}

fn notes(sweep: &Sweep, rows: &[Row]) -> Vec<String> {
    let scaled = sweep.axes.iter().filter(|axis| !axis.scaled.is_empty());
    let scaled = scaled.map(|axis| format!("{} is a factor on {}.", axis.name, axis.scaled.join(", ")));
    let common = (!sweep.settings.is_empty()).then(|| format!("All have {}.", sweep.settings.join(", ")));
    let ranges = (sweep.ensemble > 1).then(|| {
        format!(
            "Each point was run {} times with very slightly different mass and starting position; a constraint is met if all of these runs meet it.",
            sweep.ensemble
        )
    });
    let hidden = sweep.metrics.iter().enumerate().filter(|(place, _)| !is_shown(rows, *place));
    let hidden: Vec<&str> = hidden.map(|(_, metric)| metric.name.as_str()).collect();
    let hidden = (!hidden.is_empty()).then(|| {
        format!("No point has a value of {}, so there is no graph of it.", hidden.join(", nor of "))
    });
    std::iter::once(count(sweep, rows)).chain(ranges).chain(common).chain(scaled).chain(hidden).collect()
}

/// How many points there are, and how many of them are any good.
#[must_use]
pub fn count(sweep: &Sweep, rows: &[Row]) -> String {
    let of = |name: &str, count: usize| if count == 0 { String::new() } else { format!(", {count} {name}") };
    let failed = rows.iter().filter(|row| !row.failure.is_empty()).count();
    let tripped = rows.iter().filter(|row| !row.fault.is_empty()).count();
    let allowed = rows.iter().filter(|row| sweep.allows(row)).count();
    let allowed = if sweep.constraints.is_empty() { String::new() } else { format!(", {allowed} allowed") };
    let unconverged = rows.iter().filter(|row| row.converged == Some(false)).count();
    let rest = of("ended by a fault", tripped) + &of("failed", failed) + &of("not converged", unconverged);
    format!("{} points{allowed}{rest}.", rows.len())
}

/// Levels and metrics of the best point.
#[must_use]
pub fn best(sweep: &Sweep, rows: &[Row]) -> Table {
    let row = |name: &str, value: String| vec![name.to_owned(), value];
    let Some(objective) = sweep.objective else { return Table::default() };
    let aim =
        format!("{} {}", if objective.most { "most" } else { "least" }, sweep.metrics[objective.metric].name);
    let Some(best) = sweep.best(rows) else {
        let heading = format!("the best point ({aim})");
        return Table::new(
            heading,
            row("", String::new()),
            vec![row("no allowed point has a value", "-".to_owned())],
        );
    };
    let levels = sweep.axes.iter().zip(&best.levels).map(|(axis, level)| row(&axis.name, level.clone()));
    let metrics = sweep.metrics.iter().enumerate();
    let metrics = metrics.map(|(place, metric)| row(&metric.name, in_range(best, place)));
    let converged = best.converged.map(|yes| row("converged", if yes { "yes" } else { "no" }.to_owned()));
    Table::new(
        format!("the best point ({aim})"),
        row("", format!("point {}", best.point)),
        levels.chain(metrics).chain(converged),
    )
}

/// A metric of a row, with its range if it has one.
fn in_range(row: &Row, metric: usize) -> String {
    let own = row.metrics[metric];
    match row.ends.get(metric) {
        None => formatted(own),
        Some(Some([least, most])) => range::with_range(&[own, Some(*least), Some(*most)], DECIMALS),
        Some(None) => format!("{} (some runs do not show it)", formatted(own)),
    }
}

/// Decimals of the figures.
const DECIMALS: usize = 4;

/// The summary of the draws of each combination of the varied values: how many of them are allowed, and the largest
/// size of each metric. The combination with the most allowed draws comes first, then the best in the objective.
#[must_use]
pub fn combinations(sweep: &Sweep, rows: &[Row]) -> Table {
    let varied: Vec<usize> = (0..sweep.axes.len()).filter(|&place| !sweep.axes[place].drawn).collect();
    if sweep.draws == 1 || varied.is_empty() {
        return Table::default();
    }
    let mut groups: Vec<Group> = rows
        .chunk_by(|a, b| a.point / sweep.draws == b.point / sweep.draws)
        .map(|rows| Group::of(sweep, rows))
        .collect();
    groups.sort_by(|a, b| b.allowed.cmp(&a.allowed).then(a.cost.total_cmp(&b.cost)));
    let row = |group: &Group| {
        let levels = varied.iter().map(|&place| group.levels[place].clone());
        let allowed = format!("{} of {}", group.allowed, group.draws);
        levels.chain([allowed]).chain(group.largest.iter().map(|value| formatted(*value))).collect()
    };
    let metrics = sweep.metrics.iter().map(|metric| metric.name.clone());
    let columns = varied.iter().map(|&place| sweep.axes[place].name.clone()).chain(["allowed".to_owned()]);
    Table::new(
        "combinations, with the largest of each metric over their draws; the best first",
        columns.chain(metrics),
        groups.iter().take(CURVES).map(row),
    )
}

/// The draws of one combination.
struct Group {
    levels: Vec<String>,
    draws: usize,
    allowed: usize,
    /// Of each metric the largest size; None if a draw has none.
    largest: Vec<Option<f64>>,
    /// The worst of the objective: less is better.
    cost: f64,
}

impl Group {
    fn of(sweep: &Sweep, rows: &[Row]) -> Group {
        let all = |place: usize, worse: fn(f64, f64) -> f64| {
            let sizes: Option<Vec<f64>> = rows.iter().map(|row| row.metrics[place].map(f64::abs)).collect();
            sizes.and_then(|sizes| sizes.into_iter().reduce(worse))
        };
        let cost = |goal: Objective| {
            let worst = all(goal.metric, if goal.most { f64::min } else { f64::max });
            worst.map_or(f64::INFINITY, |worst| if goal.most { -worst } else { worst })
        };
        Group {
            levels: rows.first().map_or_else(Vec::new, |row| row.levels.clone()),
            draws: rows.len(),
            allowed: rows.iter().filter(|row| sweep.allows(row)).count(),
            largest: (0..sweep.metrics.len()).map(|place| all(place, f64::max)).collect(),
            cost: sweep.objective.map_or(0.0, cost),
        }
    }
}

fn constraints(sweep: &Sweep, rows: &[Row]) -> Table {
    let row = |bound: &super::Bound| {
        let kept = rows.iter().filter(|row| bound.is_kept(row)).count();
        let most = if bound.max.is_finite() { bound.max.to_string() } else { "-".to_owned() };
        vec![sweep.metrics[bound.metric].name.clone(), bound.min.to_string(), most, kept.to_string()]
    };
    Table::new(
        "constraints",
        ["", "at least", "at most", "points that meet it"],
        sweep.constraints.iter().map(row),
    )
}

fn summary(sweep: &Sweep, rows: &[Row]) -> Table {
    let row = |(place, metric): (usize, &super::Metric)| {
        let mut values: Vec<f64> = rows.iter().filter_map(|row| row.metrics[place]).collect();
        values.sort_by(f64::total_cmp);
        let ends = rows.iter().filter_map(|row| *row.ends.get(place)?);
        let ends = ends.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]);
        let least = values.first().copied().map(|least| ends.map_or(least, |[a, _]| a.min(least)));
        let most = values.last().copied().map(|most| ends.map_or(most, |[_, b]| b.max(most)));
        let median = values.get(values.len() / 2).copied();
        let which = match metric.which {
            MoveSelection::Number(number) => format!("move {number}"),
            MoveSelection::Worst => "worst move".to_owned(),
            MoveSelection::Sum => "all moves".to_owned(),
        };
        let about = format!("{}, {which}: {}", metric.figure.name, metric.figure.meaning);
        let ends = [least, median, most].map(formatted);
        let missing = (rows.len() - values.len()).to_string();
        std::iter::once(metric.name.clone()).chain(ends).chain([missing, about]).collect()
    };
    Table::new(
        "metrics",
        ["", "least", "median", "most", "points without", "is"],
        sweep.metrics.iter().enumerate().map(row),
    )
}

fn failures(sweep: &Sweep, rows: &[Row]) -> Table {
    let bad: Vec<&Row> = rows.iter().filter(|row| !row.is_whole()).collect();
    let row = |row: &&Row| {
        let why = if row.failure.is_empty() { &row.fault } else { &row.failure };
        std::iter::once(row.point.to_string()).chain(row.levels.clone()).chain([why.clone()]).collect()
    };
    let axes = sweep.axes.iter().map(|axis| axis.name.clone());
    let shown =
        if bad.len() > FAILURES { format!("; the first {FAILURES} of {}", bad.len()) } else { String::new() };
    Table::new(
        format!("points that did not run to their end{shown}"),
        std::iter::once("point".to_owned()).chain(axes).chain(["why".to_owned()]),
        bad.iter().take(FAILURES).map(row),
    )
}

fn formatted(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.DECIMALS$}"))
}

/// The metrics over an axis.
fn figures<'a>(sweep: &'a Sweep, axis: &'a Axis, rows: &'a [Row]) -> impl Iterator<Item = Figure> + 'a {
    let metrics: Vec<usize> = (0..sweep.metrics.len()).filter(|&metric| is_shown(rows, metric)).collect();
    let chunks: Vec<Vec<usize>> = metrics.chunks(PANELS).map(<[usize]>::to_vec).collect();
    chunks.into_iter().map(move |chunk| Figure {
        heading: format!("over {}", axis.name),
        across: across(axis),
        logarithmic: axis.logarithmic,
        panels: chunk.iter().map(|&metric| panel(sweep, axis, metric, rows)).collect(),
    })
}

/// Whether any point shows a metric: a graph of no points shows nothing.
fn is_shown(rows: &[Row], metric: usize) -> bool {
    rows.iter().any(|row| row.metrics.get(metric).is_some_and(Option::is_some))
}

fn across(axis: &Axis) -> String {
    if !axis.is_named() {
        return axis.name.clone();
    }
    let names = axis.levels.iter().enumerate().map(|(place, level)| format!("{place} = {level}"));
    format!("{} ({})", axis.name, names.collect::<Vec<_>>().join(", "))
}

fn panel(sweep: &Sweep, axis: &Axis, metric: usize, rows: &[Row]) -> Panel {
    let place = sweep.axes.iter().position(|other| other.name == axis.name).unwrap_or(0);
    let curve = |name: &str, colour: &'static str, rows: &mut dyn Iterator<Item = &Row>| {
        let mut points: Vec<(f64, f64)> = rows
            .map(|row| (axis.place(&row.levels[place]), row.metrics[metric].unwrap_or(f64::NAN)))
            .collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (x, y) = points.into_iter().unzip();
        Curve { look: Look::Points, colour: Some(colour), ..Curve::new(name, x, y) }
    };
    let title = &sweep.metrics[metric].name;
    // With two axes, there is a line for each level of the other axis.
    if let [one, other] = sweep.axes.as_slice()
        && !one.drawn
        && !other.drawn
    {
        let (by, at) = if place == 0 { (other, 1) } else { (one, 0) };
        if by.levels.len() <= CURVES {
            let line = |(level, colour): (&String, &&'static str)| {
                let mut rows = rows.iter().filter(|row| row.levels[at] == *level);
                Curve { look: Look::Line, ..curve(&format!("{} {level}", by.name), colour, &mut rows) }
            };
            return Panel::new(title, by.levels.iter().zip(&COLOURS).map(line).collect());
        }
    }
    let mut curves = vec![
        curve("allowed", ALLOWED, &mut rows.iter().filter(|row| sweep.allows(row))),
        curve("not allowed", NOT_ALLOWED, &mut rows.iter().filter(|row| !sweep.allows(row))),
    ];
    curves.retain(|curve| !curve.x.is_empty());
    Panel::new(title, curves)
}
