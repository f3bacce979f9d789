//! Whether perturbed runs at their own tolerance show what they would at that of the run: the shares of their figures that leave
//! the band, in closed loops drawn at random (docs/explanation/agreement.md).
//!
//! ```text
//! cargo run --release -p pneudrive-optimise --example ensemble_members -- [RIGS] [FIRST SEED]
//! ```

#[path = "../tests/ensemble_members/leaving.rs"]
mod leaving;

use pneudrive_records::judged::Spacing;
use pneudrive_sim::Accuracy;

/// A tolerance over that of a perturbed run.
const FACTORS: [f64; 4] = [0.1, 1.0, 10.0, 100.0];

fn main() {
    let argument = |i: usize| std::env::args().nth(i).and_then(|text| text.parse::<u64>().ok());
    let (rigs, first) = (argument(1).unwrap_or(100), argument(2).unwrap_or(40_000));
    let relative = Spacing::default().relative;
    let [exact, others @ ..] = leaving::of_drawn(first..first + rigs, |rig| {
        let usual = Accuracy::of_member(rig, relative).tolerance;
        let [a, b, c, d] = FACTORS.map(|factor| factor * usual);
        [Accuracy::of(rig).tolerance, a, b, c, d]
    });
    println!("| tolerance | figures | leave the band | share |\n|---|---|---|---|");
    let row = |name: &str, one: leaving::Leaving| {
        println!("| {name} | {} | {} | {:.2} % |", one.figures, one.left, 100.0 * one.share());
    };
    row("that of the run", exact);
    for (factor, one) in FACTORS.into_iter().zip(others) {
        let name = if factor == 1.0 { String::new() } else { format!("{factor} times ") };
        row(&format!("{name}that of a perturbed run"), one);
    }
}
