//! A log of another recorder: series of numbers over time.

mod csv;
mod mcap;

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, anyhow};

/// The numbers of one column, or of one field of a message.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// The column's head; of an MCAP file topic and field, such as `/drive.position_m`.
    pub name: String,
    /// When the file says it, the time of each value, s from the first message.
    pub clock_s: Option<Vec<f64>>,
    /// Not a number where there is none.
    pub values: Vec<f64>,
}

/// The series of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Log {
    /// The name of the file.
    pub name: String,
    /// In the order of the file.
    pub series: Vec<Series>,
}

impl Log {
    /// Reads a CSV or MCAP file, by what it is.
    ///
    /// # Errors
    /// When it cannot be read, or is neither.
    pub fn read(path: &Path) -> Result<Log> {
        let bytes = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        let series = Log::series_of(&bytes).with_context(|| path.display().to_string())?;
        Ok(Log { name, series })
    }

    fn series_of(bytes: &[u8]) -> Result<Vec<Series>> {
        if bytes.starts_with(::mcap::MAGIC) {
            return mcap::read(bytes);
        }
        let text = std::str::from_utf8(bytes)
            .map_err(|_| anyhow!("it is neither an MCAP file nor text; export it as CSV or MCAP"))?;
        csv::read(text)
    }

    /// A series by its name.
    ///
    /// # Errors
    /// When there is none, with the names that there are.
    pub fn get(&self, name: &str) -> Result<&Series> {
        self.series.iter().find(|series| series.name == name).ok_or_else(|| {
            let names: Vec<&str> = self.series.iter().map(|series| &*series.name).collect();
            anyhow!("{} has no column {name:?}; it has {}", self.name, names.join(", "))
        })
    }
}

#[cfg(test)]
mod tests;
