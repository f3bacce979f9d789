//! Serves the emulated board with the plant of a rig at a port, in real time, until Ctrl-C; `cargo xtask board` calls it.

#[cfg(unix)]
fn main() -> anyhow::Result<()> {
    use std::net::TcpListener;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::time::Duration;

    use anyhow::{Context, ensure};
    use pneudrive_hil_tests::{QemuTarget, Target};
    use pneudrive_records::rig_source::rig_text;
    use pneudrive_sim::Rig;

    let mut arguments = std::env::args().skip(1);
    let (name, address) = arguments.next().zip(arguments.next()).context("usage: serve RIG HOST:PORT")?;
    let (source, text) = rig_text(&name)?;
    let rig = Rig::read(&source, &text)?;
    let listener = TcpListener::bind(&address).with_context(|| address.clone())?;
    let ended = Arc::new(AtomicBool::new(false));
    let end = Arc::clone(&ended);
    ctrlc::set_handler(move || end.store(true, Ordering::Relaxed))?;

    let target = QemuTarget::serve(&rig, listener)?;
    println!("{} is on {}, on an emulated Cortex-M4", rig.name(), target.port());
    println!("try: pneudrive device --port {} info    (end with Ctrl-C)", target.port());
    while !ended.load(Ordering::Relaxed) {
        ensure!(target.board().is_on()? || ended.load(Ordering::Relaxed), "the emulator has ended");
        std::thread::sleep(Duration::from_millis(50));
    }
    println!("{}", target.cost().unwrap_or_default());
    Ok(())
}

#[cfg(not(unix))]
fn main() {
    eprintln!("the emulated board needs a Unix system");
    std::process::exit(1);
}
