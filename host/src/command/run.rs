//! `pneudrive run`.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

use anyhow::{Result, bail};
use pneudrive_controller::Parameters;
use pneudrive_controller::parameters::{id, lookup};
use pneudrive_protocol::Mode;
use pneudrive_sim::Rig;

use super::{Progress, load_rig};
use crate::cli::Run;
use crate::client::Client;
use crate::words;

pub(super) fn execute(arguments: &Run) -> Result<()> {
    let rig = load_rig(&arguments.rig, &arguments.settings)?;
    let mut client = Client::connect(&arguments.port.port)?;
    run_test(&mut client, &rig, arguments.config)?;
    say!("{}: done", rig.name());
    if rig.word("controller.loop") == "closed" {
        say!("the drive holds its last setpoint; `pneudrive device disarm` releases it");
    }
    say!("next: pneudrive record --port {}", arguments.port.port);
    Ok(())
}

/// Downloads the test of a rig (with its parameters, if asked for), arms, starts and follows it.
pub(super) fn run_test(client: &mut Client, rig: &Rig, with_parameters: bool) -> Result<()> {
    let status = client.status()?;
    match status.mode {
        Mode::Running => bail!("a run is on already; wait for its end, or stop it (`pneudrive device stop`)"),
        Mode::Fault => bail!(
            "the rig is in the fault {}: {}; make sure that it is safe, then leave the fault with `pneudrive device arm`",
            words::fault_code_name(status.fault),
            words::fault_meaning(status.fault)
        ),
        _ => {}
    }
    client.disarm()?;
    if with_parameters {
        client.import_parameters(&rig.parameters())?;
    } else {
        compare_parameters(&client.parameters()?, &rig.parameters(), rig.name())?;
    }
    warn_of_a_full_recorder(client, rig)?;
    client.download_test(rig)?;
    client.arm()?;
    client.start()?;
    let mut progress = Progress::new("running");
    let interrupted = interrupts();
    let followed = client.follow(&interrupted, |status| {
        progress.at(u64::from(status.index), u64::from(status.duration_samples));
    });
    progress.done();
    followed.map(|_| ())
}

/// Set by Ctrl-C from the first run on: a run that is interrupted is stopped, not left alone.
fn interrupts() -> Arc<AtomicBool> {
    static INTERRUPTED: OnceLock<Arc<AtomicBool>> = OnceLock::new();
    Arc::clone(INTERRUPTED.get_or_init(|| {
        let flag = Arc::new(AtomicBool::new(false));
        let set = Arc::clone(&flag);
        if ctrlc::set_handler(move || set.store(true, Ordering::Relaxed)).is_err() {
            eprintln!("note: Ctrl-C will not stop the rig; use `pneudrive device stop`");
        }
        flag
    }))
}

/// Says how much of a long test the recorder will hold.
fn warn_of_a_full_recorder(client: &mut Client, rig: &Rig) -> Result<()> {
    let capacity = client.info()?.record_capacity;
    let stored = rig.last_sample() / rig.integer("test.decimation").max(1) as u32 + 1;
    if stored > capacity {
        let least = rig.last_sample().div_ceil(capacity.saturating_sub(1).max(1));
        eprintln!(
            "note: the recorder holds {capacity} of {stored} samples and stops when it is full; test.decimation={least} records all of the test"
        );
    }
    Ok(())
}

/// Says which parameters of the rig are not those of the file: the run is the rig's, not the file's.
/// With another loop or period the moves would mean something else: that is refused.
fn compare_parameters(rig: &Parameters, file: &Parameters, name: &str) -> Result<()> {
    for id in [id::OPEN_LOOP, id::STEPPER, id::PERIOD_US] {
        let (on_rig, in_file) = (rig.get(id), file.get(id));
        if on_rig != in_file {
            let parameter = lookup(id).map_or("?", |parameter| parameter.name);
            bail!(
                "{parameter} is {} on the rig and {} in {name}, so its moves would mean something else; --config downloads the parameters of the file",
                on_rig.unwrap_or(0),
                in_file.unwrap_or(0)
            );
        }
    }
    let differences: Vec<String> = rig
        .iter()
        .zip(file.iter())
        .filter(|((_, on_rig), (_, in_file))| on_rig != in_file)
        .map(|((id, on_rig), (_, in_file))| {
            let parameter = lookup(id).map_or("?", |parameter| parameter.name);
            format!("{parameter} is {on_rig}, not {in_file}")
        })
        .collect();
    if let Some(first) = differences.first() {
        let others = differences.len() - 1;
        let more = if others == 0 { String::new() } else { format!(" and {others} more") };
        eprintln!(
            "note: the rig's parameters differ from {name} ({first}{more}); --config downloads those of the file"
        );
    }
    Ok(())
}
