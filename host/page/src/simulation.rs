//! Simulates a rig while the user drags a slider: first the run alone, then its perturbed runs.

use http::StatusCode;
use pneudrive_evaluate::cancel::CancelToken;
use pneudrive_evaluate::evaluation::{Move, moves_of_run, remarks, table, tolerance_mm, verdict};
use pneudrive_optimise::ensemble::{Ensemble, run_ensemble};
use pneudrive_optimise::positioning::beside_bound;
use pneudrive_records::band::{Band, CHANNELS};
use pneudrive_records::judged::Spacing;
use pneudrive_records::words;
use pneudrive_report::Table;
use pneudrive_sim::component::controller::Loop;
use pneudrive_sim::component::encoder::mm_per_count;
use pneudrive_sim::trace::{COLUMNS, Extra};
use pneudrive_sim::{Accuracy, Rig, Run, keys, run};
use serde_json::{Value, json};

use crate::columns::{Column, Columns};
use crate::page_rig::PageRig;
use crate::refusal::HttpRefusal;

/// The longest run while a page waits, samples: a second or two.
pub const MAX_SAMPLES: u32 = 200_000;

/// A curve of the page: its name, its unit, its column of trace.csv, and the factor between them; 0 stands for the
/// length of a count, mm.
const CURVES: [(&str, &str, &str, f64); 16] = [
    ("setpoint", "mm", "setpoint_counts", 0.0),
    ("position", "mm", "position_m", 1e3),
    ("velocity", "mm/s", "velocity_m_s", 1e3),
    ("pressure 1", "kPa", "pressure_1_pa", 1e-3),
    ("pressure 2", "kPa", "pressure_2_pa", 1e-3),
    ("temperature 1", "K", "temperature_1_k", 1.0),
    ("temperature 2", "K", "temperature_2_k", 1.0),
    ("spool", "mm", "spool_mm", 1.0),
    ("wanted spool", "mm", "spool_command_mm", 1.0),
    ("command", "counts", "command_counts", 1.0),
    ("error", "counts", "error_counts", 1.0),
    ("flow 1", "g/s", "mass_flow_1_kg_s", 1e3),
    ("flow 2", "g/s", "mass_flow_2_kg_s", 1e3),
    ("piston force", "N", "actuator_force_n", 1.0),
    ("friction", "N", "friction_n", 1.0),
    ("acceleration", "m/s2", "acceleration_m_s2", 1.0),
];

/// The curves that not every run has, of the receiver and of what a law knows: name, unit, column and the factor between them.
const EXTRA_CURVES: [(&str, &str, &str, f64); 14] = [
    ("receiver pressure", "kPa", "receiver_pressure_pa", 1e-3),
    ("reference", "mm", "law_reference_mm", 1.0),
    ("estimated", "mm", "law_position_mm", 1.0),
    ("reference speed", "mm/s", "law_reference_velocity_m_s", 1e3),
    ("estimated speed", "mm/s", "law_velocity_m_s", 1e3),
    ("wanted force", "N", "law_wanted_force_n", 1.0),
    ("measured force", "N", "law_force_n", 1.0),
    ("opposing force", "N", "law_opposing_force_n", 1.0),
    ("standing force", "N", "law_standing_force_n", 1.0),
    ("learned mass", "kg", "law_mass_kg", 1.0),
    ("learned friction", "of the file's", "law_friction_share", 1.0),
    ("learned lag", "ms", "law_lag_ms", 1.0),
    ("phase", "", "law_phase", 1.0),
    ("looseness", "", "law_looseness", 1.0),
];

/// The run of a rig alone: its curves, and the figures of its moves.
///
/// # Errors
/// When the rig is not valid, too long for a page, or cannot be integrated.
pub fn nominal(asked: &PageRig) -> Result<Vec<u8>, HttpRefusal> {
    let rig = rig_of(asked)?;
    let run = run(&rig, Accuracy::of(&rig)).map_err(|error| not_simulated(&rig, &error.into()))?;
    let moves = vec![moves_of_run(&rig, &run)];
    let head = json!({
        "summary": words::summary(&rig, &run),
        "fault": fault(&rig, &run),
        "verdict": verdict(&moves, tolerance_mm(Some(&rig))),
        "figures": to_json(&table(&moves, tolerance_mm(Some(&rig)))),
        "bits": format!("{:016x}", run.bits()),
    });
    Ok(curves(&rig, &run).to_bytes(head))
}

/// The run with its perturbed runs: the range that they cover, and whether the run has converged. Cancelled when
/// `wanted` becomes false.
///
/// # Errors
/// As [`nominal`]; when nobody waits for it any more.
pub fn members(asked: &PageRig, wanted: &(dyn Fn() -> bool + Sync)) -> Result<Vec<u8>, HttpRefusal> {
    let rig = rig_of(asked)?;
    let (accuracy, spacing) = (Accuracy::of(&rig), Spacing::default());
    let cancel = CancelToken::cancelled_unless(wanted);
    let ensemble = run_ensemble(&rig, accuracy, spacing, moves_of_run, |_, _| {}, cancel);
    let ensemble =
        ensemble.map_err(|error| HttpRefusal::gone_or(&error, |error| not_simulated(&rig, error)))?;
    Ok(band(&rig, &ensemble))
}

/// The rig of a page, if its run is short enough for the page to wait.
pub(crate) fn rig_of(asked: &PageRig) -> Result<Rig, HttpRefusal> {
    let rig = asked.rig()?;
    if rig.last_sample() > MAX_SAMPLES {
        let message = format!(
            "test.duration_s: the test has {} samples, and the studio simulates {MAX_SAMPLES} at most; `pneudrive simulate` takes longer ones",
            rig.last_sample()
        );
        return Err(HttpRefusal::new(StatusCode::UNPROCESSABLE_ENTITY, message));
    }
    Ok(rig)
}

fn not_simulated(rig: &Rig, error: &anyhow::Error) -> HttpRefusal {
    let message = format!("{} cannot be simulated: {error:#}", rig.name());
    HttpRefusal::new(StatusCode::UNPROCESSABLE_ENTITY, message)
}

fn curves(rig: &Rig, run: &Run) -> Columns {
    let mm_per_count = mm_per_count(rig);
    let rows: Vec<[f64; COLUMNS.len()]> = run.rows.iter().map(|row| row.values()).collect();
    let columns = CURVES
        .iter()
        .filter(|(name, ..)| *name != "setpoint" || rig.get(&keys::controller::LOOP) == Loop::Closed);
    let columns = columns.map(|&(name, unit, column, factor)| {
        let place = COLUMNS.iter().position(|other| *other == column).expect("a column of trace.csv");
        let factor = if factor == 0.0 { mm_per_count } else { factor };
        Column { name, unit, values: rows.iter().map(|row| (row[place] * factor) as f32).collect() }
    });
    let time = run.rows.iter().map(|row| row.time).collect();
    let of_row = |extra: &'static Extra| (extra, run.rows.iter().map(|row| extra.value(row)).collect());
    let extras: Vec<_> = Extra::of_rig(rig).into_iter().map(of_row).collect();
    Columns { time, columns: columns.chain(extra_curves(&extras)).collect() }
}

/// What there is of [`EXTRA_CURVES`].
pub(crate) fn extra_curves(extras: &[(&'static Extra, Vec<f64>)]) -> Vec<Column> {
    let drawn = EXTRA_CURVES.iter().filter_map(|&(name, unit, column, factor)| {
        let (_, values) = extras.iter().find(|(extra, _)| extra.name == column)?;
        Some(Column { name, unit, values: values.iter().map(|value| (value * factor) as f32).collect() })
    });
    drawn.collect()
}

/// The fault that ended a run: its time and meaning.
fn fault(rig: &Rig, run: &Run) -> Value {
    run.fault.map_or(Value::Null, |(fault, sample)| {
        let at_s = f64::from(sample) * f64::from(rig.period_us().get()) / 1e6;
        json!({
            "name": words::fault_name(fault),
            "meaning": words::fault_meaning(fault.code()),
            "at_s": at_s,
        })
    })
}

/// A table for the page.
pub(crate) fn to_json(table: &Table) -> Value {
    json!({ "heading": table.heading, "columns": table.columns, "rows": table.rows })
}

/// The range of a run and its perturbed runs, and the basis of its figures.
fn band(rig: &Rig, ensemble: &Ensemble<Vec<Move>>) -> Vec<u8> {
    let judged = &ensemble.nominal;
    let steps = ensemble.measured.first().map(|own| beside_bound(rig, own)).unwrap_or_default();
    let remarks = [steps, remarks(&ensemble.measured)].concat();
    let head = json!({
        "notes": words::run(rig, judged),
        "converged": judged.convergence.is_converged(),
        "verdict": verdict(&ensemble.measured, tolerance_mm(Some(rig))),
        "figures": to_json(&table(&ensemble.measured, tolerance_mm(Some(rig)))),
        "remarks": remarks,
    });
    judged
        .band
        .as_ref()
        .map_or_else(|| Columns { time: Vec::new(), columns: Vec::new() }, edges)
        .to_bytes(head)
}

/// Lowest and highest values; the lowest of a channel precede its highest.
fn edges(band: &Band) -> Columns {
    let drawn = CURVES.iter().filter(|(_, _, column, _)| CHANNELS.contains(column));
    let columns = drawn.flat_map(|&(name, unit, column, factor)| {
        band.channel(column).map(|values| Column {
            name,
            unit,
            values: values.iter().map(|value| (value * factor) as f32).collect(),
        })
    });
    Columns { time: band.time_s.clone(), columns: columns.collect() }
}
