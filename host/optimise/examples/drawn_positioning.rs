//! How the law by a model positions drives that are drawn at random: cylinders, loads, valves, supplies and periods that a builder may
//! combine, well or badly, as `rig new` makes them.
//!
//! ```text
//! cargo run --release -p pneudrive-optimise --example drawn_positioning -- [DRIVES] [DRAWS OF EACH] [FIRST SEED]
//! ```
//!
//! A line for each drive that ends a step outside 0.2 mm, still moves or trips; then the shares over all of them.

#[path = "../../design/tests/drawn/mod.rs"]
mod drawn;

use pneudrive_design::own_drive::rig_file;
use pneudrive_optimise::positioning::{Plan, Spread, StepScore, steps, usual_step_mm};
use pneudrive_sim::component::controller::Law;
use pneudrive_sim::{Rig, keys};

/// What the steps of all drives came to.
#[derive(Default)]
struct Sum {
    steps: usize,
    within: [usize; 3],
    moving: usize,
    tripped: usize,
    /// Drives all of whose steps end within 0.2 mm.
    sound: usize,
    drives: usize,
}

impl Sum {
    fn add(&mut self, score: &StepScore) {
        self.drives += 1;
        self.steps += score.within[0].of;
        for (sum, share) in self.within.iter_mut().zip(&score.within) {
            *sum += share.met;
        }
        self.moving += score.moving;
        self.tripped += score.failed.len();
        self.sound += usize::from(score.within[1].met == score.within[1].of);
    }
}

/// The drive of a seed if the law by a model takes it.
fn drive(seed: u64) -> Option<Rig> {
    let text = rig_file("drawn", &drawn::answers(seed)).ok()?;
    let rig = Rig::read("drawn", &text).ok()?;
    (rig.get(&keys::controller::LAW) == Law::Cascade).then_some(rig)
}

fn main() {
    let mut arguments = std::env::args().skip(1).map(|text| text.parse::<u64>().expect("a number"));
    let mut next = |otherwise| arguments.next().unwrap_or(otherwise);
    let (drives, draws, first) = (next(200), next(6) as usize, next(0));
    let mut sums = [Sum::default(), Sum::default()];
    let (mut seed, mut untried) = (first, 0);
    while (sums[0].drives as u64) < drives {
        let plan = Plan { spread: Spread::default(), draws, seed };
        let Some(rig) = drive(seed) else {
            (seed, untried) = (seed + 1, untried + 1);
            continue;
        };
        match steps(&rig, &plan, usual_step_mm(&rig)) {
            Ok(scores) => {
                for ((sum, score), when) in sums.iter_mut().zip(&scores).zip(["cold", "after two moves"]) {
                    sum.add(score);
                    if score.within[1].met < draws || score.moving > 0 {
                        println!("{seed}, {when}: {score}; {}", score.failed.join(", "));
                    }
                }
            }
            Err(why) => println!("{seed}: {why}"),
        }
        seed += 1;
    }
    for (sum, when) in sums.iter().zip(["cold", "after two moves"]) {
        let share = |count: usize| format!("{:.1} %", 100.0 * count as f64 / sum.steps as f64);
        println!(
            "{when}: {} drives, {} steps; within 1 / 0.2 / 0.05 mm {}; still move {}; trip {}; {} drives end all steps within 0.2 mm",
            sum.drives,
            sum.steps,
            sum.within.map(share).join(" / "),
            share(sum.moving),
            share(sum.tripped),
            sum.sound
        );
    }
    println!("{untried} combinations are refused or have another law");
}
