//! Ten minutes of a drive's time on the emulated board, or as many seconds as the argument says; `cargo xtask
//! soak` calls it.

#[cfg(unix)]
fn main() -> anyhow::Result<()> {
    use pneudrive_hil_tests::body::soak::{Soaked, drive, soak};
    use pneudrive_hil_tests::{QemuTarget, Target};

    let seconds = std::env::args().nth(1).map_or(Ok(600.0), |text| text.parse())?;
    let target = QemuTarget::start(&drive())?;
    let Soaked { runs, samples, on_level, in_simulation } = soak(&target, seconds);
    println!("{runs} runs, {samples} samples equal to the simulation, no fault, nothing lost");
    println!(
        "{:.1} s on the emulated board, {:.1} s simulated",
        on_level.as_secs_f64(),
        in_simulation.as_secs_f64()
    );
    println!("{}", target.cost().unwrap_or_default());
    Ok(())
}

#[cfg(not(unix))]
fn main() {
    eprintln!("the emulated board needs a Unix system");
    std::process::exit(1);
}
