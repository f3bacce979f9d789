//! The regression line of the pressure drop in a tube (thesis 7.1.4).
//!
//! ```text
//! ln(P_far / P_near) = (m / m_ref) ln(1 - K_dr)          6.61 as EQUATIONS section 4 reads it (R1)
//! ```
//!
//! Measured are the flow m away from the near end and the ratio of the pressures; m_ref is chosen.

use anyhow::{Context, Result, bail};
use pneudrive_tables::Table;

use super::figures::Figure;
use super::regression::Line;

/// Columns of a table: the flow in one of two units, and the ratio.
const FLOWS: [(&str, f64); 2] = [("flow_kg_s", 1.0), ("flow_g_s", 1e-3)];
const RATIOS: [&str; 2] = ["ratio", "value"];

/// A flow up to this counts as none, kg/s: it is due to rounding.
const NO_FLOW: f64 = 1e-12;

/// More passes through no tube of a drive, kg/s.
const MAX_FLOW: f64 = 1e3;

/// K_dr, `tubing.drop_slope`, of a table (a head with `flow_g_s` or `flow_kg_s`, and `ratio` or `value`)
/// for a reference flow in kg/s.
///
/// # Errors
/// When it is not such a table, with the line.
pub fn drop_slope(bytes: impl AsRef<[u8]>, reference_flow: f64) -> Result<Figure> {
    // A point without flow lies on every line through the origin, so it does not show how well a line fits.
    let flowing = points(&Table::read_whole(bytes)?)?.into_iter().filter(|(flow, _)| flow.abs() > NO_FLOW);
    let points: Vec<(f64, f64)> = flowing.map(|(flow, ratio)| (flow / reference_flow, ratio.ln())).collect();
    let line = Line::through_origin(&points).context("it needs at least two points with a flow")?;
    let left = line.slope.value.exp();
    if left >= 1.0 {
        bail!("the pressure rises with the flow; is the ratio that of the far end over the near one?");
    }
    Ok(Figure { value: 1.0 - left, error: left * line.slope.error })
}

/// Flow, kg/s, and ratio.
fn points(table: &Table) -> Result<Vec<(f64, f64)>> {
    let (Some((flow, unit)), Some(ratio)) = (table.find_first(&FLOWS)?, table.find(&RATIOS)?) else {
        bail!(
            "line {}: expected a header with flow_g_s or flow_kg_s, and ratio; found {}",
            table.head_line(),
            table.names().join(", ")
        );
    };
    let (flows, ratios) = (table.all_numbers(flow)?, table.all_numbers(ratio)?);
    let point = |(row, (flow, ratio)): (usize, (f64, f64))| {
        let (n, flow) = (table.line(row), flow * unit);
        if !is_flow(flow) {
            bail!(
                "line {n}: {flow:e} kg/s is not a plausible flow through a tube; is it in the unit of the header?"
            )
        }
        if ratio <= 0.0 {
            bail!("line {n}: a ratio of {ratio} is none; it is that of two absolute pressures, above 0")
        }
        Ok((flow, ratio))
    };
    flows.into_iter().zip(ratios).enumerate().map(point).collect()
}

/// Whether a tube can pass such a flow, kg/s.
fn is_flow(flow: f64) -> bool {
    flow.abs() <= MAX_FLOW
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_of_the_thesis_is_found_in_points_on_it() {
        let points = (1..20).map(|i| {
            let flow = 0.4 * f64::from(i);
            format!("{flow},{}\n", 0.6f64.powf(flow / 4.65))
        });
        let csv = format!("flow_g_s,ratio\n{}", points.collect::<String>());
        let found = drop_slope(csv, 0.00465).expect("a line");
        assert!((found.value - 0.4).abs() < 1e-12 && found.error < 1e-12, "{found:?}");
    }

    #[test]
    fn what_is_no_table_is_refused_with_its_line() {
        for (csv, says) in [
            ("", "empty"),
            ("a,b\n1,2\n", "line 1"),
            ("flow_g_s,ratio\n1,0.9\n2\n", "line 3"),
            ("flow_g_s,ratio\n1,0.9\n2,-1\n", "line 3"),
            ("flow_g_s,ratio\n1,0.9\n2,x\n", "line 3"),
            ("flow_g_s,ratio\n0,1\n0,1\n", "two points"),
            ("flow_g_s,ratio\n0,1\n1,0.9\n", "two points"),
            ("flow_g_s,ratio\n1,0.9\n2,inf\n", "line 3"),
            ("flow_g_s,ratio\n1e300,0.9\n2e300,0.8\n", "kg/s is not a plausible flow through a tube"),
            ("flow_g_s,ratio\n1e-300,0.9\n2e-300,0.8\n", "two points"),
            ("flow_g_s,ratio\nnan,0.9\n2,0.8\n", "line 2"),
            ("flow_g_s,ratio\n1,1.2\n2,1.5\n", "far end"),
        ] {
            let message = format!("{:#}", drop_slope(csv, 0.00465).expect_err("refused"));
            assert!(message.contains(says), "{csv:?}: {message}");
        }
    }
}
