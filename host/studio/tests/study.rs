//! Studies over HTTP: progress line by line, one at a time, called off when nobody reads.

use std::io::{BufRead, Read};
use std::time::{Duration, Instant};

use axum::http::{Method, StatusCode};
use pneudrive_page::study::{Audience, Study};
use pneudrive_sim::rigfile::builtin;
use serde_json::{Value, json};

use crate::visitor::{ask_as_page, studio};
use crate::wire::{asked, status};

/// A sweep of so many short runs.
fn sweep(points: u32) -> Value {
    json!({
        "study": "sweep", "name": "servo-b-tuned", "text": builtin("servo-b-tuned").expect("a built-in rig"),
        "settings": ["test.duration_s=0.3"],
        "vary": [{ "key": "load.mass_kg", "from": 1.0, "to": 4.0, "steps": points }],
        "metrics": ["top_speed_mm_s"], "objective": null, "runs": 1,
    })
}

#[test]
fn progress_comes_line_by_line_and_then_what_was_found() {
    let answer = ask_as_page(&studio(), Method::POST, "/api/study", Some(sweep(3)));
    assert_eq!(answer.status, StatusCode::OK, "{}", answer.text());
    let text = answer.text();
    let lines: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    let done: Vec<&Value> = lines.iter().map(|line| &line["at"]["done"]).collect();
    assert_eq!(done, [&json!(0), &json!(1), &json!(2), &json!(3), &Value::Null]);
    let study = Study::read(&sweep(3)).expect("a study");
    let found = study.work(Audience { hears: &mut |_| {}, waits: &|| true }).expect("found");
    assert_eq!(lines[4]["found"], found);
}

#[test]
fn a_study_that_cannot_be_is_refused_with_the_reason() {
    let mut wrong = sweep(3);
    wrong["vary"][0]["key"] = json!("load.mas_kg");
    let answer = ask_as_page(&studio(), Method::POST, "/api/study", Some(wrong));
    let last: Value = serde_json::from_str(answer.text().lines().last().expect("a line")).expect("JSON");
    assert_eq!(last["status"], 422);
    assert!(last["refused"]["error"].as_str().expect("a reason").contains("load.mas_kg"), "{last}");
    let answer = ask_as_page(&studio(), Method::POST, "/api/study", Some(json!({ "study": "steam" })));
    assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY);
}

#[test]
fn there_is_one_study_at_a_time_and_it_ends_with_its_page() {
    let studio = studio();
    let host = studio.local_address().to_string();
    std::thread::spawn(move || studio.serve());
    // Minutes of runs.
    let mut first = asked(&host, "/api/study", &sweep(10_000));
    assert!(status(&mut first).contains("200"));
    assert!(first.by_ref().lines().any(|line| line.expect("a line").contains("\"done\":0")));
    let mut second = asked(&host, "/api/study", &sweep(2));
    assert!(status(&mut second).contains("409"));
    let mut text = String::new();
    second.read_to_string(&mut text).expect("a reason");
    assert!(text.contains("another study is at work; cancel it"), "{text}");
    drop(first);
    // The studio notices, ends its run, and takes the next study.
    let begun = Instant::now();
    loop {
        let mut third = asked(&host, "/api/study", &sweep(2));
        if status(&mut third).contains("200") {
            let mut text = String::new();
            third.read_to_string(&mut text).expect("lines");
            assert!(text.contains("\"found\""), "{text}");
            break;
        }
        assert!(begun.elapsed() < Duration::from_secs(20), "the first study goes on without its page");
        std::thread::sleep(Duration::from_millis(50));
    }
}

/// Threads of this program.
#[cfg(target_os = "linux")]
fn threads() -> usize {
    std::fs::read_dir("/proc/self/task").expect("a list of threads").count()
}

/// A study that is called off ends the run that has begun, here some seconds.
#[cfg(target_os = "linux")]
#[test]
fn studies_that_are_begun_and_called_off_again_and_again_take_no_more_threads() {
    let studio = studio();
    let host = studio.local_address().to_string();
    std::thread::spawn(move || studio.serve());
    let mut long = sweep(10_000);
    long["settings"] = json!(["test.duration_s=250"]);
    let before = threads();
    for _ in 0..40 {
        let page = asked(&host, "/api/study", &long);
        std::thread::sleep(Duration::from_millis(50));
        drop(page);
        std::thread::sleep(Duration::from_millis(50));
    }
    // Those of the server and of one study, and of the other tests here.
    let more = threads().saturating_sub(before);
    assert!(more < 20, "{more} more threads");
}
