//! Which points are allowed, and which of them is best.

use super::{Row, Sweep};

/// What makes a point better than another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Objective {
    /// Place of its metric.
    pub metric: usize,
    /// Whether more is better.
    pub most: bool,
}

/// What the size of a metric must keep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// Place of the metric.
    pub metric: usize,
    /// At least.
    pub min: f64,
    /// At most.
    pub max: f64,
}

impl Bound {
    /// Whether a row keeps it. What has no value does not.
    #[must_use]
    pub fn is_kept(&self, row: &Row) -> bool {
        row.metrics[self.metric].is_some_and(|value| (self.min..=self.max).contains(&value.abs()))
    }
}

impl Row {
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
        let cost = |row: &Row| {
            row.metrics[objective.metric].map(|x| if objective.most { -x.abs() } else { x.abs() })
        };
        let allowed = rows.iter().filter(|row| self.allows(row));
        let costs = allowed.filter_map(|row| Some((cost(row)?, row)));
        costs.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, row)| row)
    }
}
