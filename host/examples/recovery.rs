//! Parameter recovery over many rigs: how often the 95 % intervals hold what was hidden.
//!
//! ```text
//! cargo build --release -p pneudrive
//! cargo run --release -p pneudrive --example recovery -- 100 shipped|any|live|scaled|lacking|quiet|quiet-lacking [FIRST SEED]
//! ```
//!
//! Of `quiet`, seeds 1 to 11, all pass, and all intervals hold but five that move together; seed 12 is refused wrongly.
//! Each rig is served and identified by the program itself, as a user does it. The tables of docs/howto/identification.md
//! and recovery.md beside this file join its outputs.

#[path = "../tests/hidden_rigs/mod.rs"]
mod hidden_rigs;

use std::env;
use std::path::PathBuf;

use anyhow::{Context, Result, bail, ensure};

use hidden_rigs::Hidden;
use hidden_rigs::coverage::Coverage;
use hidden_rigs::rigs::{
    any_rig, lacking_rig, live_rig, quiet_lacking_rig, quiet_rig, scaled_rig, shipped_rig,
};

/// The program, which cargo builds into the folder above that of its examples.
fn program() -> Result<PathBuf> {
    let examples = env::current_exe()?;
    let folder = examples.parent().and_then(|folder| folder.parent()).context("no folder above")?;
    let program = folder.join(format!("pneudrive{}", env::consts::EXE_SUFFIX));
    ensure!(
        program.exists(),
        "there is no {}; build it first: cargo build --release -p pneudrive",
        program.display()
    );
    Ok(program)
}

fn main() -> Result<()> {
    let argument = |i: usize| env::args().nth(i);
    let rigs: u64 = argument(1).map_or(Ok(100), |text| text.parse())?;
    let first: u64 = argument(3).map_or(Ok(1), |text| text.parse())?;
    let draw: fn(u64) -> Hidden = match argument(2).as_deref() {
        None | Some("shipped") => shipped_rig,
        Some("any") => any_rig,
        Some("live") => live_rig,
        Some("scaled") => scaled_rig,
        Some("lacking") => lacking_rig,
        Some("quiet") => quiet_rig,
        Some("quiet-lacking") => quiet_lacking_rig,
        Some(other) => {
            bail!("there are shipped, any, live, scaled, lacking, quiet and quiet-lacking rigs, not {other}")
        }
    };
    let program = program()?;
    let mut coverage = Coverage::default();
    for seed in first..first + rigs {
        let hidden = draw(seed);
        let folder = tempfile::tempdir()?;
        match hidden.identify(&program, folder.path()) {
            Ok(trial) => {
                let lacks = hidden.lacks.as_ref().map_or(String::new(), |lacks| format!(", really {lacks}"));
                eprintln!("{seed}, {}{lacks}: {}", hidden.name, trial.summary());
                match &hidden.lacks {
                    Some(lacks) => coverage.count_lacking(&trial, lacks),
                    None => coverage.count(&trial),
                }
            }
            Err(error) => {
                eprintln!("{seed}, {}: {error:#}", hidden.name);
                coverage.ended += 1;
            }
        }
        // A campaign of hours that is cut short has its table so far.
        if (seed + 1 - first).is_multiple_of(10) || seed + 1 == first + rigs {
            println!("{coverage}");
        }
    }
    Ok(())
}
