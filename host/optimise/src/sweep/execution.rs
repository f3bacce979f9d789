//! The points of a sweep on all threads of the pool.
//!
//! A row does not depend on the thread or the time at which its point is run, and rows come out in the order of points.

use std::collections::BTreeMap;

use anyhow::Result;

use super::journal::Journal;
use super::point::Points;
use super::{Row, Sweep};
use pneudrive_evaluate::parallel;

/// A part of all points: every `of`th, from the `number`th on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// From 1.
    pub number: usize,
    /// How many parts there are.
    pub of: usize,
}

impl Shard {
    /// All points.
    pub const WHOLE: Shard = Shard { number: 1, of: 1 };

    /// Its points.
    pub fn points(&self, sweep: &Sweep) -> impl Iterator<Item = usize> {
        (self.number - 1..sweep.points()).step_by(self.of)
    }
}

/// Runs the points of a shard that are not among `done` and adds each to journal and `done` when it comes;
/// `progress` is given points done and points of the shard.
///
/// # Errors
/// When the journal cannot be written.
pub fn execute(
    sweep: &Sweep,
    shard: Shard,
    journal: &mut Journal,
    done: &mut BTreeMap<usize, Row>,
    mut progress: impl FnMut(usize, usize) + Send,
) -> Result<()> {
    let all = shard.points(sweep).count();
    let todo = todo(sweep, shard, done);
    let before = all - todo.len();
    progress(before, all);
    run_points(sweep, &todo, journal, done, |finished| progress(before + finished, all))
}

/// The points of a shard that are not among `done`.
#[must_use]
pub fn todo(sweep: &Sweep, shard: Shard, done: &BTreeMap<usize, Row>) -> Vec<usize> {
    shard.points(sweep).filter(|point| !done.contains_key(point)).collect()
}

/// Runs these points; `progress` is given how many of them are done.
///
/// # Errors
/// As [`execute`].
pub fn run_points(
    sweep: &Sweep,
    todo: &[usize],
    journal: &mut Journal,
    done: &mut BTreeMap<usize, Row>,
    mut progress: impl FnMut(usize) + Send,
) -> Result<()> {
    let mut finished = 0;
    let keep = |row: Row| {
        journal.keep(&row.to_csv(sweep))?;
        done.insert(row.point, row);
        finished += 1;
        progress(finished);
        Ok(())
    };
    each_point(sweep, todo, keep)
}

/// Runs these points, and gives the row of each to `keep` when it comes. After an error no further point begins.
///
/// # Errors
/// The first one of `keep`.
pub fn each_point(sweep: &Sweep, todo: &[usize], keep: impl FnMut(Row) -> Result<()> + Send) -> Result<()> {
    let points = Points::of(sweep);
    parallel::each(todo, |point| points.run(*point), keep)
}
