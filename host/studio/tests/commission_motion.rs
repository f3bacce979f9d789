//! The page moves no more than it says, and for no longer than it is there.

use std::time::{Duration, Instant};

use axum::http::StatusCode;
use pneudrive_controller::parameters::id;
use pneudrive_link::client::Client;
use pneudrive_protocol::Mode;
use pneudrive_rigs::virtual_rig::Background;
use pneudrive_studio::Studio;
use serde_json::{Value, json};
use tokio::runtime::Runtime;

use crate::commanding::{Page, rig, rig_of_page, rig_with, runtime, status};
use crate::visitor::studio_at;

/// What a count of the built-in rig is, mm.
const MM: f64 = 0.01205;

/// A test that goes on for long, in steps.
const LONG: [&str; 2] =
    ["test.duration_s=20", "test.moves=[[0.0, 8192], [1.0, 8400], [8.0, 8192], [15.0, 8400]]"];

/// A machine that does something else adds to what the studio takes.
const PROMPT: Duration = Duration::from_millis(700);

fn page<'a>(studio: &'a Studio, runtime: &'a Runtime) -> Page<'a> {
    let mut page = Page::open(studio, runtime).expect("a page");
    page.wait_for(|line| line["position"].is_f64());
    page
}

/// How long the drive goes on once the page says nothing any more.
fn goes_on_for(rig: &Background, page: &mut Page<'_>) -> Duration {
    page.beat_until(|line| line["mode"] == "running" && line["run_s"].as_f64() > Some(0.3));
    let begun = Instant::now();
    let last = page.wait_for(|line| line["mode"] == "disarmed");
    assert_eq!(last["message"], "disarmed: the page was silent");
    assert_eq!(status(rig).mode, Mode::Disarmed);
    begun.elapsed()
}

#[test]
fn a_test_or_a_move_whose_page_falls_silent_ends_as_soon_as_a_jog_does() {
    let (rig, runtime) = (rig(), runtime());
    let studio = studio_at(Some(rig.port()));
    let mut page = page(&studio, &runtime);
    page.order("run", rig_with(&LONG));
    let test = goes_on_for(&rig, &mut page);
    let mut far = rig_of_page();
    far["mm"] = json!(250.0);
    page.order("go", far);
    let approach = goes_on_for(&rig, &mut page);
    assert!(test < PROMPT && approach < PROMPT, "the test {test:?}, the move {approach:?}");
}

/// The drive at a place, where it holds.
fn hold_at(page: &mut Page<'_>, mm: f64) {
    let mut there = rig_of_page();
    there["mm"] = json!(mm);
    page.order("go", there);
    page.beat_until(|line| line["mode"] == "running");
    page.beat_until(|line| line["mode"] == "holding");
}

#[test]
fn a_test_that_starts_elsewhere_is_not_run_unasked_and_a_drive_that_holds_goes_on() {
    let (rig, runtime) = (rig(), runtime());
    let studio = studio_at(Some(rig.port()));
    let mut page = page(&studio, &runtime);
    hold_at(&mut page, 160.0);
    page.order("run", rig_of_page());
    let line = page.beat_until(|line| line["message"] != "");
    let message = line["message"].as_str().expect("a message");
    assert!(message.starts_with("not run: the drive stands at 1"), "{message}");
    assert!(message.contains("the test starts at 98.7 mm"), "{message}");
    assert_eq!(status(&rig).mode, Mode::Done, "it holds as before");
}

#[test]
fn a_drive_goes_to_the_start_of_its_test_slowly_and_runs_it_then() {
    let (rig, runtime) = (rig(), runtime());
    let studio = studio_at(Some(rig.port()));
    let mut page = page(&studio, &runtime);
    hold_at(&mut page, 160.0);
    let (answer, approach) = page.ask("approach", rig_of_page());
    assert_eq!(answer, StatusCode::OK, "{approach}");
    assert!(approach["text"].as_str().is_some_and(|text| text.contains("50 mm/s")), "{approach}");
    let mut run = rig_of_page();
    run["from_mm"] = approach["from_mm"].clone();
    page.order("run", run);
    page.beat_until(|line| line["mode"] == "approaching");
    let begun = Instant::now();
    let mut last = (begun, status(&rig).position);
    let mut line = Value::Null;
    let mut fastest = 0.0_f64;
    while line["mode"] != "running" {
        page.order("alive", Value::Null);
        line = page.line();
        let now = (Instant::now(), status(&rig).position);
        let within = now.0 - last.0;
        if line["mode"] == "approaching" && within > Duration::from_millis(150) {
            fastest = fastest.max(f64::from((now.1 - last.1).abs()) * MM / within.as_secs_f64());
            last = now;
        }
        assert!(["approaching", "running"].iter().any(|mode| line["mode"] == *mode), "{line}");
        assert!(begun.elapsed() < Duration::from_secs(20), "{line}");
    }
    // 60 mm at 50 mm/s; the drive follows its setpoint in small steps.
    assert!((1.0..4.0).contains(&begun.elapsed().as_secs_f64()), "{:?}", begun.elapsed());
    assert!((20.0..90.0).contains(&fastest), "{fastest} mm/s");
    let from_mm = f64::from(status(&rig).position) * MM;
    assert!((from_mm - 98.7).abs() < 3.0, "the test begins at {from_mm} mm");
    page.beat_until(|line| line["mode"] == "holding");
    assert_eq!(line["message"], "");
}

#[test]
fn a_drive_at_the_start_of_its_test_has_no_way_to_ask_for() {
    let (rig, runtime) = (rig(), runtime());
    let studio = studio_at(Some(rig.port()));
    let mut page = page(&studio, &runtime);
    hold_at(&mut page, 98.7);
    assert_eq!(page.ask("approach", rig_of_page()), (StatusCode::OK, Value::Null));
}

#[test]
fn what_ends_the_way_to_a_start_ends_the_test_as_well() {
    let (rig, runtime) = (rig(), runtime());
    let studio = studio_at(Some(rig.port()));
    let mut page = page(&studio, &runtime);
    hold_at(&mut page, 160.0);
    let mut run = rig_of_page();
    run["from_mm"] = page.ask("approach", rig_of_page()).1["from_mm"].clone();
    page.order("run", run);
    page.beat_until(|line| line["mode"] == "approaching");
    page.order("disarm", Value::Null);
    page.beat_until(|line| line["mode"] == "disarmed");
    let begun = Instant::now();
    while begun.elapsed() < Duration::from_secs(2) {
        page.order("alive", Value::Null);
        assert_eq!(page.line()["mode"], "disarmed", "nothing follows");
    }
}

/// A refusal changes nothing: a vertical axis goes on holding its load.
#[test]
fn a_place_or_a_test_out_of_reach_is_refused_and_a_drive_that_holds_goes_on() {
    let (rig, runtime) = (rig(), runtime());
    let mut other = Client::connect(rig.port()).expect("a rig");
    other.change_parameters(&[(id::END_MAX_COUNTS, 14_000)]).expect("a disarmed drive");
    let studio = studio_at(Some(rig.port()));
    let mut page = page(&studio, &runtime);
    hold_at(&mut page, 98.7);
    let place = |mm: f64| {
        let mut place = rig_of_page();
        place["mm"] = json!(mm);
        place
    };
    let far = "test.moves=[[0.0, 8192], [0.5, 15000]]";
    for (order, more, told) in [
        ("go", place(200.0), "200 mm is out of reach: the drive goes from 0.0 to 168.7 mm"),
        ("go", place(-1.0), "-1 mm is out of reach"),
        ("go", place(400.0), "400 mm is out of reach"),
        ("run", rig_with(&[far]), "180.750 mm lies beyond a soft limit"),
    ] {
        page.order(order, more);
        let line = page.beat_until(|line| line["message"].as_str().is_some_and(|why| why.contains(told)));
        assert_eq!(line["mode"], "holding", "{told}");
        let status = status(&rig);
        assert_eq!(status.mode, Mode::Done, "{told}");
        assert!((f64::from(status.position) * MM - 98.7).abs() < 2.0, "{told}: {status:?}");
    }
}
