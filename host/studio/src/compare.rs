//! A TARGET file laid over the run of the page, with their deviation: what `overlay` does.

use axum::Json;
use axum::http::StatusCode;
use axum::response::Response;
use pneudrive_analysis::deviation::{deviations, table};
use pneudrive_analysis::transient::{CHANNELS, Transient};
use pneudrive_records::run_folder::StoredRun;
use pneudrive_records::target::TargetFile;
use pneudrive_sim::{Accuracy, run};
use serde::Deserialize;
use serde_json::json;

use crate::asked::Asked;
use crate::columns::{Column, Columns};
use crate::refusal::Refusal;
use crate::simulation::{in_background, rig_of, to_json};

/// A record, and the rig of the page.
#[derive(Debug, Deserialize)]
pub struct Compared {
    #[serde(flatten)]
    asked: Asked,
    record: Record,
}

/// A TARGET file or a streamed run.
#[derive(Debug, Deserialize)]
struct Record {
    /// The name of the file.
    name: String,
    /// Its text.
    text: String,
}

/// The curves of the record, and how far the simulation is from them.
///
/// # Errors
/// When the file is damaged or is none, or when the rig cannot be simulated.
pub async fn answer(Json(Compared { asked, record }): Json<Compared>) -> Result<Response, Refusal> {
    let rig = rig_of(&asked)?;
    in_background(move |_| {
        let recorded = transient(&record).map_err(|error| {
            Refusal::new(StatusCode::UNPROCESSABLE_ENTITY, format!("{}: {error:#}", record.name))
        })?;
        let run = run(&rig, Accuracy::of(&rig)).map_err(|error| Refusal::of(&error.into()))?;
        let simulated = Transient::of_run(rig.name(), &StoredRun::of(&rig, &run));
        let found = deviations(&recorded, &simulated);
        if found.is_empty() {
            let message = format!("{} and the simulation have no time in common", record.name);
            return Err(Refusal::new(StatusCode::UNPROCESSABLE_ENTITY, message));
        }
        let heading = format!("deviation of the simulation, one run, from {}", record.name);
        let head = json!({ "name": record.name, "deviation": to_json(&table(&heading, &found)) });
        Ok(curves(&recorded).to_response(head))
    })
    .await
}

fn transient(record: &Record) -> anyhow::Result<Transient> {
    Transient::of_target(&record.name, &TargetFile::from_text(&record.text)?)
}

fn curves(transient: &Transient) -> Columns {
    let column = |(&(name, unit), values): (&(&'static str, &'static str), &Vec<f64>)| Column {
        name,
        unit,
        values: values.iter().map(|value| *value as f32).collect(),
    };
    let columns = CHANNELS.iter().zip(&transient.channels).map(column).collect();
    Columns { time: transient.time.clone(), columns }
}
