//! How fast a case is over how exact it is: a run at each of a range of tolerances, held against its reference.

use std::time::{Duration, Instant};

use pneudrive_sim::keys;
use pneudrive_sim::trace::MotionRow;
use pneudrive_sim::{Accuracy, Rig, Runner};

const CASES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/cases");

/// Times that each run is taken.
const ROUNDS: usize = 20;

/// Tolerances from 1e-11 on, this factor apart.
const SPACING: f64 = 2.0;
const COUNT: i32 = 22;

/// A tolerance: the largest deviation of its run from the reference, m, and simulated seconds a wall second.
pub struct Point {
    pub deviation_m: f64,
    pub speed: f64,
}

/// The points of a case, of which a flipped count is no more one of the same transient.
pub fn of(case: &str) -> Vec<Point> {
    let read = |ending: &str| {
        std::fs::read_to_string(format!("{CASES}/{case}.{ending}")).expect("a case in the repository")
    };
    let rig = Rig::read(case, &read("toml")).expect("a valid case");
    let reference = positions(&read("csv"));
    let tolerances = (0..COUNT).map(|step| 1e-11 * SPACING.powi(step));
    let points = tolerances.map(|tolerance| point(&rig, tolerance, &reference));
    points.filter(|point| point.deviation_m < 1e-5).collect()
}

fn positions(csv: &str) -> Vec<f64> {
    let mut lines = csv.lines().map(|line| line.split(','));
    let column = lines.next().expect("a header").position(|name| name == "position_m").expect("a position");
    let position = |mut cells: std::str::Split<'_, char>| cells.nth(column).map(str::parse);
    lines.map(|cells| position(cells).expect("as many cells").expect("a number")).collect()
}

fn point(rig: &Rig, tolerance: f64, reference: &[f64]) -> Point {
    let mut runner = Runner::<MotionRow>::new(rig, Accuracy { tolerance, ..Accuracy::of(rig) });
    let mut best = Duration::MAX;
    let mut deviation_m = 0.0_f64;
    for _ in 0..ROUNDS {
        let begin = Instant::now();
        let run = runner.run().expect("a transient");
        best = best.min(begin.elapsed());
        let off = run.rows.iter().zip(reference).map(|(row, position)| (row.position - position).abs());
        deviation_m = off.fold(0.0, f64::max);
    }
    Point { deviation_m, speed: rig.get(&keys::test::DURATION_S) / best.as_secs_f64() }
}
