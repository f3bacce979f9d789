//! A page that commands a virtual rig, without a browser.

use std::time::{Duration, Instant};

use axum::body::{Body, BodyDataStream, to_bytes};
use axum::http::{Method, Request, StatusCode};
use futures_util::StreamExt;
use pneudrive_link::client::Client;
use pneudrive_protocol::{Mode, Status};
use pneudrive_rigs::virtual_rig::{Background, Listener, Pace, VirtualRig};
use pneudrive_sim::Rig;
use pneudrive_studio::Studio;
use serde_json::{Value, json};
use tokio::runtime::Runtime;
use tower::ServiceExt;

use crate::visitor::TOKEN;

pub const RIG: &str = "servo-b-tuned";

/// A virtual rig in real time that lives between its runs.
pub fn rig() -> Background {
    rig_of(RIG)
}

/// The same of a built-in rig.
pub fn rig_of(name: &str) -> Background {
    rig_that_lives(name, true)
}

/// The same, but it stands still between its runs: one that lives creeps while it is armed, until it trips.
pub fn rig_at_rest() -> Background {
    rig_that_lives(RIG, false)
}

fn rig_that_lives(name: &str, live: bool) -> Background {
    let rig = VirtualRig::new(Rig::builtin(name).expect("a built-in rig"), 0, Pace { fast: false, live });
    Background::start(rig.expect("a rig"), Listener::open("tcp:127.0.0.1:0").expect("a port"))
}

/// A page that reads of the drive, until it is dropped.
pub struct Page<'a> {
    studio: &'a Studio,
    runtime: &'a Runtime,
    lines: BodyDataStream,
    heard: String,
    pub number: Value,
}

pub fn runtime() -> Runtime {
    tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build().expect("a runtime")
}

pub fn request(studio: &Studio, runtime: &Runtime, path: &str, body: &Value) -> axum::response::Response {
    let request = Request::builder()
        .method(Method::POST)
        .uri(path)
        .header("host", studio.local_address().to_string())
        .header("authorization", format!("Bearer {TOKEN}"))
        .header("content-type", "application/json")
        .body(Body::from(body.to_string()))
        .expect("a request");
    runtime.block_on(studio.router().oneshot(request)).expect("an answer")
}

impl<'a> Page<'a> {
    pub fn open(studio: &'a Studio, runtime: &'a Runtime) -> Result<Page<'a>, StatusCode> {
        let answer = request(studio, runtime, "/api/drive", &json!({}));
        if answer.status() != StatusCode::OK {
            return Err(answer.status());
        }
        let lines = answer.into_body().into_data_stream();
        let mut page = Page { studio, runtime, lines, heard: String::new(), number: Value::Null };
        page.number = page.line()["number"].clone();
        Ok(page)
    }

    /// The next line.
    pub fn line(&mut self) -> Value {
        while !self.heard.contains('\n') {
            let bytes = self.runtime.block_on(self.lines.next()).expect("a line").expect("bytes");
            self.heard.push_str(std::str::from_utf8(&bytes).expect("text"));
        }
        let (line, rest) = self.heard.split_once('\n').expect("a line");
        let line = serde_json::from_str(line).expect("JSON");
        self.heard = rest.to_owned();
        line
    }

    /// Reads until the drive is as told.
    pub fn wait_for(&mut self, what: impl Fn(&Value) -> bool) -> Value {
        let begun = Instant::now();
        loop {
            let line = self.line();
            if what(&line) {
                return line;
            }
            assert!(begun.elapsed() < Duration::from_secs(10), "{line}");
        }
    }

    /// Reads until the drive is as told, and is heard meanwhile.
    pub fn beat_until(&mut self, what: impl Fn(&Value) -> bool) -> Value {
        let begun = Instant::now();
        loop {
            self.order("alive", Value::Null);
            let line = self.line();
            if what(&line) {
                return line;
            }
            assert!(begun.elapsed() < Duration::from_secs(20), "{line}");
        }
    }

    /// Something that is answered: its status and the answer.
    pub fn ask(&self, ask: &str, more: Value) -> (StatusCode, Value) {
        self.asker().ask(ask, more)
    }

    /// Who asks for the page, on a thread of its own.
    pub fn asker(&self) -> Asker<'a> {
        Asker { studio: self.studio, number: self.number.clone() }
    }

    pub fn order(&self, order: &str, more: Value) -> StatusCode {
        request(self.studio, self.runtime, "/api/order", &body(&self.number, "order", order, more)).status()
    }
}

/// Who asks for a page.
pub struct Asker<'a> {
    studio: &'a Studio,
    number: Value,
}

impl Asker<'_> {
    /// As [`Page::ask`].
    pub fn ask(&self, ask: &str, more: Value) -> (StatusCode, Value) {
        let runtime = runtime();
        let answer = request(self.studio, &runtime, "/api/ask", &body(&self.number, "ask", ask, more));
        let status = answer.status();
        let bytes = runtime.block_on(to_bytes(answer.into_body(), usize::MAX)).expect("a body");
        (status, serde_json::from_slice(&bytes).expect("JSON"))
    }
}

fn body(number: &Value, kind: &str, what: &str, more: Value) -> Value {
    let mut body = json!({ "number": number, kind: what });
    if let (Some(body), Value::Object(more)) = (body.as_object_mut(), more) {
        body.extend(more);
    }
    body
}

/// The rig as a page sends it.
pub fn rig_of_page() -> Value {
    json!({ "rig": { "name": RIG, "text": pneudrive_sim::rigfile::builtin(RIG), "settings": [] } })
}

/// The same with settings.
pub fn rig_with(settings: &[&str]) -> Value {
    let mut rig = rig_of_page();
    rig["rig"]["settings"] = json!(settings);
    rig
}

/// What another program sees of the drive.
pub fn status(rig: &Background) -> Status {
    Client::connect(rig.port()).expect("a rig").status().expect("a status")
}

pub fn wait_for_mode(rig: &Background, mode: Mode) -> Duration {
    let begun = Instant::now();
    while status(rig).mode != mode {
        assert!(begun.elapsed() < Duration::from_secs(5), "{:?}", status(rig).mode);
        std::thread::sleep(Duration::from_millis(20));
    }
    begun.elapsed()
}
