//! Run folders, as `simulate --out` writes them.

use std::path::Path;

use pneudrive_records::judged::{FailedMembers, Judged, Spacing};
use pneudrive_records::run_folder::{self, Existing};
use pneudrive_sim::{Accuracy, Convergence, Rig, run};
use serde_json::json;

/// Simulates a rig alone, without perturbed runs, into a folder.
pub fn simulate(rig: &Rig, folder: &Path) {
    let accuracy = Accuracy::of(rig);
    let judged = Judged {
        run: run(rig, accuracy).expect("a run"),
        accuracy,
        convergence: Convergence::UNKNOWN,
        band: None,
        spacing: Spacing { runs: 1, ..Spacing::default() },
        lost: FailedMembers::default(),
        columns: Vec::new(),
    };
    run_folder::write(folder, rig, &judged, json!([]), None, Existing::Overwrite).expect("written");
}
