//! Parameter recovery over many trials: how often the 95 % intervals hold what was hidden.
//!
//! ```text
//! cargo run --release -p pneudrive --example recovery -- 100
//! ```
//!
//! A second argument is the first seed, 1 if left out; a third one how far hidden values lie from the file's at most, 0.1 if
//! left out. The tables of docs/identification.md are its output.

use pneudrive::identification::recovery::{Coverage, HIDDEN, Trial};

fn main() -> anyhow::Result<()> {
    let argument = |i: usize, or: u64| std::env::args().nth(i).map_or(Ok(or), |text| text.parse::<u64>());
    let (trials, first) = (argument(1, 100)?, argument(2, 1)?);
    let hidden = std::env::args().nth(3).map_or(Ok(HIDDEN), |text| text.parse())?;
    let mut coverage = Coverage::default();
    for seed in first..first + trials {
        let trial = Trial::run(seed, hidden, &mut |_| {})?;
        eprintln!("seed {seed}: {}", trial.summary());
        coverage.count(&trial);
    }
    print!("{coverage}");
    Ok(())
}
