//! run.json: the description of a run.

use pneudrive_controller::parameters::TABLE;
use pneudrive_sim::component::encoder::mm_per_count;
use pneudrive_sim::rig::{Fields, Value};
use pneudrive_sim::{Convergence, Rig, Run};
use serde_json::{Map, json};

use crate::judged::Judged;

use super::{FORMAT, Numbered};
use crate::words;

/// The description of a run.
pub(super) fn describe(
    rig: &Rig,
    judged: &Judged,
    moves: serde_json::Value,
    numbered: &Numbered,
) -> serde_json::Value {
    let (run, accuracy) = (&judged.run, judged.accuracy);
    json!({
        "format": FORMAT,
        "program": format!("pneudrive {}", env!("CARGO_PKG_VERSION")),
        "rig": rig.name(),
        "method": format!("{:?}", accuracy.method),
        "tolerance": accuracy.tolerance,
        "samples": run.observations.len(),
        "rows": run.rows.len(),
        "converged": judged.convergence.is_converged(),
        "unconverged_from_s": judged.convergence.unconverged_from_s,
        "closest_edge": closest_edge(&judged.convergence),
        "position_error_m": judged.convergence.error_m,
        "ensemble": judged.band.as_ref().map(|_| members(judged)),
        "moves": moves,
        "fault": run.fault.map(|(fault, k)| json!({ "name": words::fault_name(fault), "sample": k })),
        "work": work(run),
        "controller": controller(rig),
        "keys": keys(rig),
        "mm_per_count": mm_per_count(rig),
        "run": numbered.run,
        "date": numbered.date,
    })
}

/// The members of the ensemble of a run, and those that failed.
fn members(judged: &Judged) -> serde_json::Value {
    let tripped: Vec<&str> = judged.lost.tripped.iter().map(|fault| words::fault_name(*fault)).collect();
    json!({
        "runs": judged.spacing.runs,
        "relative_change": judged.spacing.relative,
        "tripped": tripped,
        "not_simulated": judged.lost.failed,
    })
}

/// The work of the integrator.
fn work(run: &Run) -> serde_json::Value {
    json!({
        "steps": run.work.integrator.n_steps,
        "rejected": run.work.integrator.n_rejected_steps,
        "evaluations": run.work.integrator.n_rhs_evaluations,
        "restarts": run.work.integrator.n_restarts,
        "events": run.work.integrator.n_events,
        "flow_solutions": run.work.network.solutions,
        "flow_iterations": run.work.network.iterations,
    })
}

/// The controller's parameters except lists, under the device's own names.
fn controller(rig: &Rig) -> Map<String, serde_json::Value> {
    let parameters = rig.parameters();
    let scalars = TABLE.iter().filter(|parameter| parameter.len == 1);
    let named = scalars
        .filter_map(|parameter| Some((parameter.name.to_owned(), json!(parameters.get(parameter.id)?))));
    named.collect()
}

/// Every key of the rig with its value.
fn keys(rig: &Rig) -> Map<String, serde_json::Value> {
    rig.entries().map(|(key, value)| (key.path.to_owned(), json_of(value))).collect()
}

fn closest_edge(convergence: &Convergence) -> Option<serde_json::Value> {
    convergence.closest_edge.map(|edge| json!({ "distance_m": edge.distance_m, "at_s": edge.at_s }))
}

fn json_of(value: &Value) -> serde_json::Value {
    match value {
        Value::Number(value) => json!(value),
        Value::Integer(value) => json!(value),
        Value::Switch(on) => json!(on),
        Value::Word(word) => json!(word),
        Value::Integers(values) => json!(values),
        Value::Numbers(values) => json!(values),
        Value::Rows(rows) => json!(rows),
        Value::Moves(moves) => json!(moves),
        Value::Events(events) => events.iter().map(json_of_event).collect(),
    }
}

fn json_of_event(fields: &Fields) -> serde_json::Value {
    fields.iter().map(|(name, value)| ((*name).to_owned(), json_of(value))).collect()
}
