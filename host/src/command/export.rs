//! `pneudrive export`.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use pneudrive_logs::export::{self, FORMATS};
use pneudrive_logs::signals::Signals;
use pneudrive_records::whole_file::{is_device, put};
use serde_json::json;

use crate::cli::{Export, Format};
use crate::json;

pub(super) fn execute(arguments: &Export) -> Result<()> {
    let (format, path) = target(arguments)?;
    if path.exists() && !is_device(&path) && !arguments.overwrite {
        bail!(
            "{} already exists; choose another name with --out, or replace it with --overwrite",
            path.display()
        );
    }
    let signals = Signals::read(&arguments.file)?;
    put(&path, &export::file(&signals, format)?)?;
    let (count, samples) = (signals.signals.len(), signals.time_s.len());
    json::figures(|| json!({ "file": path, "signals": count, "samples": samples }));
    say!("{}: {count} signals, {samples} samples", path.display());
    Ok(())
}

/// The kind of file and its place.
fn target(arguments: &Export) -> Result<(export::Format, PathBuf)> {
    let ending_of = |path: &Path| path.extension().map(|ending| ending.to_string_lossy().into_owned());
    let ending = match (arguments.to, &arguments.out) {
        (Some(format), _) => ending(format).to_owned(),
        (None, Some(out)) => ending_of(out).unwrap_or_default(),
        (None, None) => bail!("choose a format with --to csv, mat, mcap or parquet, or a file with --out"),
    };
    let format = FORMATS.iter().find(|(_, name)| *name == ending).map(|(format, _)| *format);
    let format = format.with_context(|| {
        format!("{ending:?} is no format; choose one with --to csv, mat, mcap or parquet")
    })?;
    let beside = || PathBuf::from(arguments.file.file_name().unwrap_or_default()).with_extension(&ending);
    Ok((format, arguments.out.clone().unwrap_or_else(beside)))
}

fn ending(format: Format) -> &'static str {
    match format {
        Format::Csv => "csv",
        Format::Mat => "mat",
        Format::Mcap => "mcap",
        Format::Parquet => "parquet",
    }
}
