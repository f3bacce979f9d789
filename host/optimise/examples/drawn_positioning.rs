//! How the law `cascade` and the gain profile of `rig new` position drives that are drawn at random: cylinders, loads, valves,
//! supplies and periods in combinations that a builder may choose, good or bad.
//!
//! ```text
//! cargo run --release -p pneudrive-optimise --example drawn_positioning -- [DRIVES] [DRAWS OF EACH] [FIRST SEED]
//! ```
//!
//! A line for each law: drives, steps, the shares within 1, 0.2 and 0.05 mm, those that still move, those that trip, and on
//! how many drives all steps end within 0.2 mm. The drives on which a step of the law `cascade` does not, or still moves, go
//! to stderr.

#[path = "../../design/tests/drawn/mod.rs"]
mod drawn;

use pneudrive_design::own_drive::rig_file;
use pneudrive_design::question::question_of;
use pneudrive_optimise::positioning::{Plan, Spread, StepScore, steps, usual_step_mm};
use pneudrive_sim::Rig;
use pneudrive_sim::component::controller::Law;

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

/// The steps of a course that are judged.
const WHEN: [&str; 2] = ["cold", "after two moves"];

impl std::fmt::Display for Sum {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let share = |count: usize| format!("{:.1} %", 100.0 * count as f64 / self.steps.max(1) as f64);
        let within = self.within.map(share).join(" / ");
        let [moving, tripped] = [self.moving, self.tripped].map(share);
        write!(f, "{} | {} | {within} | {moving} | {tripped} | {}", self.drives, self.steps, self.sound)
    }
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

/// The drive of a seed on a law, if the law `cascade` takes it.
fn drive(seed: u64, law: Law) -> Option<Rig> {
    let mut answers = drawn::answers(seed);
    answers.answer(question_of("law")?, Law::Cascade.word());
    rig_file("drawn", &answers).ok()?;
    answers.answer(question_of("law")?, law.word());
    Rig::read("drawn", &rig_file("drawn", &answers).ok()?).ok()
}

fn main() {
    let mut arguments = std::env::args().skip(1).map(|text| text.parse::<u64>().expect("a number"));
    let mut next = |otherwise| arguments.next().unwrap_or(otherwise);
    let (drives, draws, first) = (next(200), next(6) as usize, next(0));
    let seeds: Vec<u64> =
        (first..).filter(|seed| drive(*seed, Law::Cascade).is_some()).take(drives as usize).collect();
    for law in [Law::Cascade, Law::GainProfile] {
        let mut sums = [Sum::default(), Sum::default()];
        for &seed in &seeds {
            let Some(rig) = drive(seed, law) else { continue };
            match steps(&rig, &Plan { spread: Spread::default(), draws, seed }, usual_step_mm(&rig)) {
                Ok(scores) => {
                    for ((sum, score), when) in sums.iter_mut().zip(&scores).zip(WHEN) {
                        sum.add(score);
                        if law == Law::Cascade && (score.within[1].met < draws || score.moving > 0) {
                            eprintln!("{seed}, {when}: {score}; {}", score.failed.join(", "));
                        }
                    }
                }
                Err(why) => eprintln!("{seed}, {}: {why}", law.word()),
            }
        }
        for (sum, when) in sums.iter().zip(WHEN) {
            println!("| {} | {when} | {sum} |", law.word());
        }
    }
}
