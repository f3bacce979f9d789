//! `pneudrive run --stream`: writes the run to a file while it lasts.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use pneudrive_controller::parameters::id;
use pneudrive_link::client::Client;
use pneudrive_protocol::StreamedSample;
use pneudrive_records::rig_info::RigParameters;
use pneudrive_records::stream_file::StreamFile;
use serde_json::json;

use crate::json;

/// A run that is streamed to a file.
pub(super) struct Streaming {
    file: StreamFile,
    path: PathBuf,
}

impl Streaming {
    /// Checks that the run can be streamed before anything on the rig is changed.
    pub(super) fn check(client: &mut Client, path: &Path) -> Result<()> {
        client.needs_streams()?;
        if path.exists() {
            bail!("{} already exists; choose another file", path.display());
        }
        // Preparing a run discards the rig's last record, so the file is tried first.
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        // A file without a name is not left behind by a kill.
        tempfile::tempfile_in(folder).map(drop).with_context(|| format!("cannot make {}", path.display()))
    }

    /// Makes the rig stream the run that will be started.
    pub(super) fn begin(
        client: &mut Client,
        test: &str,
        parameters: &RigParameters,
        path: &Path,
        every: u16,
    ) -> Result<Streaming> {
        let info = client.info()?;
        let period_us = parameters.values.get(id::PERIOD_US).unwrap_or(0);
        client.needs_streams()?;
        let moves = client.test()?;
        let file = StreamFile::create(path, test, every, &info, parameters, moves.as_ref())?;
        client.stream_begin(every, 1e6 / f64::from(period_us.max(1)))?;
        Ok(Streaming { file, path: path.to_owned() })
    }

    /// Takes the next sample.
    pub(super) fn take(&mut self, row: &StreamedSample) -> Result<()> {
        self.file.add(row)
    }

    /// Ends the stream and the file, and reports its samples and gaps.
    pub(super) fn end(mut self, client: &mut Client) -> Result<()> {
        let samples_of_run = client.status().ok().map(|status| status.index.saturating_add(1));
        let ended = client.stream_end();
        self.file.end(samples_of_run)?;
        let (samples, missing) = self.file.counts();
        let stream = json!({ "file": self.path, "samples": samples, "missing": missing });
        json::figures(|| json!({ "stream": stream }));
        let lost =
            if missing == 0 { "none missing".to_owned() } else { format!("{missing} MISSING, see its gaps") };
        say!("{}: {samples} samples, {lost}", self.path.display());
        ended
    }
}
