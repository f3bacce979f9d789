//! Measured points over a curve: `characterise --points`.

use std::path::Path;

use anyhow::{Context, Result};
use pneudrive_report::{Curve, Look};
use pneudrive_thesis::characteristics::Characteristic;
use pneudrive_thesis::measured_points::{Deviation, Points};

use super::digits::significant;
use crate::command::eval::column;

/// Measured points, and how far they are from the first curve.
pub(super) struct Measurement {
    points: Points,
    deviation: Deviation,
    /// Names of the axis and of the curve.
    across: &'static str,
    curve: String,
    /// Unit of the value.
    unit: &'static str,
}

impl Measurement {
    /// The points of a file beside the first curve of a test.
    pub fn of(path: &Path, found: &Characteristic) -> Result<Measurement> {
        let graph = found.graphs.first().context("the test has no graph")?;
        let series = graph.series.first().context("the graph has no curve")?;
        let bytes = std::fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
        let names = [found.across, graph.title].map(column);
        let in_file = || format!("{} has no points of this test", path.display());
        let points = Points::of_table(&bytes, [&names[0], &names[1]]).with_context(in_file)?;
        let deviation = points.beside(&series.x, &series.y).with_context(in_file)?;
        let unit = graph.title.split_once(", ").map_or("", |(_, unit)| unit);
        Ok(Measurement { points, deviation, across: found.across, curve: series.name.clone(), unit })
    }

    /// The points, and the ends of twice their spreads.
    pub fn curves(&self) -> Vec<Curve> {
        let points = |name: &str, y: Vec<f64>| Curve {
            look: Look::Points,
            ..Curve::new(name, self.points.x.clone(), y)
        };
        let mut curves = vec![points("measured", self.points.y.clone())];
        if let Some(spread) = &self.points.spread {
            let ends =
                [-2.0, 2.0].map(|by| self.points.y.iter().zip(spread).map(|(y, s)| y + by * s).collect());
            curves.extend(ends.map(|end| points("measured, two standard deviations", end)));
        }
        curves
    }

    /// Rows of the table of figures.
    pub fn rows(&self) -> Vec<Vec<String>> {
        let Deviation { count, largest: (largest, at), root_mean_square, scale, within } = self.deviation;
        let share = |distance: f64| format!("{:.2} % of the largest", 100.0 * distance / scale);
        let row = |name: String, value: f64| {
            vec![name, significant(value, 3), share(value.abs()), self.unit.to_owned()]
        };
        let (axis, unit) = self.across.split_once(", ").unwrap_or((self.across, ""));
        let mut rows = vec![
            row(format!("measured less \"{}\", largest, at {axis} {at} {unit}", self.curve), largest),
            row(format!("the same, root mean square of {count} points"), root_mean_square),
        ];
        if let Some(within) = within {
            let name = "points within two of their standard deviations".to_owned();
            rows.push(vec![name, format!("{within} of {count}"), String::new(), String::new()]);
        }
        rows
    }
}
