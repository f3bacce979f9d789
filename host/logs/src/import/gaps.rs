//! Where a log has no samples.

/// A distance of more mean steps between two samples is a gap, unless the map states another.
const MEAN_STEPS: f64 = 3.0;

/// A channel that holds its value is written when it changes, unless this part of its steps is even.
const REGULAR: f64 = 0.75;

/// A step is even if it is within this part of the mean one.
const NEAR: f64 = 0.1;

/// The mean step but over gaps, s: steps that are longer than the limit do not count, until no other is.
pub fn step(time_s: &[f64], limit_s: Option<f64>) -> f64 {
    let mut limit = f64::INFINITY;
    loop {
        let kept = || time_s.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step <= limit);
        let mean = kept().sum::<f64>() / kept().count().max(1) as f64;
        let next = limit_s.unwrap_or(MEAN_STEPS * mean).min(limit);
        if kept().all(|step| step <= next) {
            return mean;
        }
        limit = next;
    }
}

/// More than this between two samples is a gap, s.
pub fn limit(time_s: &[f64], asked_s: Option<f64>, step_s: f64, holds: bool) -> f64 {
    let is_near = |pair: &&[f64]| ((pair[1] - pair[0]) / step_s - 1.0).abs() <= NEAR;
    let near = time_s.windows(2).filter(is_near).count();
    if holds && (near as f64) < REGULAR * (time_s.len() - 1) as f64 {
        return f64::INFINITY;
    }
    asked_s.unwrap_or(MEAN_STEPS * step_s)
}

/// Times before and after each step that is longer than a limit, s.
pub fn of(time_s: &[f64], limit_s: f64) -> Vec<[f64; 2]> {
    let pairs = time_s.windows(2).map(|pair| [pair[0], pair[1]]);
    pairs.filter(|[before, after]| after - before > limit_s).collect()
}
