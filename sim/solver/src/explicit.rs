//! One trial step of an explicit method, its error, and how stiff it found the system. The first M states move.

use crate::dense_output::{AcceptedStep, DenseOutput, TrialError};
use crate::progress::Progress;
use crate::system::System;
use crate::tableau::{BOGACKI_SHAMPINE, DORMAND_PRINCE, MAX_STAGES, MERSON, Method, Tableau};

impl<const N: usize> Progress<N> {
    /// The step goes to `step` if its error is small.
    pub(crate) fn explicit_step<const M: usize, const G: usize, const E: usize>(
        &mut self,
        tableau: &Tableau,
        system: &mut impl System<N, G, E>,
        derivative: &[f64; N],
        h: f64,
        step: &mut AcceptedStep<N>,
    ) -> TrialError {
        // Of a tableau that the compiler knows it unrolls the sums.
        match tableau.method {
            Method::DormandPrince => self.step_by::<M, G, E>(&DORMAND_PRINCE, system, derivative, h, step),
            Method::Merson => self.step_by::<M, G, E>(&MERSON, system, derivative, h, step),
        }
    }

    /// The same by the method for short steps.
    pub(crate) fn short_step<const M: usize, const G: usize, const E: usize>(
        &mut self,
        system: &mut impl System<N, G, E>,
        derivative: &[f64; N],
        h: f64,
        step: &mut AcceptedStep<N>,
    ) -> TrialError {
        self.step_by::<M, G, E>(&BOGACKI_SHAMPINE, system, derivative, h, step)
    }

    #[inline(always)]
    fn step_by<const M: usize, const G: usize, const E: usize>(
        &mut self,
        tableau: &Tableau,
        system: &mut impl System<N, G, E>,
        derivative: &[f64; N],
        h: f64,
        step: &mut AcceptedStep<N>,
    ) -> TrialError {
        let (stages, x, end_derivative) = self.stages::<M, G, E>(tableau, system, derivative, h);
        let sizes = self.sizes::<M>(&x);
        let error = self.error_norm(&combined(tableau.error, &stages, h), &sizes);
        let trial = TrialError { error, order: tableau.error_order };
        if trial.is_small() {
            self.write_dense_output::<M>(tableau, &stages, &x, h, &mut step.dense);
            step.x = x;
            step.end_derivative = Some(end_derivative);
            if !tableau.apart.is_empty() {
                step.stiffness = stiffness_of(tableau, &stages, &sizes);
                step.moved = self.moved_to::<M>(&x, &sizes);
            }
        }
        trial
    }

    /// The derivatives of all stages, and the state and the derivative at the end; the last stage is the latter.
    #[inline(always)]
    fn stages<const M: usize, const G: usize, const E: usize>(
        &mut self,
        tableau: &Tableau,
        system: &mut impl System<N, G, E>,
        derivative: &[f64; N],
        h: f64,
    ) -> ([[f64; M]; MAX_STAGES], [f64; N], [f64; N]) {
        let mut stages = [[0.0; M]; MAX_STAGES];
        stages[0].copy_from_slice(&derivative[..M]);
        let mut x = self.x;
        self.stage::<1, M, G, E>(tableau, system, &mut stages, &mut x, h);
        self.stage::<2, M, G, E>(tableau, system, &mut stages, &mut x, h);
        let mut slope = self.stage::<3, M, G, E>(tableau, system, &mut stages, &mut x, h);
        if tableau.last_stage() >= 5 {
            self.stage::<4, M, G, E>(tableau, system, &mut stages, &mut x, h);
            slope = self.stage::<5, M, G, E>(tableau, system, &mut stages, &mut x, h);
        }
        if tableau.last_stage() == 6 {
            slope = self.stage::<6, M, G, E>(tableau, system, &mut stages, &mut x, h);
        }
        self.statistics.n_rhs_evaluations += tableau.weights.len() as u64;
        (stages, x, slope)
    }

    /// The derivative of one stage, at the state that the ones before it lead to.
    #[inline(always)]
    fn stage<const STAGE: usize, const M: usize, const G: usize, const E: usize>(
        &self,
        tableau: &Tableau,
        system: &mut impl System<N, G, E>,
        stages: &mut [[f64; M]; MAX_STAGES],
        x: &mut [f64; N],
        h: f64,
    ) -> [f64; N] {
        let moved = combined(tableau.weights[STAGE - 1], stages, h);
        for i in 0..M {
            x[i] = self.x[i] + moved[i];
        }
        let slope = system.derivative(self.t + h * tableau.nodes[STAGE - 1], x);
        stages[STAGE].copy_from_slice(&slope[..M]);
        slope
    }

    #[inline(always)]
    fn write_dense_output<const M: usize>(
        &self,
        tableau: &Tableau,
        stages: &[[f64; M]; MAX_STAGES],
        x: &[f64; N],
        h: f64,
        dense: &mut DenseOutput<N>,
    ) {
        (dense.start, dense.width, dense.n_moving, dense.refined) = (self.t, h, M, false);
        let end = &stages[tableau.last_stage()];
        let quartic = combined(tableau.dense, stages, h);
        let [r1, r2, r3, r4, r5, r6] = &mut dense.coefficients;
        *r1 = self.x;
        for i in 0..M {
            let rise = x[i] - self.x[i];
            let bend = h * stages[0][i] - rise;
            (r2[i], r3[i], r4[i]) = (rise, bend, rise - h * end[i] - bend);
            (r5[i], r6[i]) = (quartic[i], 0.0);
        }
    }
}

/// h times the fastest rate of decay: the last two stages are slopes at the same time, at states that
/// differ by little (Hairer, Norsett, Wanner II, IV.2).
///
/// Not inlined: the compiler would begin the sums of all methods and sizes before it knows which one is needed.
#[inline(never)]
fn stiffness_of<const M: usize>(tableau: &Tableau, stages: &[[f64; M]; MAX_STAGES], sizes: &[f64; M]) -> f64 {
    let last = tableau.last_stage();
    let apart = combined(tableau.apart, stages, 1.0);
    let (mut states, mut slopes) = (0.0, 0.0);
    for i in 0..M {
        let per_size = 1.0 / sizes[i];
        states += (apart[i] * per_size).powi(2);
        slopes += ((stages[last][i] - stages[last - 1][i]) * per_size).powi(2);
    }
    // The states differ by h times this: h cancels.
    if states > 0.0 { (slopes / states).sqrt() } else { 0.0 }
}

/// h times the weighted sum of the stages.
#[inline(always)]
fn combined<const M: usize>(weights: &[f64], stages: &[[f64; M]; MAX_STAGES], h: f64) -> [f64; M] {
    let mut sum = [0.0; M];
    for (&weight, stage) in weights.iter().zip(stages) {
        if weight != 0.0 {
            let weight = h * weight;
            for (sum, slope) in sum.iter_mut().zip(stage) {
                *sum += weight * slope;
            }
        }
    }
    sum
}
