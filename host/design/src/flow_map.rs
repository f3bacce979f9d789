//! A valve's measured map from a table with `spool_percent` (or `command_percent`), `upstream_kpa` and `downstream_kpa`, both
//! absolute, `flow_l_min` (ANR), and perhaps `spread_l_min`, the standard deviation of the flow.

use pneudrive_tables::{Problem, Table};

/// A measured flow: spool (% of its travel), pressures in front and behind (kPa, absolute), flow and its standard deviation
/// (l/min).
pub type Row = [f64; 5];

/// Names of the columns; of the first one either will do.
const COLUMNS: [&[&str]; 4] =
    [&["spool_percent", "command_percent"], &["upstream_kpa"], &["downstream_kpa"], &["flow_l_min"]];
const SPREAD: &str = "spread_l_min";

/// The rows of a table.
///
/// # Errors
/// When it is no such table, with the line.
pub fn rows(bytes: impl AsRef<[u8]>) -> Result<Vec<Row>, String> {
    let table = Table::read_whole(bytes).map_err(|problem| problem.to_string())?;
    rows_of(&table).map_err(|problem| problem.to_string())?.ok_or_else(|| {
        format!(
            "line {}: expected a header with spool_percent, upstream_kpa, downstream_kpa, flow_l_min and perhaps {SPREAD}; found {}",
            table.head_line(),
            table.names().join(", ")
        )
    })
}

/// None of a table that lacks a column.
fn rows_of(table: &Table) -> Result<Option<Vec<Row>>, Problem> {
    let mut rows = vec![Row::default(); table.rows()];
    for (column, names) in COLUMNS.into_iter().chain([&[SPREAD][..]]).enumerate() {
        let Some(place) = table.find(names)? else {
            if names == [SPREAD] { continue } else { return Ok(None) }
        };
        for (row, number) in rows.iter_mut().zip(table.all_numbers(place)?) {
            row[column] = number;
        }
    }
    Ok(Some(rows))
}

/// The rows as a rig file has them, a line each.
#[must_use]
pub fn to_toml(rows: &[Row]) -> String {
    let lines: String = rows.iter().map(|row| format!("  {row:?},\n")).collect();
    format!("[\n{lines}]")
}

/// The largest flow over the pressure in front of it, m3/(s Pa): about the sonic conductance of the valve fully open.
#[must_use]
pub(crate) fn largest_conductance(rows: &[Row]) -> f64 {
    rows.iter().map(|[_, up, _, flow, _]| flow / up / 6e7).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_read_by_its_columns() {
        let csv = "# bench\nupstream_kpa,command_percent,downstream_kpa,flow_l_min,spread_l_min\n700,50,140,420,3\n";
        assert_eq!(rows(csv), Ok(vec![[50.0, 700.0, 140.0, 420.0, 3.0]]));
        let without = "spool_percent,upstream_kpa,downstream_kpa,flow_l_min\n50,700,140,420\n";
        assert_eq!(rows(without), Ok(vec![[50.0, 700.0, 140.0, 420.0, 0.0]]));
        // 840 l/min at 7 bar: 14 dm3/s, 2 dm3/(s bar).
        assert!((largest_conductance(&[[100.0, 700.0, 70.0, 840.0, 0.0]]) - 2e-8).abs() < 1e-20);
    }

    #[test]
    fn what_is_no_map_is_refused_with_its_line() {
        for (csv, says) in [
            ("", "empty"),
            ("a,b\n", "line 1"),
            ("spool_percent,upstream_kpa,downstream_kpa,flow_l_min\n1,2,3\n", "line 2"),
        ] {
            assert!(rows(csv).expect_err("refused").contains(says), "{csv:?}");
        }
    }
}
