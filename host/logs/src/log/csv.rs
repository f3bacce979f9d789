//! A table as text: a header of names, a line per sample. Commas, semicolons or tabs between the cells; where it is not
//! the comma, numbers may have a decimal comma. Lines that begin with `#` and lines without a number are left out: the
//! latter are units.

use anyhow::{Context, Result, bail};
use csv::{ReaderBuilder, StringRecord, Trim};

use super::Series;

/// The series of a text.
///
/// # Errors
/// When it is no table.
pub fn read(text: &str) -> Result<Vec<Series>> {
    let text = text.trim_start_matches('\u{feff}');
    let head = text.lines().find(|line| !line.starts_with('#') && !line.trim().is_empty());
    let Some(head) = head else { bail!("it is empty") };
    let delimiter = delimiter(head);
    let mut reader = ReaderBuilder::new()
        .delimiter(delimiter)
        .comment(Some(b'#'))
        .has_headers(false)
        .trim(Trim::All)
        .from_reader(text.as_bytes());
    let mut rows = reader.records();
    let first = rows.next().context("it is empty")??;
    let numbers = numbers(&first, delimiter);
    let is_named = numbers.iter().all(|number| number.is_nan());
    let mut series: Vec<Series> = (1..)
        .zip(&first)
        .map(|(place, cell)| Series { name: name(is_named, place, cell), ..Series::default() })
        .collect();
    if !is_named {
        append(&mut series, &numbers);
    }
    for row in rows {
        let numbers = self::numbers(&row?, delimiter);
        if numbers.iter().any(|number| !number.is_nan()) {
            append(&mut series, &numbers);
        }
    }
    Ok(series)
}

/// Columns without a name are counted from 1.
fn name(is_named: bool, place: usize, cell: &str) -> String {
    if is_named && !cell.is_empty() { cell.to_owned() } else { place.to_string() }
}

fn append(series: &mut [Series], numbers: &[f64]) {
    for (one, number) in series.iter_mut().zip(numbers) {
        one.values.push(*number);
    }
}

/// What stands most often in the first line; the comma if nothing does.
fn delimiter(head: &str) -> u8 {
    let count = |delimiter: u8| head.bytes().filter(|&byte| byte == delimiter).count();
    [b'\t', b';', b','].into_iter().max_by_key(|&delimiter| count(delimiter)).unwrap_or(b',')
}

fn numbers(row: &StringRecord, delimiter: u8) -> Vec<f64> {
    row.iter().map(|cell| number(cell, delimiter)).collect()
}

fn number(cell: &str, delimiter: u8) -> f64 {
    let read = |cell: &str| cell.parse().ok().filter(|number: &f64| number.is_finite());
    let with_comma = || (delimiter != b',').then(|| read(&cell.replace(',', "."))).flatten();
    read(cell).or_else(with_comma).unwrap_or(f64::NAN)
}
