//! A rig checked, simulated and saved.

use std::fs;

use axum::http::{Method, StatusCode};
use pneudrive_evaluate::deviation;
use pneudrive_evaluate::evaluation::{moves_of_run, table, tolerance_mm};
use pneudrive_evaluate::transient::Transient;
use pneudrive_records::run_folder::StoredRun;
use pneudrive_records::target::TargetFile;
use pneudrive_sim::{Accuracy, Rig, run};
use serde_json::{Value, json};

use crate::simulated::simulate;
use crate::visitor::{self, ask_as_page, post_rig, studio, studio_with};

/// Head, times, and the columns by name.
fn columns(bytes: &[u8]) -> (Value, Vec<f64>, impl Fn(&str) -> Vec<f32> + use<>) {
    let length = u32::from_le_bytes(bytes[..4].try_into().expect("a length")) as usize;
    let head: Value = serde_json::from_slice(&bytes[4..4 + length]).expect("JSON");
    let rows = head["rows"].as_u64().expect("rows") as usize;
    let data = &bytes[4 + length..];
    let time =
        data[..8 * rows].chunks(8).map(|number| f64::from_le_bytes(number.try_into().expect("8 bytes")));
    let time = time.collect();
    let values: Vec<f32> = data[8 * rows..]
        .chunks(4)
        .map(|number| f32::from_le_bytes(number.try_into().expect("4 bytes")))
        .collect();
    let names: Vec<String> = head["columns"]
        .as_array()
        .expect("columns")
        .iter()
        .map(|one| one["name"].as_str().expect("a name").to_owned())
        .collect();
    assert_eq!(values.len(), rows * names.len());
    let column = move |name: &str| {
        let place = names.iter().position(|other| other == name).expect("a column");
        values[place * rows..(place + 1) * rows].to_vec()
    };
    (head, time, column)
}

#[test]
fn the_curves_and_figures_of_the_page_are_those_of_the_simulator() {
    let answer = post_rig(&studio(), "/api/run", "servo-b-tuned", &["load.mass_kg=2.5"]);
    assert_eq!(answer.status, StatusCode::OK, "{}", answer.text());
    let (head, time, column) = columns(&answer.body);
    let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig");
    let rig = rig.with_settings(&["load.mass_kg=2.5".to_owned()]).expect("a rig");
    let run = run(&rig, Accuracy::of(&rig)).expect("a run");
    assert_eq!(time, run.rows.iter().map(|row| row.time).collect::<Vec<_>>());
    let positions: Vec<f32> = run.rows.iter().map(|row| (row.plant.position * 1e3) as f32).collect();
    assert_eq!(column("position"), positions);
    let pressures: Vec<f32> = run.rows.iter().map(|row| (row.plant.pressures[0] * 1e-3) as f32).collect();
    assert_eq!(column("pressure 1"), pressures);
    let figures = table(&[moves_of_run(&rig, &run)], tolerance_mm(Some(&rig)));
    assert_eq!(head["figures"]["rows"], json!(figures.rows));
    assert_eq!(head["fault"], Value::Null);
}

#[test]
fn the_perturbed_runs_tell_a_band_ranges_and_whether_the_run_is_converged() {
    let answer = post_rig(&studio(), "/api/ensemble", "servo-b-tuned", &["test.duration_s=0.6"]);
    let (head, time, _) = columns(&answer.body);
    let notes = head["notes"].as_array().expect("notes");
    let converged = notes[1].as_str().expect("a sentence").starts_with("converged");
    assert_eq!(head["converged"], json!(converged));
    assert!(notes[2].as_str().is_some_and(|note| note.starts_with("7 perturbed runs")), "{notes:?}");
    // Each channel has its lowest and then its highest values.
    let names = head["columns"].as_array().expect("columns");
    assert_eq!(names[0], names[1]);
    assert!(names.len() == 14 && !time.is_empty());
    let rows = head["figures"]["rows"].as_array().expect("rows");
    assert!(rows.iter().any(|row| row[0].as_str().is_some_and(|first| first.trim() == "most")), "{rows:?}");
}

#[test]
fn a_wrong_value_is_told_at_its_key_in_the_words_of_rig_check() {
    let studio = studio();
    let text = pneudrive_sim::rigfile::builtin("servo-b-tuned").expect("a built-in rig");
    for setting in [
        "load.mass_kg=-1",
        "load.mass=8 furlongs",
        "supply.pressure_pa=1000",
        "load.mas_kg=1",
        "operator.model=steam",
    ] {
        let problems = Rig::read_with("servo-b-tuned", text, &[setting.to_owned()]).expect_err(setting);
        let expected: Vec<Value> = problems
            .0
            .iter()
            .map(|one| json!({ "key": one.key, "line": one.line, "message": one.message }))
            .collect();
        let answer = post_rig(&studio, "/api/check", "servo-b-tuned", &[setting]);
        assert_eq!(answer.json()["problems"], json!(expected), "{setting}");
        let answer = post_rig(&studio, "/api/run", "servo-b-tuned", &[setting]);
        assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY);
        assert_eq!(answer.json()["problems"], json!(expected), "{setting}");
    }
}

#[test]
fn values_come_with_their_origin_and_only_keys_of_the_chosen_models_are_shown() {
    let studio = studio();
    let text = "[load]\nmass = { typical = \"8 kg\", low = \"4 kg\", high = \"9 kg\", from = \"a book\" }\n";
    let body = json!({ "name": "own.toml", "text": text, "settings": ["load.friction=coulomb"] });
    let found = ask_as_page(&studio, Method::POST, "/api/check", Some(body)).json();
    let mass = &found["values"]["load.mass_kg"];
    assert_eq!((&mass["number"], &mass["origin"]), (&json!(8.0), &json!("typical")), "{found}");
    assert_eq!(mass["origin_in_words"], "typical, 4 to 9 kg: a book");
    assert_eq!(mass["range"], json!([4.0, 9.0]));
    let used = found["used"].as_array().expect("used");
    assert!(
        used.contains(&json!("load.mass_kg")) && !used.contains(&json!("load.bristle_stiffness_n_per_m"))
    );
    assert_eq!(found["command"], "pneudrive simulate own.toml --set load.friction=coulomb --out sim");
}

#[test]
fn a_test_too_long_for_a_page_is_refused_with_what_to_do() {
    let answer = post_rig(&studio(), "/api/run", "servo-b-tuned", &["test.duration_s=1000"]);
    assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY);
    assert!(answer.text().contains("test.duration_s") && answer.text().contains("pneudrive simulate"));
}

const OWN: &str = "# My drive.\nname = \"own\"\n\n[load]\nmass = \"8 kg\"   # weighed\nstatic_extend_n = { typical = 70.0, low = 20, high = 100, from = \"a book\" }\n";

#[test]
fn a_saved_rig_keeps_comments_and_origins_and_is_the_rig_that_was_shown() {
    let folder = tempfile::tempdir().expect("a folder");
    let own = folder.path().join("own.toml");
    fs::write(&own, OWN).expect("written");
    let studio = studio_with(own.to_str().expect("a path"), OWN);
    let settings = ["load.mass=9000 g", "supply.pressure=5 bar(g)"];
    let body = json!({ "name": "own.toml", "text": OWN, "settings": settings, "file": "own.toml" });
    let answer = ask_as_page(&studio, Method::POST, "/api/save", Some(body));
    assert_eq!(answer.status, StatusCode::OK, "{}", answer.text());
    let text = fs::read_to_string(&own).expect("saved");
    assert!(text.starts_with("# My drive.\n") && text.contains("typical = 70.0"), "{text}");
    let shown = Rig::read_with("own.toml", OWN, &settings.map(str::to_owned)).expect("a rig");
    let saved = Rig::read("own.toml", &text).expect("a rig");
    assert_eq!(saved.number_at("load.mass_kg"), Some(9.0));
    let differences = pneudrive_design::difference::differences(&shown, &saved);
    assert!(differences.is_empty(), "{differences:?}");
    assert_eq!(answer.json()["text"], text);
    // A page that is opened now begins with it; one that was opened before is asked.
    let opened = ask_as_page(&studio, Method::GET, "/api/rigs", None).json()["opened"].clone();
    assert_eq!(opened, json!({ "name": own, "text": text }));
    assert_eq!(ask_as_page(&studio, Method::GET, "/api/rigs/own.toml", None).json()["text"], text);
    let stale = json!({ "name": "own.toml", "text": OWN, "settings": [], "file": "own.toml" });
    let answer = ask_as_page(&studio, Method::POST, "/api/save", Some(stale));
    assert_eq!(answer.status, StatusCode::CONFLICT);
    assert!(
        answer.text().contains("was saved by another page since this one opened it"),
        "{}",
        answer.text()
    );
}

#[test]
fn a_file_that_is_not_ours_is_replaced_only_if_the_user_agrees() {
    let folder = tempfile::tempdir().expect("a folder");
    let [own, theirs] = ["own.toml", "theirs.toml"].map(|name| folder.path().join(name));
    fs::write(&own, OWN).expect("written");
    fs::write(&theirs, "name = \"theirs\"\n").expect("written");
    let studio = studio_with(own.to_str().expect("a path"), OWN);
    let save = |file: &str, replace: bool| {
        let body = json!({ "name": "own.toml", "text": OWN, "settings": ["load.mass_kg=9"], "file": file, "replace": replace });
        ask_as_page(&studio, Method::POST, "/api/save", Some(body)).status
    };
    assert_eq!(save("theirs.toml", false), StatusCode::CONFLICT);
    assert_eq!(fs::read_to_string(&theirs).expect("there"), "name = \"theirs\"\n");
    assert_eq!(save("theirs.toml", true), StatusCode::OK);
    assert_eq!(save("own.toml", false), StatusCode::OK, "it was opened here");
    assert_eq!(save("new.toml", false), StatusCode::OK);
    assert_eq!(save("new.toml", false), StatusCode::OK, "it was written here");
    fs::write(&own, "name = \"changed meanwhile\"\n").expect("written");
    assert_eq!(save("own.toml", false), StatusCode::CONFLICT, "someone has changed it");
    for name in ["../own.toml", "own.txt", "/tmp/own.toml"] {
        assert_eq!(save(name, true), StatusCode::BAD_REQUEST, "{name}");
    }
}

#[test]
fn a_rig_that_is_not_valid_is_not_saved() {
    let folder = tempfile::tempdir().expect("a folder");
    let own = folder.path().join("own.toml");
    let studio = studio_with(own.to_str().expect("a path"), OWN);
    let body =
        json!({ "name": "own.toml", "text": OWN, "settings": ["load.mass_kg=-1"], "file": "own.toml" });
    let answer = ask_as_page(&studio, Method::POST, "/api/save", Some(body));
    assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY);
    assert!(!own.exists());
}

const RECORD: &str = include_str!("../../tests/fixtures/TARGET-1.DAT");

fn compare(text: &str) -> visitor::Answer {
    let rig = pneudrive_sim::rigfile::builtin("servo-b-tuned");
    let record = json!({ "name": "TARGET01.DAT", "text": text });
    let body = json!({ "name": "servo-b-tuned", "text": rig, "settings": [], "record": record });
    ask_as_page(&studio(), Method::POST, "/api/compare", Some(body))
}

#[test]
fn a_record_is_compared_with_the_run_as_overlay_does_it() {
    let answer = compare(RECORD);
    assert_eq!(answer.status, StatusCode::OK, "{}", answer.text());
    let (head, time, column) = columns(&answer.body);
    let file = TargetFile::from_text(RECORD).expect("a TARGET file");
    let recorded = Transient::of_target("TARGET01.DAT", &file).expect("a transient");
    assert_eq!(time, recorded.time);
    assert_eq!(f64::from(column("position")[7]), f64::from(recorded.channels[1][7] as f32));
    let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig");
    let run = run(&rig, Accuracy::of(&rig)).expect("a run");
    let simulated = Transient::of_run("servo-b-tuned", &StoredRun::of(&rig, &run));
    let expected = deviation::table("", &deviation::deviations(&recorded, &simulated));
    assert_eq!(head["deviation"]["rows"], json!(expected.rows));
}

/// Below a run of a rig whose encoder counts twice as finely.
#[test]
fn the_error_of_a_record_is_in_counts_of_the_run_below_it_and_its_figures_are_its_own() {
    let rig = pneudrive_sim::rigfile::builtin("servo-b-tuned").expect("a built-in rig");
    let folder = tempfile::tempdir().expect("a folder");
    simulate(&Rig::read("servo-b-tuned", rig).expect("a rig"), folder.path());
    let [run_json, trace_csv] =
        ["run.json", "trace.csv"].map(|name| fs::read_to_string(folder.path().join(name)).expect("there"));
    let compare = |settings: &[&str]| {
        let record = json!({ "name": "before", "run_json": run_json, "trace_csv": trace_csv });
        let body = json!({ "name": "servo-b-tuned", "text": rig, "settings": settings, "record": record });
        let answer = ask_as_page(&studio(), Method::POST, "/api/compare", Some(body));
        assert_eq!(answer.status, StatusCode::OK, "{}", answer.text());
        let (head, _, column) = columns(&answer.body);
        (head, column("error").to_vec())
    };
    let ((head, same), (other, doubled)) = (compare(&[]), compare(&["encoder.mm_per_count=0.006025"]));
    assert!(same.iter().any(|error| error.abs() > 100.0));
    for (counts, double) in same.iter().zip(&doubled) {
        assert!((2.0 * counts - double).abs() <= 1e-3 * counts.abs(), "{counts} and {double}");
    }
    let figures = &head["figures"];
    assert!(figures["heading"].as_str().is_some_and(|heading| heading.starts_with("before, a run of ")));
    for figure in ["overshoot", "settled", "steady error"] {
        let has = |name: &serde_json::Value| name.as_str().is_some_and(|name| name.contains(figure));
        assert!(figures["columns"].as_array().expect("columns").iter().any(has), "{figures}");
    }
    // Another drive has other figures, and the record has not.
    let second =
        |head: &serde_json::Value| (1..12).map(|k| head["figures"]["rows"][1][k].clone()).collect::<Vec<_>>();
    assert_eq!(second(&head), second(&other));
}

#[test]
fn a_damaged_record_is_refused_with_its_name() {
    let damaged = RECORD.replacen("servo-b-tuned", "servo-b-tunes", 1);
    for text in ["", "no record", &damaged, &RECORD[..RECORD.len() / 2]] {
        let answer = compare(text);
        assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY);
        assert!(answer.json()["error"].as_str().is_some_and(|why| why.starts_with("TARGET01.DAT: ")));
    }
}

#[test]
fn a_run_folder_is_compared_with_the_run_as_overlay_does_it_and_a_damaged_one_refused() {
    let text = pneudrive_sim::rigfile::builtin("servo-b-tuned").expect("a built-in rig");
    let rig = |settings: &[&str]| {
        let settings: Vec<String> = settings.iter().map(|one| (*one).to_owned()).collect();
        Rig::read_with("servo-b-tuned", text, &settings).expect("a rig")
    };
    let folder = tempfile::tempdir().expect("a folder");
    simulate(&rig(&["load.mass_kg=3"]), folder.path());
    let [run_json, trace_csv] =
        ["run.json", "trace.csv"].map(|name| fs::read_to_string(folder.path().join(name)).expect("there"));
    let compare = |path: &str, trace: &str| {
        let record = json!({ "name": "heavier", "run_json": run_json, "trace_csv": trace });
        let mut body = json!({ "name": "servo-b-tuned", "text": text, "record": record });
        (body["channel"], body["from_s"], body["to_s"]) = (json!("position"), json!(0.0), json!(0.5));
        ask_as_page(&studio(), Method::POST, path, Some(body))
    };
    let answer = compare("/api/compare", &trace_csv);
    assert_eq!(answer.status, StatusCode::OK, "{}", answer.text());
    let (head, ..) = columns(&answer.body);
    let [heavier, here] = [&["load.mass_kg=3"][..], &[]].map(|settings| {
        let rig = rig(settings);
        Transient::of_run("a run", &StoredRun::of(&rig, &run(&rig, Accuracy::of(&rig)).expect("a run")))
    });
    let expected = deviation::table("", &deviation::deviations(&heavier, &here));
    assert_eq!(head["deviation"]["rows"], json!(expected.rows));
    let heading = head["deviation"]["heading"].as_str().expect("a heading");
    assert!(heading.ends_with(&format!("from heavier, a run of {}", rig(&[]).name())), "{heading}");
    assert_eq!(compare("/api/spectrum", &trace_csv).status, StatusCode::OK);
    let truncated = &trace_csv[..trace_csv.trim_end().rfind('\n').expect("rows") + 1];
    let refused = compare("/api/compare", truncated);
    assert_eq!(refused.status, StatusCode::UNPROCESSABLE_ENTITY);
    let why = refused.json()["error"].as_str().expect("a reason").to_owned();
    assert!(why.starts_with("heavier/trace.csv has") && why.contains("truncated"), "{why}");
}
