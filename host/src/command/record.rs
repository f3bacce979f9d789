//! `pneudrive record`.

use std::path::{Path, PathBuf};

use anyhow::Result;
use pneudrive_link::client::{self, Client, RecordChanged};
use pneudrive_link::firmware_notes::report_missing;
use pneudrive_link::part_file::{self, PartFile};
use pneudrive_records::own_file::make_writable;
use pneudrive_records::record::RecordHead;
use pneudrive_records::target::TargetFile;
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

/// Downloads the recorded transient to the next free TARGET file of a folder. An interrupted download leaves a part file
/// there, from which the next call resumes.
///
/// # Errors
/// When there is no record, the link breaks, or the folder cannot be written to.
pub fn record(client: &mut Client, folder: &Path) -> Result<(PathBuf, TargetFile)> {
    let info = client.info()?;
    let parameters = client.parameters()?;
    report_missing(&parameters);
    let head = client.record_head()?;
    let test = client.test()?;
    let (mut part, pieces) = PartFile::open(folder, &info, &head)?;
    report_parts(folder, &part, pieces.samples(), &head);
    let record = download(client, &head, &mut part, pieces);
    if record.as_ref().is_err_and(|error| error.is::<RecordChanged>()) {
        part.remove();
        return Err(record.err().unwrap_or_else(|| RecordChanged.into()));
    }
    let record = match record {
        Ok(record) => record,
        // Only what is on the disk is promised.
        Err(error) if part.keep_on_disk().is_ok() => return Err(error.context(kept(&part))),
        Err(error) => return Err(error),
    };
    let file = TargetFile::new(&record, &info, &parameters)?.with_test(test.as_ref());
    let path = file.write_next(folder)?;
    part.remove();
    Ok((path, file))
}

/// Downloads what is missing, with a bar; each chunk goes to the part file.
fn download(
    client: &mut Client,
    head: &RecordHead,
    part: &mut PartFile,
    pieces: client::Pieces,
) -> Result<pneudrive_records::record::Record> {
    let mut done = pieces.samples();
    let mut progress = Progress::new("recording");
    progress.begin_at(done as u64, head.samples as u64);
    let record = client.download(head, pieces, |first, samples| {
        part.keep(first, samples)?;
        done += samples.len() / pneudrive_protocol::RecordedSample::BYTES;
        progress.at(done as u64, head.samples as u64);
        Ok(())
    });
    progress.done();
    record
}

fn kept(part: &PartFile) -> String {
    format!(
        "the download is incomplete; {} keeps what has arrived: record again to resume",
        part.path().display()
    )
}

/// Reports what an earlier download has left of this record and of others.
fn report_parts(folder: &Path, part: &PartFile, there: usize, head: &RecordHead) {
    if there > 0 {
        tell!("resuming {}: {there} of {} samples are there", part.path().display(), head.samples);
    }
    for other in part_file::others(folder, part.path()) {
        tell!("note: {} is part of another record; delete it if you do not want the rest", other.display());
    }
}
