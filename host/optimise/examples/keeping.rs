//! What it brings a drive to keep what it has learned: the table of docs/explanation/control.md.
//!
//! ```text
//! cargo run --release -p pneudrive-optimise --example keeping -- [DRIVE ...] [KEY=VALUE ...]
//! ```
//!
//! A DRIVE is one of the six of the catalogue; without one, all are measured. `draws=40 seed=1 range=1 bristles=1` as in the example
//! `positioning`. `armings=4`: so many in a row, each with a step there, back and there again. `plant=load.mass_kg*2`: factors on
//! values of the plant from the arming `from=3` on, counted from 0; with `growing=1` they grow up to the last arming, a factor in equal
//! ratios. `plant=valve.null_offset_mm+0.1` adds, and `before=` has the factors of the armings before. A line for each arming: its first
//! step with and without keeping.
//!
//! `moves=50`: a soak. Each arming has so many moves to drawn places, and one line tells of all with, and one without keeping. With
//! `at=25` load and supply of `plant=` come before that move of each arming, and go before the next arming.

use std::sync::atomic::AtomicUsize;
use std::sync::atomic::Ordering::Relaxed;

use anyhow::{Context, Result, bail};
use pneudrive_controller::law::cascade::kept::Learned;
use pneudrive_design::six_drives::{SIX_DRIVES, rig_file_of};
use pneudrive_optimise::positioning::armings::{ArmingScore, first_steps};
use pneudrive_optimise::positioning::soak::{MovesScore, Soak, SoakScore, soak};
use pneudrive_optimise::positioning::{Plan, Spread, usual_step_mm};
use pneudrive_optimise::tuning::Proportion;
use pneudrive_sim::Rig;

struct Asked {
    drives: Vec<String>,
    plan: Plan,
    armings: usize,
    plant: Vec<Change>,
    /// Before the arming `from`.
    before: Vec<Change>,
    from: usize,
    grows: bool,
    step_mm: Option<f64>,
    /// Moves of each arming of a soak; None: first steps.
    moves: Option<usize>,
    at: Option<usize>,
}

/// A key of the plant, a factor on its value, and what is added to that.
struct Change {
    key: String,
    factor: f64,
    sum: f64,
}

impl Change {
    fn read(text: &str) -> Result<Change> {
        let (key, factor, sum) = match (text.split_once('*'), text.split_once('+')) {
            (Some((key, factor)), _) => (key, factor.parse()?, 0.0),
            (None, Some((key, sum))) => (key, 1.0, sum.parse()?),
            (None, None) => bail!("{text} is neither KEY*FACTOR nor KEY+SUM"),
        };
        Ok(Change { key: key.to_owned(), factor, sum })
    }

    fn all(text: &str) -> Result<Vec<Change>> {
        text.split(',').map(Change::read).collect()
    }

    /// So much of it, from 0 to 1, as a setting of a rig.
    fn setting(&self, rig: &Rig, part: f64) -> Result<String> {
        let Change { key, factor, sum } = self;
        let value = rig.number_at(key).with_context(|| format!("{key} is no number of the rig"))?;
        Ok(format!("{key}={:?}", value * factor.powf(part) + sum * part))
    }
}

impl Asked {
    fn read() -> Result<Asked> {
        let plan = Plan { spread: Spread::default(), draws: 40, seed: 1 };
        let mut asked = Asked {
            drives: vec![],
            plan,
            armings: 4,
            plant: vec![],
            before: vec![],
            from: 3,
            grows: false,
            step_mm: None,
            moves: None,
            at: None,
        };
        for argument in std::env::args().skip(1) {
            match argument.split_once('=') {
                None => asked.drives.push(argument),
                Some(("draws", value)) => asked.plan.draws = value.parse()?,
                Some(("seed", value)) => asked.plan.seed = value.parse()?,
                Some(("range", value)) => asked.plan.spread.whole_range = value != "0",
                Some(("bristles", value)) => asked.plan.spread.bristles = value != "0",
                Some(("armings", value)) => asked.armings = value.parse()?,
                Some(("from", value)) => asked.from = value.parse()?,
                Some(("growing", value)) => asked.grows = value != "0",
                Some(("step", value)) => asked.step_mm = Some(value.parse()?),
                Some(("plant", value)) => asked.plant = Change::all(value)?,
                Some(("before", value)) => asked.before = Change::all(value)?,
                Some(("moves", value)) => asked.moves = Some(value.parse()?),
                Some(("at", value)) => asked.at = Some(value.parse()?),
                Some((key, _)) => bail!(
                    "{key}=? The keys are draws, seed, range, bristles, armings, from, growing, step, plant, before, moves, at"
                ),
            }
        }
        if asked.drives.is_empty() {
            asked.drives = SIX_DRIVES.iter().map(|(name, _)| (*name).to_owned()).collect();
        }
        Ok(asked)
    }

    /// The plant of an arming.
    fn plant(&self, arming: usize, drawn: &Rig) -> Result<Rig> {
        let (changes, part) = match self.grows {
            true => (&self.plant, arming as f64 / (self.armings - 1).max(1) as f64),
            false if arming >= self.from => (&self.plant, 1.0),
            false => (&self.before, 1.0),
        };
        let settings =
            changes.iter().map(|change| change.setting(drawn, part)).collect::<Result<Vec<_>>>()?;
        Ok(drawn.with_plant(&settings)?)
    }

    /// The plant of an arming of a soak, before and behind the change between two of its moves.
    fn plants(&self, arming: usize, drawn: &Rig) -> Result<[Rig; 2]> {
        let behind = self.plant(arming, drawn)?;
        let before = if self.at.is_some() { drawn.clone() } else { behind.clone() };
        Ok([before, behind])
    }

    /// The rig of a drive whose law begins with this.
    fn rig(&self, name: &str, adapt: &str) -> Result<Rig> {
        let text = rig_file_of(name).with_context(|| format!("{name} is none of the six drives"))?;
        let settings = [format!("controller.adapt={adapt}"), "controller.law=cascade".to_owned()];
        Ok(Rig::read_with(name, &text, &settings)?)
    }

    /// The first steps of the armings, with and without keeping.
    fn show_first_steps(&self, name: &str) -> Result<()> {
        let of = |word: &str| -> Result<Vec<ArmingScore>> {
            let rig = self.rig(name, word)?;
            let step_mm = self.step_mm.unwrap_or_else(|| usual_step_mm(&rig));
            first_steps(&rig, &self.plan, step_mm, self.armings, |arming, drawn| self.plant(arming, drawn))
        };
        for (arming, (kept, afresh)) in of("kept")?.iter().zip(&of("afresh")?).enumerate() {
            let [mass, friction] = kept.begun;
            println!(
                "| {name} | {arming} | {mass:.2}, {friction:.2} | {} | {} | {} |",
                kept.changed,
                cells(kept),
                cells(afresh)
            );
            kept.step.failed.iter().for_each(|why| eprintln!("{name}, {arming}, kept: {why}"));
            afresh.step.failed.iter().for_each(|why| eprintln!("{name}, {arming}, afresh: {why}"));
        }
        Ok(())
    }

    /// A soak, with and without keeping.
    fn show_soak(&self, name: &str, moves: usize) -> Result<()> {
        for word in ["kept", "afresh"] {
            let asked = Soak { armings: self.armings, moves, change_at: self.at };
            let (done, all) = (AtomicUsize::new(0), self.armings * self.plan.draws);
            let progress = || {
                let done = done.fetch_add(1, Relaxed) + 1;
                if done % all.div_ceil(10) == 0 {
                    eprintln!("{name}, {word}: {done} of {all} armings");
                }
            };
            let plants = |arming: usize, drawn: &Rig| self.plants(arming, drawn);
            let score = soak(&self.rig(name, word)?, &self.plan, &asked, plants, progress)?;
            let of_moves = score.moves.iter().map(moves_cells).collect::<Vec<_>>().join(" | ");
            println!("| {name} | {word} | {of_moves} | {} | {} |", score.trips.len(), kept_cells(&score));
            score.trips.iter().for_each(|why| eprintln!("{name}, {word}, {why}"));
        }
        Ok(())
    }
}

/// The cells of a first step: within the bands, median time to the tightest, overshoot, deviation; those that did not end.
fn cells(score: &ArmingScore) -> String {
    let within = score.step.within.each_ref().map(|share| share.met.to_string()).join(" / ");
    let time = score.step.median_s[2].map_or("-".to_owned(), |s| format!("{s:.3}"));
    let deviation = deviation_cell(score.deviation_mm);
    let Proportion { met, of } = score.step.without_overshoot;
    let (beyond, failed) = (score.step.beyond_mm, score.step.failed.len());
    format!("{within} | {time} | {beyond:.2} ({}) | {deviation} | {failed}", of - met - failed)
}

/// Median and worst.
fn deviation_cell(mm: Option<[f64; 2]>) -> String {
    mm.map_or("-".to_owned(), |[middle, worst]| format!("{middle:.2} ({worst:.2})"))
}

/// The cells of the moves of a soak: within the bands, deviation, overshoot.
fn moves_cells(score: &MovesScore) -> String {
    let within = score.within.each_ref().map(|share| share.met.to_string()).join(" / ");
    let deviation = deviation_cell(score.deviation_mm);
    let (all, beyond) = (score.within[0].of, score.beyond_mm);
    format!("{within} of {all} | {deviation} | {beyond:.2} ({})", score.overshoots)
}

/// The ranges of what was kept, the runs that ended at a bound, and the armings that began afresh.
fn kept_cells(score: &SoakScore) -> String {
    let range = |of: fn(&Learned) -> i32, unit: f64| {
        score.kept.each_ref().map(|end| format!("{:.2}", f64::from(of(end)) / unit)).join(" to ")
    };
    let (coarse, fine) = (65_536.0, 16_777_216.0);
    let ranges = [
        range(|kept| kept.mass, coarse),
        range(|kept| kept.friction, coarse),
        range(|kept| kept.force, fine),
        range(|kept| kept.viscous, fine),
        range(|kept| kept.pace, coarse),
        range(|kept| kept.looseness, 1.0),
    ];
    let [bound, jumped, tripped] = score.afresh;
    format!("{} | {} | {bound}, {jumped}, {tripped}", ranges.join(" | "), score.at_bound)
}

const FIRST_STEPS: &str = "| drive | arming | begins with M, m | told as changed | kept: of DRAWS within 1 / 0.2 / 0.05 mm | median time, s | largest overshoot, mm (beyond 0.1) | off its trajectory, mm: median (worst) | failed | afresh: within | time | overshoot | off | failed |";

fn main() -> Result<()> {
    let asked = Asked::read()?;
    let of_moves = match asked.at {
        None => MOVES.to_owned(),
        Some(_) => ["before", "first one behind", "others behind"]
            .map(|which| format!("{which}: {MOVES}"))
            .join(" | "),
    };
    let head = match asked.moves {
        None => FIRST_STEPS.replace("DRAWS", &asked.plan.draws.to_string()),
        Some(_) => format!(
            "| drive | begins | {of_moves} | trips | kept: M | m | d, stictions | B beyond the file | lag | looseness | ended at a bound | afresh: at a bound, jumped, tripped |"
        ),
    };
    println!("{head}\n|{}", "---|".repeat(head.matches('|').count() - 1));
    for name in &asked.drives {
        match asked.moves {
            None => asked.show_first_steps(name)?,
            Some(moves) => asked.show_soak(name, moves)?,
        }
    }
    Ok(())
}

const MOVES: &str =
    "within 1 / 0.2 / 0.05 mm | off its trajectory, mm: median (worst) | overshoot, mm (beyond 0.1)";
