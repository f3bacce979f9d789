//! `pneudrive record`.

use std::path::{Path, PathBuf};

use anyhow::Result;

use super::Progress;
use crate::cli::Record;
use crate::client::Client;
use crate::run_folder::make_writable;
use crate::target::TargetFile;

pub(super) fn execute(arguments: &Record) -> Result<()> {
    make_writable(&arguments.dir)?;
    let mut client = Client::connect(&arguments.port.port)?;
    let (path, file) = record(&mut client, &arguments.dir)?;
    say!("{}: {} samples", path.display(), file.samples.len());
    Ok(())
}

/// Pulls the recorded transient into the next free TARGET file of a folder.
pub(super) fn record(client: &mut Client, folder: &Path) -> Result<(PathBuf, TargetFile)> {
    let info = client.info()?;
    let parameters = client.parameters()?;
    let mut progress = Progress::new("recording");
    let record = client.record(|done, all| progress.at(done as u64, all as u64));
    progress.done();
    let file = TargetFile::new(&record?, &info, &parameters);
    Ok((file.write_next(folder)?, file))
}
