//! How well control laws position, on the same drives and draws: the tables of docs/explanation/positioning.md.
//!
//! ```text
//! cargo run --release -p pneudrive-optimise --example positioning -- [RIG ...] [KEY=VALUE ...]
//! ```
//!
//! A RIG is one of the six drives of the catalogue, a built-in rig or a rig file; without one, the six drives and the three
//! servo-drives of the thesis are measured. `draws=120 seed=1`; `steps=0.2,2,60,300` (mm; without it 60 mm, or two fifths of a
//! shorter stroke); `laws=0,1` (places in the list of laws in `laws.rs`); `range=1` draws all that the rig file leaves open;
//! `bristles=1` puts LuGre friction on top; `sines=0` leaves out the sines. `plant=load.mass_kg*2,load.constant_force_n=-80`:
//! the plant of each draw differs from what the law knows by these factors and values. Other keys with a point are settings
//! of the rig. Gains that were found, and why runs did not come to their end, go to stderr. `figure=FILE.svg` draws the step
//! under each law instead: docs/pictures/control.svg.

mod figure;
mod laws;

use std::path::PathBuf;

use anyhow::{Context, Result, bail};
use pneudrive_design::six_drives::SIX_DRIVES;
use pneudrive_optimise::positioning::{Plan, Spread, bound, sine, steps};
use pneudrive_sim::Rig;

use laws::{Drive, LAWS, Law};

/// The drives of the thesis.
const THESIS: [&str; 3] = ["servo-a", "servo-b", "servo-c"];

/// Hz.
const SINES: [f64; 3] = [0.5, 1.0, 2.0];

struct Asked {
    rigs: Vec<String>,
    settings: Vec<String>,
    /// Changes of the plant alone, each `KEY=VALUE` or `KEY*FACTOR`.
    plant: Vec<String>,
    plan: Plan,
    steps_mm: Vec<f64>,
    laws: Vec<usize>,
    sines: bool,
    figure: Option<PathBuf>,
}

impl Asked {
    fn read() -> Result<Asked> {
        let mut asked = Asked {
            rigs: Vec::new(),
            settings: Vec::new(),
            plant: Vec::new(),
            plan: Plan { spread: Spread::default(), draws: 120, seed: 1 },
            steps_mm: Vec::new(),
            laws: (0..LAWS.len()).collect(),
            sines: true,
            figure: None,
        };
        for argument in std::env::args().skip(1) {
            let Some((key, value)) = argument.split_once('=') else {
                asked.rigs.push(argument);
                continue;
            };
            match key {
                "draws" => asked.plan.draws = value.parse()?,
                "seed" => asked.plan.seed = value.parse()?,
                "range" => asked.plan.spread.whole_range = value != "0",
                "bristles" => asked.plan.spread.bristles = value != "0",
                "plant" => asked.plant = value.split(',').map(str::to_owned).collect(),
                "sines" => asked.sines = value != "0",
                "figure" => asked.figure = Some(value.into()),
                "steps" => asked.steps_mm = value.split(',').map(str::parse).collect::<Result<_, _>>()?,
                "laws" => asked.laws = value.split(',').map(str::parse).collect::<Result<_, _>>()?,
                _ if key.contains('.') => asked.settings.push(argument),
                _ => bail!(
                    "{key}=? The keys are draws, seed, steps, laws, range, bristles, plant, sines, figure and those of a rig"
                ),
            }
        }
        if asked.rigs.is_empty() {
            asked.rigs = SIX_DRIVES.iter().map(|(name, _)| *name).chain(THESIS).map(str::to_owned).collect();
        }
        Ok(asked)
    }
}

/// A rig whose plant has changes that its law does not know.
fn disturbed(rig: &Rig, changes: &[String]) -> Result<Rig> {
    let setting = |change: &String| match change.split_once('*') {
        Some((key, factor)) => {
            let value = rig.number_at(key).with_context(|| format!("{key} is no number of the rig"))?;
            Ok(format!("{key}={:?}", value * factor.parse::<f64>()?))
        }
        None => Ok(change.clone()),
    };
    Ok(rig.with_plant(&changes.iter().map(setting).collect::<Result<Vec<_>>>()?)?)
}

/// The bound on a step each way, ms; none where the drive runs into its stop too fast to be simulated.
fn bounds(rig: &Rig, step_mm: f64) -> String {
    let ms = |extends| match bound(rig, step_mm, extends) {
        Ok(bound) => bound.map_or("-".to_owned(), |bound| format!("{:.0}", 1e3 * bound.time_s)),
        Err(why) => {
            eprintln!("{}, bang-bang: {why}", rig.name());
            "-".to_owned()
        }
    };
    format!("{}, {}", ms(true), ms(false))
}

/// The largest errors along the sines, mm: the median of the draws, and the worst.
fn sine_cells(rig: &Rig, asked: &Asked, step_mm: f64) -> Result<String> {
    let cell = |hz: &f64| {
        if !asked.sines {
            return Ok(String::new());
        }
        let score = sine(rig, &asked.plan, step_mm, *hz)?;
        score.failed.iter().for_each(|why| eprintln!("{}, {hz} Hz: {why}", rig.name()));
        Ok(score.to_string())
    };
    Ok(SINES.iter().map(cell).collect::<Result<Vec<_>>>()?.join(" | "))
}

/// The drive under a law, its plant as asked for; None where it is refused, which goes to stderr.
fn under(drive: &mut Drive, law: &Law, plant: &[String]) -> Option<Rig> {
    let rig = drive.under(law).and_then(|rig| disturbed(&rig, plant));
    rig.inspect_err(|refused| eprintln!("{}, {}: {refused:#}", drive.name, law.name)).ok()
}

/// Prints the rows of a drive.
fn rows(asked: &Asked, drive: &mut Drive, laws: &[&Law]) -> Result<()> {
    let (name, usual_mm) = (drive.name, drive.step_mm);
    let steps_mm = if asked.steps_mm.is_empty() { vec![usual_mm] } else { asked.steps_mm.clone() };
    for law in laws {
        let Some(rig) = under(drive, law, &asked.plant) else { continue };
        let sines = sine_cells(&rig, asked, usual_mm)?;
        for &step_mm in &steps_mm {
            let bounds = bounds(&rig, step_mm);
            for (when, score) in ["cold", "after two moves"].iter().zip(steps(&rig, &asked.plan, step_mm)?) {
                println!("| {name} | {} | {step_mm} | {when} | {score} | {bounds} | {sines} |", law.name);
                score.failed.iter().for_each(|why| eprintln!("{name}, {}, {when}: {why}", law.name));
            }
        }
    }
    Ok(())
}

fn main() -> Result<()> {
    let asked = Asked::read()?;
    let laws: Vec<&Law> = asked
        .laws
        .iter()
        .map(|place| LAWS.get(*place).context("there is no such law"))
        .collect::<Result<_>>()?;
    if asked.figure.is_none() {
        println!(
            "| drive | law | step, mm | | of {} within 1 / 0.2 / 0.05 mm | 95 % interval, % | median time, s | largest overshoot, mm (draws within 0.1) | limit cycle, not decidable, still moves (by more than 0.1 mm), failed | converged | bang-bang extending, retracting, ms | sine 0.5 Hz, mm: median (worst), draws within 0.6 | 1 Hz | 2 Hz |",
            asked.plan.draws
        );
        println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    }
    for name in &asked.rigs {
        let mut drive = Drive::read(name, &asked.settings)?;
        let Some(path) = &asked.figure else {
            rows(&asked, &mut drive, &laws)?;
            continue;
        };
        let step_mm = asked.steps_mm.first().copied().unwrap_or(drive.step_mm);
        let rigs: Vec<(&Law, Rig)> =
            laws.iter().filter_map(|law| Some((*law, under(&mut drive, law, &asked.plant)?))).collect();
        let drawn = figure::of(&rigs, &asked.plan, step_mm)?;
        std::fs::write(path, drawn).with_context(|| path.display().to_string())?;
    }
    Ok(())
}
