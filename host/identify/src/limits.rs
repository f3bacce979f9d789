//! Limits that the unknowns of a fit keep, and the step of least squares that keeps them.
//!
//! ```text
//! minimise  d' H d / 2 + g' d     where     u_above - u_below + d_above - d_below <= bound
//! ```
//!
//! by an active set (Nocedal and Wright 2006, section 16.5): active limits are equations, inactive ones are left out.

use nalgebra::{DMatrix, DVector};

/// u of one unknown, or its difference from that of another, is not above a bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// The unknown that counts positive, if any.
    pub above: Option<usize>,
    /// The unknown that counts negative, if any.
    pub below: Option<usize>,
    /// The largest value of their difference.
    pub bound: f64,
}

/// How far a limit may be missed by rounding.
const ROUNDING: f64 = 1e-12;

impl Limit {
    /// u of an unknown is not above `bound`.
    #[must_use]
    pub fn at_most(unknown: usize, bound: f64) -> Limit {
        Limit { above: Some(unknown), below: None, bound }
    }

    /// u of an unknown is not below `bound`.
    #[must_use]
    pub fn at_least(unknown: usize, bound: f64) -> Limit {
        Limit { above: None, below: Some(unknown), bound: -bound }
    }

    /// Whether an unknown has to do with it.
    #[must_use]
    pub fn has(&self, unknown: usize) -> bool {
        self.above == Some(unknown) || self.below == Some(unknown)
    }

    /// How far a point is inside.
    #[must_use]
    pub fn room(&self, u: &[f64]) -> f64 {
        let of = |unknown: Option<usize>| unknown.map_or(0.0, |i| u[i]);
        self.bound - of(self.above) + of(self.below)
    }

    /// By how much the room shrinks along a step.
    fn taken_by(&self, step: &DVector<f64>) -> f64 {
        self.above.map_or(0.0, |i| step[i]) - self.below.map_or(0.0, |i| step[i])
    }

    fn row(&self, unknowns: usize) -> DVector<f64> {
        let mut row = DVector::zeros(unknowns);
        self.above.into_iter().for_each(|i| row[i] = 1.0);
        self.below.into_iter().for_each(|i| row[i] = -1.0);
        row
    }
}

/// The step from `u` that minimises a quadratic and keeps the limits. None where the matrix is singular.
#[must_use]
pub(crate) fn step_within(
    matrix: &DMatrix<f64>,
    gradient: &DVector<f64>,
    limits: &[Limit],
    u: &[f64],
) -> Option<DVector<f64>> {
    let mut active: Vec<usize> = Vec::new();
    for _ in 0..4 * limits.len() + 1 {
        let (step, forces) = step_along(matrix, gradient, limits, &active, u)?;
        let pulling = (0..active.len()).min_by(|&a, &b| forces[a].total_cmp(&forces[b]));
        if let Some(place) = pulling.filter(|&place| forces[place] < 0.0) {
            active.remove(place);
            continue;
        }
        let beyond = |i: &usize| limits[*i].taken_by(&step) - limits[*i].room(u);
        let free = (0..limits.len()).filter(|i| !active.contains(i));
        match free.max_by(|a, b| beyond(a).total_cmp(&beyond(b))).filter(|i| beyond(i) > ROUNDING) {
            Some(i) => active.push(i),
            None => return Some(step),
        }
    }
    // If the limits take turns: the step without limits, as far as the first limit lets it go.
    let (step, _) = step_along(matrix, gradient, limits, &[], u)?;
    let part = |limit: &Limit| match limit.taken_by(&step) {
        taken if taken > 0.0 => limit.room(u).max(0.0) / taken,
        _ => 1.0,
    };
    Some(&step * limits.iter().map(part).fold(1.0, f64::min))
}

/// The step that ends on the active limits, and the force of each on it.
fn step_along(
    matrix: &DMatrix<f64>,
    gradient: &DVector<f64>,
    limits: &[Limit],
    active: &[usize],
    u: &[f64],
) -> Option<(DVector<f64>, DVector<f64>)> {
    let cholesky = matrix.clone().cholesky()?;
    let free = cholesky.solve(&-gradient);
    if active.is_empty() {
        return Some((free, DVector::zeros(0)));
    }
    let rows: Vec<DVector<f64>> = active.iter().map(|&i| limits[i].row(u.len())).collect();
    let columns = DMatrix::from_columns(&rows);
    let bent = cholesky.solve(&columns);
    let missed = DVector::from_iterator(
        active.len(),
        active.iter().map(|&i| limits[i].taken_by(&free) - limits[i].room(u)),
    );
    let forces = columns.tr_mul(&bent).lu().solve(&missed)?;
    Some((free - bent * &forces, forces))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(gradient: [f64; 2], limits: &[Limit]) -> DVector<f64> {
        let matrix = DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 2.0]);
        step_within(&matrix, &DVector::from_row_slice(&gradient), limits, &[0.0, 0.0]).expect("a step")
    }

    #[test]
    fn a_step_that_no_limit_holds_is_that_of_newton() {
        assert!(
            (step([-3.0, -3.0], &[Limit::at_most(0, 5.0)]) - DVector::from_element(2, 1.0)).norm() < 1e-12
        );
    }

    /// By hand: with d_0 = 0.5 the other minimises d_1^2 + d_1 / 2 - 3 d_1.
    #[test]
    fn a_limit_ends_its_unknown_and_the_others_go_on_to_their_own_minimum() {
        let found = step([-3.0, -3.0], &[Limit::at_most(0, 0.5)]);
        assert!((found - DVector::from_row_slice(&[0.5, 1.25])).norm() < 1e-12);
    }

    #[test]
    fn unknowns_that_may_not_pass_one_another_go_on_together() {
        let limit = Limit { above: Some(0), below: Some(1), bound: 0.0 };
        let found = step([-6.0, 0.0], &[limit]);
        assert!((found[0] - found[1]).abs() < 1e-12 && (found[0] - 1.0).abs() < 1e-12, "{found}");
    }

    #[test]
    fn no_step_within_the_limits_is_better() {
        let mut seed = 1u64;
        let mut draw = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        for _ in 0..300 {
            let root = DMatrix::from_fn(3, 3, |_, _| draw());
            let matrix = &root * root.transpose() + 0.01 * DMatrix::identity(3, 3);
            let gradient = DVector::from_fn(3, |_, _| 3.0 * draw());
            let limits = [
                Limit::at_most(0, draw().abs()),
                Limit::at_least(0, -draw().abs()),
                Limit { above: Some(1), below: Some(0), bound: draw().abs() },
                Limit { above: Some(2), below: Some(1), bound: draw().abs() },
                Limit::at_least(2, -draw().abs()),
            ];
            let found = step_within(&matrix, &gradient, &limits, &[0.0; 3]).expect("a step");
            let keeps = |step: &DVector<f64>| limits.iter().all(|l| l.taken_by(step) <= l.bound + 1e-9);
            let cost = |step: &DVector<f64>| 0.5 * (&matrix * step).dot(step) + gradient.dot(step);
            assert!(keeps(&found), "{found}");
            for _ in 0..300 {
                let other = &found + DVector::from_fn(3, |_, _| 0.3 * draw());
                assert!(
                    !keeps(&other) || cost(&other) > cost(&found) - 1e-9,
                    "{other} is better than {found}"
                );
            }
        }
    }
}
