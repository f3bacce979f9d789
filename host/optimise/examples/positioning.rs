//! How well control laws position, on the same drives and draws: the tables of docs/positioning.md.
//!
//! ```text
//! cargo run --release -p pneudrive-optimise --example positioning -- [RIG ...] [KEY=VALUE ...]
//! ```
//!
//! A RIG is one of the six drives of the catalogue, a built-in rig or a rig file; without one, the six drives and the three
//! servo-drives of the thesis are measured. `draws=120 seed=1`; `steps=0.2,2,60,300` (mm; without it 60 mm, or two fifths of a
//! shorter stroke); `laws=0,1` (places in the list of laws below); `range=1` draws all that the rig file leaves open;
//! `bristles=1` puts LuGre friction on top; `sines=0` leaves out the sines. `plant=load.mass_kg*2,load.constant_force_n=-80`: the plant of
//! each draw differs from what the law knows by these factors and values. Other keys with a point are settings of the rig. Gains that
//! were found, and why runs did not come to their end, go to stderr.

use std::collections::BTreeMap;

use anyhow::{Context, Result, bail};
use pneudrive_design::six_drives::{SIX_DRIVES, rig_file_of};
use pneudrive_evaluate::cancel::CancelToken;
use pneudrive_optimise::positioning::draw::TOLERANCE;
use pneudrive_optimise::positioning::{Plan, Spread, bound, sine, steps, usual_step_mm};
use pneudrive_optimise::tuning::search::Budget;
use pneudrive_optimise::tuning::{Goal, Task, tune};
use pneudrive_sim::rigfile::builtin;
use pneudrive_sim::{Rig, keys};

/// The drives of the thesis.
const THESIS: [&str; 3] = ["servo-a", "servo-b", "servo-c"];

/// Hz.
const SINES: [f64; 3] = [0.5, 1.0, 2.0];

/// A control law with gains. A new law is a line in [`LAWS`].
struct Law {
    name: &'static str,
    word: &'static str,
    /// Whether `tune` looks for its gains; otherwise they are those of the rig file.
    tuned: bool,
    /// The integral time that is added to tuned gains, s.
    integral_s: Option<f64>,
}

const LAWS: [Law; 5] = [
    Law { name: "gain profile", word: "gain-profile", tuned: false, integral_s: None },
    Law { name: "gain profile, tuned", word: "gain-profile", tuned: true, integral_s: None },
    Law { name: "P-D, tuned", word: "pid", tuned: true, integral_s: None },
    Law { name: "PI-D, tuned", word: "pid", tuned: true, integral_s: Some(0.5) },
    Law { name: "cascade", word: "cascade", tuned: false, integral_s: None },
];

/// The search that `rig new` proposes: within 1 mm, as no law that is tuned here ends within 0.05 mm often enough to be guided by that.
const SETTLED_MM: f64 = 1.0;
const TIME_S: f64 = 1.5;
const BUDGET: Budget = Budget { population: 16, generations: 10, seed: 1 };

struct Asked {
    rigs: Vec<String>,
    settings: Vec<String>,
    /// Changes of the plant alone, each `KEY=VALUE` or `KEY*FACTOR`.
    plant: Vec<String>,
    plan: Plan,
    steps_mm: Vec<f64>,
    laws: Vec<usize>,
    sines: bool,
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
                "steps" => asked.steps_mm = value.split(',').map(str::parse).collect::<Result<_, _>>()?,
                "laws" => asked.laws = value.split(',').map(str::parse).collect::<Result<_, _>>()?,
                _ if key.contains('.') => asked.settings.push(argument),
                _ => bail!(
                    "{key}=? The keys are draws, seed, steps, laws, range, bristles, plant, sines and those of a rig"
                ),
            }
        }
        if asked.rigs.is_empty() {
            asked.rigs = SIX_DRIVES.iter().map(|(name, _)| *name).chain(THESIS).map(str::to_owned).collect();
        }
        Ok(asked)
    }
}

/// The text of a rig file.
fn text_of(name: &str) -> Result<String> {
    let of_list = rig_file_of(name).or_else(|| builtin(name).map(str::to_owned));
    of_list.map_or_else(|| std::fs::read_to_string(name).with_context(|| name.to_owned()), Ok)
}

/// A drive, and the gains that have been found for it, by the word of their law.
struct Drive<'a> {
    name: &'a str,
    text: String,
    settings: &'a [String],
    step_mm: f64,
    found: BTreeMap<&'static str, Vec<String>>,
}

impl Drive<'_> {
    /// The drive under a law.
    fn under(&mut self, law: &Law) -> Result<Rig> {
        let word = format!("{}={}", keys::controller::LAW.path, law.word);
        let mut settings: Vec<String> = self.settings.iter().cloned().chain([word]).collect();
        if law.tuned {
            let gains = self.gains(law.word, &settings)?;
            settings.extend(gains);
        }
        let rig = Rig::read_with(self.name, &self.text, &settings)?;
        Ok(match law.integral_s {
            Some(time_s) => rig.with_settings(&[integral(&rig, time_s)])?,
            None => rig,
        })
    }

    /// The gains that `tune` finds, once for each law.
    fn gains(&mut self, law: &'static str, settings: &[String]) -> Result<Vec<String>> {
        if let Some(found) = self.found.get(law) {
            return Ok(found.clone());
        }
        let task = Task {
            source: (self.name.to_owned(), self.text.clone()),
            settings: settings.to_vec(),
            fixed: Vec::new(),
            goal: Goal {
                step_mm: self.step_mm,
                settled_mm: SETTLED_MM,
                overshoot_percent: 1.0,
                time_s: TIME_S,
            },
            spread: TOLERANCE,
            between_mm: [None, None],
            draws: 0,
            budget: BUDGET,
        };
        let found = tune(&task, |_| {}, CancelToken::NEVER)?.after.settings;
        eprintln!("{}, {law}: {}", self.name, found.join(" "));
        self.found.insert(law, found.clone());
        Ok(found)
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

/// Ki = 256 Kp T/T_I.
fn integral(rig: &Rig, time_s: f64) -> String {
    let proportional = rig.get(&keys::controller::PROPORTIONAL_GAIN) as f64;
    let gain =
        (256.0 * proportional * rig.get(&keys::controller::PERIOD_S) / time_s).round().clamp(1.0, 65_535.0);
    format!("{}={gain}", keys::controller::INTEGRAL_GAIN.path)
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

fn main() -> Result<()> {
    let asked = Asked::read()?;
    println!(
        "| drive | law | step, mm | | of {} within 1 / 0.2 / 0.05 mm | 95 % interval, % | median time, s | largest overshoot, mm (draws within 0.1) | limit cycle, not decidable, still moves, failed | converged | bang-bang extending, retracting, ms | sine 0.5 Hz, mm: median (worst), draws within 0.6 | 1 Hz | 2 Hz |",
        asked.plan.draws
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    for name in &asked.rigs {
        let text = text_of(name)?;
        let usual_mm = usual_step_mm(&Rig::read_with(name, &text, &asked.settings)?);
        let steps_mm = if asked.steps_mm.is_empty() { vec![usual_mm] } else { asked.steps_mm.clone() };
        let mut drive =
            Drive { name, text, settings: &asked.settings, step_mm: usual_mm, found: BTreeMap::new() };
        for place in &asked.laws {
            let law = LAWS.get(*place).context("there is no such law")?;
            let rig = match drive.under(law).and_then(|rig| disturbed(&rig, &asked.plant)) {
                Ok(rig) => rig,
                Err(refused) => {
                    eprintln!("{name}, {}: {refused:#}", law.name);
                    continue;
                }
            };
            let sines = sine_cells(&rig, &asked, usual_mm)?;
            for &step_mm in &steps_mm {
                let bounds = bounds(&rig, step_mm);
                for (when, score) in
                    ["cold", "after two moves"].iter().zip(steps(&rig, &asked.plan, step_mm)?)
                {
                    println!("| {name} | {} | {step_mm} | {when} | {score} | {bounds} | {sines} |", law.name);
                    score.failed.iter().for_each(|why| eprintln!("{name}, {}, {when}: {why}", law.name));
                }
            }
        }
    }
    Ok(())
}
