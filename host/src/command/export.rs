//! `pneudrive export`.

use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use pneudrive_logs::export::{self, FORMATS};
use pneudrive_logs::signals::Signals;
use pneudrive_records::whole_file::{is_device, put};
use serde_json::json;

use crate::cli::Export;
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
    let ending = arguments.out.as_deref().and_then(Path::extension).unwrap_or_default();
    let of = |(_, word, usual): &&(_, &str, &str)| match &arguments.to {
        Some(to) => word == to,
        None => *usual == ending,
    };
    let Some((format, _, usual)) = FORMATS.iter().find(of) else {
        let words = FORMATS.map(|(_, word, _)| word).join(", ");
        match &arguments.out {
            Some(_) => bail!("{ending:?} is no format; choose one with --to: {words}"),
            None => bail!("choose a format with --to ({words}), or a file with --out"),
        }
    };
    let beside = || PathBuf::from(arguments.file.file_name().unwrap_or_default()).with_extension(usual);
    Ok((*format, arguments.out.clone().unwrap_or_else(beside)))
}
