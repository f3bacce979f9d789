//! Serves the page: its files, and its requests on threads of their own.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use axum::Json;
use axum::body::Bytes;
use axum::extract::Path;
use axum::http::header::CONTENT_TYPE;
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use pneudrive_page::assets::ASSETS;
use pneudrive_page::refusal::HttpRefusal;
use pneudrive_page::{Answer, answer, keys};
use serde_json::Value;

use crate::refusal_response::RefusalResponse;

/// The page itself.
pub async fn index() -> Result<Response, RefusalResponse> {
    asset("index.html")
}

/// One of its files.
///
/// # Errors
/// When there is none of that name.
pub async fn file(Path(name): Path<String>) -> Result<Response, RefusalResponse> {
    asset(&name)
}

fn asset(name: &str) -> Result<Response, RefusalResponse> {
    let found = ASSETS.iter().find(|(asset, ..)| *asset == name);
    let (_, kind, text) =
        found.ok_or_else(|| HttpRefusal::new(StatusCode::NOT_FOUND, format!("there is no {name}")))?;
    Ok(([(CONTENT_TYPE, *kind)], *text).into_response())
}

/// The table of keys.
pub async fn keys() -> Json<Value> {
    Json(keys::table())
}

/// A request of the page. It is read and answered on a thread of its own, because its record may be long. It is
/// cancelled when the page has gone or asks for something else.
///
/// # Errors
/// The reason why it is not carried out.
pub async fn request(
    name: &'static str,
    headers: HeaderMap,
    body: Bytes,
) -> Result<Response, RefusalResponse> {
    refuse_form(&headers)?;
    let wanted = CancelOnDrop(Arc::new(AtomicBool::new(true)));
    let flag = wanted.0.clone();
    let done = tokio::task::spawn_blocking(move || {
        let wanted = || flag.load(Ordering::Relaxed);
        if !wanted() {
            return Err(HttpRefusal::gone());
        }
        let body: Value = serde_json::from_slice(&body).map_err(|error| HttpRefusal::malformed(&error))?;
        answer(name, &body, &wanted)
    });
    match done.await.unwrap_or_else(|error| Err(HttpRefusal::of(&error.into())))? {
        Answer::Json(value) => Ok(Json(value).into_response()),
        Answer::Columns(bytes) => Ok(([(CONTENT_TYPE, "application/octet-stream")], bytes).into_response()),
    }
}

/// Refuses a body that is not declared as JSON: a form of another page cannot declare that.
fn refuse_form(headers: &HeaderMap) -> Result<(), HttpRefusal> {
    let kind = headers.get(CONTENT_TYPE).and_then(|kind| kind.to_str().ok()).unwrap_or_default();
    let kind = kind.split(';').next().unwrap_or_default().trim();
    if kind.eq_ignore_ascii_case("application/json") {
        return Ok(());
    }
    Err(HttpRefusal::new(StatusCode::UNSUPPORTED_MEDIA_TYPE, "send the request as application/json"))
}

/// Sets a flag to false when the request that it belongs to is dropped.
struct CancelOnDrop(Arc<AtomicBool>);

impl Drop for CancelOnDrop {
    fn drop(&mut self) {
        self.0.store(false, Ordering::Relaxed);
    }
}
