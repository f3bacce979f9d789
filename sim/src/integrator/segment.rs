//! The dense output of a step.

/// One step's dense output: `x(t0 + theta h)` as a polynomial in theta.
#[derive(Clone, Debug)]
pub(super) struct Segment<const N: usize> {
    pub start: f64,
    pub width: f64,
    pub coefficients: [[f64; N]; 5],
}

impl<const N: usize> Segment<N> {
    pub fn at(&self, t: f64) -> [f64; N] {
        self.at_part((t - self.start) / self.width)
    }

    pub fn at_part(&self, theta: f64) -> [f64; N] {
        let [r1, r2, r3, r4, r5] = &self.coefficients;
        let rest = 1.0 - theta;
        std::array::from_fn(|i| r1[i] + theta * (r2[i] + rest * (r3[i] + theta * (r4[i] + rest * r5[i]))))
    }
}
