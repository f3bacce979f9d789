//! The journal of a sweep: a text file that only grows, so that a kill loses only the points in progress.
//!
//! First [`MARK`], then lines, each preceded by the CRC-32 of its text: JSON that identifies the sweep, and rows of the
//! result. A truncated or damaged line is skipped; its point is run again.

use std::collections::BTreeMap;
use std::fs::{File, TryLockError};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use crc::{CRC_32_ISO_HDLC, Crc};
use pneudrive_records::whole_file::open_to_add;
use serde_json::json;

use super::{Row, Source, Sweep};

/// Its first line.
pub const MARK: &str = "pneudrive-sweep 1\n";

/// Its name in the folder of a result.
pub const NAME: &str = "sweep.journal";

/// Which sweep a journal is of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct About {
    /// [`Sweep::identity`], in hexadecimal digits.
    pub identity: String,
    /// The program.
    pub program: String,
    /// The file of the sweep.
    pub sweep: Source,
    /// The file of its rig.
    pub rig: Source,
    /// Runs of a point.
    pub ensemble: usize,
}

impl About {
    fn of(sweep: &Sweep) -> About {
        About {
            identity: format!("{:016x}", sweep.identity()),
            program: format!("pneudrive {}", env!("CARGO_PKG_VERSION")),
            sweep: sweep.source.clone(),
            rig: sweep.rig_source.clone(),
            ensemble: sweep.ensemble,
        }
    }

    fn to_json(&self) -> String {
        let source = |source: &Source| json!({ "name": source.name, "text": source.text });
        json!({
            "identity": self.identity,
            "program": self.program,
            "sweep": source(&self.sweep),
            "rig": source(&self.rig),
            "ensemble": self.ensemble,
        })
        .to_string()
    }

    fn of_json(text: &str) -> Option<About> {
        let value: serde_json::Value = serde_json::from_str(text).ok()?;
        let text = |value: &serde_json::Value| value.as_str().map(str::to_owned);
        let source = |value: &serde_json::Value| {
            Some(Source { name: text(&value["name"])?, text: text(&value["text"])? })
        };
        Some(About {
            identity: text(&value["identity"])?,
            program: text(&value["program"])?,
            sweep: source(&value["sweep"])?,
            rig: source(&value["rig"])?,
            ensemble: value["ensemble"].as_u64().map_or(1, |runs| runs as usize),
        })
    }
}

/// The content of a journal.
#[derive(Clone, Debug, Default)]
pub struct Kept {
    /// Which sweep it is of; None if nothing of that was written.
    pub about: Option<About>,
    /// Lines of the result as they were written.
    pub lines: Vec<String>,
}

impl Kept {
    /// Reads a journal's text.
    ///
    /// # Errors
    /// When it is not one.
    pub fn of(path: &Path, text: &str) -> Result<Kept> {
        if !text.starts_with(MARK) && !MARK.starts_with(text) {
            bail!("{} was not written by this program; choose another folder (--out)", path.display());
        }
        let mut kept = Kept::default();
        for line in text.lines().filter_map(checked) {
            match About::of_json(line) {
                // The text of the sweep may have changed where it makes no difference: the last one holds.
                Some(about) => kept.about = Some(about),
                None => kept.lines.push(line.to_owned()),
            }
        }
        Ok(kept)
    }

    /// The rows, by their points.
    #[must_use]
    pub fn rows(&self, sweep: &Sweep) -> BTreeMap<usize, Row> {
        let rows = self.lines.iter().filter_map(|line| Row::of_csv(sweep, line));
        rows.map(|row| (row.point, row)).collect()
    }
}

/// The text behind a CRC that fits.
fn checked(line: &str) -> Option<&str> {
    let (crc, text) = line.split_once(' ')?;
    (crc == crc_of(text)).then_some(text)
}

fn crc_of(text: &str) -> String {
    format!("{:08x}", Crc::<u32>::new(&CRC_32_ISO_HDLC).checksum(text.as_bytes()))
}

/// A journal that is open for appending. No other program can open it meanwhile.
#[derive(Debug)]
pub struct Journal {
    file: File,
    path: PathBuf,
}

impl Journal {
    /// Opens the journal of a sweep in a folder, or begins one; with the rows that are there.
    ///
    /// # Errors
    /// When it is of another sweep, in use, or cannot be read or written.
    pub fn open(folder: &Path, sweep: &Sweep) -> Result<(Journal, BTreeMap<usize, Row>)> {
        let path = folder.join(NAME);
        let cannot = || format!("cannot continue {}", path.display());
        let mut file = open_to_add(&path).with_context(cannot)?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => bail!("{} is in use by another sweep", path.display()),
            Err(TryLockError::Error(error)) => return Err(error).with_context(cannot),
            Ok(()) => {}
        }
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).with_context(cannot)?;
        let text = String::from_utf8_lossy(&bytes);
        let kept = Kept::of(&path, &text)?;
        let mut journal = Journal { file, path };
        journal.begin(&About::of(sweep), &kept, &text)?;
        Ok((journal, kept.rows(sweep)))
    }

    /// Writes the missing lines before rows can follow.
    fn begin(&mut self, about: &About, kept: &Kept, text: &str) -> Result<()> {
        match &kept.about {
            Some(before) if before.identity != about.identity => bail!(
                "{} belongs to another sweep ({}{}); delete it, or choose another folder (--out)",
                self.path.display(),
                before.sweep.name,
                if before.program == about.program { "" } else { ", by another version of the program" },
            ),
            None if !kept.lines.is_empty() => {
                bail!("{} does not say which sweep it belongs to; delete it", self.path.display())
            }
            _ => {}
        }
        if !text.starts_with(MARK) {
            self.append(&MARK[text.len()..])?;
        } else if !text.ends_with('\n') {
            self.append("\n")?;
        }
        if kept.about.as_ref() == Some(about) { Ok(()) } else { self.keep(&about.to_json()) }
    }

    /// Adds a line.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn keep(&mut self, line: &str) -> Result<()> {
        self.append(&format!("{} {line}\n", crc_of(line)))
    }

    fn append(&mut self, text: &str) -> Result<()> {
        self.file.write_all(text.as_bytes()).with_context(|| format!("cannot write {}", self.path.display()))
    }
}
