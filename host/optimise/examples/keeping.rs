//! What it brings a drive to keep what it has learned: the table of docs/explanation/control.md.
//!
//! ```text
//! cargo run --release -p pneudrive-optimise --example keeping -- [DRIVE ...] [KEY=VALUE ...]
//! ```
//!
//! A DRIVE is one of the six of the catalogue; without one, all are measured. `draws=40 seed=1 range=1 bristles=1` as in the example
//! `positioning`. `armings=4`: so many in a row, each with a step there, back and there again. `plant=load.mass_kg*2`: factors on
//! values of the plant from the arming `from=3` on, counted from 0; with `growing=1` they grow evenly up to the last arming. A line
//! for each arming: its first step with and without keeping.

use anyhow::{Context, Result, bail};
use pneudrive_design::six_drives::{SIX_DRIVES, rig_file_of};
use pneudrive_optimise::positioning::armings::{ArmingScore, first_steps};
use pneudrive_optimise::positioning::{Plan, Spread, usual_step_mm};
use pneudrive_sim::Rig;

struct Asked {
    drives: Vec<String>,
    plan: Plan,
    armings: usize,
    /// Keys of the plant, each with a factor.
    plant: Vec<(String, f64)>,
    from: usize,
    grows: bool,
    step_mm: Option<f64>,
}

impl Asked {
    fn read() -> Result<Asked> {
        let plan = Plan { spread: Spread::default(), draws: 40, seed: 1 };
        let mut asked =
            Asked { drives: vec![], plan, armings: 4, plant: vec![], from: 3, grows: false, step_mm: None };
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
                Some(("plant", value)) => asked.plant = factors(value)?,
                Some((key, _)) => bail!(
                    "{key}=? The keys are draws, seed, range, bristles, armings, from, growing, step, plant"
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
        let part = match self.grows {
            true => arming as f64 / (self.armings - 1).max(1) as f64,
            false if arming >= self.from => 1.0,
            false => 0.0,
        };
        let setting = |(key, factor): &(String, f64)| {
            let value = drawn.number_at(key).with_context(|| format!("{key} is no number of the rig"))?;
            Ok(format!("{key}={:?}", value * factor.powf(part)))
        };
        Ok(drawn.with_plant(&self.plant.iter().map(setting).collect::<Result<Vec<_>>>()?)?)
    }
}

fn factors(text: &str) -> Result<Vec<(String, f64)>> {
    let factor = |text: &str| {
        let (key, factor) = text.split_once('*').with_context(|| format!("{text} is no KEY*FACTOR"))?;
        Ok((key.to_owned(), factor.parse()?))
    };
    text.split(',').map(factor).collect()
}

/// The cells of a first step: within the bands, median time to the tightest, overshoot, deviation; those that did not end.
fn cells(score: &ArmingScore) -> String {
    let within = score.step.within.each_ref().map(|share| share.met.to_string()).join(" / ");
    let time = score.step.median_s[2].map_or("-".to_owned(), |s| format!("{s:.3}"));
    let deviation =
        score.deviation_mm.map_or("-".to_owned(), |[middle, worst]| format!("{middle:.2} ({worst:.2})"));
    format!("{within} | {time} | {:.2} | {deviation} | {}", score.step.beyond_mm, score.step.failed.len())
}

fn main() -> Result<()> {
    let asked = Asked::read()?;
    println!(
        "| drive | arming | begins with M, m | told as changed | kept: of {} within 1 / 0.2 / 0.05 mm | median time, s | largest overshoot, mm | off its trajectory, mm: median (worst) | failed | afresh: within | time | overshoot | off | failed |",
        asked.plan.draws
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    for name in &asked.drives {
        let text = rig_file_of(name).with_context(|| format!("{name} is none of the six drives"))?;
        let of = |word: &str| -> Result<Vec<ArmingScore>> {
            let rig = Rig::read_with(
                name,
                &text,
                &[format!("controller.adapt={word}"), "controller.law=cascade".to_owned()],
            )?;
            let step_mm = asked.step_mm.unwrap_or_else(|| usual_step_mm(&rig));
            first_steps(&rig, &asked.plan, step_mm, asked.armings, |arming, drawn| asked.plant(arming, drawn))
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
    }
    Ok(())
}
