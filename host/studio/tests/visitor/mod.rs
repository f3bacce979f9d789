//! A program that asks the studio, without a browser.

use axum::body::{Body, to_bytes};
use axum::http::{HeaderMap, Method, Request, StatusCode};
use pneudrive_studio::token::Token;
use pneudrive_studio::{Opened, Options, Studio};
use serde_json::{Value, json};
use tower::ServiceExt;

pub const TOKEN: &str = "a-token-of-the-tests";

/// What came back.
pub struct Answer {
    pub status: StatusCode,
    pub headers: HeaderMap,
    pub body: Vec<u8>,
}

impl Answer {
    pub fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|error| panic!("{error}: {}", self.text()))
    }

    pub fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }
}

/// A studio at a free port, with servo-drive B.
pub fn studio() -> Studio {
    studio_with("servo-b-tuned", pneudrive_sim::rigfile::builtin("servo-b-tuned").expect("a built-in rig"))
}

/// The same with another rig.
pub fn studio_with(name: &str, text: &str) -> Studio {
    open(Opened { name: name.to_owned(), text: text.to_owned() }, None)
}

/// A studio with a rig at a port.
pub fn studio_at(port: Option<&str>) -> Studio {
    open(Opened { name: "servo-b-tuned".to_owned(), text: String::new() }, port)
}

fn open(opened: Opened, port: Option<&str>) -> Studio {
    let token = Some(Token::new(TOKEN).expect("a token"));
    let port = port.map(str::to_owned);
    Studio::open(Options { listen: "127.0.0.1:0".to_owned(), token, opened, port }).expect("a studio")
}

/// A request with these headers and no others.
pub fn ask(studio: &Studio, method: Method, path: &str, headers: &[(&str, &str)], body: Vec<u8>) -> Answer {
    let mut request = Request::builder().method(method).uri(path);
    for (name, value) in headers {
        request = request.header(*name, *value);
    }
    let request = request.body(Body::from(body)).expect("a request");
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
    runtime.block_on(async {
        let answer = studio.router().oneshot(request).await.expect("an answer");
        let (parts, body) = answer.into_parts();
        let body = to_bytes(body, usize::MAX).await.expect("a body").to_vec();
        Answer { status: parts.status, headers: parts.headers, body }
    })
}

/// A request as the page makes it.
pub fn ask_as_page(studio: &Studio, method: Method, path: &str, body: Option<Value>) -> Answer {
    let host = studio.local_address().to_string();
    let token = format!("Bearer {TOKEN}");
    let origin = format!("http://{host}");
    let headers = [
        ("host", host.as_str()),
        ("origin", &origin),
        ("authorization", &token),
        ("content-type", "application/json"),
    ];
    ask(studio, method, path, &headers, body.map_or_else(Vec::new, |body| body.to_string().into_bytes()))
}

/// The same with a rig of the file and some settings.
pub fn post_rig(studio: &Studio, path: &str, name: &str, settings: &[&str]) -> Answer {
    let text = pneudrive_sim::rigfile::builtin(name).expect("a built-in rig");
    let body = json!({ "name": name, "text": text, "settings": settings });
    ask_as_page(studio, Method::POST, path, Some(body))
}
