//! A step and its dense output.

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

/// A step that was tried.
pub(super) struct Trial<const N: usize> {
    /// Its error over what is allowed, and the power of the step size that it goes with.
    pub error: f64,
    pub order: f64,
    /// None where the error is more than that, or no number.
    pub taken: Option<Taken<N>>,
}

/// A step that is good enough.
pub(super) struct Taken<const N: usize> {
    pub segment: Segment<N>,
    /// The state at the end, and dx/dt there if it is known.
    pub x: [f64; N],
    pub end_slope: Option<[f64; N]>,
    /// The step times the fastest rate of decay in it.
    pub stiffness: f64,
}
