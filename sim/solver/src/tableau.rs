//! The coefficients of the explicit methods.
//!
//! Dormand-Prince 5(4) with its interpolant of order 4 (Hairer, Norsett, Wanner, Solving Ordinary Differential
//! Equations I, II.5 and II.6), and Merson 4(3) with cubic Hermite interpolation (II.4).

/// An explicit method of integration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Dormand-Prince 5(4): the default.
    #[default]
    DormandPrince,
    /// Runge-Kutta-Merson 4(3).
    Merson,
}

/// Stages of the larger method, the slope at the end included.
pub(crate) const MAX_STAGES: usize = 7;

/// An explicit method whose last stage is the slope at the end of the step.
#[derive(Debug)]
pub(crate) struct Tableau {
    pub method: Method,
    /// Where stages 2.. are evaluated, in parts of the step.
    pub nodes: &'static [f64],
    /// Weights of the earlier slopes in stages 2 and up; the last stage makes the step itself.
    pub weights: &'static [&'static [f64]],
    /// Weights of all slopes in the error estimate.
    pub error: &'static [f64],
    /// Weights of all slopes in the quartic term of the dense output; empty for the cubic one.
    pub dense: &'static [f64],
    /// Weights of the slopes in the difference of the last two stages' states.
    pub apart: &'static [f64],
    /// The power of the step size that the error estimate goes with.
    pub error_order: f64,
}

impl Tableau {
    /// The coefficients of a method.
    pub fn of(method: Method) -> &'static Tableau {
        match method {
            Method::DormandPrince => &DORMAND_PRINCE,
            Method::Merson => &MERSON,
        }
    }

    /// Which stage is the slope at the end.
    #[inline]
    pub fn last_stage(&self) -> usize {
        self.weights.len()
    }
}

/// Hairer, Norsett, Wanner I, table II.5.2 and the interpolant of II.6.
pub(crate) const DORMAND_PRINCE: Tableau = Tableau {
    method: Method::DormandPrince,
    nodes: &[1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0, 1.0],
    weights: &[
        &[1.0 / 5.0],
        &[3.0 / 40.0, 9.0 / 40.0],
        &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
        &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0],
        &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
        &[35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
    ],
    error: &[
        71.0 / 57600.0,
        0.0,
        -71.0 / 16695.0,
        71.0 / 1920.0,
        -17253.0 / 339_200.0,
        22.0 / 525.0,
        -1.0 / 40.0,
    ],
    dense: &[
        -12_715_105_075.0 / 11_282_082_432.0,
        0.0,
        87_487_479_700.0 / 32_700_410_799.0,
        -10_690_763_975.0 / 1_880_347_072.0,
        701_980_252_875.0 / 199_316_789_632.0,
        -1_453_857_185.0 / 822_651_844.0,
        69_997_945.0 / 29_380_423.0,
    ],
    apart: &[
        35.0 / 384.0 - 9017.0 / 3168.0,
        355.0 / 33.0,
        500.0 / 1113.0 - 46732.0 / 5247.0,
        125.0 / 192.0 - 49.0 / 176.0,
        5103.0 / 18656.0 - 2187.0 / 6784.0,
        11.0 / 84.0,
    ],
    error_order: 5.0,
};

/// Bogacki and Shampine, Applied Mathematics Letters 2, 1989, with cubic Hermite interpolation: for steps of Dormand-Prince
/// that are too short for the error to count.
pub(crate) const BOGACKI_SHAMPINE: Tableau = Tableau {
    method: Method::DormandPrince,
    nodes: &[1.0 / 2.0, 3.0 / 4.0, 1.0],
    weights: &[&[1.0 / 2.0], &[0.0, 3.0 / 4.0], &[2.0 / 9.0, 1.0 / 3.0, 4.0 / 9.0]],
    error: &[-5.0 / 72.0, 1.0 / 12.0, 1.0 / 9.0, -1.0 / 8.0],
    dense: &[],
    apart: &[],
    error_order: 3.0,
};

/// Merson 1957, as in Hairer, Norsett, Wanner I, table II.4.1; the sixth stage is the slope at the
/// end, for the interpolant and the next step.
pub(crate) const MERSON: Tableau = Tableau {
    method: Method::Merson,
    nodes: &[1.0 / 3.0, 1.0 / 3.0, 1.0 / 2.0, 1.0, 1.0],
    weights: &[
        &[1.0 / 3.0],
        &[1.0 / 6.0, 1.0 / 6.0],
        &[1.0 / 8.0, 0.0, 3.0 / 8.0],
        &[1.0 / 2.0, 0.0, -3.0 / 2.0, 2.0],
        &[1.0 / 6.0, 0.0, 0.0, 2.0 / 3.0, 1.0 / 6.0],
    ],
    error: &[1.0 / 15.0, 0.0, -3.0 / 10.0, 4.0 / 15.0, -1.0 / 30.0],
    dense: &[],
    apart: &[1.0 / 6.0 - 1.0 / 2.0, 0.0, 3.0 / 2.0, 2.0 / 3.0 - 2.0, 1.0 / 6.0],
    error_order: 5.0,
};
