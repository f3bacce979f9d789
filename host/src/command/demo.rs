//! `pneudrive demo`: the whole job with no hardware.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use anyhow::{Result, anyhow};
use pneudrive_sim::{Accuracy, Rig, run};

use super::overlay::overlay;
use super::record::record;
use super::run::run_test;
use super::{load_rig, simulate};
use crate::cli::Demo;
use crate::client::Client;
use crate::report::Report;
use crate::run_folder::{self, StoredRun};
use crate::transient::Transient;
use crate::virtual_rig::{Door, Pace, VirtualRig};

pub(super) fn execute(arguments: &Demo) -> Result<()> {
    let model = load_rig(&arguments.rig, &[])?;
    let real = model.spread(arguments.spread, arguments.seed)?;
    let percent = 100.0 * arguments.spread;

    println!("1. a virtual rig: {} with true parameters within {percent} % of the file's", model.name());
    let rig = Background::start(real, arguments.seed)?;
    let mut client = Client::connect(&rig.port)?;
    let info = client.info()?;
    println!("   {} on {}: {}", info.board, rig.port, info.firmware);

    println!("2. the step test on it, over the real protocol");
    run_test(&mut client, &model, false)?;

    println!("3. its transient, recorded");
    let (target_path, target) = record(&mut client, &arguments.out)?;
    client.disarm()?;
    drop(client);
    rig.stop()?;
    println!("   {}: {} samples", target_path.display(), target.samples.len());

    println!("4. the same test, simulated from the rig file");
    let run = run(&model, Accuracy::default())?;
    run_folder::write(&arguments.out, &model, Accuracy::default(), &run)?;
    println!("   {}", simulate::summary(&model, &run));

    println!("5. both on the same graphs\n");
    let name = target_path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let transients =
        [Transient::of_target(&name, &target)?, Transient::of_run("simulated", &StoredRun::of(&model, &run))];
    let deviations = overlay(&transients)?;
    let notes = [
        format!(
            "{name} was recorded on a virtual rig whose true parameters lie within {percent} % of the rig file's (seed {}), with noise on its sensors; the simulation knows only the rig file.",
            arguments.seed
        ),
        "A deviation is the simulation less the record.".to_owned(),
    ];
    let title = format!("{}: {name} and the simulation", model.name());
    let page = arguments.out.join("report.html");
    Report { title: &title, notes: &notes, transients: &transients, deviations: &deviations }.write(&page)?;
    println!("open {} in a browser", page.display());
    Ok(())
}

/// A virtual rig on a thread of its own.
struct Background {
    port: String,
    stop: Arc<AtomicBool>,
    thread: JoinHandle<Result<()>>,
}

impl Background {
    fn start(rig: Rig, seed: u64) -> Result<Background> {
        let mut door = Door::open("tcp:127.0.0.1:0")?;
        let port = door.port_name()?;
        let mut rig = VirtualRig::new(rig, seed, Pace { fast: true, live: false })?;
        let stop = Arc::new(AtomicBool::new(false));
        let watched = Arc::clone(&stop);
        let thread = std::thread::spawn(move || rig.serve(&mut door, &watched));
        Ok(Background { port, stop, thread })
    }

    fn stop(self) -> Result<()> {
        self.stop.store(true, Ordering::Relaxed);
        self.thread.join().map_err(|_| anyhow!("the virtual rig broke down"))?
    }
}
