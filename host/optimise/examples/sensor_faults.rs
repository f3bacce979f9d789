//! How soon the law `cascade` sees a pressure sensor that fails within its range: the table of docs/howto/pressure-sensors.md.
//!
//! ```text
//! cargo run --release -p pneudrive-optimise --example sensor_faults -- [DRIVE ...] [KEY=VALUE ...]
//! ```
//!
//! A DRIVE is one of the six of the catalogue; without one, all are measured. `draws=20 seed=1 range=1 bristles=1` as in the
//! example `positioning`; `sines=2`: a sine of so many Hz instead of a step there, back and there again. `at=0.25`: s at
//! which the sensor fails, 0.05 s after the first move begins; `at=0` before it has been read. Other keys with a point are
//! settings of the rig. A line for each kind of fault: runs that trip, and for those that do the time from the fault to the
//! trip and how far the load moved in it, median and worst; for those that do not the largest error at the end. The line
//! `none` counts false trips.

use anyhow::{Context, Result, bail};
use pneudrive_controller::{Config, Fault, Mode, Sample, State, output, sample};
use pneudrive_design::six_drives::{SIX_DRIVES, rig_file_of};
use pneudrive_optimise::positioning::draw::Place;
use pneudrive_optimise::positioning::{Sine, Spread, Steps, draws, usual_step_mm};
use pneudrive_records::words::fault_name;
use pneudrive_sim::{Accuracy, Plant, Rig, keys};

/// What a sensor does from an instant on: a name, and the reading by that at the instant and the present one.
type Failure = (&'static str, fn(&Sample, Sample) -> Sample);

const FAILURES: [Failure; 10] = [
    ("none", |_, now| now),
    ("1 frozen", |then, now| Sample { pressure_1: then.pressure_1, ..now }),
    ("2 frozen", |then, now| Sample { pressure_2: then.pressure_2, ..now }),
    ("1 half its gain", |_, now| Sample { pressure_1: now.pressure_1 / 2, ..now }),
    ("2 half its gain", |_, now| Sample { pressure_2: now.pressure_2 / 2, ..now }),
    ("1 a tenth of its range more", |_, now| Sample { pressure_1: more(now.pressure_1), ..now }),
    ("2 a tenth of its range more", |_, now| Sample { pressure_2: more(now.pressure_2), ..now }),
    ("1 a tenth of its range less", |_, now| Sample { pressure_1: now.pressure_1 - 409, ..now }),
    ("2 a tenth of its range less", |_, now| Sample { pressure_2: now.pressure_2 - 409, ..now }),
    ("swapped", |_, now| Sample { pressure_1: now.pressure_2, pressure_2: now.pressure_1, ..now }),
];

/// 4095 counts are the range; 4000 is not yet that of a shorted sensor.
fn more(raw: i16) -> i16 {
    (raw + 409).min(4000)
}

/// How a run ended.
struct End {
    /// The fault, after how many s, and how far the load moved from the failure on, mm.
    trip: Option<(Fault, f64, f64)>,
    /// At the end of a run without a trip, mm.
    error: f64,
}

/// Runs the test of a rig whose sensor fails at a time.
fn run(rig: &Rig, fail: fn(&Sample, Sample) -> Sample, at_s: f64) -> Result<End> {
    let (config, sequence) = (Config::new(&rig.parameters()).ok().context("a checked rig")?, rig.sequence());
    let mut state = State::default();
    state.locate(rig.parameters().absolute_zero().unwrap_or(0));
    state.supervisor.arm().ok().context("a new drive")?;
    state.start(&config, &sequence).ok().context("armed")?;
    let mut plant = Plant::new(rig, Accuracy { tolerance: 1e-7, ..Accuracy::of(rig) }, 0);
    let period = rig.get(&keys::controller::PERIOD_S);
    let (mut failed, mut moved) = (None, 0.0_f64);
    for k in 0..=rig.last_sample() {
        let time = f64::from(k) * period;
        let mut seen = plant.sample()?;
        let place = 1e3 * plant.look(time)?.position;
        if time >= at_s - 1e-9 {
            let (then, from) = failed.get_or_insert((seen, place));
            moved = moved.max((place - *from).abs());
            seen = fail(then, seen);
        }
        sample(&config, &sequence, &mut state, &seen);
        if let Mode::Fault(fault) = state.supervisor.mode() {
            return Ok(End { trip: Some((fault, time - at_s, moved)), error: 0.0 });
        }
        plant.command(output(&config, &mut state));
        if k < rig.last_sample() {
            plant.next_sample()?;
        }
    }
    let error = f64::from(state.observation().error.abs()) * rig.get(&keys::encoder::MM_PER_COUNT);
    Ok(End { trip: None, error })
}

struct Asked {
    drives: Vec<String>,
    settings: Vec<String>,
    spread: Spread,
    draws: usize,
    seed: u64,
    hz: f64,
    at_s: f64,
}

fn asked() -> Result<Asked> {
    let mut asked = Asked {
        drives: Vec::new(),
        settings: vec![format!("{}=cascade", keys::controller::LAW.path)],
        spread: Spread::default(),
        draws: 20,
        seed: 1,
        hz: 0.0,
        at_s: 0.25,
    };
    for argument in std::env::args().skip(1) {
        match argument.split_once('=') {
            None => asked.drives.push(argument),
            Some(("draws", value)) => asked.draws = value.parse()?,
            Some(("seed", value)) => asked.seed = value.parse()?,
            Some(("range", value)) => asked.spread.whole_range = value != "0",
            Some(("bristles", value)) => asked.spread.bristles = value != "0",
            Some(("sines", value)) => asked.hz = value.parse()?,
            Some(("at", value)) => asked.at_s = value.parse()?,
            Some((key, _)) if key.contains('.') => asked.settings.push(argument),
            Some((key, _)) => {
                bail!("{key}=? The keys are draws, seed, range, bristles, sines, at and those of a rig")
            }
        }
    }
    if asked.drives.is_empty() {
        asked.drives = SIX_DRIVES.iter().map(|(name, _)| (*name).to_owned()).collect();
    }
    Ok(asked)
}

/// The drawn rigs of a drive, with their test.
fn tests(name: &str, asked: &Asked) -> Result<Vec<Rig>> {
    let text = rig_file_of(name).with_context(|| format!("{name} is none of the six drives"))?;
    let rig = Rig::read_with(name, &text, &asked.settings)?;
    let step_mm = usual_step_mm(&rig);
    let test = |draw: pneudrive_optimise::positioning::Draw| {
        let drawn = draw.rig(&rig)?;
        let place = Place { along: draw.variant.place, extends: draw.variant.extends };
        match asked.hz {
            0.0 => Steps::of(&rig, step_mm, place)?.on(&drawn),
            hz => Sine::of(&rig, step_mm, hz)?.on(&drawn),
        }
    };
    draws(&rig, asked.spread, asked.seed, asked.draws)?.into_iter().map(test).collect()
}

/// "median (worst)" of some numbers.
fn spread_of(mut values: Vec<f64>, digits: usize) -> String {
    values.sort_by(f64::total_cmp);
    match values.last() {
        Some(worst) => format!("{:.digits$} ({worst:.digits$})", values[values.len() / 2]),
        None => "-".to_owned(),
    }
}

fn main() -> Result<()> {
    let asked = asked()?;
    println!(
        "| drive | sensor | trips | by | after ms: median (worst) | moved mm: median (worst) | error without a trip, mm |"
    );
    println!("|---|---|---|---|---|---|---|");
    for name in &asked.drives {
        let tests = tests(name, &asked)?;
        for (what, fail) in FAILURES {
            let ends: Vec<End> = tests.iter().map(|rig| run(rig, fail, asked.at_s)).collect::<Result<_>>()?;
            let trips: Vec<(Fault, f64, f64)> = ends.iter().filter_map(|end| end.trip).collect();
            let mut by: Vec<&str> = trips.iter().map(|(fault, _, _)| fault_name(*fault)).collect();
            by.sort_unstable();
            by.dedup();
            let after = spread_of(trips.iter().map(|trip| 1e3 * trip.1).collect(), 0);
            let moved = spread_of(trips.iter().map(|trip| trip.2).collect(), 1);
            let quiet = ends.iter().filter(|end| end.trip.is_none()).map(|end| end.error);
            let error = spread_of(quiet.collect(), 2);
            println!(
                "| {name} | {what} | {} of {} | {} | {after} | {moved} | {error} |",
                trips.len(),
                ends.len(),
                by.join(", ")
            );
        }
    }
    Ok(())
}
