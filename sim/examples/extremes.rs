//! What becomes of rigs at the edge of what anybody builds: refused, run, or ended by an error, and after how long.
//!
//! ```text
//! cargo run --release -p pneudrive-sim --example extremes -- [RIGS] [FIRST SEED]
//! ```

#[path = "../tests/extreme/mod.rs"]
mod extreme;

use std::time::{Duration, Instant};

use pneudrive_sim::{Accuracy, run};

fn main() {
    let argument = |i: usize| std::env::args().nth(i).and_then(|text| text.parse::<u64>().ok());
    let (rigs, first) = (argument(1).unwrap_or(250), argument(2).unwrap_or(0));
    let [mut refused, mut ran, mut ended] = [0; 3];
    let mut slowest = Duration::ZERO;
    for seed in first..first + rigs {
        let since = Instant::now();
        let rig = match extreme::rig(seed) {
            Ok(rig) => rig,
            Err(problems) => {
                refused += 1;
                println!("{seed}: refused: {problems}");
                continue;
            }
        };
        let outcome = run(&rig, Accuracy::of(&rig));
        let took = since.elapsed();
        slowest = slowest.max(took);
        match outcome {
            Ok(_) => ran += 1,
            Err(error) => {
                ended += 1;
                println!("{seed}: {:.1} s: {error}", took.as_secs_f64());
                println!("  --set {}", extreme::settings(seed).join(" --set "));
            }
        }
        if took > Duration::from_secs(3) {
            println!("{seed}: took {:.1} s", took.as_secs_f64());
        }
    }
    println!(
        "{rigs} rigs: {ran} ran, {refused} refused, {ended} ended; the slowest took {:.1} s",
        slowest.as_secs_f64()
    );
}
