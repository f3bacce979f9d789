//! A step and its dense output.

/// One step's dense output: `x(t0 + theta h)` as a polynomial in theta.
///
/// ```text
/// x = r1 + theta (r2 + (1-theta) (r3 + theta (r4 + (1-theta) (r5 + theta r6))))
/// ```
#[derive(Clone, Debug)]
pub(crate) struct DenseOutput<const N: usize> {
    pub start: f64,
    pub width: f64,
    /// r1 to r6; of states that rest r1 alone.
    pub coefficients: [[f64; N]; 6],
    /// How many states move in it: the others stay at r1.
    pub n_moving: usize,
    /// Whether it is as exact as the step.
    pub refined: bool,
}

/// Where a refined output has the derivative of the system.
pub(crate) const REFINED_AT: [f64; 2] = [0.25, 0.5];

impl<const N: usize> DenseOutput<N> {
    pub fn at(&self, t: f64) -> [f64; N] {
        self.at_part((t - self.start) / self.width)
    }

    pub fn at_part(&self, theta: f64) -> [f64; N] {
        let mut x = self.coefficients[0];
        for (i, x) in x.iter_mut().enumerate().take(self.n_moving) {
            *x = self.state_at_part(i, theta);
        }
        x
    }

    /// Brings the states that move to `t`. How many they are is one of FEW, SOME and N, each with a loop of known length.
    #[inline]
    pub fn bring_to<const FEW: usize, const SOME: usize>(&self, t: f64, x: &mut [f64; N]) {
        let theta = (t - self.start) / self.width;
        match self.n_moving {
            n if n <= FEW => self.bring_first_to::<FEW>(theta, x),
            n if n <= SOME => self.bring_first_to::<SOME>(theta, x),
            _ => self.bring_first_to::<N>(theta, x),
        }
    }

    /// Not inlined: beside loops of other lengths the compiler does not vectorise all of it.
    #[inline(never)]
    fn bring_first_to<const M: usize>(&self, theta: f64, x: &mut [f64; N]) {
        for (i, x) in x.iter_mut().enumerate().take(M) {
            *x = self.state_at_part(i, theta);
        }
    }

    #[inline(always)]
    fn state_at_part(&self, state: usize, theta: f64) -> f64 {
        let [r1, r2, r3, r4, r5, r6] = &self.coefficients;
        let rest = 1.0 - theta;
        let quartic = r4[state] + rest * (r5[state] + theta * r6[state]);
        r1[state] + theta * (r2[state] + rest * (r3[state] + theta * quartic))
    }

    /// dx/dt of one state.
    pub fn derivative_of(&self, state: usize, t: f64) -> f64 {
        if state >= self.n_moving {
            return 0.0;
        }
        let theta = (t - self.start) / self.width;
        let rest = 1.0 - theta;
        let [_, r2, r3, r4, r5, r6] = self.coefficients.map(|row| row[state]);
        // Each bracket and its slope, from the innermost one on.
        let (quintic, quintic_by) = (r5 + theta * r6, r6);
        let (quartic, quartic_by) = (r4 + rest * quintic, rest * quintic_by - quintic);
        let (cubic, cubic_by) = (r3 + theta * quartic, quartic + theta * quartic_by);
        let (line, line_by) = (r2 + rest * cubic, rest * cubic_by - cubic);
        (line + theta * line_by) / self.width
    }

    /// The polynomial of degree 5 with the derivatives of the system at [`REFINED_AT`] of the step, besides state and
    /// slope at its ends. It is of order 5, where the method's own is of order 4.
    pub fn refine(&mut self, slopes: &[[f64; N]; 2]) {
        let [_, r2, r3, r4, r5, r6] = &mut self.coefficients;
        for i in 0..self.n_moving.min(N) {
            // Derivatives of the cubic part there, and what is left for theta^2 (1-theta)^2 (r5 + theta r6).
            let quarter = self.width * slopes[0][i] - (r2[i] + 0.5 * r3[i] + 0.3125 * r4[i]);
            let half = self.width * slopes[1][i] - (r2[i] + 0.25 * r4[i]);
            r6[i] = 16.0 * half;
            r5[i] = (quarter - 0.082_031_25 * r6[i]) / 0.1875;
        }
        self.refined = true;
    }
}

/// The error of a trial step over the allowed one, and its order in the step size.
pub(crate) struct TrialError {
    pub error: f64,
    pub order: f64,
}

impl TrialError {
    /// Whether the step is good enough; not where the error is no number.
    pub fn is_small(&self) -> bool {
        self.error <= 1.0
    }
}

/// A step that is good enough. The next one is written over it.
#[derive(Clone, Debug)]
pub(crate) struct AcceptedStep<const N: usize> {
    pub dense: DenseOutput<N>,
    /// The state at the end, and dx/dt there if it is known.
    pub x: [f64; N],
    pub end_derivative: Option<[f64; N]>,
    /// The step times the fastest rate of decay in it.
    pub stiffness: f64,
    /// How far it moved the state, in allowed errors.
    pub moved: f64,
}

impl<const N: usize> AcceptedStep<N> {
    /// Before the first step.
    pub const NONE: AcceptedStep<N> = AcceptedStep {
        dense: DenseOutput {
            start: 0.0,
            width: 1.0,
            coefficients: [[0.0; N]; 6],
            n_moving: 0,
            refined: false,
        },
        x: [0.0; N],
        end_derivative: None,
        stiffness: 0.0,
        moved: 0.0,
    };
}
