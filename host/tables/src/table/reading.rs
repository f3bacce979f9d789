//! A text as a table.
//!
//! ```text
//! sep=;                     names the delimiter
//! # made by a logger        left out, as are empty lines
//! Rate: 1000 Hz             lines before the table have another number of cells
//! t;x                       the heads: lines of texts right above the numbers
//! ms;mm
//! 0;1,25
//! end of data               lines of one text behind the numbers
//! ```

use super::Table;
use crate::Problem;
use crate::dialect::{Dialect, Record, dialect, is_number, records};
use crate::number::Evidence;

/// Lines of heads that are kept above the numbers.
const MAX_HEADS: usize = 4;

pub fn table(text: &str) -> Result<Table, Problem> {
    let is_cut = !text.ends_with('\n') && !text.ends_with('\r');
    let mut text = text.replace("\r\n", "\n").replace('\r', "\n");
    if is_cut {
        text.push('\n');
    }
    let said = delimiter_line(&text);
    if said.is_some() {
        // A comment in its place keeps the numbers of the lines.
        text.replace_range(..text.find('\n').unwrap_or(0), "#");
    }
    if text.lines().all(|line| line.trim().is_empty() || line.starts_with('#')) {
        return Err(Problem::new("it is empty"));
    }
    let Some(dialect) = dialect(&text, said) else {
        return Err(Problem::new(
            "it has no columns: no line has cells with a comma, a semicolon or a tab between them; export it as CSV",
        ));
    };
    Reading::new(dialect).read(&text, is_cut)
}

/// The delimiter of a first line `sep=;`.
fn delimiter_line(text: &str) -> Option<u8> {
    let line = text.lines().next()?.trim().trim_matches('"');
    let (key, value) = line.split_at_checked(4)?;
    match value.as_bytes() {
        [] if key.eq_ignore_ascii_case("sep=") => Some(b'\t'),
        [delimiter] if key.eq_ignore_ascii_case("sep=") => Some(*delimiter),
        _ => None,
    }
}

fn uneven(line: usize, cells: usize, first: usize, most: usize) -> String {
    format!(
        "line {line} has {cells} cells, line {first} has {most}: every row needs the same number of cells; leave a missing one empty between its delimiters"
    )
}

/// The first row that a spreadsheet's error value, such as `#N/A`, makes look like a comment: its line and first cell.
fn row_like_a_comment<'a>(text: &'a str, begins: usize, dialect: &Dialect) -> Option<(usize, &'a str)> {
    let delimiter = char::from(dialect.delimiter);
    let rows = (1..).zip(text.lines()).skip(begins);
    let like = |line: &str| line.starts_with('#') && line.split(delimiter).count() == dialect.cells;
    rows.filter(|(_, line)| like(line))
        .find_map(|(line, row)| Some((line, row.split(delimiter).next()?.trim())))
}

/// A row above the line at which the table seems to begin.
struct Early {
    line: usize,
    cells: usize,
    /// The first line below it that is no row, and its cells.
    interrupted: Option<(usize, usize)>,
}

impl Early {
    /// The refusal of a table that begins at a later line with this many cells.
    fn refused(&self, begins: usize, cells: usize) -> Problem {
        let (line, found) = self.interrupted.unwrap_or((begins, cells));
        Problem::new(if found == self.cells {
            format!(
                "line {line} interrupts the rows from line {} on: two tables in one file? Cut it there, or leave the line out",
                self.line
            )
        } else {
            uneven(line, found, self.line, self.cells)
        })
    }
}

/// A table that is being read.
struct Reading {
    dialect: Dialect,
    table: Table,
    /// Lines right above the one that is read, without numbers.
    above: Vec<Record>,
    /// The first row of numbers above the one at which the table begins, and the line that interrupts it.
    early: Option<Early>,
    /// Whether a line of heads stands above that row, or it is no name with its value.
    is_early_table: bool,
    /// A line after the numbers that is not one of them.
    behind: Option<usize>,
}

impl Reading {
    fn new(dialect: Dialect) -> Reading {
        let table =
            Table { columns: dialect.cells, delimiter: char::from(dialect.delimiter), ..Table::default() };
        Reading { dialect, table, above: Vec::new(), early: None, is_early_table: false, behind: None }
    }

    fn read(mut self, text: &str, is_cut: bool) -> Result<Table, Problem> {
        let Some(begins) = self.dialect.begins else { return Err(self.without_numbers(text)) };
        if let Some((line, cell)) = row_like_a_comment(text, begins, &self.dialect) {
            return Err(Problem::new(format!(
                "line {line} begins with {cell:?}: write a number there, or leave the line out"
            )));
        }
        let last = text.lines().count();
        for record in records(text, self.dialect.delimiter) {
            if record.line < begins {
                self.above(record);
            } else if record.line == begins {
                self.begin(&record, text)?;
                self.row(&record)?;
            } else if is_cut && record.line == last && self.is_part(&record) {
                self.table
                    .notes
                    .push(format!("Line {last} ends in the middle, without a line break: it is left out."));
            } else {
                self.row(&record)?;
            }
        }
        self.without_empty_rows();
        Ok(self.table)
    }

    /// The refusal of a text without a line of numbers.
    fn without_numbers(&self, text: &str) -> Problem {
        let line = records(text, self.dialect.delimiter).next().map_or(1, |record| record.line);
        Problem::new(format!(
            "line {line} has {} cells, and no line of numbers comes after it",
            self.dialect.cells
        ))
    }

    fn above(&mut self, record: Record) {
        let is_row = record.has_numbers()
            && (record.cells.len() == self.dialect.cells
                || (record.filled() > 1 && record.cells.iter().take(record.filled()).all(is_number)));
        match &mut self.early {
            None if is_row => {
                let is_value = !record.cells.get(0).is_some_and(is_number);
                self.is_early_table =
                    !is_value || self.above.iter().any(|head| head.filled() == self.dialect.cells);
                self.early = Some(Early { line: record.line, cells: record.cells.len(), interrupted: None });
            }
            Some(Early { interrupted: interrupted @ None, .. }) if !is_row => {
                *interrupted = Some((record.line, record.cells.len()));
            }
            _ => {}
        }
        let follows = self.above.last().is_none_or(|last| last.line + 1 == record.line);
        if record.has_numbers() || !follows {
            self.above.clear();
        }
        if !record.has_numbers() {
            self.above.push(record);
        }
    }

    /// Takes the lines above the first row as heads, if they are, and drops a column that is a delimiter at the end of all lines.
    fn begin(&mut self, first: &Record, text: &str) -> Result<(), Problem> {
        let cells = self.dialect.cells;
        if let Some(early) = self.early.take_if(|_| self.is_early_table || self.above.is_empty()) {
            return Err(early.refused(first.line, cells));
        }
        let is_next = self.above.last().is_some_and(|head| head.line + 1 == first.line);
        let heads = if is_next { std::mem::take(&mut self.above) } else { Vec::new() };
        let head_cells = heads.last().map_or(0, Record::filled);
        let ends_empty = || {
            records(text, self.dialect.delimiter)
                .filter(|record| record.line >= first.line && record.cells.len() == cells)
                .all(|record| record.filled() < cells)
        };
        let is_behind_all = ends_empty();
        if head_cells < cells && is_behind_all {
            self.table.columns = cells - 1;
        }
        let columns = self.table.columns;
        // A delimiter more may stand at the end of all lines, of the rows or of the heads; a cell more is a name cut in two.
        let most = if is_behind_all { cells } else { cells + 1 };
        let is_aligned = |record: &&Record| {
            record.filled() > 1
                && record.filled() <= columns
                && (columns..=most).contains(&record.cells.len())
        };
        let names_all = |record: &Record| is_aligned(&record) && record.filled() == columns;
        // Units may lack the last one, names may not: a decimal comma without quotes would move them.
        let first_head = heads.iter().rposition(names_all);
        let is_whole =
            first_head.is_some_and(|first| heads[first..].iter().all(|record| is_aligned(&record)));
        if let Some(head) = heads.last().filter(|head| head.filled() > 1 && !is_whole) {
            return Err(Problem::new(format!(
                "line {} has {} names and line {} below it {columns} cells: is the comma both the decimal sign and between the cells, or a name without quotes cut in two? Export it with semicolons or tabs, or with quotes around the cells",
                head.line,
                head.filled(),
                first.line
            )));
        }
        let heads: Vec<&Record> = heads.iter().rev().take_while(is_aligned).take(MAX_HEADS).collect();
        self.table.head_line = heads.last().map_or(first.line, |head| head.line);
        let name = |cell: &str| cell.split_whitespace().collect::<Vec<_>>().join(" ");
        let names = |head: &&Record| head.cells.iter().take(columns).map(name).collect();
        self.table.heads = heads.iter().rev().map(names).collect();
        self.table.evidence = vec![Evidence::default(); columns];
        Ok(())
    }

    fn fits(&self, record: &Record) -> bool {
        let (cells, filled, columns) = (record.cells.len(), record.filled(), self.table.columns);
        // Where lines end in a delimiter, one without it has a cell less, but none that is empty at its end.
        let is_without_end = columns < self.dialect.cells && cells == columns && filled == columns;
        let has_end = cells == self.dialect.cells + 1 && filled == columns;
        filled <= columns && (cells == self.dialect.cells || is_without_end || has_end)
    }

    /// Whether the last line, without a line break, is the beginning of a row: too few cells, or digits fewer than in all others.
    fn is_part(&self, record: &Record) -> bool {
        if record.cells.iter().any(|cell| cell.contains('\n')) {
            return record.cells.iter().all(|cell| cell.trim_end_matches('\n').lines().count() < 2);
        }
        if !self.fits(record) {
            return record.cells.len() < self.table.columns || record.filled() < self.table.columns;
        }
        let place = self.table.columns - 1;
        let digits =
            |cell: &str| cell.rsplit(['.', ',']).next().map(str::len).filter(|digits| *digits < cell.len());
        let last = digits(record.cells.get(place).unwrap_or_default());
        let mut others = (0..self.table.rows()).map(|row| digits(self.table.cell(row, place)));
        let first = others.next().flatten();
        self.table.rows() > 1 && first.is_some() && last < first && others.all(|other| other == first)
    }

    fn row(&mut self, record: &Record) -> Result<(), Problem> {
        let line = record.line;
        if let Some(cell) = record.cells.iter().find(|cell| cell.contains('\n')) {
            let begin = cell.lines().next().unwrap_or_default();
            return Err(Problem::new(format!(
                "a quote opens at {begin:?} and is not closed before line {line}; close it"
            )));
        }
        if !self.fits(record) {
            if record.filled() < 2 && !is_number(record.cells.get(0).unwrap_or_default()) {
                self.behind.get_or_insert(line);
                return Ok(());
            }
            let first = self.table.lines.first().copied().unwrap_or(line);
            return Err(Problem::new(uneven(line, record.cells.len(), first, self.dialect.cells)));
        }
        if let Some(behind) = self.behind {
            return Err(Problem::new(format!(
                "line {behind} is no row, and rows come after it: are these two tables? Cut the file there, or leave the line out"
            )));
        }
        let is_repeated =
            |heads: &Vec<String>| heads.iter().zip(&record.cells).all(|(head, cell)| head == cell);
        if self.table.heads.iter().any(is_repeated) {
            return Err(Problem::new(format!(
                "line {line} repeats the heads of line {}: two tables in one file; cut it there",
                self.table.head_line
            )));
        }
        self.table.lines.push(line);
        for (place, cell) in record.cells.iter().take(self.table.columns).enumerate() {
            self.table.evidence[place].add(cell, line);
            self.table.cells.push_str(cell);
            self.table.ends.push(self.table.cells.len());
        }
        Ok(())
    }

    /// Leaves out rows of delimiters alone at the end.
    fn without_empty_rows(&mut self) {
        let table = &mut self.table;
        while let Some(row) = table.rows().checked_sub(1) {
            if (0..table.columns).any(|place| !table.cell(row, place).is_empty()) {
                break;
            }
            table.lines.pop();
            table.ends.truncate(row * table.columns);
        }
    }
}
