//! The tests that a fit needs, on a drive.

use anyhow::Result;
use pneudrive_controller::parameters::id;
use pneudrive_identify::plan::{self, TestRig};
use pneudrive_link::client::Client;
use pneudrive_records::target::TargetFile;
use pneudrive_session::borrowed::lend;
use pneudrive_session::record::to_memory;
use pneudrive_session::test_run::{TestRun, ready_for, wait_for_air};
use pneudrive_sim::Rig;

use crate::work::Meter;

/// Runs the tests on a drive, and returns the records that are to be fitted, with their names. The rig has either loop.
/// The drive is left as it was.
///
/// # Errors
/// When a test cannot be run or recorded, or the drive does not move in the direction of the valve.
pub fn records(
    client: &mut Client,
    closed: &Rig,
    open: &Rig,
    meter: &Meter,
) -> Result<Vec<(String, TargetFile)>> {
    let count = client.status()?.position;
    client.disarm()?;
    let (recorded, files) = lend(client, &[id::OPEN_LOOP], |client| {
        let mut bench = AtDrive { client, meter, files: Vec::new(), left_at: count };
        Ok((plan::run(&mut bench, closed, open, count)?, bench.files))
    })?;
    // A record goes on behind what is fitted, as the drive brakes.
    let fitted = |(number, (name, mut file)): (usize, (String, TargetFile))| {
        let begins = format!("{number}, ");
        let recording = recorded.fitted.iter().find(|recording| recording.name.starts_with(&begins))?;
        file.samples.truncate(recording.commands.len());
        file.seal();
        Some((name, file))
    };
    Ok((1..).zip(files).filter_map(fitted).collect())
}

/// A drive, and what was recorded on it.
struct AtDrive<'a> {
    client: &'a mut Client,
    meter: &'a Meter,
    files: Vec<(String, TargetFile)>,
    /// Where the last run left the piston, counts.
    left_at: i32,
}

impl TestRig for AtDrive<'_> {
    fn run(&mut self, test: &Rig) -> Result<()> {
        ready_for(self.client, test, self.left_at, &mut || self.meter.check())?;
        let prepared = TestRun::of(test).prepare(self.client, None)?;
        prepared.run(self.client, self.meter.ends(), &mut || self.meter.check(), |_| {}).ended?;
        self.left_at = self.client.status()?.position;
        // Armed, a drive that creeps at its null would trip while its record is fetched.
        self.client.disarm()
    }

    fn settle(&mut self) -> Result<()> {
        wait_for_air(self.client, &mut || self.meter.check())
    }

    fn record(&mut self, name: &str) -> Result<(String, TargetFile)> {
        let (_, file) = to_memory(self.client, &mut |_, _| self.meter.check())?;
        log::info!("{name} is recorded: {} samples", file.samples.len());
        self.files.push((name.to_owned(), file.clone()));
        // Its number distinguishes it from the others.
        Ok((self.files.len().to_string(), file))
    }
}
