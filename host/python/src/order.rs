//! A test as a drive is to run it: prepared, and carried out to its end.

use std::path::PathBuf;

use anyhow::{Result, bail};
use pneudrive_controller::parameters::id;
use pneudrive_link::client::Client;
use pneudrive_link::test_run;
use pneudrive_protocol::{Status, StreamedSample, UNTIL_STOPPED};
use pneudrive_records::rig_info::{Info, RigParameters};
use pneudrive_records::stream_file::StreamFile;
use pneudrive_records::units::Units;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::rig::RigOrSource;
use crate::work;

/// How a test is run.
pub struct Order {
    /// The rig.
    pub rig: pneudrive_sim::Rig,
    last_sample: u32,
    with_parameters: bool,
}

/// A file that a run is streamed to, and that every Nth sample goes there.
pub type ToFile = (PathBuf, u16);

impl Order {
    /// The test of a rig, or as much of it as lasts `duration_s`; without an end, if that is infinite and may be.
    pub fn of(
        rig: RigOrSource,
        config: bool,
        duration_s: Option<f64>,
        may_be_endless: bool,
    ) -> PyResult<Order> {
        let rig = rig.0.rig;
        let period_us = f64::from(rig.period_us().get());
        let last_sample = match duration_s {
            None => rig.last_sample(),
            Some(f64::INFINITY) if may_be_endless => UNTIL_STOPPED,
            Some(seconds) if seconds > 0.0 && 1e6 * seconds / period_us < f64::from(UNTIL_STOPPED) => {
                (1e6 * seconds / period_us) as u32
            }
            Some(other) => {
                let most = f64::from(UNTIL_STOPPED) * period_us / 1e6;
                let text = format!("duration_s must be more than 0 and at most {most:.0}, is {other}");
                return Err(PyValueError::new_err(text));
            }
        };
        Ok(Order { rig, last_sample, with_parameters: config })
    }

    /// Runs it to its end; what is streamed goes to a file.
    pub fn carry_out(&self, client: &mut Client, to: Option<&ToFile>, meter: &work::Meter) -> Result<()> {
        if let Some((path, _)) = to {
            client.needs_streams()?;
            if path.exists() {
                bail!("{} exists already; choose another file", path.display());
            }
        }
        let parameters = self.prepare(client, to.is_some())?;
        let mut file = to.map(|to| self.begin_file(client, &parameters, to)).transpose()?;
        let started = test_run::start(client, &self.rig, &mut || meter.check());
        let progressed = |status: &Status| meter.note(status.index.into(), status.duration_samples.into());
        let followed = started.and_then(|()| match &mut file {
            None => client.follow(meter.ends(), progressed).map(drop),
            Some(file) => {
                let take = |row: &StreamedSample| file.add(row);
                client.follow_streamed(meter.ends(), progressed, take).map(drop)
            }
        });
        let ended = file.map_or(Ok(()), |file| end_file(client, file));
        followed.and(ended)
    }

    /// Starts it with a stream of every Nth sample, which [`Client::follow_streamed`] then gives; returns the scales of
    /// the rig.
    pub fn start_streamed(&self, client: &mut Client, every: u16, meter: &work::Meter) -> Result<Units> {
        client.needs_streams()?;
        let parameters = self.prepare(client, true)?;
        begin(client, &parameters, every)?;
        let started = test_run::start(client, &self.rig, &mut || meter.check());
        started.inspect_err(|_| {
            let _ = client.stream_end();
        })?;
        Ok(Units::of(&parameters))
    }

    fn prepare(&self, client: &mut Client, is_streamed: bool) -> Result<RigParameters> {
        test_run::prepare(client, &self.rig, self.last_sample, self.with_parameters, is_streamed)
    }

    fn begin_file(
        &self,
        client: &mut Client,
        parameters: &RigParameters,
        (path, every): &ToFile,
    ) -> Result<StreamFile> {
        let info: Info = client.info()?;
        let moves = client.test()?;
        let file = StreamFile::create(path, self.rig.name(), *every, &info, parameters, moves.as_ref())?;
        begin(client, parameters, *every)?;
        Ok(file)
    }
}

fn begin(client: &mut Client, parameters: &RigParameters, every: u16) -> Result<()> {
    let period_us = parameters.values.get(id::PERIOD_US).unwrap_or(0);
    client.stream_begin(every, 1e6 / f64::from(period_us.max(1)))
}

/// Ends a stream and its file.
fn end_file(client: &mut Client, mut file: StreamFile) -> Result<()> {
    let samples_of_run = client.status().ok().map(|status| status.index.saturating_add(1));
    let ended = client.stream_end();
    file.end(samples_of_run)?;
    ended
}
