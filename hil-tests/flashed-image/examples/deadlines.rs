//! How late the control is at most in a run in which a host asks everything again and again, over the cycles of an
//! instruction: the table of docs/explanation/hazards.md.

use std::sync::atomic::AtomicBool;

use anyhow::Result;
use pneudrive_controller::Fault;
use pneudrive_flashed_image::target::FlashedTarget;
use pneudrive_flashed_image::time::{Corner, SLOWEST, microseconds};
use pneudrive_hil_tests::requests::{IN_A_RUN, fill_log};
use pneudrive_hil_tests::{Target, body};
use pneudrive_protocol::Mode;
use pneudrive_sim::Rig;

fn main() -> Result<()> {
    println!("| rig | period, us | cycles | sample, us | output, us | the run |\n|---|---|---|---|---|---|");
    for (name, period) in RIGS {
        let rig = body::rig(name, &["test.duration_s=2", period]);
        for cycles_per_instruction in 1..=6 {
            println!("{}", row(&rig, Corner { cycles_per_instruction, ..SLOWEST })?);
        }
    }
    Ok(())
}

/// The shortest and the usual period of the built-in rigs, and a long one.
const RIGS: [(&str, &str); 3] = [
    ("burrows", "controller.period_s=0.0005"),
    ("servo-b-tuned", "controller.period_s=0.0013"),
    ("servo-b-tuned", "controller.period_s=0.002"),
];

fn row(rig: &Rig, corner: Corner) -> Result<String> {
    let target = FlashedTarget::start(rig, corner)?;
    let outcome = match run(&target, rig) {
        Ok(()) => "comes to its end".to_owned(),
        Err(_) => ended_by(&target)?,
    };
    let late = target.with(|machine| machine.board().lateness)?;
    let [sample, output] = [late.sample, late.output].map(microseconds);
    let (period, cycles) = (rig.period_us(), corner.cycles_per_instruction);
    Ok(format!("| {} | {period} | {cycles} | {sample:.0} | {output:.0} | {outcome} |", rig.name()))
}

/// The fault that the drive is in, and how many samples of the run it has taken.
fn ended_by(target: &FlashedTarget) -> Result<String> {
    let status = target.connect()?.status()?;
    let fault = Fault::from_code(status.fault).map_or("no fault".to_owned(), |fault| format!("{fault:?}"));
    Ok(format!("{fault} at sample {}", status.index))
}

fn run(target: &FlashedTarget, rig: &Rig) -> Result<()> {
    let mut client = target.connect()?;
    fill_log(&mut client)?;
    client.download_test(rig)?;
    client.arm()?;
    client.start()?;
    while client.status()?.mode == Mode::Running {
        IN_A_RUN.iter().try_for_each(|question| (question.ask)(&mut client, rig))?;
    }
    client.follow(&AtomicBool::new(false), |_| {})?;
    client.record(|_, _| {}).map(drop)
}
