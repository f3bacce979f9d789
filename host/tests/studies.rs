//! What the studio's page finds is what the commands find, in every figure: the command line that the page shows, run with
//! `--json` in a folder with the files that the page offers.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use pneudrive_page::study::{Audience, Study};
use pneudrive_sim::rigfile::builtin;
use serde_json::{Value, json};

use crate::program::{STROKES, folder, recorded_with};

/// What the page shows before, hears of, and finds.
fn on_the_page(body: &Value) -> (Value, Vec<Value>, Value) {
    let study = Study::read(body).expect("a study");
    let plan = study.plan().expect("a plan");
    let mut heard = Vec::new();
    let found = study.work(Audience { hears: &mut |line| heard.push(line), waits: &|| true });
    (plan, heard, found.expect("found"))
}

/// The result of a command line of the page, as a shell takes it.
fn of_the_command(folder: &Path, plan: &Value) -> Value {
    let line = plan["command"].as_str().expect("a command line");
    let program = Path::new(env!("CARGO_BIN_EXE_pneudrive")).parent().expect("a folder").display();
    let script = format!("PATH={program}:$PATH {line} --json");
    let output = Command::new("sh").args(["-c", &script]).current_dir(folder).output().expect("a shell");
    let document: Value = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|error| panic!("{error}: {}", String::from_utf8_lossy(&output.stderr)));
    document["result"].clone()
}

#[test]
fn a_sweep_of_the_page_is_that_of_the_command() {
    let text = builtin("servo-b-tuned").expect("a built-in rig");
    let (plan, heard, found) = on_the_page(&json!({
        "study": "sweep", "name": "servo-b-tuned", "text": text,
        "settings": ["load.viscous_n_s_per_m=26", "test.duration=400 ms", "name=\"mine\""],
        "vary": [
            { "key": "load.mass_kg", "from": 1.0, "to": 4.0, "steps": 3, "logarithmic": true },
            { "key": "operator.model", "words": ["solenoid", "solenoid-empirical"] },
        ],
        "metrics": ["settling_s", "top_speed_mm_s"],
        "objective": { "aim": "minimise", "metric": "top_speed_mm_s" },
        "runs": 2,
    }));
    assert_eq!(plan["size"], "6 points x 2 runs");
    assert_eq!(heard.last(), Some(&json!({ "what": "points", "done": 6, "all": 6 })));
    let folder = folder();
    fs::write(folder.path().join("sweep.toml"), plan["file"]["text"].as_str().expect("a text"))
        .expect("written");
    assert_eq!(found["result"], of_the_command(folder.path(), &plan));
    let rows = found["result"]["rows"].as_array().expect("rows");
    let best = &rows[found["result"]["best"].as_u64().expect("a point") as usize];
    let taken = [&best["levels"]["load.mass_kg"], &best["levels"]["operator.model"]];
    assert_eq!(
        found["settings"],
        json!([
            format!("load.mass_kg={:?}", taken[0].as_f64().expect("a mass")),
            format!("operator.model={}", taken[1].as_str().expect("a word"))
        ])
    );
    let figures = found["page"]["figures"].as_array().expect("graphs");
    assert_eq!(figures.len(), 2, "over each key");
}

#[test]
fn a_tuning_of_the_page_is_that_of_the_command() {
    let text = builtin("servo-a").expect("a built-in rig");
    let (plan, heard, found) = on_the_page(&json!({
        "study": "tune", "name": "servo-a", "text": text, "settings": ["controller.gain_profile=[65535]"],
        "goal": {
            "step_mm": 60.0, "settled_mm": 2.0, "overshoot_percent": 20.0, "time_s": 1.5, "load_percent": 30.0,
            "friction_percent": 30.0, "supply_percent": 0.0, "draws": 5, "population": 3, "generations": 2,
        },
    }));
    assert_eq!(heard[0]["what"], "taste", "how long it takes at most is told before it begins");
    assert!(heard[0]["all"].as_f64() > heard[0]["done"].as_f64(), "{}", heard[0]);
    assert!(heard.iter().any(|line| line["what"] == "runs of the search"));
    let folder = folder();
    assert_eq!(found["result"], of_the_command(folder.path(), &plan));
    assert_eq!(found["settings"], found["result"]["after"]["settings"]);
    let note = found["page"]["notes"][0].as_str().expect("a verdict");
    assert!(note.contains("95 % intervals"), "{note}");
}

#[test]
fn an_identification_of_the_page_is_that_of_the_command() {
    let folder = folder();
    recorded_with(folder.path(), STROKES, &[("load.mass_kg", 1.8), ("load.viscous_n_s_per_m", 26.0)]);
    let record = fs::read_to_string(folder.path().join("TARGET01.DAT")).expect("a record");
    let (plan, heard, found) = on_the_page(&json!({
        "study": "identify", "name": "rig.toml", "text": STROKES, "settings": [],
        "records": [{ "name": "TARGET01.DAT", "text": record }],
        "fit": ["load.mass_kg", "load.viscous_n_s_per_m", "load.stop_stiffness_n_per_m"],
    }));
    assert!(
        plan["unknowns"].as_array().is_some_and(|all| all.iter().any(|one| one["key"] == "load.mass_kg"))
    );
    assert!(!heard.is_empty());
    let result = of_the_command(folder.path(), &plan);
    assert_eq!(found["result"], result);
    let estimates = result["parameters"].as_array().expect("parameters").iter();
    let taken = estimates.map(|one| {
        format!("{}={:?}", one["key"].as_str().expect("a key"), one["estimate"].as_f64().expect("a value"))
    });
    assert_eq!(found["settings"], json!(taken.collect::<Vec<_>>()), "the unseen one keeps the file's value");
    let panels = found["page"]["figures"][0]["panels"].as_array().expect("panels");
    assert_eq!(panels[0]["curves"].as_array().map(Vec::len), Some(3), "measured, before and after");
}

#[test]
fn a_study_is_given_up_when_nobody_waits_for_it_any_more() {
    let folder = folder();
    recorded_with(folder.path(), STROKES, &[("load.mass_kg", 1.8)]);
    let record = fs::read_to_string(folder.path().join("TARGET01.DAT")).expect("a record");
    let text = builtin("servo-a").expect("a built-in rig");
    let goal = &pneudrive_page::study::choices()["goal"];
    for body in [
        json!({
            "study": "sweep", "name": "servo-a", "text": text, "settings": [], "metrics": ["settling_s"], "runs": 1,
            "vary": [{ "key": "load.mass_kg", "from": 1.0, "to": 4.0, "steps": 10_000 }],
        }),
        json!({ "study": "tune", "name": "servo-a", "text": text, "settings": [], "goal": goal }),
        json!({
            "study": "identify", "name": "rig.toml", "text": STROKES, "settings": [],
            "records": [{ "name": "TARGET01.DAT", "text": record }],
        }),
    ] {
        let asked = AtomicUsize::new(0);
        let waits = || asked.fetch_add(1, Ordering::Relaxed) < 12;
        let begun = Instant::now();
        let work = Study::read(&body).expect("a study").work(Audience { hears: &mut |_| {}, waits: &waits });
        let refusal = work.expect_err("nobody waits");
        assert_eq!(refusal.status.as_u16(), 410, "{}", refusal.message);
        assert!(begun.elapsed() < Duration::from_secs(20), "{}: {:?}", body["study"], begun.elapsed());
    }
}

#[test]
fn what_is_wrong_is_told_before_any_work() {
    let text = builtin("servo-b-tuned").expect("a built-in rig");
    let vary =
        |vary: Value| json!({ "study": "sweep", "vary": [vary], "metrics": ["settling_s"], "runs": 1 });
    let mass = json!({ "key": "load.mass_kg", "from": 1.0, "to": 2.0, "steps": 20_000 });
    let wrong = [
        (vary(json!({ "key": "load.mass_kg", "from": 1.0 })), "load.mass_kg: give from, to"),
        (vary(json!({ "key": "load.mas_kg", "words": [] })), "there is no key \"load.mas_kg\""),
        (vary(json!({ "key": "load.mass_kg", "from": -1.0, "to": 2.0, "steps": 3 })), "load.mass_kg"),
        (vary(mass), "20000 points: the studio sweeps over 10000 at most; `pneudrive sweep` takes more"),
        (json!({ "study": "identify", "records": [{ "name": "a.dat", "text": "steam" }] }), "a.dat: "),
        (json!({ "study": "identify", "records": [], "fit": ["load.mas_kg"] }), "load.mas_kg"),
    ];
    for (mut body, message) in wrong {
        for (name, value) in
            [("name", json!("servo-b-tuned")), ("text", json!(text)), ("settings", json!([]))]
        {
            body[name] = value;
        }
        let study = Study::read(&body).expect("a study");
        let refusal = study.plan().expect_err(message);
        assert!(refusal.status.as_u16() == 422 && refusal.message.contains(message), "{}", refusal.message);
        let work = study.work(Audience { hears: &mut |line| panic!("{line}"), waits: &|| true });
        assert!(work.is_err(), "{message}");
    }
}
