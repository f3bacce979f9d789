//! One trial step of a method for stiff stretches: RODAS, a stiffly accurate, L-stable Rosenbrock method of order 4(3)
//! (Hairer and Wanner, Solving Ordinary Differential Equations II, IV.7 and IV.10), with its interpolant of order 3.
//!
//! ```text
//! (1/(h gamma) - J) u_i = f(t + alpha_i h, x + sum_j a_ij u_j) + sum_j c_ij u_j / h + h gamma_i df/dt
//! x_1 = x + sum_j a_5j u_j + u_5 + u_6,   error u_6
//! ```
//!
//! J and df/dt by differences: each state is moved by little more than the tolerance allows, because a
//! right-hand side may bend within that much of a state. It may bend within less: a flow between two volumes that are all but
//! equal goes with the root of their difference. One-sided differences then are off by as much as they are wide, and steps
//! are so short that this error stays small: they crawl.

use crate::dense_output::{AcceptedStep, DenseOutput, TrialError};
use crate::linear::Factors;
use crate::progress::Progress;
use crate::system::System;

const STAGES: usize = 6;

const GAMMA: f64 = 0.25;
/// The interpolant is of order 3, and so is the method beside it.
const ERROR_ORDER: f64 = 4.0;
/// Factors on the distance by which states are moved, tried in turn as long as steps crawl. A difference wider than
/// the bend of a right-hand side is wrong, and a narrower one loses digits.
const FINER: [f64; 5] = [1.0, 1e-1, 1e-2, 1e-3, 1e-4];
/// s: over which df/dt is taken at most.
const MOMENT: f64 = 1e-6;

const ALPHA: [f64; STAGES] = [0.0, 0.386, 0.21, 0.63, 1.0, 1.0];
const GAMMA_I: [f64; STAGES] = [0.25, -0.1043, 0.1035, -0.036_200_000_000_000_23, 0.0, 0.0];
const A: [&[f64]; STAGES] = [
    &[],
    &[1.544],
    &[0.946_678_528_081_582_6, 0.255_701_169_898_328_4],
    &[3.314_825_187_068_521, 2.896_124_015_972_201, 0.998_641_913_997_781_7],
    &[1.221_224_509_226_641, 6.019_134_481_288_629, 12.537_083_329_320_87, -0.687_886_036_105_895],
    &[1.221_224_509_226_641, 6.019_134_481_288_629, 12.537_083_329_320_87, -0.687_886_036_105_895, 1.0],
];
const C: [&[f64]; STAGES] = [
    &[],
    &[-5.6688],
    &[-2.430_093_356_833_875, -0.206_359_915_709_191_5],
    &[-0.107_352_905_815_137_5, -9.594_562_251_023_355, -20.470_286_148_096_16],
    &[7.496_443_313_967_647, -10.246_804_314_643_52, -33.999_903_528_199_05, 11.708_908_932_061_6],
    &[
        8.083_246_795_921_522,
        -7.981_132_988_064_893,
        -31.521_594_328_743_71,
        16.319_305_431_231_36,
        -6.058_818_238_834_054,
    ],
];
const DENSE: [[f64; 5]; 2] = [
    [
        10.126_235_083_445_86,
        -7.487_995_877_610_167,
        -34.800_918_615_557_47,
        -7.992_771_707_568_823,
        1.025_137_723_295_662,
    ],
    [
        -0.676_280_339_280_125_3,
        6.087_714_651_680_015,
        16.430_843_208_924_78,
        24.767_225_114_183_86,
        -6.594_389_125_716_872,
    ],
];

/// The derivatives of dx/dt by the states that move and by time at the beginning of a step.
pub(crate) struct Linearization<const N: usize> {
    jacobian: [[f64; N]; N],
    by_time: [f64; N],
}

impl<const N: usize> Progress<N> {
    /// The preparation of a step from the present state, for any size. Where steps have crawled so often, each state is moved
    /// both ways, and by less the next time.
    pub(crate) fn linearize<const G: usize, const E: usize>(
        &mut self,
        system: &mut impl System<N, G, E>,
        derivative: &[f64; N],
        crawled: u32,
    ) -> Linearization<N> {
        let mut jacobian = [[0.0; N]; N];
        let (n_moving, both_ways) = (system.n_moving(), crawled > 0);
        let part = self.moved_part(crawled);
        for j in 0..n_moving {
            let by = part * self.scale[j].max(self.x[j].abs());
            let (x, moved) = self.moved(system, j, by);
            let (from, unmoved) =
                if both_ways { self.moved(system, j, -by) } else { (self.x[j], *derivative) };
            for (i, row) in jacobian.iter_mut().enumerate() {
                row[j] = (moved[i] - unmoved[i]) / (x - from);
            }
        }
        let later = system.derivative(self.t + MOMENT, &self.x);
        self.statistics.n_rhs_evaluations += (1 + u64::from(both_ways)) * n_moving as u64 + 1;
        Linearization { jacobian, by_time: std::array::from_fn(|i| (later[i] - derivative[i]) / MOMENT) }
    }

    /// A state moved by a little, and the derivative there.
    fn moved<const G: usize, const E: usize>(
        &self,
        system: &mut impl System<N, G, E>,
        state: usize,
        by: f64,
    ) -> (f64, [f64; N]) {
        let mut x = self.x;
        x[state] += by;
        (x[state], system.derivative(self.t, &x))
    }

    /// The part of a state by which it is moved.
    fn moved_part(&self, crawled: u32) -> f64 {
        let part = (10.0 * self.tolerance).clamp(1e-10, 1e-9);
        match crawled {
            0 => part,
            times => part * FINER[(times - 1) as usize % FINER.len()],
        }
    }

    /// A trial step in which the first M states move. It goes to `step` if its error is small.
    pub(crate) fn rosenbrock_step<const M: usize, const G: usize, const E: usize>(
        &mut self,
        system: &mut impl System<N, G, E>,
        derivative: &[f64; N],
        linearization: &Linearization<N>,
        h: f64,
        step: &mut AcceptedStep<N>,
    ) -> TrialError {
        let u = self.increments::<M, G, E>(system, derivative, linearization, h);
        let mut x = self.x;
        for (i, x) in x.iter_mut().enumerate().take(M) {
            *x += combined(A[5], &u, i);
            *x += u[5][i];
        }
        let sizes = self.sizes::<M>(&x);
        let trial = TrialError { error: self.error_norm(&u[5], &sizes), order: ERROR_ORDER };
        if trial.is_small() {
            *step = AcceptedStep {
                dense: DenseOutput {
                    start: self.t,
                    width: h,
                    coefficients: self.interpolant(&u, &x),
                    n_moving: M,
                    refined: true,
                },
                x,
                end_derivative: None,
                stiffness: h * self.fastest::<M>(&linearization.jacobian),
                moved: self.moved_to(&x, &sizes),
            };
        }
        trial
    }

    fn increments<const M: usize, const G: usize, const E: usize>(
        &mut self,
        system: &mut impl System<N, G, E>,
        derivative: &[f64; N],
        linearization: &Linearization<N>,
        h: f64,
    ) -> [[f64; M]; STAGES] {
        let moving = std::array::from_fn(|i| std::array::from_fn(|j| linearization.jacobian[i][j]));
        let factors = Factors::<M>::of(moving, 1.0 / (h * GAMMA));
        let mut u = [[0.0; M]; STAGES];
        for stage in 0..STAGES {
            let f = if stage == 0 {
                *derivative
            } else {
                self.statistics.n_rhs_evaluations += 1;
                let mut x = self.x;
                for (i, x) in x.iter_mut().enumerate().take(M) {
                    *x += combined(A[stage], &u, i);
                }
                system.derivative(self.t + ALPHA[stage] * h, &x)
            };
            let by_time = h * GAMMA_I[stage];
            u[stage] = factors.solve(std::array::from_fn(|i| {
                f[i] + combined(C[stage], &u, i) / h + by_time * linearization.by_time[i]
            }));
        }
        u
    }

    fn interpolant<const M: usize>(&self, u: &[[f64; M]; STAGES], x: &[f64; N]) -> [[f64; N]; 6] {
        let mut coefficients = [[0.0; N]; 6];
        coefficients[0] = self.x;
        for i in 0..M {
            coefficients[1][i] = x[i] - self.x[i];
            coefficients[2][i] = combined(&DENSE[0], u, i);
            coefficients[3][i] = combined(&DENSE[1], u, i);
        }
        coefficients
    }

    /// A bound on the rates of decay, 1/s: the norm of J in the states' scales.
    fn fastest<const M: usize>(&self, jacobian: &[[f64; N]; N]) -> f64 {
        let scale: [f64; M] = std::array::from_fn(|i| self.scale[i].max(self.x[i].abs()));
        let row = |i: usize| (0..M).map(|j| jacobian[i][j].abs() * scale[j]).sum::<f64>() / scale[i];
        (0..M).map(row).fold(0.0, f64::max)
    }
}

fn combined<const M: usize>(weights: &[f64], u: &[[f64; M]; STAGES], i: usize) -> f64 {
    weights.iter().zip(u).map(|(weight, u)| weight * u[i]).sum()
}
