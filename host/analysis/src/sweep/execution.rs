//! The points of a sweep on all cores.
//!
//! Each thread takes the next point as soon as it is free. Which thread runs a point, and when, changes
//! nothing in its row, and rows come out in the order of their points.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::thread;

use anyhow::Result;

use super::journal::Journal;
use super::point::run_point;
use super::{Row, Sweep};

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
    threads: NonZeroUsize,
    journal: &mut Journal,
    done: &mut BTreeMap<usize, Row>,
    mut progress: impl FnMut(usize, usize),
) -> Result<()> {
    let all = shard.points(sweep).count();
    let todo = todo(sweep, shard, done);
    let before = all - todo.len();
    progress(before, all);
    run_points(sweep, &todo, threads, journal, done, |finished| progress(before + finished, all))
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
    threads: NonZeroUsize,
    journal: &mut Journal,
    done: &mut BTreeMap<usize, Row>,
    mut progress: impl FnMut(usize),
) -> Result<()> {
    let mut finished = 0;
    let next = AtomicUsize::new(0);
    thread::scope(|scope| {
        let (give, rows) = channel();
        for _ in 0..threads.get().min(todo.len()) {
            let (give, next) = (give.clone(), &next);
            scope.spawn(move || work(sweep, todo, next, &give));
        }
        drop(give);
        // If the journal fails, nobody takes the rows any more and the threads end with their points.
        for row in rows {
            journal.keep(&row.to_csv(sweep))?;
            done.insert(row.point, row);
            finished += 1;
            progress(finished);
        }
        Ok(())
    })
}

/// One thread: point after point while somebody takes the rows.
fn work(sweep: &Sweep, todo: &[usize], next: &AtomicUsize, give: &Sender<Row>) {
    while let Some(&point) = todo.get(next.fetch_add(1, Ordering::Relaxed)) {
        if give.send(run_point(sweep, point)).is_err() {
            break;
        }
    }
}
