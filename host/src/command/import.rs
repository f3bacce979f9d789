//! `pneudrive import`.

use anyhow::{Context, Result};
use pneudrive_logs::column_map::ColumnMap;
use pneudrive_logs::import::import;
use pneudrive_logs::log::Log;
use pneudrive_records::text_file;
use pneudrive_sim::keys;
use serde_json::json;

use super::rig_source::load_choice;
use crate::cli::Import;
use crate::json;

pub(super) fn execute(arguments: &Import) -> Result<()> {
    let rig = load_choice(&arguments.rig)?;
    let place = arguments.columns.display().to_string();
    let text = text_file::read(&arguments.columns)?;
    let map = ColumnMap::from_text(&text, rig.get(&keys::exhaust::PRESSURE_PA)).context(place)?;
    let log = Log::read(&arguments.log)?;
    let imported = import(&log, &map, &rig, arguments.period)?;
    for remark in &imported.remarks {
        say!("{remark}");
    }
    let path = imported.file.write_next(&arguments.out)?;
    let samples = imported.file.samples.len();
    json::figures(
        || json!({ "file": path, "rig": rig.name(), "samples": samples, "remarks": imported.remarks }),
    );
    say!("{}: {samples} samples of {}", path.display(), rig.name());
    Ok(())
}
