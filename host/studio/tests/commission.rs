//! A virtual rig moved from a page, and what becomes of it when the page goes.

use std::net::TcpListener;
use std::time::{Duration, Instant};

use axum::http::StatusCode;
use pneudrive_controller::parameters::id;
use pneudrive_link::client::Client;
use pneudrive_protocol::Mode;
use serde_json::{Value, json};

use crate::commanding::{Page, request, rig, rig_at_rest, rig_of_page, runtime, status, wait_for_mode};
use crate::visitor::studio_at;

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
    let (rig, runtime) = (rig_at_rest(), runtime());
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

/// What is at the port takes a connection and says nothing.
#[test]
fn a_stop_that_has_not_come_to_the_drive_is_not_taken_for_done() {
    let port = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = format!("tcp://{}", port.local_addr().expect("an address"));
    std::thread::spawn(move || port.incoming().for_each(drop));
    let runtime = runtime();
    let studio = studio_at(Some(&address));
    let page = Page::open(&studio, &runtime).expect("a page");
    assert_eq!(page.order("stop", Value::Null), StatusCode::INTERNAL_SERVER_ERROR);
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
    let travel = held["position"].as_f64().expect("mm") - from;
    let most = 10.0 * begun.elapsed().as_secs_f64() + 2.0;
    assert!((4.0..most).contains(&travel), "{travel} mm in {:?}: {held}", begun.elapsed());
    page.order("release", Value::Null);
    wait_for_mode(&rig, Mode::Disarmed);
}

#[test]
fn a_jog_button_that_is_not_confirmed_any_more_ends_the_motion() {
    let (rig, runtime) = (rig(), runtime());
    let studio = studio_at(Some(rig.port()));
    let mut page = Page::open(&studio, &runtime).expect("a page");
    let begun = Instant::now();
    while page.line()["mode"] != "running" {
        page.order("retract", rig_of_page());
        assert!(begun.elapsed() < Duration::from_secs(10), "it does not move");
    }
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

/// Its moves would mean something else.
#[test]
fn a_test_that_was_designed_for_another_calibration_is_refused_with_the_key() {
    let (rig, runtime) = (rig(), runtime());
    let studio = studio_at(Some(rig.port()));
    let mut other = Client::connect(rig.port()).expect("a rig");
    let mut page = Page::open(&studio, &runtime).expect("a page");
    let mut refused = |settings: &[&str], key: &str| {
        let mut more = rig_of_page();
        more["rig"]["settings"] = json!(settings);
        page.order("release", Value::Null);
        page.wait_for(|line| line["message"] == "");
        page.order("run", more);
        let line = page.wait_for(|line| line["message"] != "");
        assert!(line["message"].as_str().is_some_and(|why| why.contains(key)), "{key}: {line}");
        assert_eq!(status(&rig).mode, Mode::Disarmed, "{key}");
    };
    refused(&["controller.period_s=0.002", "controller.delay_s=0.0005"], "controller.period_s");
    refused(&["encoder.mm_per_count=0.0125"], "encoder.mm_per_count");
    other.change_parameters(&[(id::ON_ARRIVAL, 1)]).expect("a parameter of the drive");
    refused(&[], "controller.exit_on_dead_band");
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
