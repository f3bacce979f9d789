//! `pneudrive identify --plan`: runs the plan's tests on the rig at a port.

use std::path::Path;

use anyhow::{Context, Result, bail};
use pneudrive_analysis::identification::plan::{self, Bench, NEEDS_PRESSURES, Recorded};
use pneudrive_controller::parameters::id;
use pneudrive_link::client::Client;
use pneudrive_records::target::TargetFile;
use pneudrive_records::units::lacks_pressures;
use pneudrive_sim::Rig;
use pneudrive_sim::component::controller::Loop;
use pneudrive_sim::keys;

use crate::cli::RigChoice;
use crate::command::record::record;
use crate::command::rig_source::load_rig;
use crate::command::run::run_test;

/// Runs the tests on the rig at a port and writes their TARGET files to a folder.
pub(super) fn execute(choice: &RigChoice, port: &str, folder: &Path) -> Result<Recorded> {
    let [closed, open] = ["closed", "open"].map(|loop_| {
        let with = format!("controller.loop={loop_}");
        load_rig(&choice.rig, &[&choice.settings[..], &[with]].concat())
    });
    let (closed, open) = (closed?, open?);
    let mut client = Client::connect(port)?;
    let count = client.status()?.position;
    client.disarm()?;
    let parameters = client.parameters()?.values;
    if lacks_pressures(&parameters) {
        bail!("the rig at {port} has no pressure sensors (pressure_sensors is 0): {NEEDS_PRESSURES}");
    }
    let open_loop = parameters.get(id::OPEN_LOOP).unwrap_or(0);
    let recorded = plan::run(&mut AtPort { client: &mut client, folder }, &closed, &open, count);
    // Even if a test failed, the drive is disarmed and its loop is as before.
    let left = client.disarm().and_then(|()| client.set_parameters(id::OPEN_LOOP, &[open_loop]));
    let recorded = recorded?;
    left.context("the tests are done, but the rig could not be disarmed and its controller.loop restored")?;
    Ok(recorded)
}

/// A rig at a port, and the folder for its records.
struct AtPort<'a> {
    client: &'a mut Client,
    folder: &'a Path,
}

impl Bench for AtPort<'_> {
    fn run(&mut self, test: &Rig) -> Result<()> {
        let open_loop = i32::from(test.get(&keys::controller::LOOP) == Loop::Open);
        self.client.disarm()?;
        self.client.set_parameters(id::OPEN_LOOP, &[open_loop])?;
        run_test(self.client, test, test.last_sample(), false, None)
    }

    fn record(&mut self, name: &str) -> Result<(String, TargetFile)> {
        let (path, file) = record(self.client, self.folder)?;
        self.client.disarm()?;
        say!("{}: {name}", path.display());
        Ok((path.file_name().unwrap_or_default().to_string_lossy().into_owned(), file))
    }
}
