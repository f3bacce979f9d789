//! Velocity and acceleration of a transient, as the controller estimates them.

use pneudrive_controller::estimator::{Estimator, EstimatorConfig};

use crate::transient::Transient;

/// Velocity and acceleration at the transient's instants.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Motion {
    /// Velocity, mm/s.
    pub velocity_mm_s: Vec<f64>,
    /// Acceleration, mm/s^2.
    pub acceleration_mm_s2: Vec<f64>,
}

impl Motion {
    /// The controller's own estimator over the counts of a transient.
    ///
    /// Its windows count stored samples: at decimation N they are N times as long as the controller's.
    #[must_use]
    pub fn of(transient: &Transient) -> Motion {
        let period = transient.period_s();
        let [v, a] = transient.windows;
        let windows = EstimatorConfig { velocity_window: v, acceleration_window: a };
        let velocity = transient.mm_per_count / (f64::from(v) * period);
        let acceleration = velocity / (f64::from(a) * period);
        let mut estimator = Estimator::default();
        let (velocity_mm_s, acceleration_mm_s2) = transient
            .counts
            .iter()
            .map(|&position| {
                let motion = estimator.update(&windows, position);
                (motion.velocity as f64 * velocity, motion.acceleration as f64 * acceleration)
            })
            .unzip();
        Motion { velocity_mm_s, acceleration_mm_s2 }
    }
}
