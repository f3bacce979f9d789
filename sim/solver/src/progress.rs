//! The progress of an integration: its state, its accuracy and its cost, from which a step begins.

use crate::dense_output::{DenseOutput, REFINED_AT};
use crate::statistics::Statistics;
use crate::system::System;

/// The start of a step.
#[derive(Clone, Debug)]
pub(crate) struct Progress<const N: usize> {
    pub t: f64,
    pub x: [f64; N],
    /// Allowed error of a step, in each state's scale.
    pub tolerance: f64,
    /// The scale of each state.
    pub scale: [f64; N],
    pub statistics: Statistics,
}

impl<const N: usize> Progress<N> {
    /// The measure for an error of each of the first M states: the state, but not less than its scale.
    #[inline(always)]
    pub fn sizes<const M: usize>(&self, x: &[f64; N]) -> [f64; M] {
        std::array::from_fn(|i| larger(self.scale[i], x[i].abs()))
    }

    /// The largest of several errors, each over its state's size, over the allowed error.
    #[inline(always)]
    pub fn error_norm<const M: usize>(&self, error: &[f64; M], sizes: &[f64; M]) -> f64 {
        let (mut largest, mut sum) = (0.0, 0.0);
        for i in 0..M {
            let ratio = error[i].abs() / sizes[i];
            largest = larger(largest, ratio);
            sum += ratio;
        }
        // The larger one ignores a NaN, the sum does not.
        if f64::is_finite(sum) { largest / self.tolerance } else { f64::INFINITY }
    }

    /// How far each of the first M states moves to one, in allowed errors: the largest.
    #[inline(always)]
    pub fn moved_to<const M: usize>(&self, x: &[f64; N], sizes: &[f64; M]) -> f64 {
        self.error_norm(&std::array::from_fn(|i| x[i] - self.x[i]), sizes)
    }

    /// Makes the dense output as accurate inside a step as at its end; returns whether it was not yet.
    pub fn refine<const G: usize, const E: usize>(
        &mut self,
        system: &mut impl System<N, G, E>,
        step: &mut DenseOutput<N>,
    ) -> bool {
        let new = !step.refined;
        if new {
            let derivatives =
                REFINED_AT.map(|part| system.derivative(step.start + part * step.width, &step.at_part(part)));
            self.statistics.n_rhs_evaluations += 2;
            step.refine(&derivatives);
        }
        new
    }
}

/// The larger of two numbers; the first one if the second is not a number. A single instruction, which `f64::max` is not.
#[inline(always)]
fn larger(one: f64, other: f64) -> f64 {
    if other > one { other } else { one }
}
