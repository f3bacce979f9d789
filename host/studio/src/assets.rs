//! The page, embedded in the program: it works offline.

use axum::extract::Path;
use axum::http::StatusCode;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};

use crate::refusal::Refusal;

const HTML: &str = "text/html; charset=utf-8";
const CSS: &str = "text/css; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";

macro_rules! asset {
    ($name:literal, $kind:expr) => {
        ($name, $kind, include_str!(concat!("../web/", $name)))
    };
}

/// The files of the page: name, media type, content.
pub const ASSETS: &[(&str, &str, &str)] = &[
    asset!("index.html", HTML),
    asset!("colours.css", CSS),
    asset!("controls.css", CSS),
    asset!("studio.css", CSS),
    asset!("inspector.css", CSS),
    asset!("figures.css", CSS),
    asset!("picture.css", CSS),
    asset!("studio.js", SCRIPT),
    asset!("server.js", SCRIPT),
    asset!("history.js", SCRIPT),
    asset!("simulation.js", SCRIPT),
    asset!("inspector.js", SCRIPT),
    asset!("field.js", SCRIPT),
    asset!("slider.js", SCRIPT),
    asset!("picture.js", SCRIPT),
    asset!("components.js", SCRIPT),
    asset!("svg.js", SCRIPT),
    asset!("plot.js", SCRIPT),
    asset!("panel.js", SCRIPT),
    asset!("scale.js", SCRIPT),
    asset!("figures.js", SCRIPT),
    asset!("dialog.js", SCRIPT),
    asset!("commission.js", SCRIPT),
    asset!("export.js", SCRIPT),
];

/// The page itself.
pub async fn index() -> Response {
    asset("index.html").into_response()
}

/// One of its files.
pub async fn file(Path(name): Path<String>) -> Result<Response, Refusal> {
    let found = ASSETS.iter().any(|(asset, ..)| *asset == name);
    if found {
        Ok(asset(&name).into_response())
    } else {
        Err(Refusal::new(StatusCode::NOT_FOUND, format!("there is no {name}")))
    }
}

fn asset(name: &str) -> impl IntoResponse + use<> {
    let found = ASSETS.iter().find(|(asset, ..)| *asset == name);
    let (_, kind, text) = found.copied().unwrap_or(("", HTML, ""));
    ([(CONTENT_TYPE, kind)], text)
}
