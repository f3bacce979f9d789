//! A known table in drawn dialects: it is read as it was written, or refused by name, and never read as another table.

use pneudrive_tables::{Column, Table};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

const DRAWS: u64 = 10_000;

/// A writer of tables.
#[derive(Debug)]
struct Dialect {
    delimiter: char,
    decimal: char,
    /// Between thousands.
    grouping: Option<char>,
    /// Nothing, heads alone, all cells.
    quotes: u32,
    line_end: &'static str,
    encoding: u32,
    mark: bool,
    said: bool,
    preamble: u32,
    heads: bool,
    units: bool,
    comment: bool,
    trailing: bool,
    blank_end: bool,
    /// Letters of the last line that are left; None of a whole file.
    cut: Option<usize>,
}

/// A column: its head, and its cells without any sign but the dot and the minus.
#[derive(Debug)]
struct Drawn {
    head: &'static str,
    cells: Vec<String>,
}

struct Draw(ChaCha8Rng);

impl Draw {
    fn below(&mut self, end: u32) -> u32 {
        self.0.next_u32() % end
    }

    fn one_in(&mut self, many: u32) -> bool {
        self.below(many) == 0
    }

    fn of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len() as u32) as usize]
    }

    fn dialect(&mut self) -> Dialect {
        let decimal = self.of(&['.', ',']);
        let other = if decimal == '.' { ',' } else { '.' };
        let signs = [None, None, None, Some(other), Some(' '), Some('\''), Some('\u{a0}'), Some('\u{202f}')];
        Dialect {
            delimiter: self.of(&[',', ';', '\t', '|']),
            decimal,
            grouping: self.of(&signs),
            quotes: self.below(3),
            line_end: self.of(&["\n", "\r\n", "\r"]),
            encoding: self.below(8),
            mark: self.one_in(3),
            said: self.one_in(6),
            preamble: if self.one_in(3) { 1 + self.below(3) } else { 0 },
            heads: !self.one_in(5),
            units: self.one_in(4),
            comment: self.one_in(6),
            trailing: self.one_in(5),
            blank_end: self.one_in(5),
            cut: self.one_in(8).then(|| self.below(60) as usize),
        }
    }

    fn table(&mut self) -> Vec<Drawn> {
        const HEADS: [&str; 6] = ["t", "x [mm]", "p1, bar", "u", "flow; l/min", "t"];
        let (rows, first) = (2 + self.below(20), self.below(3));
        let mut column = |column: u32| Drawn {
            head: HEADS[((column + first) % 6) as usize],
            cells: self.cells(column == 0, rows),
        };
        let columns: Vec<Drawn> = (0..2).map(&mut column).collect();
        let more = (2..2 + rows % 3).map(column);
        columns.into_iter().chain(more).collect()
    }

    fn cells(&mut self, is_time: bool, rows: u32) -> Vec<String> {
        let decimals = self.of(&[0, 1, 2, 3, 3, 3, 6]);
        let scale = self.of(&[1.0, 1000.0, 2000.0, 1e6]);
        let step = self.of(&[0.5, 1.0, 1.3]);
        let (varies, kind) = (self.one_in(4), self.below(3));
        let from = self.of(&[0.0, 0.0, 990.0]);
        let mut cell = |row: u32| {
            let even = f64::from(self.below(1_000_000)) / 1e6;
            let value = match kind {
                _ if is_time => from + step * f64::from(row),
                0 => scale * even,
                1 => scale * (even - 0.5),
                _ => scale * (1.0 + even),
            };
            let text = format!("{value:.decimals$}");
            if varies { text.parse::<f64>().unwrap_or(value).to_string() } else { text }
        };
        (0..rows).map(&mut cell).collect()
    }
}

impl Dialect {
    fn cell(&self, plain: &str) -> String {
        let (sign, digits) = plain.split_at(usize::from(plain.starts_with('-')));
        let (whole, part) =
            digits.split_once('.').map_or((digits, None), |(whole, part)| (whole, Some(part)));
        let mut grouped = String::new();
        for (place, digit) in whole.chars().enumerate() {
            if place > 0 && (whole.len() - place) % 3 == 0 {
                grouped.extend(self.grouping);
            }
            grouped.push(digit);
        }
        let part = part.map_or_else(String::new, |part| format!("{}{part}", self.decimal));
        format!("{sign}{grouped}{part}")
    }

    fn quoted(&self, cell: &str, from: u32) -> String {
        if self.quotes >= from { format!("\"{cell}\"") } else { cell.to_owned() }
    }

    fn line(&self, cells: impl Iterator<Item = String>) -> String {
        let mut line = cells.collect::<Vec<_>>().join(&self.delimiter.to_string());
        line.extend(self.trailing.then_some(self.delimiter));
        line + self.line_end
    }

    fn text(&self, table: &[Drawn]) -> String {
        let mut text = String::new();
        if self.said {
            text += &format!("sep={}{}", self.delimiter, self.line_end);
        }
        for line in ["Logger v2", "Serial 17", "Rate: 1 kHz"].iter().take(self.preamble as usize) {
            text += &format!("{line}{}", self.line_end);
        }
        if self.heads {
            text += &self.line(table.iter().map(|column| self.quoted(column.head, 1)));
            if self.units {
                text += &self.line(table.iter().map(|_| self.quoted("mm", 1)));
            }
        }
        for row in 0..table[0].cells.len() {
            if self.comment && row == 1 {
                text += &format!("# a remark{}", self.line_end);
            }
            text += &self.line(table.iter().map(|column| self.quoted(&self.cell(&column.cells[row]), 2)));
        }
        if self.blank_end {
            text += self.line_end;
        }
        match self.cut {
            Some(left) => {
                let whole = text.trim_end_matches(['\r', '\n']);
                let begin = whole.rfind(['\r', '\n']).map_or(0, |place| place + 1);
                let left: String = whole[begin..].chars().take(left).collect();
                format!("{}{left}", &text[..begin])
            }
            None => text,
        }
    }

    /// None of a text that its encoding cannot hold.
    fn bytes(&self, text: &str) -> Option<Vec<u8>> {
        let mark = if self.mark { "\u{feff}" } else { "" };
        let text = format!("{mark}{text}");
        match self.encoding {
            0 => Some(text.encode_utf16().flat_map(u16::to_le_bytes).collect()),
            1 => Some(text.encode_utf16().flat_map(u16::to_be_bytes).collect()),
            2 if !self.mark => text.chars().map(|letter| u8::try_from(u32::from(letter)).ok()).collect(),
            _ => Some(text.into_bytes()),
        }
    }

    /// Whether the writer makes another table: where heads are missing, or cut by the same sign, nothing tells a decimal sign
    /// from one between cells.
    fn is_another(&self, table: &[Drawn]) -> bool {
        let is_between = |sign| self.delimiter == sign;
        let heads_have_it = table.iter().any(|column| column.head.contains(self.delimiter));
        self.quotes < 2
            && (!self.heads || self.quotes == 0 && heads_have_it)
            && (is_between(self.decimal) || self.grouping.is_some_and(is_between))
    }
}

/// What becomes of a draw: whether it was read. A wrong number panics.
fn outcome(dialect: &Dialect, table: &[Drawn], bytes: &[u8]) -> bool {
    let named = ["line ", "column", "UTF-16", "Latin-1", "empty", "no text", "quote"];
    let is_named = |problem: String| {
        assert!(named.iter().any(|name| problem.contains(name)), "{problem}: {dialect:?}");
        false
    };
    let read = match Table::read(bytes) {
        Ok(read) => read,
        Err(problem) => return is_named(problem.to_string()),
    };
    let whole = table[0].cells.len();
    let rows = read.rows();
    // The last row may be cut, and is then left out.
    let fits = rows == whole || dialect.cut.is_some() && rows + 1 == whole;
    assert!(fits, "{rows} of {whole} rows: {dialect:?} {table:?}");
    let mut all = true;
    for (place, column) in table.iter().enumerate() {
        let twice = table.iter().filter(|other| other.head == column.head).count() > 1;
        let by = match dialect.heads && !twice {
            true => Column::Named(column.head.to_owned()),
            false => Column::Numbered(place + 1),
        };
        let found = match read.place(&by).and_then(|place| read.all_numbers(place)) {
            Ok(found) => found,
            Err(problem) => {
                all = is_named(problem.to_string());
                continue;
            }
        };
        let expected = column.cells.iter().map(|cell| cell.parse::<f64>().expect("a number"));
        for (row, (found, expected)) in found.iter().zip(expected).enumerate() {
            assert!(*found == expected, "row {row} of {}: {found}: {dialect:?} {table:?}", column.head);
        }
        assert!(!(dialect.heads && twice) || read.place(&column.head.into()).is_err(), "{dialect:?}");
    }
    all
}

/// Whether the digits of the last cell show that it is cut. Without decimals, or where their number changes, none do.
fn shows_a_cut(dialect: &Dialect, table: &[Drawn]) -> bool {
    let decimals = |cell: &String| cell.split_once('.').map(|(_, part)| part.len());
    let last = &table[table.len() - 1].cells;
    let first = decimals(&last[0]);
    dialect.cut.is_none()
        || last.len() > 2 && first.is_some() && last.iter().all(|cell| decimals(cell) == first)
}

#[test]
fn a_table_is_read_right_or_refused_by_name_and_never_read_as_another() {
    let (mut read, mut drawn) = (0, 0);
    for seed in 0..DRAWS {
        let mut draw = Draw(ChaCha8Rng::seed_from_u64(seed));
        let (dialect, table) = (draw.dialect(), draw.table());
        let text = dialect.text(&table);
        let Some(bytes) = dialect.bytes(&text).filter(|_| !dialect.is_another(&table)) else { continue };
        if shows_a_cut(&dialect, &table) {
            drawn += 1;
            read += u32::from(outcome(&dialect, &table, &bytes));
        }
    }
    println!("{read} of {drawn} tables are read, the others refused by name");
    assert!(drawn > 7_000 && read > drawn / 2, "{read} of {drawn}");
}
