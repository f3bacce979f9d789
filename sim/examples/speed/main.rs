//! How fast runs are on this machine: simulated seconds a wall second on one core, controller and rows included, the best
//! of many runs in turns. The tables of docs/speed.md are what one machine printed.
//!
//! ```text
//! cargo run --release -p pneudrive-sim --example speed
//! ```

#[path = "../../tests/cases/loosest.rs"]
mod loosest;

use pneudrive_sim::keys;
use std::hint::black_box;
use std::time::{Duration, Instant};

use loosest::LOOSEST;
use pneudrive_sim::{Accuracy, Rig, run};

/// Times that each run is taken.
const ROUNDS: usize = 60;

/// A run to be timed.
struct Timed {
    title: String,
    rig: Rig,
    accuracy: Accuracy,
    best: Duration,
}

impl Timed {
    /// A reference case, with these settings and at this tolerance if not at what its drive needs.
    fn new(case: &str, settings: &[&str], tolerance: Option<f64>) -> Timed {
        let path = format!("{}/tests/cases/{case}.toml", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(path).expect("a case in the repository");
        let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
        let rig = Rig::read_with(case, &text, &settings).expect("a valid case");
        let own = Accuracy::of(&rig);
        let accuracy = Accuracy { tolerance: tolerance.unwrap_or(own.tolerance), ..own };
        let title = std::iter::once(case.to_owned()).chain(settings).collect::<Vec<_>>().join(", ");
        Timed { title, rig, accuracy, best: Duration::MAX }
    }

    fn take(&mut self) {
        let begin = Instant::now();
        black_box(run(&self.rig, self.accuracy)).expect("a transient");
        self.best = self.best.min(begin.elapsed());
    }

    fn row(&self) -> String {
        let run = run(&self.rig, self.accuracy).expect("a transient");
        let (evaluations, samples) =
            (run.work.integrator.n_rhs_evaluations as f64, run.observations.len() as f64);
        format!(
            "| {} | {:.0e} | {:.1} | {:.2} | {:.0} |",
            self.title,
            self.accuracy.tolerance,
            evaluations / samples,
            1e3 * self.best.as_secs_f64(),
            self.rig.get(&keys::test::DURATION_S) / self.best.as_secs_f64(),
        )
    }
}

fn main() {
    let mut runs: Vec<Timed> = Vec::new();
    for (case, tolerance) in LOOSEST {
        runs.push(Timed::new(case, &[], None));
        runs.push(Timed::new(case, &[], Some(tolerance)));
    }
    for _ in 0..ROUNDS {
        runs.iter_mut().for_each(Timed::take);
    }
    println!("| case | tolerance | evaluations a sample | ms a run | simulated s a s |");
    println!("|---|---|---|---|---|");
    runs.iter().for_each(|timed| println!("{}", timed.row()));
}
