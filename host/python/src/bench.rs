//! The tests that a fit needs, on a drive.

use anyhow::{Context, Result};
use pneudrive_analysis::identification::plan::{self, Bench};
use pneudrive_controller::parameters::id;
use pneudrive_link::borrowed::Borrowed;
use pneudrive_link::client::Client;
use pneudrive_link::test_run;
use pneudrive_records::target::TargetFile;
use pneudrive_sim::Rig;
use pneudrive_sim::component::controller::Loop;
use pneudrive_sim::keys;

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
    let borrowed = Borrowed::of(client, &[id::OPEN_LOOP])?;
    let mut bench = AtDrive { client, meter, files: Vec::new() };
    let recorded = plan::run(&mut bench, closed, open, count);
    let files = bench.files;
    let left = client.disarm().and_then(|()| borrowed.give_back(client));
    let fitted: Vec<String> = recorded?.fitted.into_iter().map(|recording| recording.name).collect();
    left.context("the tests are done, but the rig was not left as it was")?;
    let is_fitted = |number: usize| fitted.iter().any(|name| name.starts_with(&format!("{number}, ")));
    let numbered = (1..).zip(files).filter(|(number, _)| is_fitted(*number));
    Ok(numbered.map(|(_, file)| file).collect())
}

/// A drive, and what was recorded on it.
struct AtDrive<'a> {
    client: &'a mut Client,
    meter: &'a Meter,
    files: Vec<(String, TargetFile)>,
}

impl Bench for AtDrive<'_> {
    fn run(&mut self, test: &Rig) -> Result<()> {
        let open_loop = i32::from(test.get(&keys::controller::LOOP) == Loop::Open);
        self.client.disarm()?;
        self.client.set_parameters(id::OPEN_LOOP, &[open_loop])?;
        test_run::prepare(self.client, test, test.last_sample(), false, false)?;
        test_run::start(self.client, test, &mut || self.meter.check())?;
        self.client.follow(self.meter.ends(), |_| {})?;
        // Armed, a drive that creeps at its null would trip while its record is fetched.
        self.client.disarm()
    }

    fn record(&mut self, name: &str) -> Result<(String, TargetFile)> {
        let (info, parameters) = (self.client.info()?, self.client.parameters()?);
        let test = self.client.test()?;
        let file =
            TargetFile::new(&self.client.record(|_, _| {})?, &info, &parameters)?.with_test(test.as_ref());
        log::info!("{name} is recorded: {} samples", file.samples.len());
        self.files.push((name.to_owned(), file.clone()));
        // Its number tells it from the others.
        Ok((self.files.len().to_string(), file))
    }
}
