//! The result of a sweep for other programs.

use serde_json::{Map, Value, json};

use super::{Metric, Row, Sweep};

/// The rows of sweep.csv, and which of them is best (docs/reference/json.md). A figure that a run does not show is null.
#[must_use]
pub fn to_json(sweep: &Sweep, rows: &[Row]) -> Value {
    let levels = |row: &Row| -> Map<String, Value> {
        let level = |text: &String| text.parse::<f64>().map_or_else(|_| json!(text), |number| json!(number));
        sweep.axes.iter().zip(&row.levels).map(|(axis, text)| (axis.name.clone(), level(text))).collect()
    };
    let metrics = |row: &Row| -> Map<String, Value> {
        let metric = |(place, metric): (usize, &Metric)| {
            let ends = row.ends.get(place).copied().flatten();
            let [least, most] = ends.map_or([None; 2], |ends| ends.map(Some));
            (metric.name.clone(), json!({ "value": row.metrics[place], "least": least, "most": most }))
        };
        sweep.metrics.iter().enumerate().map(metric).collect()
    };
    let one = |row: &Row| {
        json!({
            "point": row.point,
            "levels": levels(row),
            "metrics": metrics(row),
            "converged": row.converged,
            "fault": row.fault,
            "failure": row.failure,
            "allowed": sweep.allows(row),
        })
    };
    json!({
        "rig": sweep.rig.name(),
        "rows": rows.iter().map(one).collect::<Vec<_>>(),
        "best": sweep.best(rows).map(|row| row.point),
    })
}
