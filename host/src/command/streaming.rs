//! `pneudrive run --stream`: the run goes to a file while it is on.

use std::path::Path;

use anyhow::{Result, bail};
use pneudrive_controller::parameters::id;

use crate::client::{Client, RigParameters};
use crate::stream::Arrivals;
use crate::stream_file::StreamFile;

/// A run on its way to a file.
pub(super) struct Streaming {
    arrivals: Arrivals,
    file: StreamFile,
    path: std::path::PathBuf,
}

impl Streaming {
    /// Whether this could be done, before anything is: nothing on the rig is changed yet.
    pub(super) fn check(client: &mut Client, path: &Path) -> Result<()> {
        client.needs_streams()?;
        if path.exists() {
            bail!("{} is there already; name another file", path.display());
        }
        Ok(())
    }

    /// Has the rig stream the run that will be started.
    pub(super) fn begin(
        client: &mut Client,
        test: &str,
        parameters: &RigParameters,
        path: &Path,
        every: u16,
    ) -> Result<Streaming> {
        let info = client.info()?;
        let period_us = parameters.values.get(id::PERIOD_US).unwrap_or(0);
        client.stream_begin(every, 1e6 / f64::from(period_us.max(1)))?;
        let file = StreamFile::create(path, test, every, &info, parameters)?;
        Ok(Streaming { arrivals: Arrivals::default(), file, path: path.to_owned() })
    }

    /// Takes what has come since the last call.
    pub(super) fn go_on(&mut self, client: &mut Client) -> Result<()> {
        client.stream_on(&mut self.arrivals)?;
        self.store()
    }

    fn store(&mut self) -> Result<()> {
        while let Some(row) = self.arrivals.take() {
            self.file.add(&row)?;
        }
        self.file.flush()
    }

    /// The last rows, and what the file says of itself. A rig that does not answer any more has no last
    /// rows.
    pub(super) fn end(mut self, client: &mut Client) -> Result<()> {
        let rest = client.stream_rest(&mut self.arrivals);
        self.store()?;
        let samples_of_run = client.status().ok().map(|status| status.index.saturating_add(1));
        self.file.end(samples_of_run)?;
        let (samples, missing) = self.file.counts();
        let lost =
            if missing == 0 { "none missing".to_owned() } else { format!("{missing} MISSING, see its gaps") };
        say!("{}: {samples} samples, {lost}", self.path.display());
        rest.and_then(|()| client.stream_end())
    }
}
