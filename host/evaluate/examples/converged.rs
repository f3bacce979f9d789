//! How many closed loops drawn at random have converged, whether those that say so are, and what the check of convergence
//! costs: the table of docs/explanation/agreement.md.
//!
//! ```text
//! cargo run --release -p pneudrive-evaluate --example converged -- [PAIRS] [FIRST DRAW]
//! ```

#[path = "../tests/own_drives/mod.rs"]
mod own_drives;
#[path = "../tests/pairs/mod.rs"]
mod pairs;

use pairs::drawn::Drawn;
use pairs::{KINDS, PARTED_M, Pair, drawn_rig};
use pneudrive_sim::Accuracy;

#[derive(Clone, Copy, Default)]
struct Counts {
    pairs: u32,
    converged: u32,
    /// Of the converged ones.
    wrong: u32,
    parted: u32,
    seconds: [f64; 2],
}

impl Counts {
    fn take(&mut self, pair: &Pair) {
        self.pairs += 1;
        self.converged += u32::from(pair.convergence.is_converged());
        self.wrong += u32::from(pair.is_wrong());
        self.parted += u32::from(pair.apart_m > PARTED_M);
        for (sum, took) in self.seconds.iter_mut().zip(pair.took) {
            *sum += took.as_secs_f64();
        }
    }
}

fn main() {
    let argument = |i: usize| std::env::args().nth(i).and_then(|text| text.parse::<u64>().ok());
    let (pairs, first) = (argument(1).unwrap_or(60), argument(2).unwrap_or(0));
    let mut counts = [Counts::default(); KINDS.len()];
    for draw in first..first + pairs {
        let (kind, Drawn { name, rig }) = drawn_rig(draw);
        let pair = Pair::of(&rig, Accuracy::of(&rig));
        if pair.is_wrong() {
            println!("draw {draw}, {name}: {:e} m apart, {:?}", pair.apart_m, pair.convergence);
        }
        counts[kind].take(&pair);
    }
    println!(
        "| drawn | pairs | converged | of these farther apart than stated | not converged | parted | convergence / run |"
    );
    println!("|---|---|---|---|---|---|---|");
    for (kind, Counts { pairs, converged, wrong, parted, seconds: [run, convergence] }) in
        KINDS.iter().zip(counts)
    {
        let unconverged = 1e2 * (1.0 - f64::from(converged) / f64::from(pairs));
        let cost = convergence / run;
        println!("| {kind} | {pairs} | {converged} | {wrong} | {unconverged:.1} % | {parted} | {cost:.2} |");
    }
}
