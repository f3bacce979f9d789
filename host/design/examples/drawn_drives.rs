//! How many drives drawn at random run, how many `rig new` refuses, and what becomes of the others.
//!
//! ```text
//! cargo run --release -p pneudrive-design --example drawn_drives -- [DRIVES] [FIRST SEED]
//! ```

#[path = "../tests/drawn/mod.rs"]
mod drawn;
#[path = "../tests/outcome/mod.rs"]
mod outcome;

use outcome::{Outcome, outcome};

fn main() {
    let mut arguments = std::env::args().skip(1).map(|text| text.parse::<u64>().expect("a number"));
    let (drives, first) = (arguments.next().unwrap_or(500), arguments.next().unwrap_or(0));
    let (mut run, mut refused, mut failed) = (0, 0, 0);
    for seed in first..first + drives {
        match outcome(seed) {
            Outcome::Runs => run += 1,
            Outcome::Refused => refused += 1,
            Outcome::Fails(how) => {
                failed += 1;
                println!("{seed}: {how}");
            }
        }
    }
    println!("{drives} drives: {run} run, {refused} are refused, {failed} fail");
}
