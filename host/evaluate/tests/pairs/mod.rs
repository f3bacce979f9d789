//! Pairs of runs of closed loops drawn at random: the run as it comes, and a reference by another method at 1e-13.

#[path = "../../../../sim/tests/drawn/mod.rs"]
pub mod drawn;

use std::time::{Duration, Instant};

use drawn::Drawn;
use pneudrive_sim::{Accuracy, Convergence, Method, Rig, Run, check_convergence, run};

use crate::own_drives::{Kind, Steps, own_drive};

/// m: two runs that are farther apart have parted.
pub const PARTED_M: f64 = 1e-5;

const REFERENCE: Accuracy = Accuracy { method: Method::Merson, tolerance: 1e-13 };

const STEPS: Steps = Steps { at_s: &[0.3, 1.7], duration_s: 3.1 };

/// What is drawn, in turns.
pub const KINDS: [&str; 4] =
    ["built-in rig", "own drive, dry friction", "own drive, LuGre", "own drive, LuGre, flow node"];

/// The rig of a draw, with its place in [`KINDS`].
pub fn drawn_rig(draw: u64) -> (usize, Drawn) {
    let (kind, seed) = ((draw % 4) as usize, draw / 4);
    let own = |of: Kind| {
        let rig = own_drive(seed, of, STEPS);
        Drawn { name: rig.name().to_owned(), rig }
    };
    let drawn = match kind {
        0 => drawn::closed_loop(seed),
        1 => own(Kind::Dry),
        2 => own(Kind::Bristles),
        _ => own(Kind::BristlesFlowNode),
    };
    (kind, drawn)
}

/// A run and its reference.
pub struct Pair {
    pub convergence: Convergence,
    /// How far the positions at their samples are apart at most, m.
    pub apart_m: f64,
    /// How long the run and the check of convergence took.
    pub took: [Duration; 2],
}

impl Pair {
    /// Of a rig whose run comes with this accuracy.
    pub fn of(rig: &Rig, accuracy: Accuracy) -> Pair {
        let begun = Instant::now();
        let own = run(rig, accuracy).expect("a run");
        let run_took = begun.elapsed();
        let convergence = check_convergence(rig, accuracy, &own).expect("a convergence");
        let took = [run_took, begun.elapsed() - run_took];
        Pair { convergence, apart_m: apart(&own, &run(rig, REFERENCE).expect("a reference")), took }
    }

    /// Whether the run says that it has converged and is off by more than it says.
    pub fn is_wrong(&self) -> bool {
        self.convergence.is_converged() && self.apart_m > self.convergence.error_m
    }
}

fn apart(one: &Run, other: &Run) -> f64 {
    if one.readings.len() != other.readings.len() {
        return f64::INFINITY;
    }
    let pairs = one.readings.iter().zip(&other.readings);
    pairs.map(|(one, other)| (one.position - other.position).abs()).fold(0.0, f64::max)
}
