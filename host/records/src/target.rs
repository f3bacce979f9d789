//! TARGETxx.DAT: a recorded transient as a text file (thesis 5.5.2), as specified in DESIGN section 3.
//!
//! A file is written whole or not at all, and never over another one. Its CRC covers every line but its own. From version 1
//! on the format is append-only: a later program adds header lines, and reads files without them.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, bail};
use pneudrive_controller::Sequence;
use pneudrive_protocol::RecordedSample;

use crate::record::Record;
pub use crate::record_text::UNKNOWN;
use crate::record_text::{COLUMNS, crc_text, data_lines, described, header_text};
use crate::rig_info::{Info, RigParameters};
use crate::stream_file;
use crate::test_lines;
use crate::whole_file::{Staged, sync_folder};

mod reading;

/// The value of the first line.
pub const FORMAT: &str = "pneudrive-target 1";

/// Key of a record that was made from the log of another recorder: the name of that log.
pub const IMPORTED: &str = "imported";

/// Key of the header's last line: the CRC of all other lines.
const CRC: &str = "crc32";

/// A TARGET file, or the file of a streamed run.
#[derive(Clone, Debug, PartialEq)]
pub struct TargetFile {
    /// The `# key = value` lines, in order.
    pub header: Vec<(String, String)>,
    /// Index k and channels of the stored samples.
    pub samples: Vec<(i32, RecordedSample)>,
}

impl TargetFile {
    /// The file of a record, with everything that is needed to read it.
    ///
    /// # Errors
    /// When a sample has an index that is too large for a file.
    pub fn new(record: &Record, info: &Info, parameters: &RigParameters) -> Result<TargetFile> {
        let head = &record.head;
        let mut header = described(FORMAT, &head.test, info, parameters);
        let place = header.iter().position(|(key, _)| key == "mm_per_count").unwrap_or(header.len());
        let taken = [
            ("measured_period_us", format!("{}", f64::from(head.measured_period_ns) / 1e3)),
            ("decimation", head.decimation.to_string()),
            ("pre_trigger", head.pre_trigger.to_string()),
        ];
        header.splice(place..place, taken.map(|(key, value)| (key.to_owned(), value)));
        let place = header.iter().position(|(key, _)| key.starts_with("param.")).unwrap_or(header.len());
        header.insert(place, ("mean_spool_raw".to_owned(), head.mean_spool_raw.to_string()));
        let numbered = head.indices().zip(&record.samples).map(|(index, sample)| numbered(index, *sample));
        let samples: Vec<(i32, RecordedSample)> = numbered.collect::<Result<_>>()?;
        let mut file = TargetFile { header, samples };
        file.seal();
        Ok(file)
    }

    /// The same with the test that was run.
    #[must_use]
    pub fn with_test(mut self, test: &Sequence) -> TargetFile {
        self.header.extend(test_lines::lines(test));
        self.seal();
        self
    }

    /// Writes the CRC of the current content into the last header line.
    pub fn seal(&mut self) {
        self.header.retain(|(key, _)| key != CRC);
        self.header.push((CRC.to_owned(), crc_text(&self.to_text())));
    }

    /// The value of a header line.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&str> {
        self.header.iter().find(|(name, _)| name == key).map(|(_, value)| value.as_str())
    }

    /// Whether a channel was not measured, because the rig has no sensor of it, or the log of this record did not
    /// have it: `pressure_1`, `pressure_2`, `spool` or `setpoint`.
    #[must_use]
    pub fn is_unknown(&self, channel: &str) -> bool {
        self.get(UNKNOWN).is_some_and(|unknown| unknown.split(',').any(|name| name == channel))
    }

    /// A number of the header.
    ///
    /// # Errors
    /// When the header has no such line, or its value is not a number.
    pub fn number(&self, key: &str) -> Result<f64> {
        let text = self.get(key).ok_or_else(|| anyhow!("the header has no line `# {key} = ...`"))?;
        let number = text.parse().ok().filter(|number: &f64| number.is_finite());
        number.ok_or_else(|| anyhow!("the header's {key} is {text:?}, not a number"))
    }

    /// A number of the header that must be above 0.
    ///
    /// # Errors
    /// When the header has no such line, or its value is not such a number.
    pub fn positive(&self, key: &str) -> Result<f64> {
        match self.number(key)? {
            number if number > 0.0 => Ok(number),
            number => bail!("the header's {key} is {number}; it must be more than 0"),
        }
    }

    /// The text of the file.
    #[must_use]
    pub fn to_text(&self) -> String {
        header_text(&self.header) + COLUMNS + "\n" + &data_lines(&self.samples)
    }

    /// The sample period measured by the board, us; for a stream, which has none, the requested one.
    ///
    /// # Errors
    /// When the header does not have it.
    pub fn period_us(&self) -> Result<f64> {
        self.positive(if self.is_streamed() { "sample_period_us" } else { "measured_period_us" })
    }

    /// Whether it was streamed instead of downloaded.
    #[must_use]
    pub fn is_streamed(&self) -> bool {
        self.get("format") == Some(stream_file::FORMAT)
    }

    /// Writes the file under the next free number in a folder, and returns its path.
    ///
    /// # Errors
    /// When the folder cannot be written to.
    pub fn write_next(&self, folder: &Path) -> Result<PathBuf> {
        fs::create_dir_all(folder).with_context(|| format!("cannot make the folder {}", folder.display()))?;
        let staged = Staged::write(folder, "TARGET", &[self.to_text().as_bytes()])
            .with_context(|| format!("cannot write a TARGET file to {}", folder.display()))?;
        let path = place(staged.path(), folder)?;
        sync_folder(folder);
        Ok(path)
    }
}

/// Gives a complete file the first free name. A hard link never replaces an existing file.
fn place(partial: &Path, folder: &Path) -> Result<PathBuf> {
    for number in 1..=999 {
        let path = folder.join(format!("TARGET{number:02}.DAT"));
        match fs::hard_link(partial, &path) {
            Ok(()) => return Ok(path),
            Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {}
            // On a file system without hard links, a name that is free now is taken by renaming.
            Err(_) if !path.exists() => {
                fs::rename(partial, &path).with_context(|| format!("cannot write {}", path.display()))?;
                return Ok(path);
            }
            Err(_) => {}
        }
    }
    bail!("{} holds TARGET01.DAT to TARGET999.DAT; move some away", folder.display())
}

/// A sample under its index k.
fn numbered(index: i64, sample: RecordedSample) -> Result<(i32, RecordedSample)> {
    let index = i32::try_from(index)
        .map_err(|_| anyhow!("sample {index} is beyond the last one that a file can have, {}", i32::MAX))?;
    Ok((index, sample))
}

#[cfg(test)]
mod tests;
