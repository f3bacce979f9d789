//! `pneudrive record`.

use std::path::{Path, PathBuf};

use anyhow::Result;
use pneudrive_link::client::Client;
use pneudrive_records::own_file::make_writable;
use pneudrive_records::target::TargetFile;
use pneudrive_session::record::to_folder;
use serde_json::json;

use super::progress::Progress;
use crate::cli::Record;
use crate::json;

pub(super) fn execute(arguments: &Record) -> Result<()> {
    make_writable(&arguments.dir)?;
    let mut client = arguments.port.connect()?;
    let (path, file) = record(&mut client, &arguments.dir)?;
    json::figures(|| json!({ "file": path, "samples": file.samples.len() }));
    say!("{}: {} samples", path.display(), file.samples.len());
    Ok(())
}

/// Downloads the record to the next free TARGET file of a folder, with a bar.
pub(super) fn record(client: &mut Client, folder: &Path) -> Result<(PathBuf, TargetFile)> {
    let mut progress: Option<Progress> = None;
    let recorded = to_folder(client, folder, &mut |done, all| {
        if all > 0 {
            let (done, all) = (done as u64, all as u64);
            let begin = || {
                let mut progress = Progress::new("recording");
                progress.begin_at(done, all);
                progress
            };
            progress.get_or_insert_with(begin).at(done, all);
        }
        Ok(())
    });
    progress.into_iter().for_each(Progress::done);
    recorded
}
