//! How late the control is at most in a run with all its requests, over the cycles of an instruction: the table of
//! docs/hazards.md.

use std::sync::atomic::AtomicBool;

use anyhow::Result;
use pneudrive_flashed_image::target::FlashedTarget;
use pneudrive_flashed_image::time::{Corner, SLOWEST, microseconds};
use pneudrive_hil_tests::{Target, body};

fn main() -> Result<()> {
    println!("| rig | period, us | cycles | sample, us | output, us | the run |\n|---|---|---|---|---|---|");
    for name in ["burrows", "servo-b-tuned"] {
        for cycles_per_instruction in 1..=6 {
            println!("{}", row(name, Corner { cycles_per_instruction, ..SLOWEST })?);
        }
    }
    Ok(())
}

fn row(name: &str, corner: Corner) -> Result<String> {
    let rig = body::rig(name, &["test.duration_s=0.6"]);
    let target = FlashedTarget::start(&rig, corner)?;
    let outcome =
        run(&target, &rig).map_or_else(|error| error.to_string(), |()| "comes to its end".to_owned());
    let late = target.with(|machine| machine.board().lateness)?;
    let [sample, output] = [late.sample, late.output].map(microseconds);
    let (period, cycles) = (rig.period_us(), corner.cycles_per_instruction);
    Ok(format!("| {name} | {period} | {cycles} | {sample:.0} | {output:.0} | {outcome} |"))
}

fn run(target: &FlashedTarget, rig: &pneudrive_sim::Rig) -> Result<()> {
    let mut client = target.connect()?;
    client.download_test(rig)?;
    client.arm()?;
    client.start()?;
    client.follow(&AtomicBool::new(false), |_| {})?;
    client.record(|_, _| {}).map(drop)
}
