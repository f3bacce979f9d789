//! One trial step of an explicit method, its error, and how stiff it found the system. The first M states move.

use super::segment::{Segment, Taken, Trial};
use super::tableau::MOST_STAGES;
use super::{Hybrid, Integrator};

impl<const N: usize, const G: usize, const F: usize, const CORE: usize> Integrator<N, G, F, CORE> {
    pub(super) fn explicit_trial<const M: usize>(
        &mut self,
        system: &mut impl Hybrid<N, G, F>,
        slope: [f64; N],
        h: f64,
    ) -> Trial<N> {
        let (stages, x) = self.stages::<M>(system, slope, h);
        let error = self.error_norm(&combined::<M, N>(self.tableau.error, &stages, h), &x);
        let taken = (error <= 1.0).then(|| Taken {
            segment: self.segment_of::<M>(&stages, &x, h),
            x,
            end_slope: Some(stages[self.tableau.last_stage()]),
            stiffness: self.stiffness_of::<M>(&stages, &x),
        });
        Trial { error, order: self.tableau.error_order, taken }
    }

    /// The slopes of all stages and the state at the end; the last stage is the slope there.
    fn stages<const M: usize>(
        &mut self,
        system: &mut impl Hybrid<N, G, F>,
        slope: [f64; N],
        h: f64,
    ) -> ([[f64; N]; MOST_STAGES], [f64; N]) {
        let mut stages = [[0.0; N]; MOST_STAGES];
        stages[0] = slope;
        let mut x = self.x;
        for (stage, weights) in self.tableau.weights.iter().enumerate() {
            let moved = combined::<M, N>(weights, &stages, h);
            for i in 0..M {
                x[i] = self.x[i] + moved[i];
            }
            stages[stage + 1] = system.derivative(self.t + h * self.tableau.nodes[stage], &x);
        }
        self.work.evaluations += self.tableau.weights.len() as u64;
        (stages, x)
    }

    /// h times the fastest rate of decay: the last two stages are slopes at the same time, at states that
    /// differ by little (Hairer, Norsett, Wanner II, IV.2).
    fn stiffness_of<const M: usize>(&self, stages: &[[f64; N]; MOST_STAGES], x: &[f64; N]) -> f64 {
        let last = self.tableau.last_stage();
        let apart = combined::<M, N>(self.tableau.apart, stages, 1.0);
        let (mut states, mut slopes) = (0.0, 0.0);
        for i in 0..M {
            let per_scale = 1.0 / self.scale[i].max(x[i].abs());
            states += (apart[i] * per_scale).powi(2);
            slopes += ((stages[last][i] - stages[last - 1][i]) * per_scale).powi(2);
        }
        // The states differ by h times this: h cancels.
        if states > 0.0 { (slopes / states).sqrt() } else { 0.0 }
    }

    fn segment_of<const M: usize>(
        &self,
        stages: &[[f64; N]; MOST_STAGES],
        x: &[f64; N],
        h: f64,
    ) -> Segment<N> {
        let end = &stages[self.tableau.last_stage()];
        let quartic = combined::<M, N>(self.tableau.dense, stages, h);
        let mut coefficients = [[0.0; N]; 6];
        coefficients[0] = self.x;
        coefficients[4][..M].copy_from_slice(&quartic);
        for i in 0..M {
            let rise = x[i] - self.x[i];
            let bend = h * stages[0][i] - rise;
            coefficients[1][i] = rise;
            coefficients[2][i] = bend;
            coefficients[3][i] = rise - h * end[i] - bend;
        }
        Segment { start: self.t, width: h, coefficients, refined: false }
    }
}

/// h times the weighted sum of the stages.
fn combined<const M: usize, const N: usize>(
    weights: &[f64],
    stages: &[[f64; N]; MOST_STAGES],
    h: f64,
) -> [f64; M] {
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
