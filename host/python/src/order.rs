//! A test as a drive is to run it: prepared, and carried out to its end.

use anyhow::Result;
use pneudrive_link::client::Client;
use pneudrive_protocol::{Status, UNTIL_STOPPED};
use pneudrive_records::units::Units;
use pneudrive_session::streaming::{self, ToFile};
use pneudrive_session::test_run::{self, TestRun};
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
        let progressed = |status: &Status| meter.note(status.index.into(), status.duration_samples.into());
        let prepared = self.test().prepare(client, to)?;
        let ran = prepared.run(client, meter.ends(), &mut || meter.check(), progressed);
        ran.ended.and(ran.stream_ended)
    }

    /// Starts it with a stream of every Nth sample, which [`Client::follow_streamed`] then gives; returns the scales of
    /// the rig.
    pub fn start_streamed(&self, client: &mut Client, every: u16, meter: &work::Meter) -> Result<Units> {
        let TestRun { rig, last_sample, with_parameters } = self.test();
        let parameters = test_run::prepare(client, rig, last_sample, with_parameters, true)?;
        streaming::begin(client, &parameters, every)?;
        let started = test_run::start(client, rig, &mut || meter.check());
        started.inspect_err(|_| {
            let _ = client.stream_end();
        })?;
        Ok(Units::of(&parameters))
    }

    fn test(&self) -> TestRun<'_> {
        TestRun { rig: &self.rig, last_sample: self.last_sample, with_parameters: self.with_parameters }
    }
}
