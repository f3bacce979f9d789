//! A log of another recorder: series of numbers over time.

mod mcap;

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, anyhow, bail};
use pneudrive_tables::{Column, Table};

use crate::column_map::Source;

/// The numbers of one column, or of one field of a message.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// The column's head; of an MCAP file topic and field, such as `/drive.position_m`.
    pub name: String,
    /// When the file says it, the time of each value, s from the first message.
    pub clock_s: Option<Vec<f64>>,
    /// The values; NaN where there is no number.
    pub values: Vec<f64>,
}

/// A log: the series of an MCAP file, or a table.
#[derive(Clone, Debug, Default)]
pub struct Log {
    /// The name of the file.
    pub name: String,
    /// The series in the order of the file; empty for a table.
    pub series: Vec<Series>,
    /// None of an MCAP file.
    pub table: Option<Table>,
}

impl Log {
    /// Reads a CSV or MCAP file, by its contents.
    ///
    /// # Errors
    /// When it cannot be read, or is neither.
    pub fn read(path: &Path) -> Result<Log> {
        let bytes = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
        Log::of_bytes(&name, &bytes).with_context(|| path.display().to_string())
    }

    /// The log in the bytes of a file.
    ///
    /// # Errors
    /// When it is neither CSV nor MCAP.
    pub fn of_bytes(name: &str, bytes: &[u8]) -> Result<Log> {
        let is_mcap = bytes.starts_with(&::mcap::MAGIC[..5]);
        let table = if is_mcap { None } else { Some(Table::read(bytes)?) };
        let series = if is_mcap { mcap::read(bytes)? } else { Vec::new() };
        Ok(Log { name: name.to_owned(), series, table })
    }

    /// The numbers of a column, or of a field of a message.
    ///
    /// # Errors
    /// When no column or more than one has that name, with the existing names, or when its decimal sign is ambiguous.
    pub fn get(&self, of: &Source) -> Result<Series> {
        let Some(table) = &self.table else { return self.field(&of.column).cloned() };
        let place = table.place(&of.column).with_context(|| self.name.clone())?;
        let values = table.numbers(place, of.decimal).with_context(|| self.name.clone())?;
        Ok(Series { name: of.column.to_string(), clock_s: None, values })
    }

    fn field(&self, column: &Column) -> Result<&Series> {
        let is_meant = |(place, series): &(usize, &Series)| match column {
            Column::Named(name) => series.name == *name,
            Column::Numbered(number) => place + 1 == *number,
        };
        let found: Vec<(usize, &Series)> = self.series.iter().enumerate().filter(is_meant).collect();
        match found[..] {
            [(_, series)] => Ok(series),
            [] => {
                let names: Vec<&str> = self.series.iter().map(|series| &*series.name).collect();
                bail!("{} has no column {column}; it has {}", self.name, names.join(", "))
            }
            _ => {
                let numbers: Vec<String> = found.iter().map(|(place, _)| (place + 1).to_string()).collect();
                bail!(
                    "{} has {column} {} times, as the columns {}; take one by its number",
                    self.name,
                    found.len(),
                    numbers.join(", ")
                )
            }
        }
    }

    /// The times of a column of times with a date, s from its first; None of another column.
    ///
    /// # Errors
    /// When no column or more than one has that name, or a cell is not a time.
    pub fn times(&self, of: &Source) -> Result<Option<Vec<f64>>> {
        let Some(table) = &self.table else { return Ok(None) };
        let times = table.place(&of.column).and_then(|place| table.times(place));
        times.with_context(|| self.name.clone())
    }

    /// Where the value of a row stands, for messages: line and column of a table.
    #[must_use]
    pub fn at(&self, column: &Column, row: usize) -> String {
        match self.table.as_ref().and_then(|table| Some((table, table.place(column).ok()?))) {
            Some((table, place)) => table.at(row, place),
            None => format!("message {} of {column}", row + 1),
        }
    }

    /// The refusal of a value that is no number.
    #[must_use]
    pub fn no_number(&self, column: &Column, row: usize) -> anyhow::Error {
        match self.table.as_ref().and_then(|table| Some((table, table.place(column).ok()?))) {
            Some((table, place)) => table.no_number(row, place).into(),
            None => anyhow!("{} is not a number; fill it, or leave such messages out", self.at(column, row)),
        }
    }
}

#[cfg(test)]
mod tests;
