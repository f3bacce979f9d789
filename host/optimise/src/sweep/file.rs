//! The file of a sweep: its keys, and all errors in it.
//!
//! | key | is |
//! |---|---|
//! | `rig` | a built-in rig, or a rig file beside this one |
//! | `settled_mm`, `tolerance` | `test.tolerance_mm` of the rig, unless it is given here, and the allowed error of a step of the integrator: by default that of the drive, for draws that of a perturbed run |
//! | `ensemble` | 1; with more, each point is run with perturbed runs, and its metrics are ranges over them; not with `[draw]` |
//! | `[set]` | keys of the rig that all points have in common |
//! | `[vary]` | a key and its values (`file/vary.rs`) |
//! | `[draw]` | `count` of draws of the distributions, `seed` = 1, `method` = "latin-hypercube" or "random" |
//! | `[metrics]` | a name and its figure, or `{ figure = "settling_s", move = 2 }`; `move` = a number, "worst" or "sum" |
//! | `[objective]` | `minimise` or `maximise` = a metric: of its size |
//! | `[constraints]` | a metric and `{ min = 0.0, max = 1.0 }`, either or both: of its size |

mod fields;
mod names;
mod vary;

use pneudrive_sim::rig::Problems;
use pneudrive_sim::{Accuracy, Rig, keys};
use toml_edit::{Item, Table, TableLike};

use super::axis::Draw;
use super::metric::{FIGURES, Metric, MoveSelection};
use super::{Axis, Bound, Objective, Source, Sweep};
use fields::{Entry, Reader, count, known, nearest_of, number, only, text};
use names::plain_name;
use pneudrive_sim::schedule::USUAL_TOLERANCE_MM;

const TOP: [&str; 10] = [
    "rig",
    "settled_mm",
    "tolerance",
    "ensemble",
    "set",
    "vary",
    "draw",
    "metrics",
    "objective",
    "constraints",
];

/// Most points of a sweep: they fit into memory with their rows.
const MAX_POINTS: usize = 1_000_000;

/// Most runs of a point.
const MAX_RUNS: usize = 1000;

/// Columns of a result that no metric can have.
const TAKEN: [&str; 4] = ["point", "converged", "fault", "failure"];

impl Sweep {
    /// Reads the file of a sweep; `find_rig` gives the rig that it names.
    ///
    /// # Errors
    /// Every problem with its line and key.
    pub fn read(
        source: Source,
        find_rig: impl Fn(&str) -> anyhow::Result<Source>,
    ) -> Result<Sweep, Problems> {
        let text = source.text.clone();
        let mut reader = Reader::new(&source.name, &text);
        let Some(document) = reader.file.document() else { return Err(Problems(reader.file.problems)) };
        let top = document.as_table();
        for entry in reader.entries(top) {
            reader.note(&entry, known(&entry.name, &TOP));
        }
        let read = reader.rig(top, &find_rig);
        let Some((rig_source, rig, settings)) = read else { return Err(Problems(reader.file.problems)) };
        let (axes, draws) = reader.axes(top, &rig, &settings);
        let metrics = reader.metrics(top, &axes);
        let sweep = Sweep {
            rig_source,
            rig,
            settings,
            tolerance: reader.tolerance(top),
            ensemble: reader.ensemble(top, &axes),
            draws,
            objective: reader.objective(top, &metrics),
            constraints: reader.constraints(top, &metrics),
            axes,
            metrics,
            source: source.clone(),
        };
        reader.check_size(&sweep);
        if let Some(message) = sweep.column_twice() {
            reader.file.problem(None, "metrics", message);
        }
        reader.file.end(sweep)
    }
}

impl Sweep {
    /// The same with another number of runs a point.
    ///
    /// # Errors
    /// When its points are draws, or two columns of the result would have one name.
    pub fn with_ensemble(self, runs: usize) -> Result<Sweep, Problems> {
        let sweep = Sweep { ensemble: runs, ..self };
        let wrong = match sweep.is_drawn() && runs > 1 {
            true => Some(DRAWS.to_owned()),
            false => sweep.column_twice(),
        };
        let problem = |message| {
            let mut reader = Reader::new(&sweep.source.name, "");
            reader.file.problem(None, "ensemble", message);
            Problems(reader.file.problems)
        };
        wrong.map(problem).map_or(Ok(()), Err)?;
        Ok(sweep)
    }

    /// The problem if two columns of the result have one name.
    fn column_twice(&self) -> Option<String> {
        let header = self.header();
        let names: Vec<&str> = header.split(',').collect();
        let twice = (1..names.len()).find(|&place| names[..place].contains(&names[place]))?;
        Some(format!("the result would have two columns {}; choose another name", names[twice]))
    }
}

/// Why draws have no perturbed runs.
const DRAWS: &str = "draws are already an ensemble; remove ensemble";

impl Reader<'_> {
    /// The rig with its settings.
    fn rig(
        &mut self,
        top: &Table,
        find_rig: &dyn Fn(&str) -> anyhow::Result<Source>,
    ) -> Option<(Source, Rig, Vec<String>)> {
        let Some(entry) = self.entry(top, "rig") else {
            self.file.problem(None, "rig", "name the rig: rig = \"servo-b-tuned\", or a rig file".to_owned());
            return None;
        };
        let name = text(entry.item);
        let name = self.note(&entry, name)?;
        let found = find_rig(&name).map_err(|error| format!("{error:#}"));
        let source = self.note(&entry, found)?;
        if let Err(problems) = Rig::read(&source.name, &source.text) {
            self.file.problems.extend(problems.0);
            return None;
        }
        let entries = self.rig_keys(top, "set");
        let settled = self.settled(top, &entries);
        let own = entries.iter().filter_map(|entry| self.note(entry, setting(entry)));
        let settings: Vec<String> = own.chain(settled).collect();
        match Rig::read_with(&source.name, &source.text, &settings) {
            Ok(rig) => Some((source, rig, settings)),
            Err(problems) => {
                let at_all = self.entry(top, "set").and_then(|set| set.line);
                for problem in problems.0 {
                    // A contradiction may be reported at a key that is not set here.
                    let own = entries.iter().find(|entry| entry.name == problem.key);
                    let key = own.map_or(problem.key.clone(), |own| format!("set.{}", own.name));
                    self.file.problem(own.map_or(at_all, |own| own.line), &key, problem.message);
                }
                None
            }
        }
    }

    /// `settled_mm` as the key of the rig that it sets.
    fn settled(&mut self, top: &Table, set: &[Entry<'_>]) -> Option<String> {
        let (key, entry) = (&keys::test::TOLERANCE_MM, self.entry(top, "settled_mm")?);
        if set.iter().any(|entry| entry.name == key.path) {
            self.note(&entry, Err::<(), _>(format!("is also in [set], as {}; remove one of them", key.path)));
        }
        Some(key.setting(self.positive(top, "settled_mm", USUAL_TOLERANCE_MM)))
    }

    fn tolerance(&mut self, top: &Table) -> Option<f64> {
        self.entry(top, "tolerance")?;
        let tolerance = self.positive(top, "tolerance", Accuracy::default().tolerance);
        if !(1e-13..=1e-2).contains(&tolerance) {
            let line = self.entry(top, "tolerance").and_then(|entry| entry.line);
            self.file.problem(line, "tolerance", format!("must be between 1e-13 and 1e-2, is {tolerance:e}"));
        }
        Some(tolerance)
    }

    /// How many runs a point has.
    fn ensemble(&mut self, top: &Table, axes: &[Axis]) -> usize {
        let Some(entry) = self.entry(top, "ensemble") else { return 1 };
        let runs = count(entry.item, 1, MAX_RUNS).and_then(|runs| match axes.iter().any(|axis| axis.drawn) {
            true if runs > 1 => Err(DRAWS.to_owned()),
            _ => Ok(runs),
        });
        self.note(&entry, runs).unwrap_or(1)
    }

    /// The varied quantities, and the number of draws.
    fn axes(&mut self, top: &Table, rig: &Rig, settings: &[String]) -> (Vec<Axis>, usize) {
        let draw = self.draw(top);
        let mut axes: Vec<Axis> = Vec::new();
        for entry in self.rig_keys(top, "vary") {
            let read = vary::axis(&entry.name, entry.item, rig, draw, axes.len() as u64);
            let read = read.and_then(|axis| refuse_twice(&axis, settings, &axes).map(|()| axis));
            axes.extend(self.note(&entry, read));
        }
        if axes.is_empty() && self.file.problems.is_empty() {
            self.file.problem(
                None,
                "vary",
                "nothing varies; write, for example, load.mass_kg = [1.0, 2.0]".to_owned(),
            );
        }
        let drawn = axes.iter().any(|axis| axis.drawn);
        if let Some(entry) = self.entry(top, "draw").filter(|_| !drawn && self.file.problems.is_empty()) {
            self.file.problem(
                entry.line,
                "draw",
                "no key has a distribution to draw from; remove [draw]".to_owned(),
            );
        }
        (axes, draw.filter(|_| drawn).map_or(1, |draw| draw.count))
    }

    fn draw(&mut self, top: &Table) -> Option<Draw> {
        top.get("draw")?;
        let mut draw = Draw { count: 0, seed: 1, latin_hypercube: true };
        for entry in self.section(top, "draw") {
            let read = known(&entry.name, &["count", "seed", "method"]).and_then(|()| {
                match entry.name.as_str() {
                    "count" => draw.count = count(entry.item, 1, MAX_POINTS)?,
                    "seed" => draw.seed = count(entry.item, 0, usize::MAX >> 1)? as u64,
                    _ => draw.latin_hypercube = method(entry.item)?,
                }
                Ok(())
            });
            self.note(&entry, read);
        }
        if draw.count == 0 && self.file.problems.is_empty() {
            let line = self.entry(top, "draw").and_then(|entry| entry.line);
            self.file.problem(line, "draw.count", "say how many draws: count = 100".to_owned());
        }
        Some(draw)
    }

    fn metrics(&mut self, top: &Table, axes: &[Axis]) -> Vec<Metric> {
        let mut metrics: Vec<Metric> = Vec::new();
        for entry in self.section(top, "metrics") {
            let taken =
                TAKEN.contains(&entry.name.as_str()) || axes.iter().any(|axis| axis.name == entry.name);
            let read = match plain_name(&entry.name) {
                Ok(()) if taken => Err("is the name of another column; choose another".to_owned()),
                checked => checked.and_then(|()| metric(&entry)),
            };
            metrics.extend(self.note(&entry, read));
        }
        if metrics.is_empty() && self.file.problems.is_empty() {
            let message = "nothing is collected; write, for example, settling = \"settling_s\"";
            self.file.problem(None, "metrics", message.to_owned());
        }
        metrics
    }

    fn objective(&mut self, top: &Table, metrics: &[Metric]) -> Option<Objective> {
        let entries = self.section(top, "objective");
        if let Some(second) = entries.get(1) {
            self.note(second, Err::<(), _>("there can be only one objective; remove the other".to_owned()));
        }
        let entry = entries.first()?;
        let read = known(&entry.name, &["minimise", "maximise"]).and_then(|()| {
            let metric = place_of(&text(entry.item)?, metrics)?;
            Ok(Objective { metric, most: entry.name == "maximise" })
        });
        self.note(entry, read)
    }

    fn constraints(&mut self, top: &Table, metrics: &[Metric]) -> Vec<Bound> {
        let entries = self.section(top, "constraints");
        let read = entries.into_iter().map(|entry| (bound(&entry, metrics), entry));
        let read: Vec<_> = read.collect();
        read.into_iter().filter_map(|(bound, entry)| self.note(&entry, bound)).collect()
    }

    fn check_size(&mut self, sweep: &Sweep) {
        let grid = sweep.axes.iter().filter(|axis| !axis.drawn).map(|axis| axis.levels.len());
        let points = grid.chain([sweep.draws]).try_fold(1_usize, usize::checked_mul);
        if points.is_none_or(|points| points > MAX_POINTS) {
            self.file.problem(
                None,
                "vary",
                format!("that makes more than {MAX_POINTS} points; use fewer steps"),
            );
        }
    }
}

/// Refuses an axis that changes a key which is set, or which another one changes.
fn refuse_twice(axis: &Axis, settings: &[String], axes: &[Axis]) -> Result<(), String> {
    let is_set = |key: &str| settings.iter().any(|setting| setting.starts_with(&format!("{key}=")));
    let is_varied = |key: &&str| axes.iter().any(|other| other.keys().any(|own| own == *key));
    // A set value may be scaled.
    if axis.scaled.is_empty() && is_set(&axis.name) {
        return Err("is also in [set]; remove it there".to_owned());
    }
    axis.keys().find(is_varied).map_or(Ok(()), |key| Err(format!("{key} is varied twice")))
}

/// `key=value`, without the comments around it.
fn setting(entry: &Entry<'_>) -> Result<String, String> {
    let value = entry.item.as_value().ok_or("write its value after a =; for tables, a list: [{ ... }]")?;
    Ok(format!("{}={}", entry.name, value.clone().decorated("", "")))
}

fn method(item: &Item) -> Result<bool, String> {
    match text(item)?.as_str() {
        "latin-hypercube" => Ok(true),
        "random" => Ok(false),
        other => Err(format!("must be \"latin-hypercube\" or \"random\", is \"{other}\"")),
    }
}

fn metric(entry: &Entry<'_>) -> Result<Metric, String> {
    let table = entry.item.as_table_like();
    let (figure, which) = match table {
        Some(table) => {
            only(table, &["figure", "move"])?;
            let figure =
                table.get("figure").ok_or("say which figure: { figure = \"settling_s\", move = 2 }")?;
            (text(figure)?, table.get("move").map_or(Ok(MoveSelection::Worst), which)?)
        }
        None => (text(entry.item)?, MoveSelection::Worst),
    };
    let names = FIGURES.map(|figure| figure.name);
    let found = FIGURES.iter().find(|known| known.name == figure);
    let found =
        found.ok_or_else(|| format!("there is no figure \"{figure}\"{}", nearest_of(&figure, &names)))?;
    Ok(Metric { name: entry.name.clone(), figure: found, which })
}

fn which(item: &Item) -> Result<MoveSelection, String> {
    match (item.as_integer(), item.as_str()) {
        (Some(number @ 1..), _) => Ok(MoveSelection::Number(number as usize)),
        (_, Some("worst")) => Ok(MoveSelection::Worst),
        (_, Some("sum")) => Ok(MoveSelection::Sum),
        _ => Err("move must be the number of a move, from 1, or \"worst\" or \"sum\"".to_owned()),
    }
}

fn place_of(name: &str, metrics: &[Metric]) -> Result<usize, String> {
    let names: Vec<&str> = metrics.iter().map(|metric| metric.name.as_str()).collect();
    let place = names.iter().position(|known| *known == name);
    place.ok_or_else(|| format!("there is no metric \"{name}\"{}", nearest_of(name, &names)))
}

fn bound(entry: &Entry<'_>, metrics: &[Metric]) -> Result<Bound, String> {
    let form = "must be { max = 0.5 }, { min = 0.1 } or both";
    let table: &dyn TableLike = entry.item.as_table_like().ok_or(form)?;
    only(table, &["min", "max"])?;
    if table.is_empty() {
        return Err(form.to_owned());
    }
    let metric = place_of(&entry.name, metrics)?;
    let end = |name: &str, without: f64| table.get(name).map_or(Ok(without), number);
    let bound = Bound { metric, min: end("min", 0.0)?, max: end("max", f64::INFINITY)? };
    if bound.min <= bound.max { Ok(bound) } else { Err("min is more than max".to_owned()) }
}

#[cfg(test)]
mod tests;
