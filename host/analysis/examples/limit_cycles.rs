//! What short records say of limit cycles, against what long ones show: the table of docs/evaluation.md.
//!
//! `cargo run --release -p pneudrive-analysis --example limit_cycles -- 200` draws so many drives: built-in rigs with another load,
//! friction, supply and velocity gain, and a step of 5, 24 or 72 mm. Each is simulated for 8 s after the step; its
//! records of 1 s to 3 s are held against all of it.

use pneudrive_analysis::evaluation::{LimitCycle, Motion, moves};
use pneudrive_analysis::transient::Transient;
use pneudrive_records::run_folder::StoredRun;
use pneudrive_sim::rig::{Value, builtin, unit_interval};
use pneudrive_sim::{Accuracy, Rig, run};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

const RIGS: [&str; 6] =
    ["servo-a", "servo-a-tuned", "servo-b-tuned", "servo-c-tuned", "lut-stepper", "lut-solenoid"];

/// When the step comes, and how long it is looked at, s.
const STEP_S: f64 = 0.3;
const WHOLE_S: f64 = 8.0;

/// Lengths of the records from the step on, s.
const RECORDS_S: [f64; 4] = [1.0, 1.5, 2.0, 3.0];

const FRICTION: [&str; 4] =
    ["load.static_extend_n", "load.coulomb_extend_n", "load.static_retract_n", "load.coulomb_retract_n"];

fn main() {
    let count = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(200);
    let mut told = [[[0; 3]; 3]; RECORDS_S.len()];
    let mut drives = 0;
    for drive in (0..count).filter_map(simulated) {
        drives += 1;
        let last = verdict(&drive, WHOLE_S);
        for (table, seconds) in told.iter_mut().zip(RECORDS_S) {
            table[verdict(&drive, seconds)][last] += 1;
        }
    }
    println!("{drives} of {count} drives that did not trip\n");
    println!(
        "| record | judged at rest: rests, swings, open | judged to swing: rests, swings, open | not decidable |"
    );
    println!("|---|---|---|---|");
    for (table, seconds) in told.iter().zip(RECORDS_S) {
        let row = |verdict: usize| {
            let [rests, swings, open] = table[verdict];
            format!("{rests}, {swings}, {open}")
        };
        println!("| {seconds} s | {} | {} | {} |", row(0), row(1), table[2].iter().sum::<i32>());
    }
}

/// 0 at rest, 1 a limit cycle, 2 not decidable.
fn verdict(drive: &Transient, seconds: f64) -> usize {
    let record = drive.between(0.0, STEP_S + seconds);
    match moves(&record, &Motion::of(&record), None, 0.05).last().expect("a step").limit_cycle {
        LimitCycle::None { .. } => 0,
        LimitCycle::Sustained(_) => 1,
        LimitCycle::Undecided(_) => 2,
    }
}

/// The drive of a seed; None if its run ends before its time.
fn simulated(seed: u64) -> Option<Transient> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let name = RIGS[(unit_interval(&mut random) * RIGS.len() as f64) as usize];
    let text = builtin(name).expect("a built-in rig");
    let settings = settings(&Rig::read(name, text).expect("a valid rig"), &mut random);
    let rig = Rig::read_with(name, text, &settings).unwrap_or_else(|problems| panic!("{name}: {problems}"));
    let run = run(&rig, Accuracy::of(&rig)).ok().filter(|run| run.fault.is_none())?;
    Some(Transient::of_run(name, &StoredRun::of(&rig, &run)))
}

fn settings(rig: &Rig, random: &mut ChaCha8Rng) -> Vec<String> {
    let mut by_ratio = |low: f64, high: f64| low * (high / low).powf(unit_interval(random));
    let friction = by_ratio(0.1, 2.0);
    let mut settings: Vec<String> = FRICTION
        .iter()
        .map(|key| format!("{key}={:?}", friction * rig.number_at(key).expect("a number")))
        .collect();
    settings.push(format!("load.mass_kg={:?}", by_ratio(0.5, 60.0)));
    settings.push(format!("supply.pressure_pa={:?}", by_ratio(3.5e5, 9e5)));
    if let Some(Value::Integer(gain)) = rig.value("controller.velocity_gain") {
        settings.push(format!("controller.velocity_gain={}", (*gain as f64 * by_ratio(0.2, 2.0)) as i64));
    }
    let counts = [400, 2000, 6000][(by_ratio(1.0, std::f64::consts::E).ln() * 3.0) as usize % 3];
    settings.push(format!("test.moves=[[0.0, 8192], [{STEP_S}, {}]]", 8192 + counts));
    settings.push(format!("test.duration_s={:?}", STEP_S + WHOLE_S));
    settings
}
