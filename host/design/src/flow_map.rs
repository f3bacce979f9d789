//! A valve's measured map from a table: CSV with `spool_percent` (or `command_percent`), `upstream_kpa` and `downstream_kpa`, both
//! absolute, `flow_l_min` (ANR), and perhaps `spread_l_min`, the standard deviation of the flow.

/// A measured flow: spool (% of its travel), pressures in front and behind (kPa, absolute), flow and its standard deviation (l/min).
pub type Row = [f64; 5];

/// Names of the columns; of the first one either will do.
const COLUMNS: [&[&str]; 4] =
    [&["spool_percent", "command_percent"], &["upstream_kpa"], &["downstream_kpa"], &["flow_l_min"]];
const SPREAD: &str = "spread_l_min";

/// The rows of a table.
///
/// # Errors
/// When it is no such table, with the line.
pub fn rows(csv: &str) -> Result<Vec<Row>, String> {
    let mut lines = (1..).zip(csv.lines()).filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let (_, header) = lines.next().ok_or("it is empty")?;
    let names: Vec<&str> = header.split(',').map(str::trim).collect();
    let place = |wanted: &[&str]| names.iter().position(|name| wanted.contains(name));
    let [Some(spool), Some(up), Some(down), Some(flow)] = COLUMNS.map(place) else {
        return Err(format!(
            "line 1: expected a header with spool_percent, upstream_kpa, downstream_kpa, flow_l_min and perhaps {SPREAD}; found {header:?}"
        ));
    };
    let spread = place(&[SPREAD]);
    let row = |(n, line): (usize, &str)| {
        let cells: Vec<Option<f64>> = line.split(',').map(|cell| cell.trim().parse().ok()).collect();
        let number = |i: usize| cells.get(i).copied().flatten().filter(|number| number.is_finite());
        let read = || {
            Some([
                number(spool)?,
                number(up)?,
                number(down)?,
                number(flow)?,
                spread.map_or(Some(0.0), number)?,
            ])
        };
        read().ok_or_else(|| format!("line {n}: expected numbers, found {line:?}"))
    };
    lines.map(row).collect()
}

/// The rows as a rig file has them, a line each.
#[must_use]
pub fn to_toml(rows: &[Row]) -> String {
    let lines: String = rows.iter().map(|row| format!("  {row:?},\n")).collect();
    format!("[\n{lines}]")
}

/// The largest flow over the pressure in front of it, m3/(s Pa): about the sonic conductance of the valve fully open.
#[must_use]
pub fn largest_conductance(rows: &[Row]) -> f64 {
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
