//! Studies over HTTP: progress line by line, one at a time, called off when nobody reads.

mod visitor;

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use axum::http::{Method, StatusCode};
use pneudrive_page::study::{Audience, Study};
use pneudrive_sim::rig::builtin;
use serde_json::{Value, json};

use visitor::{TOKEN, ask_as_page, studio};

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

/// A page that asks for a study, and reads as long as it likes.
fn asked(host: &str, body: &Value) -> BufReader<TcpStream> {
    let mut stream = TcpStream::connect(host).expect("it listens");
    stream.set_read_timeout(Some(Duration::from_secs(60))).expect("a socket");
    let body = body.to_string();
    write!(
        stream,
        "POST /api/study HTTP/1.1\r\nHost: {host}\r\nAuthorization: Bearer {TOKEN}\r\nContent-Type: application/json\r\nContent-Length: {}\r\nConnection: close\r\n\r\n{body}",
        body.len()
    )
    .expect("sent");
    BufReader::new(stream)
}

/// Its status line.
fn status(page: &mut BufReader<TcpStream>) -> String {
    let mut line = String::new();
    page.read_line(&mut line).expect("a status");
    line
}

#[test]
fn there_is_one_study_at_a_time_and_it_ends_with_its_page() {
    let studio = studio();
    let host = studio.local_address().to_string();
    std::thread::spawn(move || studio.serve());
    // Minutes of runs.
    let mut first = asked(&host, &sweep(10_000));
    assert!(status(&mut first).contains("200"));
    assert!(first.by_ref().lines().any(|line| line.expect("a line").contains("\"done\":0")));
    let mut second = asked(&host, &sweep(2));
    assert!(status(&mut second).contains("409"));
    let mut text = String::new();
    second.read_to_string(&mut text).expect("a reason");
    assert!(text.contains("another study is at work; cancel it"), "{text}");
    drop(first);
    // The studio notices, ends its run, and takes the next study.
    let begun = Instant::now();
    loop {
        let mut third = asked(&host, &sweep(2));
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
