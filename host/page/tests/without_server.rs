//! The page without a server, in a browser: the numbers of the native program, bit for bit.
//!
//! Needs Chromium and the folder that `cargo xtask web` makes (`PNEUDRIVE_WEB`), so `cargo xtask test web` runs it.

#[allow(dead_code)] // It belongs to the tests of the studio, which use the rest.
#[path = "../../studio/tests/chromium/mod.rs"]
mod chromium;

use std::path::PathBuf;
use std::time::Instant;

use axum::Router;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use axum::http::header::CONTENT_TYPE;
use axum::response::IntoResponse;
use axum::routing::get;
use pneudrive_page::study::{Audience, Study};
use pneudrive_page::{Answer, answer};
use pneudrive_sim::rigfile::{BUILTIN, builtin};
use pneudrive_sim::{Accuracy, Rig, run};
use serde_json::{Value, json};

use chromium::Browser;

/// A record of servo-drive B.
const RECORD: &str = include_str!("../../tests/fixtures/TARGET-1.DAT");

/// The folder, served by a host that knows nothing of it but its files.
fn address() -> String {
    let folder = std::env::var_os("PNEUDRIVE_WEB").map(PathBuf::from);
    let folder = folder.expect("PNEUDRIVE_WEB: the folder of `cargo xtask web`");
    let listener = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    listener.set_nonblocking(true).expect("a socket");
    let address = listener.local_addr().expect("an address");
    let router = Router::new().route("/{name}", get(file)).with_state(folder);
    std::thread::spawn(move || {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
        runtime.block_on(async {
            let listener = tokio::net::TcpListener::from_std(listener).expect("a listener");
            axum::serve(listener, router).await
        })
    });
    format!("http://{address}/index.html")
}

async fn file(State(folder): State<PathBuf>, Path(name): Path<String>) -> impl IntoResponse {
    let kind = match name.rsplit('.').next() {
        Some("html") => "text/html; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        _ => "application/octet-stream",
    };
    match std::fs::read(folder.join(&name)) {
        Ok(bytes) => Ok(([(CONTENT_TYPE, kind)], bytes)),
        Err(_) => Err(StatusCode::NOT_FOUND),
    }
}

fn page() -> Browser {
    let mut page = Browser::open(&address(), [1440, 900]);
    page.wait_until("window.studio?.simulation.isAtRest && document.querySelector('.verdict.converged, .verdict.unconverged')");
    page
}

/// Rows, readings and commands of each built-in rig, to the last bit.
#[test]
fn every_built_in_rig_runs_to_the_bits_of_the_native_program() {
    let mut page = page();
    page.evaluate("window.answers = import('./server.js')");
    println!("rig, native ms, browser ms, ratio");
    for (name, text) in BUILTIN {
        let rig = Rig::builtin(name).expect("a built-in rig");
        let begun = Instant::now();
        let native = run(&rig, Accuracy::of(&rig)).expect("a run");
        let native_ms = begun.elapsed().as_secs_f64() * 1e3;
        let asked = json!({ "name": name, "text": text, "settings": [] });
        let found = page.evaluate(&format!(
            "(async () => {{ const {{ postForColumns }} = await window.answers; const begun = performance.now(); \
               const {{ head, time }} = await postForColumns('/api/run', {asked}); \
               return {{ bits: head.bits, rows: time.length, ms: performance.now() - begun }}; }})()"
        ));
        assert_eq!(found["bits"], json!(format!("{:016x}", native.bits())), "{name}");
        assert_eq!(found["rows"], json!(native.rows.len()), "{name}");
        let browser_ms = found["ms"].as_f64().expect("a time");
        println!("{name}, {native_ms:.1}, {browser_ms:.1}, {:.1}", browser_ms / native_ms);
    }
    assert_eq!(page.complaints, Vec::<String>::new());
}

/// What the page shows is what the native program answers, byte for byte: values, ranges, convergence, deviations.
#[test]
fn every_answer_is_that_of_the_native_program() {
    let mut page = page();
    page.evaluate("window.answers = import('./server.js')");
    let text = builtin("servo-b-tuned").expect("a built-in rig");
    let rig = json!({ "name": "servo-b-tuned", "text": text, "settings": ["load.mass=2500 g", "test.duration_s=0.5"] });
    let mut compared = rig.clone();
    compared["record"] = json!({ "name": "TARGET01.DAT", "text": RECORD });
    for (request, body) in [("check", &rig), ("ensemble", &rig), ("compare", &compared)] {
        let native = match answer(request, body, &|| true).expect(request) {
            Answer::Json(value) => value.to_string().into_bytes(),
            Answer::Columns(bytes) => bytes,
        };
        let found = page.evaluate(&format!(
            "window.answers.then(({{ ask }}) => ask('/api/{request}', {body})).then((bytes) => Array.from(new Uint8Array(bytes)))"
        ));
        let found: Vec<u8> = serde_json::from_value(found).expect("bytes");
        assert!(found == native, "{request}: {} and {} bytes", found.len(), native.len());
    }
}

/// A tuning with a small budget, on the one thread that a browser has for it: the figures of the native one, in every bit.
#[test]
fn a_study_finds_what_the_native_program_finds_and_tells_how_far_it_is() {
    let mut page = page();
    let text = builtin("servo-a").expect("a built-in rig");
    let goal = json!({
        "step_mm": 60.0, "settled_mm": 2.0, "overshoot_percent": 20.0, "time_s": 1.0, "load_percent": 30.0,
        "friction_percent": 30.0, "supply_percent": 0.0, "draws": 3, "population": 2, "generations": 1,
    });
    let body = json!({ "study": "tune", "name": "servo-a", "text": text, "settings": [], "goal": goal });
    let begun = Instant::now();
    let study = Study::read(&body).expect("a study");
    let mut heard = 0;
    let native = study.work(Audience { hears: &mut |_| heard += 1, waits: &|| true }).expect("found");
    let native_s = begun.elapsed().as_secs_f64();
    let begun = Instant::now();
    let found = page.evaluate(&format!(
        "import('./server.js').then(async ({{ study }}) => {{ const heard = []; \
         const found = await study({body}, new AbortController().signal, (at) => heard.push(at)); return {{ heard, found }}; }})"
    ));
    println!("a tuning: native {native_s:.1} s, browser {:.1} s", begun.elapsed().as_secs_f64());
    assert_eq!(found["heard"].as_array().map(Vec::len), Some(heard));
    assert_eq!(found["heard"][0]["what"], "taste", "how long it takes is told before it begins");
    assert_eq!(with_real_numbers(&found["found"]), with_real_numbers(&native));
}

/// A page writes 60.0 as 60: both are the same number.
fn with_real_numbers(value: &Value) -> Value {
    match value {
        Value::Number(number) => json!(number.as_f64()),
        Value::Array(items) => items.iter().map(with_real_numbers).collect(),
        Value::Object(fields) => {
            fields.iter().map(|(name, value)| (name.clone(), with_real_numbers(value))).collect()
        }
        other => other.clone(),
    }
}

#[test]
fn a_value_is_changed_and_the_run_its_band_and_its_figures_follow() {
    let mut page = page();
    page.click("#picture [data-id=load] .title");
    page.wait_until("document.querySelector('#inspector [data-key=\"load.mass_kg\"]')");
    page.evaluate(
        "(() => { const slider = document.querySelector('#inspector [data-key=\"load.mass_kg\"] input[type=range]'); \
         slider.value = slider.max; slider.dispatchEvent(new Event('input')); slider.dispatchEvent(new Event('change')); })()",
    );
    page.wait_until("document.querySelectorAll('#runs .ghost').length === 1 && studio.simulation.isAtRest");
    page.wait_until("document.querySelector('.verdict.converged, .verdict.unconverged')");
    let command = page.evaluate("document.getElementById('command').value");
    assert!(command.as_str().is_some_and(|line| line.contains("--set load.mass")), "{command}");
    assert_eq!(page.complaints, Vec::<String>::new());
}
