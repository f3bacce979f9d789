//! What a page asks of a drive and waits for: parameters, the record, a bring-up. And the samples that it is told.

use std::time::{Duration, Instant};

use axum::http::StatusCode;
use pneudrive_controller::parameters::id;
use pneudrive_link::client::Client;
use pneudrive_protocol::Mode;
use pneudrive_records::target::TargetFile;
use serde_json::{Value, json};

use crate::commanding::{Page, rig, rig_of, rig_of_page, runtime, status, wait_for_mode};
use crate::visitor::studio_at;

/// Reads of the drive and keeps the page alive until it is as told; the last line.
fn wait_alive(page: &mut Page<'_>, mut what: impl FnMut(&Value) -> bool) -> Value {
    let begun = Instant::now();
    loop {
        page.order("alive", Value::Null);
        let line = page.line();
        if what(&line) {
            return line;
        }
        assert!(begun.elapsed() < Duration::from_secs(30), "{line}");
    }
}

fn row<'a>(table: &'a Value, path: &str) -> &'a Value {
    let rows = table["parameters"].as_array().expect("a list");
    rows.iter().find(|row| row["path"] == path).expect(path)
}

#[test]
fn parameters_are_shown_beside_the_design_changed_as_a_whole_and_saved_when_asked() {
    let (rig, runtime) = (rig(), runtime());
    let studio = studio_at(Some(rig.port()));
    let page = Page::open(&studio, &runtime).expect("a page");
    let mut more = rig_of_page();
    more["rig"]["settings"] = json!(["controller.velocity_gain=99"]);
    let (_, table) = page.ask("parameters", more.clone());
    let gain = row(&table, "controller.velocity_gain");
    assert_eq!([&gain["designed"], &gain["differs"]], [&json!("99"), &json!(true)], "{gain}");
    assert_eq!(row(&table, "controller.scale")["differs"], false);

    let values = json!([["controller.velocity_gain", "98"], ["controller.delay_s", "soon"]]);
    let (code, refused) = page.ask("change", json!({ "values": values }));
    assert_eq!(
        (code, &refused["problems"][0]["key"]),
        (StatusCode::UNPROCESSABLE_ENTITY, &json!("controller.delay_s"))
    );
    let values = json!([["controller.velocity_gain", "98"], ["controller.delay_s", "0.05"]]);
    let (code, refused) = page.ask("change", json!({ "values": values }));
    assert_eq!(code, StatusCode::UNPROCESSABLE_ENTITY, "the drive refuses it: {refused}");
    assert_eq!(refused["problems"][0]["key"], "controller.delay_s", "{refused}");
    let mut other = Client::connect(rig.port()).expect("a rig");
    let gain = |other: &mut Client| other.parameters().expect("an answer").values.get(id::VELOCITY_GAIN);
    assert_ne!(gain(&mut other), Some(98), "nothing was changed");

    let (code, _) = page.ask("change", json!({ "values": [["controller.velocity_gain", "99"]] }));
    assert_eq!((code, gain(&mut other)), (StatusCode::OK, Some(99)));
    let (code, again) = page.ask("change", json!({ "values": [["controller.velocity_gain", "99"]] }));
    assert_eq!(code, StatusCode::OK, "it has that value already: {again}");
    let (_, table) = page.ask("parameters", more.clone());
    assert_eq!(
        (&table["saved"], &row(&table, "controller.velocity_gain")["differs"]),
        (&json!(false), &json!(false))
    );
    assert_eq!(page.ask("save", Value::Null).0, StatusCode::OK);
    assert_eq!(page.ask("parameters", more).1["saved"], true);
    assert!(other.config_state().expect("an answer").saved);
}

#[test]
fn another_page_is_told_nothing_of_a_drive_that_it_does_not_command() {
    let (rig, runtime) = (rig(), runtime());
    let studio = studio_at(Some(rig.port()));
    let mut page = Page::open(&studio, &runtime).expect("a page");
    page.number = json!(77);
    assert_eq!(page.ask("record", Value::Null).0, StatusCode::CONFLICT);
    assert_eq!(page.ask("change", json!({ "values": [] })).0, StatusCode::CONFLICT);
}

/// Time and position of all samples in a line.
fn samples(line: &Value) -> Vec<(f64, Option<f64>)> {
    let numbers = |value: &Value| value.as_array().cloned().unwrap_or_default();
    let time = numbers(&line["samples"]["time"]);
    let position = numbers(&line["samples"]["channels"][1]);
    time.iter().zip(&position).map(|(time, mm)| (time.as_f64().expect("a time"), mm.as_f64())).collect()
}

#[test]
fn the_page_is_told_every_sample_of_a_test_on_one_axis_of_time_and_then_has_its_record() {
    let (rig, runtime) = (rig(), runtime());
    let studio = studio_at(Some(rig.port()));
    let mut page = Page::open(&studio, &runtime).expect("a page");
    let mut told = Vec::new();
    page.order("run", rig_of_page());
    wait_alive(&mut page, |line| {
        told.extend(samples(line));
        line["mode"] == "running"
    });
    let end = wait_alive(&mut page, |line| {
        told.extend(samples(line));
        line["mode"] == "holding"
    });
    for _ in 0..10 {
        told.extend(samples(&page.line()));
    }
    let began = end["run_began_s"].as_f64().expect("it has begun");
    assert!(told.is_sorted_by(|a, b| a.0 < b.0), "one axis of time");
    let (code, record) = page.ask("record", Value::Null);
    assert_eq!(code, StatusCode::OK, "{record}");
    let file = TargetFile::from_text(record["text"].as_str().expect("a text")).expect("a TARGET file");
    assert_eq!(record["samples"], file.samples.len());
    let mm_per_count = file.number("mm_per_count").expect("a scale");
    for (k, (index, sample)) in file.samples.iter().enumerate() {
        let at_s = began + f64::from(*index) * 0.0013;
        let found =
            told.iter().find(|(time, _)| (time - at_s).abs() < 1e-5).unwrap_or_else(|| panic!("sample {k}"));
        let mm = found.1.expect("a place");
        assert!((mm - f64::from(sample.position) * mm_per_count).abs() < 1e-4, "sample {k}: {mm} mm");
    }
}

/// Whether the order comes before, during or after the download.
#[test]
fn a_drive_that_is_disarmed_while_its_record_is_read_is_disarmed() {
    let (rig, runtime) = (rig(), runtime());
    let studio = studio_at(Some(rig.port()));
    let mut page = Page::open(&studio, &runtime).expect("a page");
    page.order("run", rig_of_page());
    wait_alive(&mut page, |line| line["mode"] == "running");
    wait_alive(&mut page, |line| line["mode"] == "holding");
    let asker = page.asker();
    std::thread::scope(|scope| {
        let asked = scope.spawn(move || asker.ask("record", Value::Null));
        page.order("disarm", Value::Null);
        let (code, answer) = asked.join().expect("an answer");
        assert!([StatusCode::OK, StatusCode::CONFLICT].contains(&code), "{answer}");
    });
    wait_for_mode(&rig, Mode::Disarmed);
}

#[test]
fn a_record_of_a_drive_that_has_none_is_refused_with_the_reason() {
    let (rig, runtime) = (rig(), runtime());
    let studio = studio_at(Some(rig.port()));
    let page = Page::open(&studio, &runtime).expect("a page");
    let (code, refused) = page.ask("record", Value::Null);
    assert_eq!(code, StatusCode::CONFLICT);
    assert!(
        refused["error"].as_str().is_some_and(|why| why.contains("nothing has been recorded")),
        "{refused}"
    );
}

/// A bring-up whose questions are answered by `answer`, until that ends it; its answer, and the lines.
fn brought_up(
    page: &mut Page<'_>,
    mut answer: impl FnMut(&Page<'_>, &str) -> Option<bool>,
) -> ((StatusCode, Value), Vec<Value>) {
    let asker = page.asker();
    std::thread::scope(|scope| {
        let more = json!({ "push_wait_s": 0, "most_percent": 30 });
        let asked = scope.spawn(move || asker.ask("bring-up", more));
        let (mut shown, mut answered) = (Vec::new(), Value::Null);
        while !asked.is_finished() {
            page.order("alive", Value::Null);
            let told = page.line()["bring_up"].take();
            let question = &told["question"];
            if !question.is_null() && question["number"] != answered {
                answered = question["number"].clone();
                if let Some(yes) = answer(page, question["text"].as_str().expect("a text")) {
                    page.order("answer", json!({ "question": answered, "yes": yes }));
                }
            }
            shown.extend((!told.is_null()).then_some(told));
        }
        // The answer may be there before the line that tells its end.
        if shown.last().is_some_and(|told| told["is_on"] == true) {
            shown.push(page.wait_for(|line| line["bring_up"]["is_on"] == false)["bring_up"].take());
        }
        (asked.join().expect("an answer"), shown)
    })
}

#[test]
fn a_bring_up_asks_before_it_moves_tells_each_check_and_ends_with_its_report() {
    let (rig, runtime) = (rig_of("servo-c"), runtime());
    let studio = studio_at(Some(rig.port()));
    let mut page = Page::open(&studio, &runtime).expect("a page");
    let mut asked = Vec::new();
    let ((code, report), shown) = brought_up(&mut page, |_, question| {
        asked.push(question.to_owned());
        Some(question.starts_with("The cylinder will move"))
    });
    assert_eq!(code, StatusCode::OK, "{report}");
    assert!(asked[0].starts_with("The cylinder will move") && asked[1].contains("drive_enable"), "{asked:?}");
    assert!(asked[0].contains("the watchdog resets the board; the slide may jerk then"), "{asked:?}");
    assert_eq!(report["wrong"], json!([]), "{report}");
    let text = report["text"].as_str().expect("a text");
    assert!(
        text.starts_with("# Bring-up") && text.contains("| pulses |") && text.contains("| right |"),
        "{text}"
    );
    let last = shown.last().expect("it was shown");
    let names: Vec<&str> = last["checks"]
        .as_array()
        .expect("a list")
        .iter()
        .filter_map(|check| check["name"].as_str())
        .collect();
    assert_eq!(names.first(), Some(&"board"));
    assert_eq!(names.last(), Some(&"watchdog"));
    assert_eq!(status(&rig).mode, Mode::Disarmed);
}

/// Whoever ends it at a question does not want the drive armed.
#[test]
fn a_bring_up_that_is_ended_or_stopped_at_a_question_moves_nothing_and_says_why() {
    for (order, message) in [("abort", "ended by the page"), ("stop", "the drive was stopped")] {
        let (rig, runtime) = (rig(), runtime());
        let studio = studio_at(Some(rig.port()));
        let mut page = Page::open(&studio, &runtime).expect("a page");
        let ((code, refused), shown) = brought_up(&mut page, |page, question| {
            if question.starts_with("The cylinder will move") {
                return Some(true);
            }
            page.order(order, Value::Null);
            None
        });
        assert_eq!(code, StatusCode::CONFLICT, "{refused}");
        assert!(refused["error"].as_str().is_some_and(|why| why.contains(message)), "{refused}");
        assert_eq!(shown.last().expect("shown")["is_on"], false);
        let expected = if order == "stop" { Mode::Fault } else { Mode::Disarmed };
        assert_eq!(status(&rig).mode, expected);
        let open =
            Client::connect(rig.port()).expect("a rig").parameters().expect("read").values.get(id::OPEN_LOOP);
        assert_eq!(open, Some(0), "its parameters are as they were");
    }
}

#[test]
fn a_page_that_goes_under_a_bring_up_leaves_the_drive_disarmed() {
    let (rig, runtime) = (rig(), runtime());
    let studio = studio_at(Some(rig.port()));
    let mut page = Page::open(&studio, &runtime).expect("a page");
    let asker = page.asker();
    std::thread::scope(|scope| {
        let asked =
            scope.spawn(move || asker.ask("bring-up", json!({ "push_wait_s": 0, "most_percent": 30 })));
        let told = page.wait_for(|line| !line["bring_up"]["question"].is_null());
        page.order("answer", json!({ "question": told["bring_up"]["question"]["number"], "yes": true }));
        drop(page);
        let (code, refused) = asked.join().expect("an answer");
        assert_eq!(code, StatusCode::CONFLICT, "{refused}");
        assert!(refused["error"].as_str().is_some_and(|why| why.contains("the page has gone")), "{refused}");
    });
    wait_for_mode(&rig, Mode::Disarmed);
}
