//! How a request is refused: a status, and JSON that says why.

use axum::Json;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use pneudrive_sim::rig::Problems;
use serde_json::{Value, json};

/// A request that is not carried out.
#[derive(Debug)]
pub struct Refusal {
    /// Why, as HTTP has it.
    pub status: StatusCode,
    /// Why, in words.
    pub message: String,
    /// What is wrong with the rig, if that is why.
    pub problems: Vec<Value>,
}

impl Refusal {
    /// A request that is refused as a whole.
    #[must_use]
    pub fn new(status: StatusCode, message: impl Into<String>) -> Refusal {
        Refusal { status, message: message.into(), problems: Vec::new() }
    }

    /// Something that the server could not do.
    #[must_use]
    pub fn of(error: &anyhow::Error) -> Refusal {
        Refusal::new(StatusCode::INTERNAL_SERVER_ERROR, format!("{error:#}"))
    }
}

/// A rig that does not exist: each problem at its key.
impl From<Problems> for Refusal {
    fn from(problems: Problems) -> Refusal {
        let message = problems.to_string();
        Refusal { status: StatusCode::UNPROCESSABLE_ENTITY, message, problems: to_json(&problems) }
    }
}

impl IntoResponse for Refusal {
    fn into_response(self) -> Response {
        let body = json!({ "error": self.message, "problems": self.problems });
        (self.status, Json(body)).into_response()
    }
}

/// Problems as the page shows them, each at its field.
#[must_use]
pub fn to_json(problems: &Problems) -> Vec<Value> {
    let one = |problem: &pneudrive_sim::rig::Problem| json!({ "key": problem.key, "line": problem.line, "message": problem.message });
    problems.0.iter().map(one).collect()
}
