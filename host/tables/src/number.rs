//! The decimal sign of a column, from all of its cells.
//!
//! ```text
//! number   [+-] digits [decimal sign digits] [e [+-] digits]
//! digits   1234, or in groups of three: 1,234  1.234  1 234  1'234     the sign of the groups is not the decimal sign
//! ```
//!
//! A cell such as `1,234` reads either way. It is decided by the other cells of its column, then by the other columns: a file has
//! one decimal sign. Where neither decides, the column is refused.

use crate::Problem;

/// A decimal sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// 0.5
    Dot,
    /// 0,5
    Comma,
}

impl Sign {
    fn character(self) -> char {
        match self {
            Sign::Dot => '.',
            Sign::Comma => ',',
        }
    }

    fn other(self) -> Sign {
        match self {
            Sign::Dot => Sign::Comma,
            Sign::Comma => Sign::Dot,
        }
    }

    /// The sign that a text names: `"."` or `","`.
    #[must_use]
    pub fn named(text: &str) -> Option<Sign> {
        [Sign::Dot, Sign::Comma].into_iter().find(|sign| text == sign.character().to_string())
    }
}

/// The form of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// No number.
    Text,
    /// A number without a sign that could be decimal.
    Plain,
    /// A number with one decimal sign alone.
    Only(Sign),
    /// A number with either sign, and another one with each: this one stands in it.
    Either(Sign),
}

/// Spaces and marks between groups of digits that are no decimal sign anywhere.
const GROUPING: [char; 6] = [' ', '\u{a0}', '\u{202f}', '\u{2009}', '\'', '\u{2019}'];

/// The form of a cell.
pub fn shape(cell: &str) -> Shape {
    match [Sign::Dot, Sign::Comma].map(|sign| parts(cell, sign).is_some()) {
        [false, false] => Shape::Text,
        [true, false] => Shape::Only(Sign::Dot),
        [false, true] => Shape::Only(Sign::Comma),
        [true, true] if cell.contains(',') => Shape::Either(Sign::Comma),
        [true, true] if cell.contains('.') => Shape::Either(Sign::Dot),
        [true, true] => Shape::Plain,
    }
}

/// The number of a cell with this decimal sign; None of none.
pub fn number(cell: &str, sign: Sign) -> Option<f64> {
    let [minus, whole, part, exponent] = parts(cell, sign)?;
    let digits = |text: &str| text.chars().filter(char::is_ascii_digit).collect::<String>();
    let text = format!("{minus}{}.{}{exponent}", digits(whole), digits(part));
    text.parse().ok().filter(|number: &f64| number.is_finite())
}

/// Minus, whole part, part after the decimal sign, exponent.
fn parts(cell: &str, sign: Sign) -> Option<[&str; 4]> {
    let (minus, rest) = match cell.strip_prefix(['-', '\u{2212}']) {
        Some(rest) => ("-", rest),
        None => ("", cell.strip_prefix('+').unwrap_or(cell)),
    };
    let (mantissa, exponent) = rest.split_at(rest.find(['e', 'E']).unwrap_or(rest.len()));
    let (whole, part) = mantissa.split_once(sign.character()).unwrap_or((mantissa, ""));
    let is_digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    let is_whole = is_digits(whole) || (exponent.is_empty() && is_grouped(whole, sign.other()));
    let is_exponent = exponent.is_empty() || {
        let digits = exponent[1..].strip_prefix(['+', '-']).unwrap_or(&exponent[1..]);
        !digits.is_empty() && is_digits(digits)
    };
    let fits = is_whole && is_digits(part) && is_exponent && !(whole.is_empty() && part.is_empty());
    fits.then_some([minus, whole, part, exponent])
}

/// Whether digits stand in groups of three with one sign between them: no decimal one of this file.
fn is_grouped(whole: &str, sign: Sign) -> bool {
    let between = whole.chars().find(|character| !character.is_ascii_digit());
    let Some(between) = between.filter(|&found| found == sign.character() || GROUPING.contains(&found))
    else {
        return false;
    };
    let mut groups = whole.split(between);
    let first = groups.next().unwrap_or_default();
    let is_digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    (1..=3).contains(&first.len())
        && !first.starts_with('0')
        && is_digits(first)
        && groups.all(|group| group.len() == 3 && is_digits(group))
}

/// A cell and its line.
type Seen = Option<(usize, String)>;

/// The evidence of a column's cells on its decimal sign.
#[derive(Clone, Debug, Default)]
pub struct Evidence {
    /// A cell that can be read with the dot alone, and one with the comma alone.
    only: [Seen; 2],
    /// A cell that reads either way, with the sign in it.
    either: Option<(usize, String, Sign)>,
    /// Numbers without a sign.
    plain: bool,
    /// A number that reads either way ends in 0: no writer that drops zeros wrote it as a decimal.
    padded: bool,
}

impl Evidence {
    pub fn add(&mut self, cell: &str, line: usize) {
        match shape(cell) {
            Shape::Text => {}
            Shape::Plain => self.plain = true,
            Shape::Only(sign) => {
                self.only[sign as usize].get_or_insert_with(|| (line, cell.to_owned()));
            }
            Shape::Either(sign) => {
                self.padded |= cell.ends_with('0');
                self.either.get_or_insert_with(|| (line, cell.to_owned(), sign));
            }
        }
    }

    /// The sign that cells of this column show, alone.
    pub fn shown(&self) -> Option<Sign> {
        match &self.only {
            [Some(_), None] => Some(Sign::Dot),
            [None, Some(_)] => Some(Sign::Comma),
            _ => None,
        }
    }

    /// Whether every number has three digits behind its one sign: all above 999, or a writer of three decimals.
    fn has_three_decimals(&self) -> bool {
        self.either.is_some() && !self.plain
    }

    /// The decimal sign of this column of a table, `name` in messages.
    ///
    /// # Errors
    /// When its cells contradict each other, or leave it open.
    pub fn sign(&self, name: &str, all: &[Evidence], delimiter: char) -> Result<Sign, Problem> {
        if let [Some((dot_line, dot)), Some((comma_line, comma))] = &self.only {
            return Err(Problem::new(format!(
                "{name} has both decimal signs: {dot:?} in line {dot_line}, {comma:?} in line {comma_line}; write it with one"
            )));
        }
        let Some((line, cell, sign)) = &self.either else { return Ok(self.shown().unwrap_or(Sign::Dot)) };
        if let Some(shown) = self.shown() {
            return Ok(shown);
        }
        let mixed = self.plain && self.padded;
        match self.of_file(all, *sign, delimiter) {
            Some(decided) if !mixed || decided != *sign => Ok(decided),
            _ => Err(Problem::new(format!(
                "line {line}, {name}: {cell:?} may be {} or {}; write the column without signs between thousands, or say decimal = \".\" or \",\" in its table of the map",
                shown_as(cell, Sign::Dot),
                shown_as(cell, Sign::Comma)
            ))),
        }
    }

    /// The evidence of the file on a column whose cells read either way, with this sign in them.
    fn of_file(&self, all: &[Evidence], sign: Sign, delimiter: char) -> Option<Sign> {
        let shown = |wanted: Sign| all.iter().any(|one| one.shown() == Some(wanted));
        match (shown(Sign::Dot), shown(Sign::Comma)) {
            (true, false) => return Some(Sign::Dot),
            (false, true) => return Some(Sign::Comma),
            (true, true) => return None,
            (false, false) => {}
        }
        // With both signs in the file, one of them stands between thousands.
        if all.iter().any(|one| one.either.as_ref().is_some_and(|(_, _, other)| *other != sign)) {
            return None;
        }
        // Between commas a dot is the decimal sign; semicolons are there because the comma is one.
        let mut numbers = all.iter().filter(|one| one.plain || one.either.is_some());
        let is_usual = match sign {
            Sign::Dot => delimiter == ',' && self.has_three_decimals(),
            Sign::Comma => delimiter == ';' && numbers.all(Evidence::has_three_decimals),
        };
        is_usual.then_some(sign)
    }
}

fn shown_as(cell: &str, sign: Sign) -> String {
    number(cell, sign).map_or_else(String::new, |number| number.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_as_people_and_programs_write_them() {
        for (cell, sign, expected) in [
            ("1.5", Sign::Dot, 1.5),
            ("-1,5", Sign::Comma, -1.5),
            ("\u{2212}1,5", Sign::Comma, -1.5),
            ("+2e-3", Sign::Dot, 2e-3),
            ("2,5E3", Sign::Comma, 2500.0),
            (".5", Sign::Dot, 0.5),
            ("5.", Sign::Dot, 5.0),
            ("1,000", Sign::Dot, 1000.0),
            ("1,000", Sign::Comma, 1.0),
            ("1.234.567,5", Sign::Comma, 1_234_567.5),
            ("1 234,5", Sign::Comma, 1234.5),
            ("12'345.5", Sign::Dot, 12_345.5),
            ("12\u{202f}345", Sign::Dot, 12_345.0),
        ] {
            assert_eq!(number(cell, sign), Some(expected), "{cell}");
        }
        for cell in [
            "",
            "-",
            "1,00,0",
            "1 2",
            "0x10",
            "1e",
            "1e+",
            "nan",
            "inf",
            "1,5,2",
            "1.5.2",
            "5 %",
            ".",
            "1234,567.8",
        ] {
            assert_eq!([Sign::Dot, Sign::Comma].map(|sign| number(cell, sign)), [None, None], "{cell}");
        }
        assert_eq!(number("0,001", Sign::Dot), None, "no group begins with 0");
        assert_eq!(number("1,000e3", Sign::Dot), None, "no group has an exponent");
    }

    #[test]
    fn a_cell_shows_one_sign_or_reads_either_way() {
        for (cell, expected) in [
            ("1.5", Shape::Only(Sign::Dot)),
            ("0,001", Shape::Only(Sign::Comma)),
            ("1,000", Shape::Either(Sign::Comma)),
            ("101.325", Shape::Either(Sign::Dot)),
            ("1,000.5", Shape::Only(Sign::Dot)),
            ("1,000,000", Shape::Only(Sign::Dot)),
            ("998", Shape::Plain),
            ("1 000", Shape::Plain),
            ("1e3", Shape::Plain),
            ("off", Shape::Text),
        ] {
            assert_eq!(shape(cell), expected, "{cell}");
        }
    }
}
