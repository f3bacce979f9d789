//! The part file of an interrupted download: it lies beside the TARGET files, or in the folder of states, until the record is
//! complete.
//!
//! It holds frames of replies as they came over the link ([`pneudrive_protocol::frame`]): first the rig's identity and
//! the head of its record, then the chunks. It is read like a link: a frame that was cut when the program was killed, or
//! damaged since, is skipped and downloaded again. Beside TARGET files its name has the CRC of the record; a download resumes
//! only if everything known of rig and record is the same.

use std::fs::{self, File};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow};
use pneudrive_link::client::Pieces;
use pneudrive_protocol::frame::DELIMITER;
use pneudrive_protocol::{Accumulator, MAX_FRAME, Reply, ReplyBody, decode_reply, encode};
use pneudrive_records::record::RecordHead;
use pneudrive_records::rig_info::Info;
use pneudrive_records::whole_file::{open_to_add, sync_folder};

/// A part file, to which chunks are added.
#[derive(Debug)]
pub struct PartFile {
    path: PathBuf,
    file: File,
}

impl PartFile {
    /// The part file of a record in a folder, and the pieces of the record in it; none in a new file.
    ///
    /// # Errors
    /// When the folder cannot be written to.
    pub fn open(folder: &Path, info: &Info, head: &RecordHead) -> Result<(PartFile, Pieces)> {
        PartFile::at(&folder.join(format!("TARGET-{:08x}.part", head.crc32)), info, head)
    }

    /// The same at a path, where the part of another record is replaced.
    ///
    /// # Errors
    /// As for [`PartFile::open`].
    pub fn at(path: &Path, info: &Info, head: &RecordHead) -> Result<(PartFile, Pieces)> {
        let (path, folder) = (path.to_owned(), path.parent().unwrap_or(path));
        fs::create_dir_all(folder).with_context(|| format!("cannot make the folder {}", folder.display()))?;
        let cannot = |error| anyhow::Error::new(error).context(format!("cannot write {}", path.display()));
        let mut file = open_to_add(&path).map_err(cannot)?;
        let mut old = Vec::new();
        file.read_to_end(&mut old).map_err(cannot)?;
        let pieces = read(&old, info, head);
        if pieces.is_none() {
            // It belongs to another record, or is not a part file.
            file.set_len(0).map_err(cannot)?;
        }
        let mut part = PartFile { path, file };
        match pieces {
            // Terminates a frame that was cut.
            Some(_) => part.append(&[DELIMITER])?,
            None => {
                part.add(&who(info))?;
                part.add(&ReplyBody::RecordInfo(head.info()))?;
            }
        }
        Ok((part, pieces.unwrap_or_else(|| Pieces::none(head.samples))))
    }

    /// Its path.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Adds a chunk.
    ///
    /// # Errors
    /// When the disk does not take it.
    pub fn keep(&mut self, first: usize, samples: &[u8]) -> Result<()> {
        self.add(&ReplyBody::Chunk { first: first as u32, samples })
    }

    /// Adds a frame in one piece: if the program is killed, the file has all of it or none, as far as the system allows.
    fn add(&mut self, body: &ReplyBody<'_>) -> Result<()> {
        let mut frame = [0; MAX_FRAME];
        let frame = encode(&Reply { sequence: 0, body: *body }, &mut frame)
            .ok_or_else(|| anyhow!("the rig's description of itself is too long"))?;
        self.append(frame)
    }

    fn append(&mut self, bytes: &[u8]) -> Result<()> {
        self.file.write_all(bytes).with_context(|| format!("cannot write {}", self.path.display()))
    }

    /// Brings the file to the disk, as the download stops here.
    ///
    /// # Errors
    /// When the disk does not take it.
    pub(crate) fn keep_on_disk(&self) -> Result<()> {
        self.file.sync_all().with_context(|| format!("cannot write {}", self.path.display()))?;
        self.path.parent().into_iter().for_each(sync_folder);
        Ok(())
    }

    /// Removes the file: the record is complete, or never will be.
    pub fn remove(self) {
        let _ = fs::remove_file(self.path);
    }
}

/// Part files of other records in the same folder: they stay until they are resumed or deleted.
#[must_use]
pub fn others(folder: &Path, than: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let is_part = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.starts_with("TARGET-") && name.ends_with(".part") && path.file_name() != than.file_name()
    };
    let mut others: Vec<PathBuf> = entries.filter(is_part).collect();
    others.sort();
    others
}

fn who(info: &Info) -> ReplyBody<'_> {
    ReplyBody::Info {
        version: info.version,
        firmware: &info.firmware,
        build: &info.build,
        board: &info.board,
        record_capacity: info.record_capacity,
    }
}

/// The pieces of a record in the bytes of a part file; None if it belongs to another record.
#[must_use]
pub fn read(bytes: &[u8], info: &Info, head: &RecordHead) -> Option<Pieces> {
    let (mut same_rig, mut same_record) = (false, false);
    let mut pieces = Pieces::none(head.samples);
    let mut accumulator: Accumulator = Accumulator::new();
    // A file that was cut just before its last delimiter gets one here.
    for &byte in bytes.iter().chain(&[DELIMITER]) {
        let Some(Ok(message)) = accumulator.push(byte) else { continue };
        match decode_reply(message).ok()?.body {
            body @ ReplyBody::Info { .. } => same_rig = body == who(info),
            ReplyBody::RecordInfo(stored) => {
                same_record = head.is_of_the_same_record(&RecordHead::from(&stored));
            }
            ReplyBody::Chunk { first, samples } if same_rig && same_record => {
                pieces.take(first as usize, samples);
            }
            _ => return None,
        }
    }
    (same_rig && same_record).then_some(pieces)
}

#[cfg(test)]
mod tests {
    use pneudrive_protocol::{CHUNK_SAMPLES, RecordedSample};

    use super::*;

    const CHUNK: [u8; CHUNK_SAMPLES * RecordedSample::BYTES] = [7; CHUNK_SAMPLES * RecordedSample::BYTES];

    fn info(build: &str) -> Info {
        Info {
            version: 3,
            firmware: "pneudrive 0.1.0".to_owned(),
            build: build.to_owned(),
            board: "virtual rig".to_owned(),
            record_capacity: 4389,
        }
    }

    fn head(test: &str) -> RecordHead {
        RecordHead {
            test: test.to_owned(),
            samples: 100,
            first_index: 0,
            decimation: 1,
            pre_trigger: 0,
            measured_period_ns: 1_300_000,
            mean_spool_raw: 5,
            crc32: 0xcbf4_3926,
        }
    }

    fn open(folder: &Path, build: &str, test: &str) -> (PartFile, usize) {
        let (part, pieces) = PartFile::open(folder, &info(build), &head(test)).expect("a folder to write to");
        (part, pieces.samples())
    }

    #[test]
    fn what_was_kept_is_there_again_whatever_the_clock_of_the_board_has_measured_since() {
        let folder = tempfile::tempdir().expect("a folder");
        let (mut part, before) = open(folder.path(), "a", "step");
        assert_eq!(before, 0);
        assert_eq!(part.path().file_name().expect("a name"), "TARGET-cbf43926.part");
        part.keep(32, &CHUNK).expect("written");
        drop(part);
        let later = RecordHead { measured_period_ns: 1_300_001, ..head("step") };
        let (part, pieces) = PartFile::open(folder.path(), &info("a"), &later).expect("there");
        assert_eq!(pieces.samples(), 32);
        part.remove();
        assert_eq!(open(folder.path(), "a", "step").1, 0);
    }

    #[test]
    fn a_part_of_another_record_or_rig_is_never_gone_on_with() {
        let folder = tempfile::tempdir().expect("a folder");
        for (build, test) in [("a", "ramp"), ("b", "ramp"), ("b", "step"), ("a", "step")] {
            let (mut part, before) = open(folder.path(), build, test);
            assert_eq!(before, 0, "{build} {test}");
            part.keep(0, &CHUNK).expect("written");
        }
    }

    #[test]
    fn a_file_that_was_cut_anywhere_is_gone_on_with_and_what_is_added_then_counts() {
        let folder = tempfile::tempdir().expect("a folder");
        let (mut part, _) = open(folder.path(), "a", "step");
        for first in [0, 32] {
            part.keep(first, &CHUNK).expect("written");
        }
        let whole = fs::read(part.path()).expect("there");
        for end in 0..whole.len() {
            fs::write(part.path(), &whole[..end]).expect("written");
            let (mut again, before) = open(folder.path(), "a", "step");
            assert!(before <= 64 && before.is_multiple_of(32));
            again.keep(64, &CHUNK).expect("written");
            assert_eq!(open(folder.path(), "a", "step").1, before + 32, "cut after {end} bytes");
        }
    }

    #[test]
    fn damage_costs_the_chunks_it_touches() {
        let folder = tempfile::tempdir().expect("a folder");
        let (mut part, _) = open(folder.path(), "a", "step");
        for first in [0, 32, 64] {
            part.keep(first, &CHUNK).expect("written");
        }
        let mut bytes = fs::read(part.path()).expect("there");
        let middle = bytes.len() - 700;
        bytes[middle] ^= 4;
        fs::write(part.path(), bytes).expect("written");
        assert_eq!(open(folder.path(), "a", "step").1, 64);
    }

    #[test]
    fn parts_of_other_records_are_found() {
        let folder = tempfile::tempdir().expect("a folder");
        let (part, _) = open(folder.path(), "a", "step");
        fs::write(folder.path().join("TARGET-00000001.part"), "x").expect("written");
        fs::write(folder.path().join("TARGET01.DAT"), "x").expect("written");
        let found = others(folder.path(), part.path());
        assert_eq!(found, [folder.path().join("TARGET-00000001.part")]);
    }
}
