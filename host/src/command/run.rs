//! `pneudrive run`.

use anyhow::{Result, bail};
use pneudrive_controller::Parameters;
use pneudrive_controller::parameters::lookup;
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
        warn_of_differences(&client.parameters()?, &rig.parameters(), rig.name());
    }
    client.download_test(rig)?;
    client.arm()?;
    client.start()?;
    let mut progress = Progress::new("running");
    let followed = client.follow(|status| {
        progress.at(u64::from(status.index), u64::from(status.duration_samples));
    });
    progress.done();
    followed.map(|_| ())
}

/// Says which parameters of the rig are not those of the file: the run is the rig's, not the file's.
fn warn_of_differences(rig: &Parameters, file: &Parameters, name: &str) {
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
}
