//! Refusals of the server: a status, and JSON with the reason.

use axum::Json;
use axum::response::{IntoResponse, Response};
use pneudrive_page::refusal::Refusal;

/// A refusal as an answer over HTTP.
#[derive(Debug)]
pub struct Refused(pub Refusal);

impl<T: Into<Refusal>> From<T> for Refused {
    fn from(refusal: T) -> Refused {
        Refused(refusal.into())
    }
}

impl IntoResponse for Refused {
    fn into_response(self) -> Response {
        (self.0.status, Json(self.0.body())).into_response()
    }
}
