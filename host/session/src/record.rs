//! The record of the last run as a TARGET file. An interrupted download is resumed by the next one.
//!
//! ```text
//! rig     head of the record, test of the run
//! disk    part file: the chunks that an earlier download has left, and each that arrives
//! rig     the chunks that are missing
//! result  TARGET file; the part file is removed
//! ```
//!
//! The part file lies beside the TARGET files of the folder that the record goes to. A record that goes to no folder has
//! one in the user's folder of states, by the name of its port.

use std::path::{Path, PathBuf};

use anyhow::Result;
use pneudrive_link::client::{Client, Pieces, RecordChanged};
use pneudrive_protocol::RecordedSample;
use pneudrive_records::record::{Record, RecordHead};
use pneudrive_records::rig_info::Info;
use pneudrive_records::target::TargetFile;

use crate::firmware_notes::report_missing;
use crate::part_file::{self, PartFile};
use crate::state;

/// Told again and again how many samples of how many have arrived, both 0 until the rig has said how many there are. An error
/// ends the download.
pub type Watch<'a> = dyn FnMut(usize, usize) -> Result<()> + 'a;

/// Downloads the record to the next free TARGET file of a folder.
///
/// # Errors
/// When there is no record, the link breaks, the folder cannot be written to, or `watch` says so.
pub fn to_folder(client: &mut Client, folder: &Path, watch: &mut Watch<'_>) -> Result<(PathBuf, TargetFile)> {
    let open = |info: &Info, head: &RecordHead| {
        let (part, pieces) = PartFile::open(folder, info, head)?;
        for other in part_file::others(folder, part.path()) {
            log::info!(
                "{} is part of another record; delete it if you do not want the rest",
                other.display()
            );
        }
        Ok((Some(part), pieces))
    };
    let Recorded { file, part, .. } = recorded(client, open, watch)?;
    let path = file.write_next(folder)?;
    part.into_iter().for_each(PartFile::remove);
    Ok((path, file))
}

/// Downloads the record: its CRC, and what would stand in its file. Where the part file cannot be written, the download
/// goes on without one.
///
/// # Errors
/// When there is no record, the link breaks, or `watch` says so.
pub fn to_memory(client: &mut Client, watch: &mut Watch<'_>) -> Result<(u32, TargetFile)> {
    let path = state::file(client.port_name(), "part");
    let open = |info: &Info, head: &RecordHead| {
        let opened = path.and_then(|path| PartFile::at(&path, info, head));
        let none = |error| {
            log::info!("an interrupted download would begin anew: {error:#}");
            (None, Pieces::none(head.samples))
        };
        Ok(opened.map_or_else(none, |(part, pieces)| (Some(part), pieces)))
    };
    let Recorded { file, part, crc32 } = recorded(client, open, watch)?;
    part.into_iter().for_each(PartFile::remove);
    Ok((crc32, file))
}

/// A whole record, and the part file that keeps it until it is somewhere else.
struct Recorded {
    file: TargetFile,
    crc32: u32,
    part: Option<PartFile>,
}

fn recorded(
    client: &mut Client,
    open: impl FnOnce(&Info, &RecordHead) -> Result<(Option<PartFile>, Pieces)>,
    watch: &mut Watch<'_>,
) -> Result<Recorded> {
    let (info, parameters) = (client.info()?, client.parameters()?);
    report_missing(&parameters);
    let head = client.record_head_while(|| watch(0, 0))?;
    let test = client.test()?;
    let (mut part, pieces) = open(&info, &head)?;
    if let Some(part) = part.as_ref().filter(|_| pieces.samples() > 0) {
        let (path, there, all) = (part.path().display(), pieces.samples(), head.samples);
        log::info!("resuming {path}: {there} of {all} samples are there");
    }
    let record = match chunks(client, &head, part.as_mut(), pieces, watch) {
        Ok(record) => record,
        Err(error) if error.is::<RecordChanged>() => {
            part.into_iter().for_each(PartFile::remove);
            return Err(error);
        }
        // Only samples on the disk are reported as kept.
        Err(error) => {
            return Err(match part.filter(|part| part.keep_on_disk().is_ok()) {
                Some(part) => error.context(kept(&part)),
                None => error,
            });
        }
    };
    let file = TargetFile::new(&record, &info, &parameters)?.with_test(&test);
    Ok(Recorded { file, crc32: head.crc32, part })
}

/// Downloads the chunks that are missing; each goes to the part file.
fn chunks(
    client: &mut Client,
    head: &RecordHead,
    mut part: Option<&mut PartFile>,
    pieces: Pieces,
    watch: &mut Watch<'_>,
) -> Result<Record> {
    let mut done = pieces.samples();
    watch(done, head.samples)?;
    client.download(head, pieces, |first, samples| {
        part.as_mut().map_or(Ok(()), |part| part.keep(first, samples))?;
        done += samples.len() / RecordedSample::BYTES;
        watch(done, head.samples)
    })
}

fn kept(part: &PartFile) -> String {
    let path = part.path().display();
    format!("the download is incomplete; {path} keeps what has arrived: record again to resume")
}
