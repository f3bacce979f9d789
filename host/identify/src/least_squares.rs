//! The minimum of a sum of squares (Levenberg 1944, Marquardt 1963; damping after Nielsen 1999).
//!
//! ```text
//! (J' J + lambda D) d = -J' r,     D = diag(J' J)
//! ```
//!
//! The derivatives of a search by secants are those at its start, corrected step by step (Broyden 1965), each unknown
//! weighted by what it does to the residuals:
//!
//! ```text
//! J + (r(u + d) - r(u) - J d) (D d)' / (d' D d)
//! ```
//!
//! Such a step costs a single evaluation, so effects can be tried out one after the other.
//!
//! Limits of the unknowns are kept ([`super::limits`]). Ours, because a point that cannot be evaluated (a rig that is
//! not valid, a run that ends early) must shorten the step; the crates for it end there.

use nalgebra::{DMatrix, DVector};

use super::limits::{Limit, step_within};

/// A sum of squares.
pub trait Problem {
    /// The residuals at `u`; None where there are none.
    fn residuals(&self, u: &[f64]) -> Option<DVector<f64>>;
    /// Their derivatives at `u`, where the residuals are `at`; a column an unknown.
    fn jacobian(&self, u: &[f64], at: &DVector<f64>) -> Option<DMatrix<f64>>;
    /// What the unknowns keep.
    fn limits(&self) -> Vec<Limit>;
    /// Longest step along an unknown: beyond it the linear model is not to be trusted.
    fn longest(&self, unknown: usize) -> f64;
    /// Whether each unknown is limited to its longest step on its own, while the others take their full step; otherwise the
    /// whole step is shortened.
    fn is_confined(&self) -> bool {
        false
    }
    /// Whether a search must end where it is.
    fn is_cut(&self) -> bool {
        false
    }
}

/// Where a search ended.
#[derive(Clone, Debug)]
pub struct Minimum {
    /// The point.
    pub u: Vec<f64>,
    /// The residuals there.
    pub residuals: DVector<f64>,
    /// Their derivatives.
    pub jacobian: DMatrix<f64>,
    /// Whether it is a minimum.
    pub converged: bool,
}

impl Minimum {
    /// The derivatives, corrected by what a step to `u` did to the residuals.
    fn corrected(&self, u: &[f64], residuals: &DVector<f64>) -> DMatrix<f64> {
        let step = DVector::from_fn(u.len(), |i, _| u[i] - self.u[i]);
        let weighted = DVector::from_fn(u.len(), |i, _| self.jacobian.column(i).norm_squared() * step[i]);
        let off = residuals - &self.residuals - &self.jacobian * &step;
        let size = weighted.dot(&step);
        if size > 0.0 { &self.jacobian + off * weighted.transpose() / size } else { self.jacobian.clone() }
    }
}

/// Most steps of a search to the end.
const MAX_STEPS: usize = 40;

/// Most steps of a search that only has to come near.
const MAX_ROUGH_STEPS: usize = 12;

/// Most steps of a search by secants.
const MAX_SECANTS: usize = 20;

/// A search is at its end where the next step promises less than this part of the sum of squares per degree
/// of freedom: a seventh of a standard error.
const NEAR: f64 = 0.02;

/// It is also where so many steps in a row have gained less: a kink of the sum promises what it does not keep.
const IDLE_STEPS: usize = 3;

/// A rough search ends where a step gains less than this part of the sum.
const ROUGH_GAIN: f64 = 5e-3;

/// Damping at the start of a search that has far to go, and of one that is near.
const DAMPING: [f64; 2] = [1e-3, 1e-8];

/// Damping at which a search stops.
const MAX_DAMPING: f64 = 1e10;

/// Searches from `start`: to the end, or near it. None when there are no residuals or derivatives at `start`.
pub fn minimise(
    problem: &impl Problem,
    start: &[f64],
    to_the_end: bool,
    progress: &mut dyn FnMut(&str),
) -> Option<Minimum> {
    let mut search = Search::at(problem, start, DAMPING[usize::from(to_the_end)])?;
    let most = if to_the_end { MAX_STEPS } else { MAX_ROUGH_STEPS };
    let mut idle = 0;
    for _ in 0..most {
        if problem.is_cut() {
            break;
        }
        let before = search.cost();
        search.step(problem);
        idle = if before - search.cost() < search.near() { idle + 1 } else { 0 };
        search.minimum.converged |= idle >= IDLE_STEPS;
        progress(&format!("sum of squares {:.6e}", search.cost()));
        if search.stuck
            || search.minimum.converged
            || (!to_the_end && search.cost() > (1.0 - ROUGH_GAIN) * before)
        {
            break;
        }
    }
    Some(search.minimum)
}

/// Searches from a point whose derivatives are known, roughly at least, without evaluating them again.
pub(crate) fn minimise_by_secants(problem: &impl Problem, start: Minimum) -> Minimum {
    let mut search = Search::from(problem, start, DAMPING[1]);
    search.by_secants = true;
    let mut idle = 0;
    for _ in 0..MAX_SECANTS {
        if problem.is_cut() {
            break;
        }
        let before = search.cost();
        search.step(problem);
        idle = if before - search.cost() < search.near() { idle + 1 } else { 0 };
        search.minimum.converged |= idle >= IDLE_STEPS;
        if search.stuck || search.minimum.converged {
            break;
        }
    }
    search.minimum
}

struct Search {
    minimum: Minimum,
    limits: Vec<Limit>,
    damping: f64,
    growth: f64,
    stuck: bool,
    by_secants: bool,
}

impl Search {
    fn at(problem: &impl Problem, start: &[f64], damping: f64) -> Option<Search> {
        let residuals = problem.residuals(start)?;
        let jacobian = problem.jacobian(start, &residuals)?;
        let minimum = Minimum { u: start.to_vec(), residuals, jacobian, converged: false };
        Some(Search::from(problem, minimum, damping))
    }

    fn from(problem: &impl Problem, minimum: Minimum, damping: f64) -> Search {
        let limits = problem.limits();
        Search { minimum, limits, damping, growth: 2.0, stuck: false, by_secants: false }
    }

    fn cost(&self) -> f64 {
        self.minimum.residuals.norm_squared()
    }

    /// A negligible gain of the sum.
    fn near(&self) -> f64 {
        let freedom = self.minimum.residuals.len().saturating_sub(self.minimum.u.len()).max(1);
        NEAR * self.cost() / freedom as f64
    }

    /// One step that gains something; none where no step does.
    fn step(&mut self, problem: &impl Problem) {
        let jacobian = &self.minimum.jacobian;
        let (normal, gradient) = (jacobian.tr_mul(jacobian), jacobian.tr_mul(&self.minimum.residuals));
        let (near, limits) = (self.near(), self.limits_of_a_step(problem));
        while self.damping < MAX_DAMPING {
            let matrix = damped(&normal, self.damping);
            let Some(step) = step_within(&matrix, &gradient, &limits, &self.minimum.u) else {
                self.grow();
                continue;
            };
            let promised = -gradient.dot(&step) - 0.5 * (&normal * &step).dot(&step);
            if 2.0 * promised < near && self.damping <= 1.0 {
                self.minimum.converged = true;
                return;
            }
            let step = limited(step, problem);
            let u: Vec<f64> = self.minimum.u.iter().zip(&step).map(|(u, d)| u + d).collect();
            if self.take(problem, u) {
                return;
            }
            self.grow();
        }
        self.stuck = true;
    }

    /// What a step keeps.
    fn limits_of_a_step(&self, problem: &impl Problem) -> Vec<Limit> {
        let mut limits = self.limits.clone();
        if problem.is_confined() {
            for (i, u) in self.minimum.u.iter().enumerate() {
                let longest = problem.longest(i);
                limits.extend([Limit::at_least(i, u - longest), Limit::at_most(i, u + longest)]);
            }
        }
        limits
    }

    /// Moves to `u` if that is better, and continues from there.
    fn take(&mut self, problem: &impl Problem, u: Vec<f64>) -> bool {
        let Some(residuals) = problem.residuals(&u).filter(|r| r.norm_squared() < self.cost()) else {
            return false;
        };
        let jacobian = match self.by_secants {
            true => Some(self.minimum.corrected(&u, &residuals)),
            false => problem.jacobian(&u, &residuals),
        };
        let Some(jacobian) = jacobian else { return false };
        self.minimum = Minimum { u, residuals, jacobian, converged: false };
        self.damping = (self.damping / 5.0).max(1e-9);
        self.growth = 2.0;
        true
    }

    fn grow(&mut self) {
        self.damping *= self.growth;
        self.growth *= 2.0;
    }
}

fn damped(normal: &DMatrix<f64>, damping: f64) -> DMatrix<f64> {
    let mut matrix = normal.clone();
    for i in 0..matrix.nrows() {
        matrix[(i, i)] += damping * normal[(i, i)];
    }
    matrix
}

/// The step, shortened where an unknown would go further than can be trusted.
fn limited(step: DVector<f64>, problem: &impl Problem) -> DVector<f64> {
    let longest = step.iter().enumerate().map(|(i, d)| d.abs() / problem.longest(i)).fold(0.0, f64::max);
    if longest > 1.0 { step / longest } else { step }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    /// Rosenbrock's valley, without points left of a wall, and within limits.
    struct Valley {
        wall: f64,
        limits: Vec<Limit>,
        is_confined: bool,
    }

    fn from(wall: f64) -> Valley {
        Valley { wall, limits: Vec::new(), is_confined: false }
    }

    impl Problem for Valley {
        fn residuals(&self, u: &[f64]) -> Option<DVector<f64>> {
            (u[0] >= self.wall)
                .then(|| DVector::from_vec(vec![10.0 * (u[1] - u[0] * u[0]), 1.0 - u[0], 1e-3, 1e-3]))
        }

        fn jacobian(&self, u: &[f64], _: &DVector<f64>) -> Option<DMatrix<f64>> {
            let rows = [-20.0 * u[0], 10.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
            Some(DMatrix::from_row_slice(4, 2, &rows))
        }

        fn limits(&self) -> Vec<Limit> {
            self.limits.clone()
        }

        fn longest(&self, _: usize) -> f64 {
            0.3
        }

        fn is_confined(&self) -> bool {
            self.is_confined
        }
    }

    /// A valley whose residuals may be evaluated so many times.
    struct Paid {
        valley: Valley,
        left: Cell<i32>,
    }

    impl Problem for Paid {
        fn residuals(&self, u: &[f64]) -> Option<DVector<f64>> {
            self.left.set(self.left.get() - 1);
            self.valley.residuals(u)
        }

        fn jacobian(&self, u: &[f64], at: &DVector<f64>) -> Option<DMatrix<f64>> {
            self.valley.jacobian(u, at)
        }

        fn limits(&self) -> Vec<Limit> {
            Vec::new()
        }

        fn longest(&self, unknown: usize) -> f64 {
            self.valley.longest(unknown)
        }

        fn is_cut(&self) -> bool {
            self.left.get() <= 0
        }
    }

    #[test]
    fn a_search_whose_budget_is_spent_ends_with_the_step_that_it_is_at() {
        let spent = |search: &dyn Fn(&Paid) -> Minimum| {
            let paid = Paid { valley: from(-9.0), left: Cell::new(6) };
            assert!(!search(&paid).converged, "it is cut");
            6 - paid.left.get()
        };
        let u = [-1.2, 1.0];
        let full = |paid: &Paid| minimise(paid, &u, true, &mut |_| {}).expect("residuals");
        let by_secants = |paid: &Paid| {
            let residuals = paid.valley.residuals(&u).expect("residuals");
            let jacobian = paid.valley.jacobian(&u, &residuals).expect("derivatives");
            minimise_by_secants(paid, Minimum { u: u.to_vec(), residuals, jacobian, converged: false })
        };
        for evaluations in [spent(&full), spent(&by_secants)] {
            assert!((6..20).contains(&evaluations), "{evaluations}");
        }
    }

    #[test]
    fn the_end_of_a_curved_valley_is_found() {
        let minimum = minimise(&from(-9.0), &[-1.2, 1.0], true, &mut |_| {}).expect("residuals");
        assert!(minimum.converged);
        assert!((minimum.u[0] - 1.0).abs() < 1e-3 && (minimum.u[1] - 1.0).abs() < 1e-3, "{:?}", minimum.u);
    }

    #[test]
    fn secants_from_rough_derivatives_find_the_end_of_a_curved_valley_too() {
        let valley = from(-9.0);
        let u = vec![0.6, 0.5];
        let residuals = valley.residuals(&u).expect("residuals");
        let jacobian = 1.1 * valley.jacobian(&u, &residuals).expect("derivatives");
        let start = Minimum { u, residuals, jacobian, converged: false };
        let minimum = minimise_by_secants(&valley, start);
        assert!(minimum.converged);
        assert!((minimum.u[0] - 1.0).abs() < 1e-2 && (minimum.u[1] - 1.0).abs() < 2e-2, "{:?}", minimum.u);
    }

    #[test]
    fn a_search_from_where_there_are_no_residuals_finds_nothing() {
        assert!(minimise(&from(0.0), &[-1.2, 1.0], true, &mut |_| {}).is_none());
    }

    #[test]
    fn a_search_goes_on_along_points_that_cannot_be_evaluated() {
        let minimum = minimise(&from(-1.2), &[-1.2, 1.0], true, &mut |_| {}).expect("residuals");
        assert!(minimum.converged && (minimum.u[0] - 1.0).abs() < 1e-3, "{:?}", minimum.u);
    }

    #[test]
    fn a_step_keeps_its_direction_where_it_is_as_long_as_is_trusted() {
        let valley = from(-9.0);
        assert_eq!(limited(DVector::from_vec(vec![0.6, -0.3]), &valley).as_slice(), [0.3, -0.15]);
        assert_eq!(limited(DVector::from_vec(vec![0.2, -0.3]), &valley).as_slice(), [0.2, -0.3]);
    }

    /// From (0, -3) the bottom is 3 away along the second unknown.
    #[test]
    fn an_unknown_that_has_far_to_go_does_not_stop_the_others_of_a_confined_step() {
        let step = |is_confined| {
            let valley = Valley { is_confined, ..from(-9.0) };
            let mut search = Search::at(&valley, &[0.0, -3.0], DAMPING[1]).expect("residuals");
            search.step(&valley);
            search.minimum.u
        };
        let (shortened, confined) = (step(false), step(true));
        assert!((shortened[1] + 2.7).abs() < 1e-6 && (confined[1] + 2.7).abs() < 1e-6);
        assert!(confined[0] > 0.29 && shortened[0] < 0.15, "{confined:?} {shortened:?}");
    }

    /// On the edge u_0 = 0.5 of the valley its bottom is at u_1 = 0.25.
    #[test]
    fn a_search_ends_at_the_best_point_within_the_limits() {
        let valley = Valley { limits: vec![Limit::at_most(0, 0.5)], ..from(-9.0) };
        let minimum = minimise(&valley, &[-1.2, 1.0], true, &mut |_| {}).expect("residuals");
        assert!(minimum.converged, "{:?}", minimum.u);
        // A seventh of a standard error, which is 0.035.
        assert!((minimum.u[0] - 0.5).abs() < 1e-9 && (minimum.u[1] - 0.25).abs() < 5e-3, "{:?}", minimum.u);
    }
}
