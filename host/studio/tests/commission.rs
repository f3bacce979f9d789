//! A virtual rig moved from a page, and what becomes of it when the page goes.

mod visitor;

use std::time::{Duration, Instant};

use axum::body::{Body, BodyDataStream};
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

use visitor::{TOKEN, studio_at};

const RIG: &str = "servo-b-tuned";

/// A virtual rig in real time that lives between its runs.
fn rig() -> Background {
    let rig =
        VirtualRig::new(Rig::builtin(RIG).expect("a built-in rig"), 0, Pace { fast: false, live: true });
    Background::start(rig.expect("a rig"), Listener::open("tcp:127.0.0.1:0").expect("a port"))
}

/// A page that reads of the drive, until it is dropped.
struct Page<'a> {
    studio: &'a Studio,
    runtime: &'a Runtime,
    lines: BodyDataStream,
    heard: String,
    number: Value,
}

fn runtime() -> Runtime {
    tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build().expect("a runtime")
}

fn request(studio: &Studio, runtime: &Runtime, path: &str, body: &Value) -> axum::response::Response {
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
    fn open(studio: &'a Studio, runtime: &'a Runtime) -> Result<Page<'a>, StatusCode> {
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
    fn line(&mut self) -> Value {
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
    fn wait_for(&mut self, what: impl Fn(&Value) -> bool) -> Value {
        let begun = Instant::now();
        loop {
            let line = self.line();
            if what(&line) {
                return line;
            }
            assert!(begun.elapsed() < Duration::from_secs(10), "{line}");
        }
    }

    fn order(&self, order: &str, more: Value) -> StatusCode {
        let mut body = json!({ "number": self.number, "order": order });
        if let (Some(body), Value::Object(more)) = (body.as_object_mut(), more) {
            body.extend(more);
        }
        request(self.studio, self.runtime, "/api/order", &body).status()
    }
}

/// The rig as a page sends it.
fn rig_of_page() -> Value {
    json!({ "rig": { "name": RIG, "text": pneudrive_sim::rig::builtin(RIG), "settings": [] } })
}

/// What another program sees of the drive.
fn status(rig: &Background) -> Status {
    Client::connect(rig.port()).expect("a rig").status().expect("a status")
}

fn wait_for_mode(rig: &Background, mode: Mode) -> Duration {
    let begun = Instant::now();
    while status(rig).mode != mode {
        assert!(begun.elapsed() < Duration::from_secs(5), "{:?}", status(rig).mode);
        std::thread::sleep(Duration::from_millis(20));
    }
    begun.elapsed()
}

#[test]
fn one_page_commands_and_a_second_one_is_refused_until_it_has_gone() {
    let (rig, runtime) = (rig(), runtime());
    let studio = studio_at(Some(rig.port()));
    let mut page = Page::open(&studio, &runtime).expect("the first page");
    page.wait_for(|line| line["mode"] == "disarmed");
    assert_eq!(Page::open(&studio, &runtime).err(), Some(StatusCode::CONFLICT));
    let other = json!({ "number": 77, "order": "arm" });
    assert_eq!(request(&studio, &runtime, "/api/order", &other).status(), StatusCode::CONFLICT);
    drop(page);
    assert!(Page::open(&studio, &runtime).is_ok());
}

#[test]
fn a_page_that_goes_leaves_the_drive_disarmed() {
    let (rig, runtime) = (rig(), runtime());
    let studio = studio_at(Some(rig.port()));
    let mut page = Page::open(&studio, &runtime).expect("a page");
    assert_eq!(page.order("arm", Value::Null), StatusCode::ACCEPTED);
    page.wait_for(|line| line["mode"] == "armed" && line["is_enabled"] == true);
    assert_eq!(status(&rig).mode, Mode::Armed);
    drop(page);
    let took = wait_for_mode(&rig, Mode::Disarmed);
    assert!(took < Duration::from_millis(1000), "{took:?}");
}

#[test]
fn a_page_that_says_nothing_leaves_the_drive_disarmed() {
    let (rig, runtime) = (rig(), runtime());
    let studio = studio_at(Some(rig.port()));
    let mut page = Page::open(&studio, &runtime).expect("a page");
    page.order("arm", Value::Null);
    page.wait_for(|line| line["mode"] == "armed");
    let last = page.wait_for(|line| line["mode"] == "disarmed");
    assert_eq!(last["message"], "disarmed: the page was silent");
}

#[test]
fn any_page_with_the_token_stops_the_drive_and_the_reason_is_told_in_words() {
    let (rig, runtime) = (rig(), runtime());
    let studio = studio_at(Some(rig.port()));
    let mut page = Page::open(&studio, &runtime).expect("a page");
    page.order("arm", Value::Null);
    page.wait_for(|line| line["mode"] == "armed");
    let stop = json!({ "order": "stop" });
    assert_eq!(request(&studio, &runtime, "/api/order", &stop).status(), StatusCode::ACCEPTED);
    let tripped = page.wait_for(|line| line["mode"] == "fault");
    assert_eq!(tripped["fault"], "stop: a stop was requested");
}

/// Another program may have set it going.
#[test]
fn a_drive_that_no_page_commands_is_stopped_as_well() {
    let (rig, runtime) = (rig(), runtime());
    let studio = studio_at(Some(rig.port()));
    let mut other = Client::connect(rig.port()).expect("a rig");
    other.arm().expect("armed");
    let stop = json!({ "order": "stop" });
    assert_eq!(request(&studio, &runtime, "/api/order", &stop).status(), StatusCode::ACCEPTED);
    assert_eq!(other.status().expect("a status").mode, Mode::Fault);
    let arm = json!({ "order": "arm" });
    assert_eq!(request(&studio, &runtime, "/api/order", &arm).status(), StatusCode::CONFLICT);
}

/// 10 mm/s, and what the drive does on a step of half a millimetre.
#[test]
fn a_jog_moves_the_drive_at_its_rate_while_the_button_is_held_and_disarms_it_then() {
    let (rig, runtime) = (rig(), runtime());
    let studio = studio_at(Some(rig.port()));
    let mut page = Page::open(&studio, &runtime).expect("a page");
    let from = page.wait_for(|line| line["position"].is_f64())["position"].as_f64().expect("mm");
    let begun = Instant::now();
    while begun.elapsed() < Duration::from_millis(1500) {
        assert_eq!(page.order("extend", rig_of_page()), StatusCode::ACCEPTED);
        page.line();
        page.line();
    }
    let held = page.wait_for(|line| line["position"].is_f64());
    let way = held["position"].as_f64().expect("mm") - from;
    let most = 10.0 * begun.elapsed().as_secs_f64() + 2.0;
    assert!((4.0..most).contains(&way), "{way} mm in {:?}: {held}", begun.elapsed());
    page.order("release", Value::Null);
    wait_for_mode(&rig, Mode::Disarmed);
}

#[test]
fn a_jog_button_that_is_not_confirmed_any_more_ends_the_motion() {
    let (rig, runtime) = (rig(), runtime());
    let studio = studio_at(Some(rig.port()));
    let mut page = Page::open(&studio, &runtime).expect("a page");
    page.order("retract", rig_of_page());
    page.wait_for(|line| line["mode"] == "running");
    let last = page.wait_for(|line| line["mode"] == "disarmed");
    assert_eq!(last["message"], "disarmed: the jog button was not confirmed");
}

#[test]
fn the_drive_goes_to_a_place_slowly_and_holds_it() {
    let (rig, runtime) = (rig(), runtime());
    let studio = studio_at(Some(rig.port()));
    let mut page = Page::open(&studio, &runtime).expect("a page");
    let from = page.wait_for(|line| line["position"].is_f64())["position"].as_f64().expect("mm");
    let mut more = rig_of_page();
    more["mm"] = json!(from + 25.0);
    page.order("go", more);
    page.wait_for(|line| line["mode"] == "running");
    let mut end = Value::Null;
    while end["mode"] != "holding" {
        page.order("alive", Value::Null);
        end = page.line();
        assert!(end["mode"] == "running" || end["mode"] == "holding", "{end}");
    }
    let reached = end["position"].as_f64().expect("mm");
    assert!((reached - from - 25.0).abs() < 2.0, "{end}");
}

#[test]
fn a_rig_with_another_clock_than_the_page_is_not_moved() {
    let (rig, runtime) = (rig(), runtime());
    let studio = studio_at(Some(rig.port()));
    let mut page = Page::open(&studio, &runtime).expect("a page");
    let mut more = rig_of_page();
    more["rig"]["settings"] = json!(["controller.period_s=0.002", "controller.delay_s=0.0005"]);
    page.order("run", more);
    let line = page.wait_for(|line| line["message"] != "");
    assert!(line["message"].as_str().is_some_and(|why| why.contains("controller.period_s")), "{line}");
    assert_eq!(status(&rig).mode, Mode::Disarmed);
}

#[test]
fn a_port_without_a_rig_ends_the_stream_with_the_reason() {
    let runtime = runtime();
    let studio = studio_at(Some("tcp://127.0.0.1:1"));
    let mut page = Page::open(&studio, &runtime).expect("a page");
    let last = page.wait_for(|line| line["is_over"] == true);
    assert!(last["message"].as_str().is_some_and(|why| why.contains("127.0.0.1:1")), "{last}");
    drop(page);
    assert_eq!(Page::open(&studio_at(None), &runtime).err(), Some(StatusCode::NOT_FOUND));
}
