//! How many closed loops drawn at random are decided, whether those that say so are, and what it costs.
//!
//! ```text
//! cargo run --release -p pneudrive-sim --example decided -- [RIGS] [FIRST SEED]
//! ```

#[path = "../tests/drawn/mod.rs"]
mod drawn;

use pneudrive_sim::{Accuracy, Run, decide, run};

/// m.
const AGREES: f64 = 1e-5;

#[derive(Default)]
struct Counts {
    rigs: u32,
    decided: u32,
    wrong: u32,
    diverged: u32,
    diverged_before: u32,
    evaluations: f64,
}

fn apart(one: &Run, other: &Run) -> f64 {
    let pairs = one.rows.iter().zip(&other.rows);
    pairs.map(|(one, other)| (one.plant.position - other.plant.position).abs()).fold(0.0, f64::max)
}

impl Counts {
    fn judge(&mut self, seed: u64) {
        let drawn::Drawn { name, rig } = drawn::closed_loop(seed);
        let accuracy = Accuracy::of(&rig);
        let at = |accuracy| run(&rig, accuracy).unwrap_or_else(|error| panic!("{name}: {error}"));
        let (usual, before) = (at(accuracy), at(Accuracy::of_motion(&rig)));
        let fine = at(Accuracy { tolerance: 1e-12, ..accuracy });
        let decision = decide(&rig, accuracy, &usual).unwrap_or_else(|error| panic!("{name}: {error}"));
        let (off, off_before) = (apart(&usual, &fine), apart(&before, &fine));
        self.rigs += 1;
        self.decided += u32::from(decision.is_decided());
        self.diverged += u32::from(off > AGREES);
        self.diverged_before += u32::from(off_before > AGREES);
        let evaluations = |run: &Run| run.work.integrator.n_rhs_evaluations as f64;
        self.evaluations += (evaluations(&usual) / evaluations(&before)).ln();
        if decision.is_decided() && off > AGREES {
            self.wrong += 1;
            println!("{name}: said to be decided and {off:.1e} m off: {decision:?}");
        }
    }
}

fn main() {
    let argument = |i: usize| std::env::args().nth(i).and_then(|text| text.parse::<u64>().ok());
    let (rigs, first) = (argument(1).unwrap_or(60), argument(2).unwrap_or(0));
    let mut counts = Counts::default();
    (first..first + rigs).for_each(|seed| counts.judge(seed));
    let Counts { rigs, decided, wrong, diverged, diverged_before, evaluations } = counts;
    println!("{rigs} closed loops: {decided} decided, {wrong} of these more than 10 um from a run at 1e-12");
    println!(
        "{diverged} parted from it by more than 10 um, at the tolerance of open loops {diverged_before}"
    );
    println!(
        "{:.2} times the evaluations at the tolerance of open loops in the mean",
        (evaluations / f64::from(rigs)).exp()
    );
}
