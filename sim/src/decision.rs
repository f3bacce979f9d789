//! Whether the transient of a run is decided, or whether the error of its integration chose between two.
//!
//! Positions become counts. Where a sampled position is nearer to a count's edge than the integration is exact,
//! the exact solution may have the other count, and from there on another transient; the same holds for pressures
//! where the law reads them. Everything else in the plant depends on its state without such jumps, or its error
//! shows.
//!
//! The error of a run is that of its plant under its own commands: a second integration under the same commands,
//! whose error is of another size, shows it without a second loop that could part from the first. With y the
//! positions of the run, and e the estimate of their error so far:
//!
//! ```text
//! e_k = max over j <= k of 0.2 |y_j - y_j(100 tolerance)|     first, as it costs little, up to 1e-4
//! e_k = max over j <= k of |y_j - y_j(tolerance / 100)|       where that leaves the run undecided, down to 1e-13
//! decided:  distance of y_k to an edge > e_k, and e_k < 10 um, at every sample
//! ```
//!
//! Two decades of tolerance change the error 60-fold as a rule, but the coarser run may be right by chance: of 595 closed
//! loops drawn at random 15 were off at their end by more than a fifth of the distance to it and two by more than all of
//! it, and 68 and 10 at some time.

use crate::component::controller;
use crate::component::sensors::Sensors;
use crate::follow::{Reading, Timing, follow};
use crate::keys;
use crate::plant::Accuracy;
use crate::run::{Run, run};
use crate::values::Rig;
use crate::values::seconds;
use pneudrive_solver::IntegrationError;

/// A run whose positions are estimated to be more wrong than this is not decided, m.
pub const LARGEST_ERROR_M: f64 = 1e-5;

/// How much coarser and finer the other integrations are. None is coarser than [`COARSEST`].
const DECADES: f64 = 100.0;

/// Part of the distance to the coarser run that counts as the run's own error.
const OF_COARSER: f64 = 0.2;

/// The loosest and the tightest tolerance that are of use.
const COARSEST: f64 = 1e-4;
/// The other integration of a coarse run must not be coarse itself.
const FINE: f64 = 1e-7;
const FINEST: f64 = 1e-13;

/// What is known of the exactness of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decision {
    /// The sampled position that came closest to another count; None where no encoder is in the loop.
    pub closest_edge: Option<Edge>,
    /// Estimated error of the positions, the largest of the run, m.
    pub error_m: f64,
    /// From when on the exact transient may be another one, s.
    pub undecided_from_s: Option<f64>,
}

/// A sampled position near the edge of a count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// How near, m.
    pub distance_m: f64,
    /// When, s.
    pub at_s: f64,
}

impl Decision {
    /// Of a run that no other integration can be compared with.
    pub const UNKNOWN: Decision =
        Decision { closest_edge: None, error_m: f64::INFINITY, undecided_from_s: Some(0.0) };

    /// Whether the exact transient is this one.
    #[must_use]
    pub fn is_decided(&self) -> bool {
        self.undecided_from_s.is_none()
    }
}

/// Determines whether a run of a rig with this accuracy is decided.
///
/// # Errors
/// When the finer integration fails.
pub fn decide(rig: &Rig, accuracy: Accuracy, run: &Run) -> Result<Decision, IntegrationError> {
    let other = |tolerance: f64| readings(rig, Accuracy { tolerance, ..accuracy }, run);
    let judge = |other: &[Reading], part: f64| Judge::new(rig).judge(run, other, part);
    let [coarser, finer] = [DECADES * accuracy.tolerance, (accuracy.tolerance / DECADES).clamp(FINEST, FINE)];
    let first = (coarser <= COARSEST).then(|| other(coarser)).and_then(Result::ok);
    let first = first.map(|readings| judge(&readings, OF_COARSER));
    match first {
        Some(decision) if decision.is_decided() => Ok(decision),
        // No finer integration is left to compare with.
        _ if finer >= accuracy.tolerance => Ok(first.unwrap_or(Decision::UNKNOWN)),
        _ => Ok(judge(&other(finer)?, 1.0)),
    }
}

/// What the sensors would have read of the plant of a run, integrated another way: under the run's commands, or with
/// the continuous controller in its own loop.
fn readings(rig: &Rig, accuracy: Accuracy, of: &Run) -> Result<Vec<Reading>, IntegrationError> {
    if rig.get(&keys::controller::MODEL) == controller::Model::Continuous {
        return run(rig, accuracy).map(|run| run.readings);
    }
    let timing = Timing {
        period_us: u64::from(rig.period_us().get()),
        delay_us: rig.microseconds(&keys::controller::DELAY_S),
    };
    follow(rig, accuracy, timing, &of.commands)
}

/// Which readings the law of a rig takes, and how they become counts.
struct Judge {
    sensors: Sensors,
    reads_position: bool,
    reads_pressures: bool,
    period_us: u64,
}

impl Judge {
    fn new(rig: &Rig) -> Judge {
        let sampled = rig.get(&keys::controller::MODEL) == controller::Model::Sampled
            && rig.get(&keys::controller::LOOP) == controller::Loop::Closed;
        let feeds_back = rig.get(&keys::controller::LAW) == controller::Law::OnOff
            && rig.get(&keys::controller::PRESSURE_FEEDBACK_GAIN) != 0.0;
        Judge {
            sensors: Sensors::new(rig, 0),
            reads_position: sampled,
            reads_pressures: sampled && feeds_back,
            period_us: u64::from(rig.period_us().get()),
        }
    }

    /// `part` of the distance to the other readings is the error.
    fn judge(mut self, run: &Run, other: &[Reading], part: f64) -> Decision {
        let mut decision = Decision { closest_edge: None, error_m: 0.0, undecided_from_s: None };
        let mut pressure_error = 0.0_f64;
        let common = run.readings.len().min(other.len());
        for (k, (own, other)) in (0u64..).zip(run.readings.iter().zip(other)) {
            let at_s = seconds(k * self.period_us);
            let apart = |i: usize| part * (own.pressures[i] - other.pressures[i]).abs();
            decision.error_m = decision.error_m.max(part * (own.position - other.position).abs());
            pressure_error = pressure_error.max(apart(0)).max(apart(1));
            let [position, pressure_1, pressure_2] = self.sensors.distances(own);
            if self.reads_position && decision.closest_edge.is_none_or(|edge| position < edge.distance_m) {
                decision.closest_edge = Some(Edge { distance_m: position, at_s });
            }
            let doubtful = decision.error_m > LARGEST_ERROR_M
                || self.reads_position && position <= decision.error_m
                || self.reads_pressures && pressure_1.min(pressure_2) <= pressure_error;
            if doubtful && decision.undecided_from_s.is_none() {
                decision.undecided_from_s = Some(at_s);
            }
        }
        // One of them tripped; from there on the other one has nothing to be compared with.
        if run.readings.len() != other.len() && decision.is_decided() {
            decision.undecided_from_s = Some(seconds(common as u64 * self.period_us));
        }
        decision
    }
}
