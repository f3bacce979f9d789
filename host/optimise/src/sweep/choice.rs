//! Which points are allowed, and which of them is best.

use super::{Row, Sweep};

/// The criterion by which a point is better than another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Objective {
    /// Index of its metric.
    pub metric: usize,
    /// Whether more is better.
    pub most: bool,
}

/// The bounds on the size of a metric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// Index of the metric.
    pub metric: usize,
    /// Lower bound.
    pub min: f64,
    /// Upper bound.
    pub max: f64,
}

impl Bound {
    /// Whether a row is within the bounds, over its whole range if it has one. A missing value is not.
    #[must_use]
    pub fn is_kept(&self, row: &Row) -> bool {
        let sizes = row.sizes(self.metric);
        sizes.is_some_and(|[least, most]| self.min <= least && most <= self.max)
    }
}

impl Row {
    /// The least and the largest size of a metric: over an ensemble, or of the run alone. None if a run lacks it.
    fn sizes(&self, metric: usize) -> Option<[f64; 2]> {
        let [least, most] = match self.ends.get(metric) {
            Some(ends) => (*ends)?,
            None => [self.metrics[metric]?; 2],
        };
        let [a, b] = [least.abs(), most.abs()];
        // A range whose ends have different signs contains 0.
        Some([if least * most < 0.0 { 0.0 } else { a.min(b) }, a.max(b)])
    }

    /// Whether the run went to its end without a fault.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.failure.is_empty() && self.fault.is_empty()
    }
}

impl Sweep {
    /// Whether a point ran to its end and keeps all constraints.
    #[must_use]
    pub fn allows(&self, row: &Row) -> bool {
        row.is_whole() && self.constraints.iter().all(|bound| bound.is_kept(row))
    }

    /// The best of the allowed points; of equals the first. None without an objective, and if none is allowed.
    #[must_use]
    pub fn best<'a>(&self, rows: &'a [Row]) -> Option<&'a Row> {
        let objective = self.objective?;
        // Of a range, the worse end counts.
        let cost = |row: &Row| {
            row.sizes(objective.metric).map(|[least, most]| if objective.most { -least } else { most })
        };
        let allowed = rows.iter().filter(|row| self.allows(row));
        let costs = allowed.filter_map(|row| Some((cost(row)?, row)));
        costs.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, row)| row)
    }
}
