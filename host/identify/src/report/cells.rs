//! What stands in the tables of a fit.

use pneudrive_report::Table;

/// Six significant digits, four more than those of a standard error.
pub(super) fn digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    format!("{rounded}")
}

/// A table of rows.
pub(super) fn table(heading: &str, columns: &[&str], rows: Vec<Vec<String>>) -> Table {
    Table::new(heading, columns.iter().copied(), rows)
}
