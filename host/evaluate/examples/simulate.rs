//! Simulates the test of a rig file and says what its moves are like.
//! Run it: cargo run -p pneudrive-evaluate --example simulate [FILE]

use anyhow::{Context, Result};
use pneudrive_evaluate::evaluation::{moves_of_run, tolerance_mm, verdict};
use pneudrive_sim::{Accuracy, Rig, check_convergence, run};

fn main() -> Result<()> {
    let rig = match std::env::args().nth(1) {
        Some(path) => Rig::read(&path, &std::fs::read_to_string(&path)?)?,
        None => Rig::builtin("press").context("a built-in rig")?,
    };
    let accuracy = Accuracy::of(&rig);
    let run = run(&rig, accuracy)?;
    let moves = moves_of_run(&rig, &run);
    for one in &moves {
        let settled =
            one.settling_s.map_or("does not settle".to_owned(), |s| format!("settles after {s:.3} s"));
        println!(
            "{:.2} to {:.2} mm, up to {:.0} mm/s: {settled}",
            one.from_mm, one.end_mm, one.top_speed_mm_s
        );
    }
    println!("{}: {}", rig.name(), verdict(&[moves], tolerance_mm(Some(&rig))));
    println!("converged: {}", check_convergence(&rig, accuracy, &run)?.is_converged());
    Ok(())
}
