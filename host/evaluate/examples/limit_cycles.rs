//! What short records say of limit cycles, against what is seen in 12 s: the table of docs/explanation/evaluation.md.
//!
//! `cargo run --release -p pneudrive-evaluate --example limit_cycles -- 800` draws so many drives: in turns built-in rigs with
//! another load, friction, supply and velocity gain and a step of 5, 24 or 72 mm, and own drives with a step, with dry
//! friction and with LuGre friction. Each is simulated for 12 s after the step; its records of 1 s to 3 s are held
//! against all of it.

#[path = "../tests/own_drives/mod.rs"]
mod own_drives;
#[path = "../tests/watched/mod.rs"]
mod watched;

use pneudrive_evaluate::evaluation::LimitCycle;
use pneudrive_evaluate::transient::Transient;
use pneudrive_sim::Rig;
use pneudrive_sim::keys;
use pneudrive_sim::rig::{Value, unit_interval};
use pneudrive_sim::rigfile::builtin;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use watched::{Kind, MOVES_MM, STEP_S, WATCHED_S, moves_later_mm, stepping, verdict};

const RIGS: [&str; 6] =
    ["servo-a", "servo-a-tuned", "servo-b-tuned", "servo-c-tuned", "lut-stepper", "lut-solenoid"];

/// Lengths of the records from the step on, s.
const RECORDS_S: [f64; 4] = [1.0, 1.5, 2.0, 3.0];

const FRICTION: [&str; 4] =
    ["load.static_extend_n", "load.coulomb_extend_n", "load.static_retract_n", "load.coulomb_retract_n"];

/// A limit cycle of so few cycles is apart from the others in the table.
const FEW_CYCLES: usize = 4;

/// What a verdict rests on.
const OF: [&str; 2] = ["a simulated run", "a record"];

/// What became of drives by the verdict on their records.
#[derive(Clone, Copy, Default)]
struct Told {
    /// Judged at rest: stay where they are, and move.
    rests: [u32; 2],
    /// Judged to swing, by few cycles or more, and after 12 s at rest, swinging, open.
    swings: [[u32; 3]; 2],
    undecided: u32,
}

impl Told {
    fn take(&mut self, drive: &Transient, seconds: f64, last: LimitCycle) {
        match verdict(drive, seconds) {
            LimitCycle::None { .. } => {
                self.rests[usize::from(moves_later_mm(drive, seconds) > MOVES_MM)] += 1;
            }
            LimitCycle::Sustained(seen) => {
                self.swings[usize::from(seen.cycles > FEW_CYCLES)][place(last)] += 1;
            }
            LimitCycle::Undecided(_) => self.undecided += 1,
        }
    }

    /// How many judged to swing come to rest.
    fn at_rest_later(&self) -> u32 {
        self.swings.iter().map(|[rest, ..]| rest).sum()
    }
}

/// 0 at rest, 1 a limit cycle, 2 not decidable.
fn place(verdict: LimitCycle) -> usize {
    match verdict {
        LimitCycle::None { .. } => 0,
        LimitCycle::Sustained(_) => 1,
        LimitCycle::Undecided(_) => 2,
    }
}

/// The verdicts on short records of drives: as of simulated runs, and without their friction, as of recorded ones.
#[derive(Default)]
struct Tables([[Told; RECORDS_S.len()]; 2]);

impl Tables {
    fn take(&mut self, draw: u64, simulated: &Transient) {
        let last = verdict(simulated, WATCHED_S);
        let recorded = Transient { grip: None, ..simulated.clone() };
        for ((table, drive), of) in self.0.iter_mut().zip([simulated, &recorded]).zip(OF) {
            for (told, seconds) in table.iter_mut().zip(RECORDS_S) {
                let before = *told;
                told.take(drive, seconds, last);
                if told.rests[1] > before.rests[1] {
                    println!("draw {draw}, {}: rests after {seconds} s by {of}, and moves later", drive.name);
                }
                if told.at_rest_later() > before.at_rest_later() {
                    println!("draw {draw}, {}: {:?}, and rests later", drive.name, verdict(drive, seconds));
                }
            }
        }
    }

    fn print(&self) {
        for (table, of) in self.0.iter().zip(OF) {
            println!("\n{of}\n");
            println!(
                "| record | judged at rest: stay, move | to swing, by {FEW_CYCLES} cycles at most: rest, swing, open | by more | not decidable |"
            );
            println!("|---|---|---|---|---|");
            for (Told { rests: [stay, move_], swings, undecided }, seconds) in table.iter().zip(RECORDS_S) {
                let [few, more] = swings.map(|[rest, swing, open]| format!("{rest}, {swing}, {open}"));
                println!("| {seconds} s | {stay}, {move_} | {few} | {more} | {undecided} |");
            }
        }
    }
}

fn main() {
    let count = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(800);
    let mut tables = Tables::default();
    let mut drives = 0;
    for (draw, drive) in (0..count).filter_map(|draw| Some((draw, watched::watched(&drawn(draw))?))) {
        drives += 1;
        tables.take(draw, &drive);
    }
    println!("{drives} of {count} drives did not trip");
    tables.print();
}

fn drawn(draw: u64) -> Rig {
    let seed = draw / 4;
    match draw % 4 {
        0 => built_in(seed),
        1 => stepping(seed, Kind::Dry),
        2 => stepping(seed, Kind::Bristles),
        _ => stepping(seed, Kind::BristlesFlowNode),
    }
}

fn built_in(seed: u64) -> Rig {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let name = RIGS[(unit_interval(&mut random) * RIGS.len() as f64) as usize];
    let text = builtin(name).expect("a built-in rig");
    let settings = settings(&Rig::read(name, text).expect("a valid rig"), &mut random);
    Rig::read_with(name, text, &settings).unwrap_or_else(|problems| panic!("{name}: {problems}"))
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
    if let Some(Value::Integer(gain)) = rig.value(keys::controller::VELOCITY_GAIN.path) {
        settings.push(format!("controller.velocity_gain={}", (*gain as f64 * by_ratio(0.2, 2.0)) as i64));
    }
    let counts = [400, 2000, 6000][(by_ratio(1.0, std::f64::consts::E).ln() * 3.0) as usize % 3];
    settings.push(format!("test.moves=[[0.0, 8192], [{STEP_S}, {}]]", 8192 + counts));
    settings.push(format!("test.duration_s={:?}", STEP_S + WATCHED_S));
    settings
}
