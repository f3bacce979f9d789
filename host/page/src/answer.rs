//! Dispatches requests to their answers.

use http::StatusCode;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use crate::refusal::HttpRefusal;
use crate::rigs::Opened;
use crate::study::{self, Study};
use crate::{check, compare, difference, keys, rigs, simulation, spectrum};

/// An answer to the page.
#[derive(Clone, Debug)]
pub enum Answer {
    /// Words and figures.
    Json(Value),
    /// Numbers over time, in the layout of [`columns`](crate::columns).
    Columns(Vec<u8>),
}

/// Requests that bring a rig and need nothing else: no server, no file.
pub const REQUESTS: [&str; 7] = ["check", "run", "ensemble", "compare", "spectrum", "difference", "plan"];

/// Answers a request: `keys`, `choices`, `rig`, `written`, or one of [`REQUESTS`]. Long work is cancelled when
/// `wanted` becomes false.
///
/// # Errors
/// The reason why it is not carried out: not found, malformed, or an invalid rig.
pub fn answer(
    request: &str,
    body: &Value,
    wanted: &(dyn Fn() -> bool + Sync),
) -> Result<Answer, HttpRefusal> {
    match request {
        "keys" => Ok(Answer::Json(keys::table())),
        "choices" => Ok(Answer::Json(study::choices())),
        "plan" => Ok(Answer::Json(Study::read(body)?.plan()?)),
        "rig" => Ok(Answer::Json(json!(Opened::builtin(&read::<String>(body)?)?))),
        "written" => written(body),
        "check" => Ok(Answer::Json(check::answer(&read(body)?))),
        "run" => simulation::nominal(&read(body)?).map(Answer::Columns),
        "ensemble" => simulation::members(&read(body)?, wanted).map(Answer::Columns),
        "compare" => compare::answer(&read(body)?).map(Answer::Columns),
        "spectrum" => spectrum::answer(&read(body)?).map(Answer::Columns),
        "difference" => difference::answer(&read(body)?).map(Answer::Json),
        _ => Err(HttpRefusal::new(StatusCode::NOT_FOUND, format!("there is no request {request}"))),
    }
}

/// The text of the rig file that a page saves.
fn written(body: &Value) -> Result<Answer, HttpRefusal> {
    let rigs::ToSave { asked, file, .. } = read(body)?;
    let text = rigs::text_to_save(&asked, &file)?;
    Ok(Answer::Json(json!({ "name": file, "text": text })))
}

fn read<T: DeserializeOwned>(body: &Value) -> Result<T, HttpRefusal> {
    T::deserialize(body)
        .map_err(|error| HttpRefusal::new(StatusCode::UNPROCESSABLE_ENTITY, error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_request_that_is_none_is_refused_with_its_name() {
        let refusal = answer("steam", &Value::Null, &|| true).expect_err("no request");
        assert_eq!(refusal.status, StatusCode::NOT_FOUND);
        assert!(refusal.message.contains("steam"), "{}", refusal.message);
    }

    #[test]
    fn every_request_refuses_a_body_that_has_no_rig() {
        for request in REQUESTS {
            let refusal = answer(request, &json!({ "name": 1 }), &|| true).expect_err(request);
            assert_eq!(refusal.status, StatusCode::UNPROCESSABLE_ENTITY, "{request}");
        }
    }

    #[test]
    fn perturbed_runs_that_nobody_waits_for_are_given_up() {
        let (name, text) = pneudrive_sim::rigfile::BUILTIN[0];
        let body = json!({ "name": name, "text": text, "settings": ["test.duration_s=0.2"] });
        let refusal = answer("ensemble", &body, &|| false).expect_err("given up");
        assert_eq!(refusal.status, StatusCode::GONE);
    }
}
