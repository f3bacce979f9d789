//! A run together with its neighbours, as a run folder keeps them: how exactly it was integrated, whether it is decided,
//! and the band that it and its neighbours cover.

use pneudrive_controller::Fault;
use pneudrive_sim::trace::Extra;
use pneudrive_sim::{Accuracy, Decision, Run};

use crate::band::Band;

/// How many runs, and how far they are apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spacing {
    /// Runs in all, the nominal one among them; 1: that alone.
    pub runs: usize,
    /// Relative change of the mass, and of the starting position over the stroke.
    pub relative: f64,
}

impl Default for Spacing {
    fn default() -> Self {
        Spacing { runs: 8, relative: 1e-5 }
    }
}

/// A run, and what is known of how far it can be trusted.
#[derive(Clone, Debug)]
pub struct Judged {
    /// The run of the rig as it is.
    pub run: Run,
    /// How exactly it was integrated.
    pub accuracy: Accuracy,
    /// Whether it is decided.
    pub decision: Decision,
    /// What it and its neighbours cover; None of a run alone.
    pub band: Option<Band>,
    /// How many neighbours it has, and how far away.
    pub spacing: Spacing,
    /// What went wrong with its neighbours.
    pub lost: FailedNeighbours,
    /// Columns of its trace that not every trace has; its rows hold them.
    pub columns: Vec<&'static Extra>,
}

/// Neighbours that did not come to the end of their run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FailedNeighbours {
    /// Faults of those whose supervisor tripped; their figures are among the others.
    pub tripped: Vec<Fault>,
    /// Why the others have no run: beyond the limits of a key, or what the integrator says.
    pub failed: Vec<String>,
}
