//! Refusals of requests: a status, and JSON with the reason.

use http::StatusCode;
use pneudrive_evaluate::cancel::Cancelled;
use pneudrive_sim::rig::Problems;
use serde_json::{Value, json};

/// A refused request.
#[derive(Debug)]
pub struct HttpRefusal {
    /// The HTTP status.
    pub status: StatusCode,
    /// The reason in words.
    pub message: String,
    /// The problems of the rig, if they are the reason.
    pub problems: Vec<Value>,
}

impl HttpRefusal {
    /// A request that is refused as a whole.
    #[must_use]
    pub fn new(status: StatusCode, message: impl Into<String>) -> HttpRefusal {
        HttpRefusal { status, message: message.into(), problems: Vec::new() }
    }

    /// A request that cannot be fulfilled.
    #[must_use]
    pub fn wrong(message: impl Into<String>) -> HttpRefusal {
        HttpRefusal::new(StatusCode::UNPROCESSABLE_ENTITY, message)
    }

    /// A request that is not JSON, or not of its form.
    #[must_use]
    pub fn malformed(error: &serde_json::Error) -> HttpRefusal {
        HttpRefusal::new(StatusCode::BAD_REQUEST, format!("the request cannot be read: {error}"))
    }

    /// A request whose page has stopped waiting for the answer.
    #[must_use]
    pub fn gone() -> HttpRefusal {
        HttpRefusal::new(StatusCode::GONE, "the page has gone on")
    }

    /// Why work has no result: its page has stopped waiting, or else what `otherwise` says.
    #[must_use]
    pub(crate) fn gone_or(
        error: &anyhow::Error,
        otherwise: impl FnOnce(&anyhow::Error) -> HttpRefusal,
    ) -> HttpRefusal {
        if error.is::<Cancelled>() { HttpRefusal::gone() } else { otherwise(error) }
    }

    /// The refusal as the page reads it.
    #[must_use]
    pub fn body(&self) -> Value {
        json!({ "error": self.message, "problems": self.problems })
    }

    /// A failure while carrying out a request.
    #[must_use]
    pub fn of(error: &anyhow::Error) -> HttpRefusal {
        HttpRefusal::new(StatusCode::INTERNAL_SERVER_ERROR, format!("{error:#}"))
    }
}

/// An invalid rig: each problem at its key.
impl From<Problems> for HttpRefusal {
    fn from(problems: Problems) -> HttpRefusal {
        let message = problems.to_string();
        HttpRefusal { status: StatusCode::UNPROCESSABLE_ENTITY, message, problems: to_json(&problems) }
    }
}

/// Problems, each for its field on the page.
#[must_use]
pub fn to_json(problems: &Problems) -> Vec<Value> {
    let one = |problem: &pneudrive_sim::rig::Problem| json!({ "key": problem.key, "line": problem.line, "message": problem.message });
    problems.0.iter().map(one).collect()
}
