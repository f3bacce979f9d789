//! `pneudrive sweep`.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Result, bail};
use pneudrive_optimise::sweep::execution::{execute as run_shard, run_points, todo};
use pneudrive_optimise::sweep::journal::{Journal, NAME};
use pneudrive_optimise::sweep::{HEADER_END, Row, Source, Sweep, numbers, report};
use pneudrive_records::own_file::{GENERATOR, make_writable, refuse_to_replace};
use pneudrive_records::text_file;
use pneudrive_records::whole_file::put;
use pneudrive_report::Library;
use pneudrive_sim::rigfile::builtin;

use super::long_work::{about, allow};
use super::progress::Progress;
use super::rig_source::rig_text;
use super::threads;
use crate::{cli, json};

pub(super) fn execute(arguments: &cli::Sweep) -> Result<()> {
    let sweep = read(arguments)?;
    let out = arguments.out.clone().unwrap_or_else(|| folder_of(&arguments.file));
    make_room(&out)?;
    let (mut journal, mut rows) = Journal::open(&out, &sweep)?;
    let threads = threads::prepare(arguments.threads)?;
    if !rows.is_empty() {
        say!("{}: {} points are already done", out.join(NAME).display(), rows.len());
    }
    try_out(&sweep, arguments, threads, &mut journal, &mut rows)?;
    let mut progress = Progress::of("sweeping", "points");
    let there = arguments.shard.points(&sweep).filter(|point| rows.contains_key(point)).count();
    progress.begin_at(there as u64, arguments.shard.points(&sweep).count() as u64);
    run_shard(&sweep, arguments.shard, &mut journal, &mut rows, |done, all| {
        progress.at(done as u64, all as u64);
    })?;
    progress.done();
    if rows.len() < sweep.points() {
        let (there, all) = (rows.len(), sweep.points());
        say!("{}: {there} of {all} points; pneudrive merge joins the shards", out.display());
        let rows: Vec<Row> = rows.into_values().collect();
        json::figures(|| numbers::to_json(&sweep, &rows));
        return Ok(());
    }
    leave(&out, &sweep, rows, arguments.pages.library())
}

/// Reports the size of the sweep and, after its first points, how long it will take.
fn try_out(
    sweep: &Sweep,
    arguments: &cli::Sweep,
    threads: NonZeroUsize,
    journal: &mut Journal,
    rows: &mut BTreeMap<usize, Row>,
) -> Result<()> {
    let todo = todo(sweep, arguments.shard, rows);
    let left = match todo.len() {
        all if all == arguments.shard.points(sweep).count() => String::new(),
        left => format!(" {left} of them still to be run,"),
    };
    tell!("sweeping: {},{left} on {threads} threads", size(sweep));
    if todo.len() <= 2 * threads.get() {
        return Ok(());
    }
    // One for each thread, spread over the sweep: points at its corners may take different times.
    let first: Vec<usize> = todo.iter().copied().step_by(todo.len().div_ceil(threads.get())).collect();
    let begun = Instant::now();
    run_points(sweep, &first, journal, rows, |_| {})?;
    let rest = todo.len() - first.len();
    let lasts = begun.elapsed().mul_f64(rest as f64 / first.len() as f64);
    tell!("sweeping: {} for the other {rest}, estimated from the first {}", about(lasts), first.len());
    allow("the sweep", lasts, arguments.yes)
}

/// The number of points, and the runs or draws of each.
fn size(sweep: &Sweep) -> String {
    let (points, draws) = (sweep.points(), sweep.draws);
    match (sweep.is_drawn(), sweep.ensemble) {
        (true, _) => format!("{} combinations x {draws} draws = {points} points", points / draws),
        (false, 1) => format!("{points} points"),
        (false, runs) => format!("{points} points x {runs} runs"),
    }
}

/// The folder named after a file.
fn folder_of(file: &Path) -> PathBuf {
    PathBuf::from(file.file_stem().filter(|stem| Path::new(stem) != file).unwrap_or("sweep".as_ref()))
}

fn read(arguments: &cli::Sweep) -> Result<Sweep> {
    let file = &arguments.file;
    let text = text_file::read(file)?;
    let beside = |rig: &str| {
        let place = file.parent().unwrap_or(Path::new("")).join(rig);
        let rig = if builtin(rig).is_some() { rig.to_owned() } else { place.display().to_string() };
        let (name, text) = rig_text(&rig)?;
        Ok(Source { name, text })
    };
    let sweep = Sweep::read(Source { name: file.display().to_string(), text }, beside)?;
    match arguments.ensemble {
        Some(runs) => Ok(sweep.with_ensemble(usize::from(runs))?),
        None => Ok(sweep),
    }
}

/// Checks before long work that the result can be written there.
pub(super) fn make_room(out: &Path) -> Result<()> {
    make_writable(out)?;
    refuse_to_replace(&out.join("sweep.csv"), HEADER_END)?;
    refuse_to_replace(&out.join("sweep.html"), GENERATOR)
}

/// Writes the result and the page of all points, and prints a summary.
pub(super) fn leave(out: &Path, sweep: &Sweep, rows: BTreeMap<usize, Row>, library: Library) -> Result<()> {
    let rows: Vec<Row> = rows.into_values().collect();
    let lines = std::iter::once(sweep.header()).chain(rows.iter().map(|row| row.to_csv(sweep)));
    put(&out.join("sweep.csv"), &lines.map(|line| line + "\n").collect::<String>())?;
    #[cfg(feature = "parquet")]
    put(&out.join("sweep.parquet"), &pneudrive_optimise::sweep::parquet::file(sweep, &rows)?)?;
    report::page(sweep, &rows).write(&out.join("sweep.html"), library)?;
    json::figures(|| numbers::to_json(sweep, &rows));
    say!("{}", report::count(sweep, &rows));
    let best = report::best(sweep, &rows);
    if !best.rows.is_empty() {
        say!("\n{}\n{}", best.heading, best.to_text());
    }
    let combinations = report::combinations(sweep, &rows);
    if !combinations.rows.is_empty() {
        say!("{}\n{}", combinations.heading, combinations.to_text());
    }
    let parquet = if cfg!(feature = "parquet") { "sweep.parquet, " } else { "" };
    say!("{}: sweep.csv, {parquet}sweep.html", out.display());
    if let Some(first) = rows.iter().find(|row| !row.failure.is_empty())
        && rows.iter().all(|row| !row.failure.is_empty())
    {
        bail!("every point failed; the first: {}", first.failure);
    }
    Ok(())
}
