//! The identifications that need no model of the drive: `identify --tubing`, `--conductance`, `--timer`.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use pneudrive_identify::conductance::Path as Conductance;
use pneudrive_identify::figures::Figure;
use pneudrive_identify::regression::Line;
use pneudrive_identify::report;
use pneudrive_identify::tubing::drop_slope;
use pneudrive_records::target::TargetFile;
use pneudrive_report::Table;
use pneudrive_sim::Rig;
use pneudrive_sim::keys;
use serde_json::json;

use crate::json;

/// The regression line of a measured pressure drop (thesis 7.1.4).
pub(super) fn tubing(rig: &Rig, path: &Path) -> Result<()> {
    let reference = rig.get(&keys::tubing::REFERENCE_FLOW_KG_S);
    let bytes = std::fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    let found = drop_slope(&bytes, reference)
        .with_context(|| format!("{} is not a table of a pressure drop", path.display()))?;
    json::figures(|| json!({ "drop_slope": report::with_error(found), "reference_flow_kg_s": reference }));
    say!("tubing.drop_slope = {}, at tubing.reference_flow_kg_s = {reference}", with_error(found));
    Ok(())
}

/// Conductance and critical ratio of a path of the valve, from measured flows (ISO 6358-1).
pub(super) fn conductance(rig: &Rig, path: &Path) -> Result<()> {
    let index = rig.get(&keys::iso6358::SUBSONIC_INDEX);
    let bytes = std::fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    let found = Conductance::of_table(&bytes, index)
        .with_context(|| format!("{} tells no conductance", path.display()))?;
    json::figures(|| {
        json!({
            "sonic_conductance_m3_per_s_pa": report::with_error(found.sonic_conductance),
            "critical_ratio": report::with_error(found.critical_ratio),
            "subsonic_index": index,
            "scatter_over_choked_flow": found.scatter,
        })
    });
    let scaled =
        |Figure { value, error }: Figure, scale: f64| format!("{:.4} +- {:.4}", scale * value, scale * error);
    say!(
        "valve.sonic_conductance_m3_per_s_pa = {:.4e}   (C = {} dm3/(s bar), standard error)",
        found.sonic_conductance.value,
        scaled(found.sonic_conductance, 1e8)
    );
    say!(
        "valve.critical_ratio = {:.4}   (b = {}, standard error)",
        found.critical_ratio.value,
        scaled(found.critical_ratio, 1.0)
    );
    say!(
        "the points scatter by {:.2} % of the choked flow about the curve with m = {index}",
        100.0 * found.scatter
    );
    Ok(())
}

/// The requested sample period and the measured one (thesis 7.1.5).
pub(super) fn timer(paths: &[PathBuf]) -> Result<()> {
    let mut points = Vec::new();
    let mut rows = Vec::new();
    for path in paths {
        let file = TargetFile::read(path)?;
        if file.is_streamed() {
            bail!("{}: a stream does not contain the measured period; use a record", path.display());
        }
        let period = |key: &str| file.positive(key).with_context(|| path.display().to_string());
        let (asked, measured) = (period("sample_period_us")?, period("measured_period_us")?);
        let off = 1e6 * (measured / asked - 1.0);
        rows.push(vec![
            path.display().to_string(),
            asked.to_string(),
            measured.to_string(),
            format!("{off:+.1}"),
        ]);
        points.push((asked, measured));
    }
    let columns = ["record", "requested, us", "measured, us", "off, ppm"];
    say!("{}", Table::new("", columns, rows).to_text());
    let line = Line::through(&points);
    json::figures(|| {
        let periods =
            points.iter().map(|(asked, measured)| json!({ "requested_us": asked, "measured_us": measured }));
        json!({
            "periods": periods.collect::<Vec<_>>(),
            "intercept_us": line.map(|line| report::with_error(line.intercept)),
            "slope": line.map(|line| report::with_error(line.slope)),
        })
    });
    match line {
        Some(line) => {
            say!("measured = {} us + {} x requested", with_error(line.intercept), with_error(line.slope))
        }
        None => say!("a regression line needs three records with at least two different periods"),
    }
    Ok(())
}

fn with_error(Figure { value, error }: Figure) -> String {
    format!("{value:.6} +- {error:.1e}")
}
