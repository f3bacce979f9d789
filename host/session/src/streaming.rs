//! The file that a run is streamed to while it lasts.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use pneudrive_controller::parameters::id;
use pneudrive_link::client::Client;
use pneudrive_protocol::StreamedSample;
use pneudrive_records::rig_info::RigParameters;
use pneudrive_records::stream_file::StreamFile;

/// Where the samples of a run go: to a file, each `every`th.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ToFile {
    /// The file, which must not be there yet.
    pub path: PathBuf,
    /// 1 or more.
    pub every: u16,
}

/// A file that is complete.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Streamed {
    /// Its path.
    pub path: PathBuf,
    /// Samples in it.
    pub samples: u64,
    /// Samples that the link has lost.
    pub missing: u64,
}

/// A run that is streamed to a file.
pub(crate) struct Streaming {
    file: StreamFile,
    path: PathBuf,
    test: String,
    parameters: RigParameters,
}

impl Streaming {
    /// Checks that a run can be streamed before anything on the rig is changed.
    pub(crate) fn check(path: &Path) -> Result<()> {
        if path.exists() {
            bail!("{} already exists; choose another file", path.display());
        }
        // Preparing a run discards the rig's last record, so the file is tried first.
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        // A file without a name is not left behind by a kill.
        tempfile::tempfile_in(folder).map(drop).with_context(|| format!("cannot make {}", path.display()))
    }

    /// Makes the rig stream the run that will be started.
    pub(crate) fn begin(
        client: &mut Client,
        test: &str,
        parameters: &RigParameters,
        to: &ToFile,
    ) -> Result<Streaming> {
        let (info, moves) = (client.info()?, client.test()?);
        let file = StreamFile::create(&to.path, test, to.every, &info, parameters, &moves)?;
        begin(client, parameters, to.every)?;
        let (path, test, parameters) = (to.path.clone(), test.to_owned(), parameters.clone());
        Ok(Streaming { file, path, test, parameters })
    }

    /// The drive is armed, by which what its last run learned became parameters: the header gets them.
    pub(crate) fn renew(&mut self, client: &mut Client) -> Result<()> {
        let parameters = client.parameters()?;
        if parameters != self.parameters {
            self.file.describe_again(&self.test, &client.info()?, &parameters, &client.test()?)?;
            self.parameters = parameters;
        }
        Ok(())
    }

    /// Takes the next sample.
    pub(crate) fn take(&mut self, row: &StreamedSample) -> Result<()> {
        self.file.add(row)
    }

    /// Ends the file, whatever the rig says, and the stream.
    pub(crate) fn end(mut self, client: &mut Client) -> (Option<Streamed>, Result<()>) {
        let samples_of_run = client.status().ok().map(|status| status.index.saturating_add(1));
        let ended = client.stream_end();
        if let Err(error) = self.file.end(samples_of_run) {
            return (None, Err(error));
        }
        let (samples, missing) = self.file.counts();
        (Some(Streamed { path: self.path, samples, missing }), ended)
    }
}

/// Makes a rig with these parameters stream every Nth sample of the run that will be started.
///
/// # Errors
/// When it refuses, or does not answer.
pub fn begin(client: &mut Client, parameters: &RigParameters, every: u16) -> Result<()> {
    let period_us = parameters.values.get(id::PERIOD_US).unwrap_or(0);
    client.stream_begin(every, 1e6 / f64::from(period_us.max(1)))
}
