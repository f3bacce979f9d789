//! Drives a rig at a port: a virtual one, which this program serves. For a board, connect to its port instead.
//! Run it: cargo run -p pneudrive-session --example drive_a_rig

use std::sync::atomic::AtomicBool;

use anyhow::{Context, Result};
use pneudrive_evaluate::recorded_run::recorded_run;
use pneudrive_link::client::Client;
use pneudrive_rigs::virtual_rig::Background;
use pneudrive_session::{record, test_run::TestRun};
use pneudrive_sim::{Accuracy, Rig, run};

fn main() -> Result<()> {
    let rig = Rig::builtin("servo-b-tuned").context("a built-in rig")?;
    let served = Background::of(rig.clone())?;
    let mut client = Client::connect(served.port())?;

    let test = TestRun::of(&rig).prepare(&mut client, None)?;
    let ran = test.run(&mut client, &AtomicBool::new(false), &mut || Ok(()), |_| {});
    println!("the run ends {:?}", ran.ended?);
    let folder = tempfile::tempdir()?;
    let (_, recorded) = record::to_folder(&mut client, folder.path(), &mut |_, _| Ok(()))?;

    let simulated = recorded_run(&rig, &run(&rig, Accuracy::of(&rig))?)?;
    let same = recorded.samples.iter().zip(&simulated.samples).filter(|(one, other)| one == other).count();
    println!("{} samples are recorded, {same} of them as simulated", recorded.samples.len());
    Ok(())
}
