//! Reading of TARGET files and streamed runs.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, anyhow, bail};
use pneudrive_tables::text::utf8;

use super::{CRC, FORMAT, TargetFile};
use crate::record_text::{COLUMNS, crc_text, header_text, sample_of};
use crate::stream_file;
use crate::text_file::as_written;

impl TargetFile {
    /// Parses a file's text.
    ///
    /// # Errors
    /// With the line of the problem, or when a CRC does not match.
    pub fn from_text(text: &str) -> Result<TargetFile> {
        Ok(TargetFile::read_text(text)?.0)
    }

    /// Reads a file. A note on a stream that was interrupted goes to the log.
    ///
    /// # Errors
    /// With the file and the line of the problem.
    pub fn read(path: &Path) -> Result<TargetFile> {
        let bytes = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
        let text = utf8(&bytes)
            .with_context(|| format!("{} is neither a TARGET file nor a run folder", path.display()))?;
        let (file, is_whole) = TargetFile::read_text(&text).with_context(|| path.display().to_string())?;
        if !is_whole {
            log::info!("{}: its stream was interrupted, so no checksum protects its samples", path.display());
        }
        Ok(file)
    }

    /// The file of a text, and whether a CRC covers all of it: of a stream that was interrupted it covers the header.
    fn read_text(text: &str) -> Result<(TargetFile, bool)> {
        let text = &as_written(text);
        let mut lines = text.lines().enumerate();
        let mut file = TargetFile { header: header(&mut lines)?, samples: Vec::new() };
        let ends_with_a_line = text.ends_with('\n');
        let is_whole = match file.get("format") {
            Some(FORMAT) => {
                file.samples = lines.map(|(number, line)| sample_of(number, line)).collect::<Result<_>>()?;
                file.check_crc()?;
                true
            }
            Some(stream_file::FORMAT) => {
                file.check_header_crc()?;
                let (samples, is_whole) = stream_file::samples(lines, ends_with_a_line)?;
                file.samples = samples;
                is_whole
            }
            Some(other) => {
                let (target, stream) = (FORMAT, stream_file::FORMAT);
                bail!(
                    "its format is {other:?}; this program reads {target:?} and {stream:?}: use a later version of it"
                )
            }
            None => bail!("it is not a TARGET file: its header has no `# format = {FORMAT}`"),
        };
        Ok((file, is_whole))
    }

    fn check_crc(&self) -> Result<()> {
        let stated = self.get(CRC).ok_or_else(|| anyhow!("the header has no {CRC}"))?;
        let actual = crc_text(&self.without(CRC).to_text());
        if stated != actual {
            bail!("it is damaged, truncated or changed: the CRC is {actual}, the header says {stated}");
        }
        Ok(())
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
