//! The lines of a table, cut into cells: which delimiter does it, and where the numbers begin.

use csv::{ReaderBuilder, StringRecord, Trim};

use crate::instant::nanoseconds;
use crate::number::{Shape, shape};

/// The delimiters. Of two that fit equally well, the first one is taken.
const DELIMITERS: [u8; 4] = [b'\t', b';', b',', b'|'];

/// The lines in this many bytes decide the delimiter.
const SAMPLE: usize = 1 << 16;

/// A line of cells, with its number.
pub struct Record {
    pub line: usize,
    pub cells: StringRecord,
}

impl Record {
    /// Cells up to the last one that is not empty.
    pub fn filled(&self) -> usize {
        (1..).zip(&self.cells).filter(|(_, cell)| !cell.is_empty()).last().map_or(0, |(place, _)| place)
    }

    /// Whether half of its cells are numbers or times.
    pub fn has_numbers(&self) -> bool {
        let there = self.cells.iter().filter(|cell| !cell.is_empty()).count();
        let numbers = numbers(&self.cells);
        numbers > 0 && 2 * numbers >= there
    }
}

/// The cells that are numbers or times.
fn numbers(cells: &StringRecord) -> usize {
    cells.iter().filter(|cell| is_number(cell)).count()
}

/// Whether a cell is a number or a time.
pub fn is_number(cell: &str) -> bool {
    shape(cell) != Shape::Text || nanoseconds(cell).is_some()
}

/// The lines of a text whose lines end with LF: without empty ones and those that begin with `#`.
pub fn records(text: &str, delimiter: u8) -> impl Iterator<Item = Record> + '_ {
    let mut reader = ReaderBuilder::new()
        .delimiter(delimiter)
        .comment(Some(b'#'))
        .has_headers(false)
        .flexible(true)
        .trim(Trim::All)
        .from_reader(text.as_bytes());
    std::iter::from_fn(move || {
        let mut cells = StringRecord::new();
        // Reading UTF-8 text from memory cannot fail.
        let is_there = reader.read_record(&mut cells).unwrap_or(false);
        is_there.then(|| Record { line: reader.position().line().saturating_sub(1) as usize, cells })
    })
}

/// How a table is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dialect {
    pub delimiter: u8,
    /// Cells of most lines.
    pub cells: usize,
    /// The first line of numbers; None of a table without one.
    pub begins: Option<usize>,
}

/// The dialect of a text; None of no table. `said` is the delimiter that the text names.
pub fn dialect(text: &str, said: Option<u8>) -> Option<Dialect> {
    let sample = match text.get(..text.floor_char_boundary(SAMPLE)) {
        Some(part) if part.len() < text.len() => &part[..=part.rfind('\n').unwrap_or(part.len() - 1)],
        _ => text,
    };
    let fits = DELIMITERS.into_iter().filter(|delimiter| said.is_none_or(|said| said == *delimiter));
    let mut best: Option<(f64, Dialect)> = None;
    for delimiter in fits.chain(said.filter(|said| !DELIMITERS.contains(said))) {
        let Some((score, dialect)) = tried(sample, delimiter) else { continue };
        if best.is_none_or(|(other, _)| score > other) {
            best = Some((score, dialect));
        }
    }
    best.map(|(_, dialect)| dialect)
}

/// How well a delimiter cuts a text into lines of equally many numbers, and the result.
fn tried(sample: &str, delimiter: u8) -> Option<(f64, Dialect)> {
    let records: Vec<Record> = records(sample, delimiter).collect();
    let of_numbers = || records.iter().filter(|record| record.has_numbers());
    let cells = most_frequent(of_numbers().map(|record| record.cells.len()))
        .or_else(|| records.iter().map(|record| record.cells.len()).max())?;
    if cells < 2 {
        return None;
    }
    let alike = || records.iter().filter(|record| record.cells.len() == cells);
    let found: usize = alike().map(|record| numbers(&record.cells)).sum();
    let there: usize =
        alike().map(|record| record.cells.iter().filter(|cell| !cell.is_empty()).count()).sum();
    let score = found as f64 / there.max(1) as f64 * alike().count() as f64 / records.len() as f64;
    Some((score, Dialect { delimiter, cells, begins: beginning(&records, cells) }))
}

/// The number that comes most often; of several the largest.
fn most_frequent(counts: impl Iterator<Item = usize>) -> Option<usize> {
    let mut seen: Vec<usize> = counts.collect();
    seen.sort_unstable();
    seen.chunk_by(|a, b| a == b).max_by_key(|same| same.len()).map(|same| same[0])
}

/// The line at which the longest sequence of lines of numbers begins; of several the last.
fn beginning(records: &[Record], cells: usize) -> Option<usize> {
    let is_row = |record: &Record| record.cells.len() == cells && record.has_numbers();
    let runs = records.chunk_by(|a, b| is_row(a) == is_row(b)).filter(|run| is_row(&run[0]));
    runs.max_by_key(|run| run.len()).map(|run| run[0].line)
}
