//! How fast runs are on this machine: simulated seconds a wall second on one core, controller and rows included, the best
//! of many runs in turns. The tables of docs/explanation/speed.md are what one machine printed.
//!
//! ```text
//! cargo run --release -p pneudrive-sim --example speed            # the table
//! cargo run --release -p pneudrive-sim --example speed -- figure  # docs/pictures/speed.svg
//! ```

mod curve;
mod figure;
#[path = "../../tests/cases/loosest.rs"]
mod loosest;

use pneudrive_sim::keys;
use std::hint::black_box;
use std::time::{Duration, Instant};

use loosest::LOOSEST;
use pneudrive_sim::trace::{MotionRow, Row};
use pneudrive_sim::{Accuracy, Record, Rig, Runner};

/// Times that each run is taken.
const ROUNDS: usize = 60;

/// A run to be timed, with all columns of its trace and with those of the motion alone.
struct Timed {
    title: String,
    rig: Rig,
    accuracy: Accuracy,
    whole: Runner<Row>,
    motion: Runner<MotionRow>,
    best: [Duration; 2],
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
        let (whole, motion) = (Runner::new(&rig, accuracy), Runner::new(&rig, accuracy));
        Timed { title, rig, accuracy, whole, motion, best: [Duration::MAX; 2] }
    }

    fn take(&mut self) {
        self.best[0] = self.best[0].min(time(&mut self.whole));
        self.best[1] = self.best[1].min(time(&mut self.motion));
    }

    fn row(&mut self) -> String {
        let run = self.whole.run().expect("a transient");
        let (evaluations, samples) =
            (run.work.integrator.n_rhs_evaluations as f64, run.observations.len() as f64);
        format!(
            "| {} | {:.0e} | {:.1} | {:.2} | {:.0} | {:.0} |",
            self.title,
            self.accuracy.tolerance,
            evaluations / samples,
            1e3 * self.best[0].as_secs_f64(),
            self.speed(0),
            self.speed(1),
        )
    }

    /// Simulated seconds a wall second.
    fn speed(&self, of: usize) -> f64 {
        self.rig.get(&keys::test::DURATION_S) / self.best[of].as_secs_f64()
    }
}

fn time<R: Record>(runner: &mut Runner<R>) -> Duration {
    let begin = Instant::now();
    black_box(runner.run()).expect("a transient");
    begin.elapsed()
}

fn main() {
    match std::env::args().nth(1).as_deref() {
        Some("figure") => write_figure(),
        _ => print_table(),
    }
}

/// Of other programs, scaled to the machine of docs/explanation/speed.md: at which deviation (m) they make how many simulated seconds a
/// second.
const BESIDE_A: [(&str, f64, f64); 4] = [
    ("specialised program", 1e-6, 12_700.0),
    ("CVODE Adams", 1e-6, 1380.0),
    ("CVODE BDF", 1e-6, 550.0),
    ("SciPy", 1e-6, 8.0),
];
const BESIDE_B: [(&str, f64, f64); 4] = [
    ("specialised program", 1e-6, 369.0),
    ("CVODE Adams", 1e-6, 72.0),
    ("CVODE BDF", 1e-6, 41.0),
    ("SciPy", 1e-6, 2.6),
];

fn write_figure() {
    let [a, b] = ["A_closed", "B_closed_damped"].map(curve::of);
    let svg = figure::of(&[
        figure::Case { name: "A_closed", colour: "#1f5fa8", curve: &a, others: &BESIDE_A },
        figure::Case { name: "B_closed_damped", colour: "#b8452a", curve: &b, others: &BESIDE_B },
    ]);
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/pictures/speed.svg");
    std::fs::write(path, svg).expect("docs can be written");
}

fn print_table() {
    let mut runs: Vec<Timed> = Vec::new();
    for (case, tolerance) in LOOSEST {
        runs.push(Timed::new(case, &[], None));
        runs.push(Timed::new(case, &[], Some(tolerance)));
    }
    for _ in 0..ROUNDS {
        runs.iter_mut().for_each(Timed::take);
    }
    println!(
        "| case | tolerance | evaluations a sample | ms a run | simulated s a s | of the motion alone |"
    );
    println!("|---|---|---|---|---|---|");
    runs.iter_mut().for_each(|timed| println!("{}", timed.row()));
}
