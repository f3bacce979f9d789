//! One trial step of an explicit method, its error, and how stiff it found the system.

use super::segment::{Segment, Trial};
use super::tableau::MOST_STAGES;
use super::{Hybrid, Integrator};

impl<const N: usize, const G: usize, const F: usize> Integrator<N, G, F> {
    pub(super) fn explicit_trial(
        &mut self,
        system: &mut impl Hybrid<N, G, F>,
        slope: [f64; N],
        h: f64,
    ) -> Trial<N> {
        let (stages, x) = self.stages(system, slope, h);
        let error: [f64; N] = std::array::from_fn(|i| {
            h * self.tableau.error.iter().zip(&stages).map(|(&e, k)| e * k[i]).sum::<f64>()
        });
        Trial {
            error: self.error_norm(&error, &x),
            order: self.tableau.error_order,
            segment: self.segment_of(&stages, &x, h),
            x,
            end_slope: Some(stages[self.tableau.last_stage()]),
            stiffness: self.stiffness_of(&stages, &x),
        }
    }

    /// The slopes of all stages and the state at the end; the last stage is the slope there.
    fn stages(
        &mut self,
        system: &mut impl Hybrid<N, G, F>,
        slope: [f64; N],
        h: f64,
    ) -> ([[f64; N]; MOST_STAGES], [f64; N]) {
        let mut stages = [[0.0; N]; MOST_STAGES];
        stages[0] = slope;
        let mut x = self.x;
        for (stage, weights) in self.tableau.weights.iter().enumerate() {
            x = self.x;
            for (&weight, earlier) in weights.iter().zip(&stages) {
                if weight != 0.0 {
                    for (value, slope) in x.iter_mut().zip(earlier) {
                        *value += h * weight * slope;
                    }
                }
            }
            stages[stage + 1] = system.derivative(self.t + h * self.tableau.nodes[stage], &x);
        }
        self.work.evaluations += self.tableau.weights.len() as u64;
        (stages, x)
    }

    /// h times the fastest rate of decay: the last two stages are slopes at the same time, at states that
    /// differ by little (Hairer, Norsett, Wanner II, IV.2).
    fn stiffness_of(&self, stages: &[[f64; N]; MOST_STAGES], x: &[f64; N]) -> f64 {
        let last = self.tableau.last_stage();
        let [to_last, to_other] = [last - 1, last - 2].map(|row| self.tableau.weights[row]);
        let apart = |i: usize| -> f64 {
            let weight = |row: &[f64], stage: usize| row.get(stage).copied().unwrap_or(0.0);
            (0..last).map(|stage| (weight(to_last, stage) - weight(to_other, stage)) * stages[stage][i]).sum()
        };
        let mut states = 0.0;
        let mut slopes = 0.0;
        for i in 0..N {
            let scale = self.scale[i].max(x[i].abs());
            states += (apart(i) / scale).powi(2);
            slopes += ((stages[last][i] - stages[last - 1][i]) / scale).powi(2);
        }
        // The states differ by h times this: h cancels.
        if states > 0.0 { (slopes / states).sqrt() } else { 0.0 }
    }

    fn segment_of(&self, stages: &[[f64; N]; MOST_STAGES], x: &[f64; N], h: f64) -> Segment<N> {
        let last = self.tableau.last_stage();
        let mut coefficients = [[0.0; N]; 5];
        for i in 0..N {
            let rise = x[i] - self.x[i];
            let bend = h * stages[0][i] - rise;
            let quartic: f64 = self.tableau.dense.iter().zip(stages).map(|(&d, k)| d * k[i]).sum();
            coefficients[0][i] = self.x[i];
            coefficients[1][i] = rise;
            coefficients[2][i] = bend;
            coefficients[3][i] = rise - h * stages[last][i] - bend;
            coefficients[4][i] = h * quartic;
        }
        Segment { start: self.t, width: h, coefficients }
    }
}
