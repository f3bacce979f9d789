//! A run with its perturbed runs, as stored in a run folder: the accuracy of its integration, whether it has converged, and the
//! band of the run and its perturbed runs.

use pneudrive_controller::Fault;
use pneudrive_sim::trace::Extra;
use pneudrive_sim::{Accuracy, Convergence, PERTURBATION, Run};

use crate::band::Band;

/// The number of runs, and their distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spacing {
    /// Number of runs including the nominal one; 1: only that.
    pub runs: usize,
    /// Relative change of the mass, and of the starting position over the stroke.
    pub relative: f64,
}

impl Default for Spacing {
    fn default() -> Self {
        Spacing { runs: 8, relative: PERTURBATION }
    }
}

/// A run, with the evidence of how far it can be trusted.
#[derive(Clone, Debug)]
pub struct Judged {
    /// The nominal run.
    pub run: Run,
    /// The accuracy of its integration.
    pub accuracy: Accuracy,
    /// Whether it has converged.
    pub convergence: Convergence,
    /// The range of the run and its perturbed runs; None without perturbed runs.
    pub band: Option<Band>,
    /// The number and the distance of its perturbed runs.
    pub spacing: Spacing,
    /// Its perturbed runs that failed.
    pub lost: FailedMembers,
    /// Columns of its trace that not every trace has; its rows hold them.
    pub columns: Vec<&'static Extra>,
}

/// Perturbed runs that did not reach the end of their run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FailedMembers {
    /// Faults of those whose supervisor tripped; their figures are among the others.
    pub tripped: Vec<Fault>,
    /// Why the others could not be simulated: a key out of its range, or an error of the integrator.
    pub failed: Vec<String>,
}
