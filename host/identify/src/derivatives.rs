//! Derivatives of the residuals by the unknowns, from differences, and the least-squares problem of a model.
//!
//! ```text
//! (r(u + h) - r(u - h)) / 2 h                                      fine
//! 2 (r(u +- h/2) - r(u)) / (+-h/2) - (r(u +- h) - r(u)) / +-h      beside a jump of the residuals, on the smooth side
//! (r(u + h) - r(u)) / h                                            rough
//! ```
//!
//! The first two are of second order: combinations of unknowns that change nothing must stay such, or the data would seem
//! to show what they do not. At the edge of what is a valid rig there is one side only.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::least_squares::Problem;
use super::limits::Limit;
use super::model::{FittedModel, Job, stacked};

/// Difference in u of an initial state for a derivative: a tenth of a count.
const DIFFERENCE_OF_START: f64 = 0.01;

/// Differences of a rough search over those of a fine one. A secant over many jumps of the sum of squares shows the way to
/// its minimum that a tangent between two of them does not.
const ROUGH: f64 = 100.0;

/// Derivatives to both sides that differ by more than this part of the smaller one have a jump of the residuals on one
/// side: a spool that swings once more, say.
const JUMP: f64 = 0.1;

/// A derivative that changes within its differences by more than this part of it, or of what is usual in its column, is
/// that of a sample just beside a jump.
const BENT: f64 = 0.1;

/// A column of the derivatives: its first row, and the rows from there on. The others are 0.
pub(super) struct Column {
    /// First row that depends on the unknown.
    pub first: usize,
    /// The derivatives.
    pub rows: DVector<f64>,
    /// Rows, from the first of all on, whose derivative changes so much within the differences that it is none.
    pub bent: Vec<usize>,
}

impl FittedModel<'_> {
    /// The columns of some unknowns at a point where the residuals are `at`; None for one that can be moved to
    /// neither side.
    pub(super) fn columns(&self, u: &[f64], at: &DVector<f64>, of: Range<usize>) -> Vec<Option<Column>> {
        self.columns_of(u, at, of, 1.0)
    }

    /// The same from differences of a `part` of the usual ones.
    fn columns_of(&self, u: &[f64], at: &DVector<f64>, of: Range<usize>, part: f64) -> Vec<Option<Column>> {
        let unknowns: Vec<usize> = of.collect();
        let up = self.differences(u, at, &unknowns, part);
        let down = self.some_differences(u, at, &unknowns, -part, |i| self.fine || up[i].is_none());
        let smooth = |i: usize| !self.fine || up[i].as_ref().zip(down[i].as_ref()).is_some_and(is_smooth);
        let [half_up, half_down] =
            [0.5, -0.5].map(|half| self.some_differences(u, at, &unknowns, half * part, |i| !smooth(i)));
        let sides = [up.into_iter().zip(half_up), down.into_iter().zip(half_down)];
        let [ups, downs] = sides.map(|side| side.map(|(whole, half)| Side { whole, half }));
        let column = |((&unknown, up), down): ((&usize, Side), Side)| {
            let first = self.rows_of(unknown).start;
            let (rows, bend) = derivative(up, down)?;
            Some(Column { first, bent: bent(first, &rows, &bend), rows })
        };
        unknowns.iter().zip(ups).zip(downs).map(column).collect()
    }

    /// The differences of those unknowns, by their place in the list, that are needed.
    fn some_differences(
        &self,
        u: &[f64],
        at: &DVector<f64>,
        unknowns: &[usize],
        part: f64,
        needed: impl Fn(usize) -> bool,
    ) -> Vec<Option<DVector<f64>>> {
        let some: Vec<usize> = (0..unknowns.len()).filter(|&i| needed(i)).map(|i| unknowns[i]).collect();
        let mut found = self.differences(u, at, &some, part).into_iter();
        (0..unknowns.len()).map(|i| if needed(i) { found.next().flatten() } else { None }).collect()
    }

    /// The recordings that an unknown has to do with.
    fn recordings_of(&self, unknown: usize) -> Range<usize> {
        match unknown.checked_sub(self.parameters.len()) {
            None => 0..self.recordings.len(),
            Some(i) => i / self.unknowns_of_start()..i / self.unknowns_of_start() + 1,
        }
    }

    /// The rows of the residuals that an unknown has to do with.
    fn rows_of(&self, unknown: usize) -> Range<usize> {
        let (rows, of) = (self.rows(), self.recordings_of(unknown));
        rows[of.start].start..rows[of.end - 1].end
    }

    fn difference(&self, unknown: usize) -> f64 {
        self.parameters.get(unknown).map_or(DIFFERENCE_OF_START, |parameter| parameter.difference)
    }

    /// Column by column, the derivatives from a difference of `part` steps.
    fn differences(
        &self,
        u: &[f64],
        at: &DVector<f64>,
        unknowns: &[usize],
        part: f64,
    ) -> Vec<Option<DVector<f64>>> {
        let difference = |(&unknown, moved): (&usize, Option<DVector<f64>>)| {
            let rows = self.rows_of(unknown);
            Some((moved? - at.rows(rows.start, rows.len())) / (part * self.difference(unknown)))
        };
        unknowns.iter().zip(self.moved(u, unknowns, part)).map(difference).collect()
    }

    /// The residuals with one unknown moved by `part` steps, of the recordings that it has to do with. Beyond a limit
    /// of it there are none.
    fn moved(&self, u: &[f64], unknowns: &[usize], part: f64) -> Vec<Option<DVector<f64>>> {
        let limits = self.limits();
        let point = |&i: &usize| {
            let mut point = u.to_vec();
            point[i] += part * self.difference(i);
            let keeps = limits.iter().filter(|limit| limit.has(i)).all(|limit| limit.room(&point) >= 0.0);
            keeps.then_some(point)
        };
        let points: Vec<Option<Vec<f64>>> = unknowns.iter().map(point).collect();
        let jobs: Vec<Job<'_>> = unknowns
            .iter()
            .zip(&points)
            .filter_map(|(&i, point)| Some((i, point.as_ref()?)))
            .flat_map(|(i, u)| self.recordings_of(i).map(move |recording| Job { u, recording }))
            .collect();
        let mut found = self.follow_all(&jobs).into_iter();
        let residuals = |(&i, point): (&usize, &Option<Vec<f64>>)| {
            point.as_ref()?;
            let parts: Vec<_> = found.by_ref().take(self.recordings_of(i).len()).collect();
            Some(stacked(parts.into_iter().collect::<Option<Vec<_>>>()?))
        };
        unknowns.iter().zip(&points).map(residuals).collect()
    }

    /// The matrix of columns, and below it the derivatives of the terms of the unknowns.
    fn matrix(&self, columns: Vec<Column>) -> DMatrix<f64> {
        let data = self.rows().last().map_or(0, |rows| rows.end);
        let mut jacobian = DMatrix::zeros(data + self.unknowns(), self.unknowns());
        for (i, column) in columns.into_iter().enumerate() {
            jacobian.view_mut((column.first, i), (column.rows.len(), 1)).copy_from(&column.rows);
            jacobian[(data + i, i)] = 1.0 / self.prior(i);
        }
        jacobian
    }
}

/// Whether the derivatives to both sides agree, without a jump.
fn is_smooth((up, down): (&DVector<f64>, &DVector<f64>)) -> bool {
    (up - down).norm() <= JUMP * up.norm().min(down.norm())
}

/// The differences to one side over their steps: of a whole step, and of half a step beside a jump.
#[derive(Clone, Debug, Default)]
struct Side {
    whole: Option<DVector<f64>>,
    half: Option<DVector<f64>>,
}

/// A derivative, and how much it changes from the middle of one difference to that of another.
type Bending = (DVector<f64>, DVector<f64>);

impl Side {
    /// The derivative of second order.
    fn second_order(&self) -> Option<Bending> {
        let (whole, half) = self.whole.as_ref().zip(self.half.as_ref())?;
        Some((2.0 * half - whole, 2.0 * (whole - half)))
    }
}

/// The derivative from the differences to both sides: beside a jump that of the side that bends less.
fn derivative(up: Side, down: Side) -> Option<Bending> {
    let straighter = match (up.second_order(), down.second_order()) {
        (Some(up), Some(down)) => Some(if up.1.norm() < down.1.norm() { up } else { down }),
        (up, down) => up.or(down),
    };
    match (straighter, up.whole, down.whole) {
        (Some(derivative), ..) => Some(derivative),
        (None, Some(up), Some(down)) => Some((0.5 * (&up + &down), up - down)),
        (None, up, down) => up.or(down).map(|rows| (rows.clone(), DVector::zeros(rows.len()))),
    }
}

/// The rows that bend too much.
fn bent(first: usize, rows: &DVector<f64>, bend: &DVector<f64>) -> Vec<usize> {
    let usual = rows.norm() / (rows.len() as f64).sqrt();
    let bends = |i: &usize| bend[*i].abs() > BENT * rows[*i].abs().max(usual);
    (0..rows.len()).filter(bends).map(|i| first + i).collect()
}

impl Problem for FittedModel<'_> {
    fn residuals(&self, u: &[f64]) -> Option<DVector<f64>> {
        self.residuals_at(u)
    }

    fn jacobian(&self, u: &[f64], at: &DVector<f64>) -> Option<DMatrix<f64>> {
        let part = if self.fine { 1.0 } else { ROUGH };
        let columns = self.columns_of(u, at, 0..self.unknowns(), part);
        Some(self.matrix(columns.into_iter().collect::<Option<Vec<_>>>()?))
    }

    fn limits(&self) -> Vec<Limit> {
        FittedModel::limits(self)
    }

    fn longest(&self, unknown: usize) -> f64 {
        FittedModel::longest(self, unknown)
    }

    fn is_confined(&self) -> bool {
        self.parameters.iter().any(|parameter| parameter.is_calibration)
    }

    fn is_cut(&self) -> bool {
        self.budget.is_spent()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x + 3 x^2 with a jump at `edge`, from 0 over a step of 0.01 times `part`.
    fn difference(edge: f64, part: f64) -> Option<DVector<f64>> {
        let x = 0.01 * part;
        let jump = if (edge > 0.0 && x > edge) || (edge < 0.0 && x < edge) { 5.0 } else { 0.0 };
        Some(DVector::from_element(3, (x + 3.0 * x * x + jump) / x))
    }

    fn side(edge: f64, part: f64) -> Side {
        Side { whole: difference(edge, part), half: difference(edge, 0.5 * part) }
    }

    #[test]
    fn a_derivative_does_not_reach_across_a_jump_and_stays_of_second_order() {
        for edge in [0.003, 0.008, -0.003, -0.008] {
            let [up, down] = [1.0, -1.0].map(|part| difference(edge, part).expect("one"));
            assert!(!is_smooth((&up, &down)));
            let slope = derivative(side(edge, 1.0), side(edge, -1.0)).expect("a smooth side").0[0];
            assert!((slope - 1.0).abs() < 1e-12, "{edge}: {slope}");
        }
    }

    #[test]
    fn at_the_edge_of_what_can_be_evaluated_there_is_one_side() {
        let only = derivative(Side::default(), side(9.0, -1.0)).expect("a side");
        assert!((only.0[0] - 1.0).abs() < 1e-12);
        assert!(derivative(Side::default(), Side::default()).is_none());
    }
}
