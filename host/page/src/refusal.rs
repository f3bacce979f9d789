//! How a request is refused: a status, and JSON that says why.

use http::StatusCode;
use pneudrive_evaluate::wanted::CalledOff;
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

    /// A request for something that cannot be.
    #[must_use]
    pub fn wrong(message: impl Into<String>) -> Refusal {
        Refusal::new(StatusCode::UNPROCESSABLE_ENTITY, message)
    }

    /// A request that is no JSON, or not of its form.
    #[must_use]
    pub fn malformed(error: &serde_json::Error) -> Refusal {
        Refusal::new(StatusCode::BAD_REQUEST, format!("the request cannot be read: {error}"))
    }

    /// A request that its page waits for no more.
    #[must_use]
    pub fn gone() -> Refusal {
        Refusal::new(StatusCode::GONE, "the page has gone on")
    }

    /// Why work has no result: its page waits for it no more, or what `otherwise` says.
    #[must_use]
    pub fn gone_or(error: &anyhow::Error, otherwise: impl FnOnce(&anyhow::Error) -> Refusal) -> Refusal {
        if error.is::<CalledOff>() { Refusal::gone() } else { otherwise(error) }
    }

    /// As the page reads it.
    #[must_use]
    pub fn body(&self) -> Value {
        json!({ "error": self.message, "problems": self.problems })
    }

    /// Something that could not be done.
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

/// Problems as the page shows them, each at its field.
#[must_use]
pub fn to_json(problems: &Problems) -> Vec<Value> {
    let one = |problem: &pneudrive_sim::rig::Problem| json!({ "key": problem.key, "line": problem.line, "message": problem.message });
    problems.0.iter().map(one).collect()
}
