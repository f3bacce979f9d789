//! Whether a run has converged, or the error of its integration has chosen between two transients.
//!
//! Positions become counts. If a sampled position is closer to the edge of a count than the integration error, the
//! exact solution may have the other count there, and another transient from then on. The same holds for pressures if
//! the law reads them. Everything else in the plant depends on its state without such jumps, or its error shows.
//!
//! The error of a run is the error of its plant under its own commands. Other integrations under the same commands,
//! whose errors are of another size, show it without a second loop that could part from the first. Let y be the
//! positions of the run, and d_k(t) = max over j <= k of |y_j - y_j(t)| their distance from those at a tolerance t:
//!
//! ```text
//! c_k = max(d_k(100 tolerance), 0.1 d_k(1000 tolerance))     first, as it costs little; coarsest 1e-4
//! f_k = max(3 d_k(tolerance / 100), 0.01 c_k)                if c does not suffice; finest 1e-13
//! converged:  distance of y_k to an edge > e_k, and e_k < 10 um, at every sample, with e = c or e = f
//! ```
//!
//! A single other integration can agree with the run by chance. In one drive, whose errors grow 5,000-fold over its test,
//! it was 4 nm from the solution at 1e-13 when both were 22 nm off. Two integrations with errors of different size hardly
//! agree at the same time. If no coarser one is left, two finer ones are compared. Where rounding sets the errors, a
//! finer integration is no more exact than the run. The coarser ones then show how far errors grow, and the floor of f_k
//! is a part of their distance. Two decades of tolerance usually change the error 60-fold. So c_k is some 60 times the
//! error, and its floor three fifths of it. docs/explanation/agreement.md has measured how often each bound holds.

use crate::component::controller;
use crate::component::sensors::Sensors;
use crate::follow::{Reading, Timing, follow};
use crate::keys;
use crate::plant::Accuracy;
use crate::run::{Run, run};
use crate::values::Rig;
use crate::values::seconds;
use pneudrive_solver::IntegrationError;

/// A run whose positions are estimated to be further off than this has not converged, m.
pub const LARGEST_ERROR_M: f64 = 1e-5;

/// How much coarser the first integrations are, and the factors from the distances to them to the bound on the error.
const COARSER: [(f64, f64); 2] = [(1e2, 1.0), (1e3, 0.1)];

/// How much finer the next one is, and the factor from the distance to it to the bound on the error.
const FINER: f64 = 1e-2;
const OF_FINER: f64 = 3.0;

/// The smallest error by the finer integration, as a part of the bound by the coarser ones.
const FLOOR: f64 = 0.01;

/// A single other integration may agree with the run by chance.
const FEWEST: usize = 2;

/// The loosest and the tightest useful tolerance.
const COARSEST: f64 = 1e-4;
/// The other integration of a coarse run must not be coarse itself.
const FINE: f64 = 1e-7;
const FINEST: f64 = 1e-13;

/// The exactness of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Convergence {
    /// The sampled position that came closest to another count; None without an encoder in the loop.
    pub closest_edge: Option<Edge>,
    /// Estimated error of the positions, the largest of the run, m.
    pub error_m: f64,
    /// The time from which the exact transient may be another one, s.
    pub unconverged_from_s: Option<f64>,
}

/// A sampled position near the edge of a count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// The distance to the edge, m.
    pub distance_m: f64,
    /// The time, s.
    pub at_s: f64,
}

impl Convergence {
    /// For a run with no other integration to compare.
    pub const UNKNOWN: Convergence =
        Convergence { closest_edge: None, error_m: f64::INFINITY, unconverged_from_s: Some(0.0) };

    /// Whether the exact transient is this one.
    #[must_use]
    pub fn is_converged(&self) -> bool {
        self.unconverged_from_s.is_none()
    }
}

/// Determines whether a run of a rig with this accuracy has converged.
///
/// # Errors
/// When a finer integration fails.
pub fn check_convergence(rig: &Rig, accuracy: Accuracy, run: &Run) -> Result<Convergence, IntegrationError> {
    let comparison = Comparison { rig, accuracy, run };
    let mut others = comparison.coarser();
    let mut convergence = comparison.judge(&others);
    if others.len() < COARSER.len() || !convergence.is_converged() {
        let finer = comparison.finer(others.is_empty())?;
        if !finer.is_empty() {
            others.iter_mut().for_each(|coarser| coarser.part *= FLOOR);
            others.extend(finer);
            convergence = comparison.judge(&others);
        }
    }
    Ok(if others.len() < FEWEST && convergence.is_converged() { Convergence::UNKNOWN } else { convergence })
}

/// A run that is compared with others of its rig.
struct Comparison<'a> {
    rig: &'a Rig,
    accuracy: Accuracy,
    run: &'a Run,
}

impl Comparison<'_> {
    /// The coarser integrations, up to the first by which the run has not converged.
    fn coarser(&self) -> Vec<Other> {
        let mut others = Vec::new();
        for (times, part) in COARSER {
            let tolerance = times * self.accuracy.tolerance;
            let Some(other) = (tolerance <= COARSEST).then(|| self.other(tolerance, part)) else { break };
            let Ok(other) = other else { break };
            others.push(other);
            if !self.judge(&others).is_converged() {
                break;
            }
        }
        others
    }

    /// A finer integration, or two; those that are useful.
    fn finer(&self, two: bool) -> Result<Vec<Other>, IntegrationError> {
        let first = (FINER * self.accuracy.tolerance).clamp(FINEST, FINE);
        let tolerances = [first, FINER * first].into_iter().take(1 + usize::from(two));
        let of_use = tolerances.filter(|finer| (FINEST..self.accuracy.tolerance).contains(finer));
        of_use.map(|tolerance| self.other(tolerance, OF_FINER)).collect()
    }

    fn other(&self, tolerance: f64, part: f64) -> Result<Other, IntegrationError> {
        let accuracy = Accuracy { tolerance, ..self.accuracy };
        Ok(Other { readings: readings(self.rig, accuracy, self.run)?, part })
    }

    fn judge(&self, others: &[Other]) -> Convergence {
        Judge::new(self.rig).judge(self.run, others)
    }
}

/// Another integration under the commands of a run.
struct Other {
    readings: Vec<Reading>,
    /// The factor from the distance to it to the bound on the error of the run.
    part: f64,
}

impl Other {
    /// The bound by a reading, m and Pa.
    fn bound(&self, own: &Reading, k: usize) -> [f64; 3] {
        let other = &self.readings[k];
        let apart = |i: usize| self.part * (own.pressures[i] - other.pressures[i]).abs();
        [self.part * (own.position - other.position).abs(), apart(0), apart(1)]
    }
}

/// The readings of a run's plant in another integration: under the run's commands, or with the continuous controller
/// in its own loop.
fn readings(rig: &Rig, accuracy: Accuracy, of: &Run) -> Result<Vec<Reading>, IntegrationError> {
    if rig.get(&keys::controller::MODEL) == controller::ControllerKind::Continuous {
        return run(rig, accuracy).map(|run| run.readings);
    }
    let timing = Timing {
        period_us: u64::from(rig.period_us().get()),
        delay_us: rig.microseconds(&keys::controller::DELAY_S),
    };
    follow(rig, accuracy, timing, &of.commands)
}

/// The readings that the law of a rig uses, and their conversion to counts.
struct Judge {
    sensors: Sensors,
    reads_position: bool,
    reads_pressures: bool,
    period_us: u64,
}

impl Judge {
    fn new(rig: &Rig) -> Judge {
        let sampled = rig.get(&keys::controller::MODEL) == controller::ControllerKind::Sampled
            && rig.get(&keys::controller::LOOP) == controller::Loop::Closed;
        let feeds_back = rig.get(&keys::controller::PRESSURE_FEEDBACK_GAIN) != 0.0;
        Judge {
            sensors: Sensors::new(rig, 0),
            reads_position: sampled,
            reads_pressures: sampled && feeds_back,
            period_us: u64::from(rig.period_us().get()),
        }
    }

    /// The largest bound by one of the others is the error.
    fn judge(mut self, run: &Run, others: &[Other]) -> Convergence {
        let mut convergence = Convergence { closest_edge: None, error_m: 0.0, unconverged_from_s: None };
        let mut pressure_error = 0.0_f64;
        let common = others.iter().map(|other| other.readings.len()).fold(run.readings.len(), usize::min);
        for (k, own) in run.readings[..common].iter().enumerate() {
            let at_s = seconds(k as u64 * self.period_us);
            for [position, pressure_1, pressure_2] in others.iter().map(|other| other.bound(own, k)) {
                convergence.error_m = convergence.error_m.max(position);
                pressure_error = pressure_error.max(pressure_1).max(pressure_2);
            }
            let [position, pressure_1, pressure_2] = self.sensors.distances(own);
            if self.reads_position && convergence.closest_edge.is_none_or(|edge| position < edge.distance_m) {
                convergence.closest_edge = Some(Edge { distance_m: position, at_s });
            }
            let doubtful = convergence.error_m > LARGEST_ERROR_M
                || self.reads_position && position <= convergence.error_m
                || self.reads_pressures && pressure_1.min(pressure_2) <= pressure_error;
            if doubtful && convergence.unconverged_from_s.is_none() {
                convergence.unconverged_from_s = Some(at_s);
            }
        }
        // One of them tripped; from there on the other one has nothing to be compared with.
        let all_as_long = others.iter().all(|other| other.readings.len() == run.readings.len());
        if !all_as_long && convergence.is_converged() {
            convergence.unconverged_from_s = Some(seconds(common as u64 * self.period_us));
        }
        convergence
    }
}
