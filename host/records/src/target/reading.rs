//! Reading of TARGET files and streamed runs.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, anyhow, bail};
use pneudrive_tables::text::utf8;

use super::{CRC, FORMAT, FORMAT_1, TargetFile};
use crate::record_text::{COLUMNS, crc_text, data_lines, header_text, sample_of};
use crate::stream_file;
use crate::text_file::as_written;

/// The part of a file that its checksums cover.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Covered {
    /// All of it.
    Whole,
    /// The header of a stream that was interrupted.
    Header,
    /// The samples of a TARGET file of format 1.
    Samples,
    /// Nothing of a stream of format 1.
    Nothing,
}

impl Covered {
    /// A note on the part that is not covered.
    fn note(self) -> Option<&'static str> {
        match self {
            Covered::Whole => None,
            Covered::Header => Some("its stream was interrupted, so no checksum protects its samples"),
            Covered::Samples => Some(
                "it is of format 1, whose CRC covers only the samples: changed scales or parameters in its header cannot be detected",
            ),
            Covered::Nothing => {
                Some("it is a stream of format 1, which has no CRC: changes cannot be detected")
            }
        }
    }
}

impl TargetFile {
    /// Parses a file's text.
    ///
    /// # Errors
    /// With the line of the problem, or when a CRC does not match.
    pub fn from_text(text: &str) -> Result<TargetFile> {
        Ok(TargetFile::read_text(text)?.0)
    }

    /// Reads a file. A note on a part that its CRC does not cover goes to the log.
    ///
    /// # Errors
    /// With the file and the line of the problem.
    pub fn read(path: &Path) -> Result<TargetFile> {
        let bytes = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
        let text = utf8(&bytes)
            .with_context(|| format!("{} is neither a TARGET file nor a run folder", path.display()))?;
        let (file, covered) = TargetFile::read_text(&text).with_context(|| path.display().to_string())?;
        if let Some(note) = covered.note() {
            log::info!("{}: {note}", path.display());
        }
        Ok(file)
    }

    /// The file of a text, and the part of it that a CRC covers.
    pub(crate) fn read_text(text: &str) -> Result<(TargetFile, Covered)> {
        let text = &as_written(text);
        let mut lines = text.lines().enumerate();
        let mut file = TargetFile { header: header(&mut lines)?, samples: Vec::new() };
        let ends_with_a_line = text.ends_with('\n');
        let covered = match file.get("format") {
            Some(FORMAT | FORMAT_1) => {
                file.samples = lines.map(|(number, line)| sample_of(number, line)).collect::<Result<_>>()?;
                file.check_crc()?
            }
            Some(stream_file::FORMAT) => {
                file.check_header_crc()?;
                let (samples, whole) = stream_file::samples(lines, ends_with_a_line)?;
                file.samples = samples;
                if whole { Covered::Whole } else { Covered::Header }
            }
            Some(stream_file::FORMAT_1) => {
                file.samples = stream_file::samples(lines, ends_with_a_line)?.0;
                Covered::Nothing
            }
            Some(other) => {
                let (target, stream) = (FORMAT, stream_file::FORMAT);
                bail!("its format is {other:?}; this program reads {target:?}, {stream:?} and earlier ones")
            }
            None => bail!("it is not a TARGET file: its header has no `# format = {FORMAT}`"),
        };
        Ok((file, covered))
    }

    fn check_crc(&self) -> Result<Covered> {
        let stated = self.get(CRC).ok_or_else(|| anyhow!("the header has no {CRC}"))?;
        let (text, covered) = match self.get("format") {
            Some(FORMAT_1) => (data_lines(&self.samples), Covered::Samples),
            _ => (self.without(CRC).to_text(), Covered::Whole),
        };
        let actual = crc_text(&text);
        if stated != actual {
            let what = if covered == Covered::Whole { "it is" } else { "its data are" };
            bail!("{what} damaged, truncated or changed: the CRC is {actual}, the header says {stated}");
        }
        Ok(covered)
    }

    fn check_header_crc(&self) -> Result<()> {
        let key = stream_file::HEADER_CRC;
        let stated = self.get(key).ok_or_else(|| anyhow!("the header has no {key}"))?;
        let actual = crc_text(&header_text(&self.without(key).header));
        if stated != actual {
            bail!("its header is damaged or changed: the CRC is {actual}, the header says {stated}");
        }
        Ok(())
    }

    fn without(&self, key: &str) -> TargetFile {
        let lines = self.header.iter().filter(|(name, _)| name != key);
        TargetFile { header: lines.cloned().collect(), samples: self.samples.clone() }
    }
}

/// The lines `# key = value`, each key once, up to the header of the samples.
fn header<'a>(lines: &mut impl Iterator<Item = (usize, &'a str)>) -> Result<Vec<(String, String)>> {
    let mut header: Vec<(String, String)> = Vec::new();
    for (number, line) in lines {
        // A file that was converted repeatedly may end its lines with more than one CR.
        let line = line.trim_end_matches('\r');
        if line == COLUMNS {
            return Ok(header);
        }
        let pair = line.strip_prefix("# ").and_then(|line| line.split_once(" = "));
        let Some((key, value)) = pair else {
            bail!("line {}: expected `# key = value` or `{COLUMNS}`, found {line:?}", number + 1);
        };
        if let Some(before) = header.iter().position(|(name, _)| name == key) {
            bail!("line {}: {key} is already set in line {}", number + 1, before + 1);
        }
        header.push((key.to_owned(), value.to_owned()));
    }
    bail!("the file ends before its data: it has no line `{COLUMNS}`");
}
