//! Tables of numbers.

mod reading;

use crate::Problem;
use crate::instant::nanoseconds;
use crate::number::{Evidence, Sign, number};

/// How a column is named.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Column {
    /// By its head.
    Named(String),
    /// By its place, from 1.
    Numbered(usize),
}

impl std::fmt::Display for Column {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Column::Named(name) => write!(f, "{name:?}"),
            Column::Numbered(place) => write!(f, "{place}"),
        }
    }
}

impl From<&str> for Column {
    fn from(name: &str) -> Column {
        Column::Named(name.to_owned())
    }
}

/// A table: rows of as many cells each.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// Lines of heads above the numbers: names, and perhaps units.
    heads: Vec<Vec<String>>,
    /// Line of the first head, or of the first row.
    head_line: usize,
    columns: usize,
    delimiter: char,
    /// The line of each row.
    lines: Vec<usize>,
    /// All cells, one after the other, and where each ends.
    cells: String,
    ends: Vec<usize>,
    evidence: Vec<Evidence>,
    notes: Vec<String>,
}

impl Table {
    /// The table in the bytes of a file.
    ///
    /// # Errors
    /// When there is none, with the line and the remedy.
    pub fn read(bytes: &[u8]) -> Result<Table, Problem> {
        reading::table(&crate::text::decoded(bytes)?)
    }

    /// The table in the bytes of a file none of whose lines is cut.
    ///
    /// # Errors
    /// As [`Table::read`], and when the last line ends in the middle.
    pub fn read_whole(bytes: impl AsRef<[u8]>) -> Result<Table, Problem> {
        let table = Table::read(bytes.as_ref())?;
        match table.notes.first() {
            Some(_) => Err(Problem::new(
                "its last line ends in the middle, without a line break: complete it, or take it out",
            )),
            None => Ok(table),
        }
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.lines.len()
    }

    /// Number of columns.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// The line of a row in the file, from 1.
    #[must_use]
    pub fn line(&self, row: usize) -> usize {
        self.lines.get(row).copied().unwrap_or(self.head_line)
    }

    /// The line of the heads, or of the first row where there are none.
    #[must_use]
    pub fn head_line(&self) -> usize {
        self.head_line
    }

    /// The remark for the reader of the table: a cut last line was left out.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// A cell; empty if there is none.
    #[must_use]
    pub fn cell(&self, row: usize, place: usize) -> &str {
        let k = row * self.columns + place;
        let begin = k.checked_sub(1).and_then(|before| self.ends.get(before)).copied().unwrap_or(0);
        self.ends.get(k).and_then(|&end| self.cells.get(begin..end)).unwrap_or_default()
    }

    /// The heads of all columns, for messages; those without one by their number.
    #[must_use]
    pub fn names(&self) -> Vec<String> {
        (0..self.columns).map(|place| self.name(place)).collect()
    }

    /// The head of a column, or its number.
    fn name(&self, place: usize) -> String {
        let heads = self.heads.iter().filter_map(|heads| heads.get(place)).filter(|head| !head.is_empty());
        heads.clone().next().map_or_else(|| (place + 1).to_string(), Clone::clone)
    }

    /// A column for messages.
    fn label(&self, place: usize) -> String {
        match self.name(place) {
            name if name == (place + 1).to_string() => format!("column {name}"),
            name => format!("column {} ({name:?})", place + 1),
        }
    }

    /// The place of a column.
    ///
    /// # Errors
    /// When there is none, or more than one: with the choices.
    pub fn place(&self, column: &Column) -> Result<usize, Problem> {
        let found = match column {
            Column::Numbered(number) => number.checked_sub(1).filter(|place| *place < self.columns),
            Column::Named(name) => self.find(&[name])?,
        };
        found.ok_or_else(|| Problem::new(format!("there is no column {column}; there are {}", self.listed())))
    }

    /// The place of the column with one of these names; None if there is none.
    ///
    /// # Errors
    /// When more than one column has such a name: with their numbers.
    pub fn find(&self, names: &[&str]) -> Result<Option<usize>, Problem> {
        let is_named = |place: &usize| {
            self.heads.iter().any(|heads| heads.get(*place).is_some_and(|head| names.contains(&&**head)))
        };
        let is_counted = |place: &usize| {
            let number = (place + 1).to_string();
            self.name(*place) == number && names.contains(&&*number)
        };
        let found: Vec<usize> =
            (0..self.columns).filter(|place| is_named(place) || is_counted(place)).collect();
        match found[..] {
            [] => Ok(None),
            [place] => Ok(Some(place)),
            _ => {
                let numbers: Vec<String> = found.iter().map(|place| (place + 1).to_string()).collect();
                Err(Problem::new(format!(
                    "line {}: {} columns are called {}: {}; give each a name of its own, or take one by its number, as column = {}",
                    self.head_line,
                    found.len(),
                    names.iter().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(" or "),
                    numbers.join(", "),
                    numbers[0]
                )))
            }
        }
    }

    /// The place of the first of these columns that exists, and the value of its unit; None if there is none.
    ///
    /// # Errors
    /// When one of them is there twice, or more than one of them is.
    pub fn find_first(&self, units: &[(&str, f64)]) -> Result<Option<(usize, f64)>, Problem> {
        let mut found: Option<(usize, f64)> = None;
        for (name, unit) in units {
            let Some(place) = self.find(&[name])? else { continue };
            if let Some((before, _)) = found {
                return Err(Problem::new(format!(
                    "line {}: {} and {} say the same; leave one out",
                    self.head_line,
                    self.label(before),
                    self.label(place)
                )));
            }
            found = Some((place, *unit));
        }
        Ok(found)
    }

    fn listed(&self) -> String {
        let names = self.names();
        (1..)
            .zip(&names)
            .map(
                |(number, name)| {
                    if *name == number.to_string() { name.clone() } else { format!("{number} {name:?}") }
                },
            )
            .collect::<Vec<_>>()
            .join(", ")
    }

    /// The numbers of a column; not a number where the cell has none. Without a `sign`, the cells decide which one is decimal.
    ///
    /// # Errors
    /// When they leave it open, or contradict each other.
    pub fn numbers(&self, place: usize, sign: Option<Sign>) -> Result<Vec<f64>, Problem> {
        let sign = match (sign, self.evidence.get(place)) {
            (Some(sign), _) => sign,
            (None, Some(evidence)) => evidence.sign(&self.label(place), &self.evidence, self.delimiter)?,
            (None, None) => Sign::Dot,
        };
        Ok((0..self.rows()).map(|row| number(self.cell(row, place), sign).unwrap_or(f64::NAN)).collect())
    }

    /// The numbers of a column that has one in each row.
    ///
    /// # Errors
    /// As [`Table::numbers`], and with the first cell that is no number.
    pub fn all_numbers(&self, place: usize) -> Result<Vec<f64>, Problem> {
        let numbers = self.numbers(place, None)?;
        match numbers.iter().position(|number| !number.is_finite()) {
            Some(row) => Err(self.no_number(row, place)),
            None => Ok(numbers),
        }
    }

    /// The refusal of a cell that is no number.
    #[must_use]
    pub fn no_number(&self, row: usize, place: usize) -> Problem {
        let what = match self.cell(row, place) {
            "" => "is empty".to_owned(),
            cell => format!("{cell:?} is not a number"),
        };
        Problem::new(format!("{}: {what}; write a number there, or leave the line out", self.at(row, place)))
    }

    /// Line and column of a cell, for messages.
    #[must_use]
    pub fn at(&self, row: usize, place: usize) -> String {
        format!("line {}, {}", self.line(row), self.label(place))
    }

    /// The times of a column of times with a date or of the day, s from its first; None of another column.
    ///
    /// # Errors
    /// With the first cell that is no such time.
    pub fn times(&self, place: usize) -> Result<Option<Vec<f64>>, Problem> {
        let Some(first) = nanoseconds(self.cell(0, place)) else { return Ok(None) };
        let seconds = |row: usize| {
            let time = nanoseconds(self.cell(row, place)).ok_or_else(|| {
                let (at, cell) = (self.at(row, place), self.cell(row, place));
                Problem::new(format!(
                    "{at}: {cell:?} is no time such as 2026-01-31T12:00:00.5, as the rows before it have"
                ))
            });
            time.map(|time| (time - first) as f64 / 1e9)
        };
        (0..self.rows()).map(seconds).collect::<Result<_, _>>().map(Some)
    }
}

#[cfg(test)]
mod tests;
