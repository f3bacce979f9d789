//! `pneudrive merge`: joins the shards of a sweep.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use pneudrive_optimise::sweep::journal::{About, Journal, Kept, NAME};
use pneudrive_optimise::sweep::{Row, Sweep};
use pneudrive_records::words::few;

use super::sweep::{leave, make_room};
use crate::cli::Merge;

pub(super) fn execute(arguments: &Merge) -> Result<()> {
    let shards: Vec<(&Path, Kept, About)> =
        arguments.folders.iter().map(|folder| read(folder)).collect::<Result<_>>()?;
    let Some((_, _, about)) = shards.first() else { bail!("name the folders of the shards") };
    let sweep = sweep_of(about)?;
    let mut rows = BTreeMap::new();
    for (folder, kept, own) in &shards {
        ensure!(
            own.identity == about.identity,
            "{} belongs to another sweep ({})",
            folder.display(),
            own.sweep.name
        );
        add(&mut rows, kept.rows(&sweep), folder)?;
    }
    refuse_gaps(&sweep, &rows)?;
    make_room(&arguments.out)?;
    let (mut journal, there) = Journal::open(&arguments.out, &sweep)?;
    for row in rows.values().filter(|row| !there.contains_key(&row.point)) {
        journal.keep(&row.to_csv(&sweep))?;
    }
    leave(&arguments.out, &sweep, rows, arguments.pages.library())
}

fn read(folder: &Path) -> Result<(&Path, Kept, About)> {
    let path = folder.join(NAME);
    let bytes = fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
    let kept = Kept::of(&path, &String::from_utf8_lossy(&bytes))?;
    let about = kept.about.clone();
    let about =
        about.with_context(|| format!("{} does not say which sweep it belongs to", path.display()))?;
    Ok((folder, kept, about))
}

/// The sweep that a journal belongs to.
fn sweep_of(about: &About) -> Result<Sweep> {
    let sweep = Sweep::read(about.sweep.clone(), |_| Ok(about.rig.clone()))?.with_ensemble(about.ensemble)?;
    ensure!(
        format!("{:016x}", sweep.identity()) == about.identity,
        "these shards were run by {}; merge them with that version",
        about.program
    );
    Ok(sweep)
}

fn add(rows: &mut BTreeMap<usize, Row>, more: BTreeMap<usize, Row>, folder: &Path) -> Result<()> {
    for (point, row) in more {
        if let Some(before) = rows.get(&point) {
            let differs = || {
                format!("point {point} in {} differs from the same point in another shard", folder.display())
            };
            ensure!(*before == row, differs());
        }
        rows.insert(point, row);
    }
    Ok(())
}

fn refuse_gaps(sweep: &Sweep, rows: &BTreeMap<usize, Row>) -> Result<()> {
    let missing = (0..sweep.points()).filter(|point| !rows.contains_key(point));
    let missing: Vec<String> = missing.map(|point| point.to_string()).collect();
    let names: Vec<&str> = missing.iter().map(String::as_str).collect();
    ensure!(
        missing.is_empty(),
        "{} of {} points are missing ({}); run their shards to completion",
        missing.len(),
        sweep.points(),
        few(&names)
    );
    Ok(())
}
