//! How well a drive positions before and after `pneudrive commission`, over drives drawn from all that a rig file leaves open.
//!
//! ```text
//! cargo build --release -p pneudrive
//! cargo run --release -p pneudrive --example commissioned -- COUNT [FIRST] [bristles]
//! ```
//!
//! Each draw of the press is served as a rig that goes on between its runs, in real time, and commissioned by the program itself. Then its
//! steps are simulated with the parameters by the data sheets and with those of the fit, and judged by the true position. A line is printed
//! for each draw, and at the end how many are within 0.05 mm: of the first step, and of that after two moves.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use pneudrive_optimise::positioning::{
    Arrival, Measured, Spread, Steps, draws, places, steps_on, usual_step_mm,
};
use pneudrive_rigs::virtual_rig::{Background, Listener, Pace, VirtualRig};
use pneudrive_sim::{Rig, rigfile};

/// Fixes the draws.
const SEED: u64 = 1;

/// Tables of a rig file that are no part of the drive.
const NOT_OF_THE_DRIVE: [&str; 2] = ["controller", "test"];

/// The program, which cargo builds into the folder above that of its examples.
fn program() -> Result<PathBuf> {
    let examples = env::current_exe()?;
    let folder = examples.parent().and_then(Path::parent).context("no folder above")?;
    let program = folder.join(format!("pneudrive{}", env::consts::EXE_SUFFIX));
    ensure!(program.exists(), "there is no {}; build it first", program.display());
    Ok(program)
}

/// The press in the middle of its stroke.
fn press() -> Result<String> {
    let press = rigfile::builtin("press").context("a built-in rig")?;
    let is_place = |line: &&str| !line.starts_with("position_m") && !line.starts_with("moves_mm");
    let lines: String = press.lines().filter(is_place).map(|line| format!("{line}\n")).collect();
    Ok(format!("{lines}position_m = 0.125005\nmoves_mm = [[0.0, 125.0]]\n"))
}

/// A rig whose law knows `known`, and whose drive is `drive`.
fn with_drive(known: &Rig, drive: &Rig) -> Result<Rig> {
    let of_the_drive = drive.entries().filter(|(key, _)| !NOT_OF_THE_DRIVE.contains(&key.table()));
    let settings: Vec<String> = of_the_drive.map(|(key, value)| format!("{}={value}", key.path)).collect();
    Ok(known.with_plant(&settings)?)
}

/// Commissions a drive by the program. The folder has the fitted rig file if it comes to a fit.
fn commission(program: &Path, folder: &Path, drive: Rig, seed: u64) -> Result<(f64, String)> {
    let served = VirtualRig::new(drive, seed, Pace { fast: false, live: true })?;
    let served = Background::start(served, Listener::open("tcp:127.0.0.1:0")?);
    let begun = Instant::now();
    let mut command = Command::new(program);
    command.current_dir(folder).args([
        "commission",
        "model.toml",
        "--yes",
        "--out",
        "found",
        "--port",
        served.port(),
    ]);
    let output = command.output()?;
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    let last = printed.lines().last().unwrap_or_default().to_owned();
    let told = if output.status.success() { "commissioned".to_owned() } else { last };
    Ok((begun.elapsed().as_secs_f64(), told))
}

/// How the steps ended: time to 0.05 mm, s, and error at the end, mm.
fn told(measured: &Measured<[Arrival; 2]>) -> String {
    match measured {
        Err(why) => why.clone(),
        Ok((arrivals, _)) => {
            let each = arrivals.iter().map(|arrival| {
                let time = arrival.within_s[2].map_or("-".to_owned(), |time| format!("{time:.3} s"));
                format!("{time} ({:.3} mm, {:.2} beyond)", arrival.error_mm, arrival.beyond_mm)
            });
            each.collect::<Vec<_>>().join(", ")
        }
    }
}

/// Which of the two steps are within 0.05 mm.
fn within(measured: &Measured<[Arrival; 2]>) -> [bool; 2] {
    let of = |n: usize| measured.as_ref().is_ok_and(|(arrivals, _)| arrivals[n].within_s[2].is_some());
    [of(0), of(1)]
}

fn main() -> Result<()> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let number = |n: usize, usual: usize| arguments.get(n).map_or(Ok(usual), |text| text.parse::<usize>());
    let (count, first) = (number(0, 10)?, number(1, 1)?);
    let spread = Spread { whole_range: true, bristles: arguments.iter().any(|text| text == "bristles") };
    let (program, text) = (program()?, press()?);
    let file = Rig::read("model.toml", &text)?;
    let last = first + count - 1;
    let drawn = draws(&file, spread, SEED, last)?;
    let (mut before, mut after, mut fitted) = ([0; 2], [0; 2], 0);
    for (n, place) in (first..=last).zip(places(SEED, last).into_iter().skip(first - 1)) {
        let (drive, steps) = (drawn[n - 1].rig(&file)?, Steps::of(&file, usual_step_mm(&file), place)?);
        let folder = tempfile::tempdir()?;
        std::fs::write(folder.path().join("model.toml"), &text)?;
        let (seconds, outcome) = commission(&program, folder.path(), drive.clone(), n as u64)?;
        let without = steps_on(&drive, &steps)?;
        let found = std::fs::read_to_string(folder.path().join("found/fitted.toml")).ok();
        let with = match &found {
            Some(found) => steps_on(&with_drive(&Rig::read("fitted.toml", found)?, &drive)?, &steps)?,
            None => without.clone(),
        };
        fitted += usize::from(found.is_some());
        for step in 0..2 {
            before[step] += usize::from(within(&without)[step]);
            after[step] += usize::from(within(&with)[step]);
        }
        println!("{n}, {seconds:.0} s, {outcome}: {}; after: {}", told(&without), told(&with));
    }
    println!(
        "of {count}: {fitted} fitted; within 0.05 mm before {}, {}, after {}, {} (first step, after two moves)",
        before[0], before[1], after[0], after[1]
    );
    Ok(())
}
