//! Refusals of the server: a status, and JSON with the reason.

use axum::Json;
use axum::response::{IntoResponse, Response};
use pneudrive_page::refusal::HttpRefusal;

/// A refusal as an answer over HTTP.
#[derive(Debug)]
pub struct RefusalResponse(pub HttpRefusal);

impl<T: Into<HttpRefusal>> From<T> for RefusalResponse {
    fn from(refusal: T) -> RefusalResponse {
        RefusalResponse(refusal.into())
    }
}

impl IntoResponse for RefusalResponse {
    fn into_response(self) -> Response {
        (self.0.status, Json(self.0.body())).into_response()
    }
}
