//! Parameter recovery over many trials: how often the 95 % intervals hold what was hidden.
//!
//! ```text
//! cargo run --release -p pneudrive --example recovery -- 100
//! ```
//!
//! The table of docs/identification.md is its output.

use pneudrive::identification::recovery::{Coverage, Trial};

fn main() -> anyhow::Result<()> {
    let trials: u64 = std::env::args().nth(1).map_or(Ok(100), |text| text.parse())?;
    let mut coverage = Coverage::default();
    for seed in 1..=trials {
        let trial = Trial::run(seed, &mut |_| {})?;
        eprintln!("seed {seed}: {}", trial.summary());
        coverage.count(&trial);
    }
    print!("{coverage}");
    Ok(())
}
