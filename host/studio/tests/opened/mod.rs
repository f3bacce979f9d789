//! A studio opened in a browser, for the tests that look at it.
//!
//! With `PNEUDRIVE_SHOTS=FOLDER` the tests write the pictures of docs/howto/studio.md there.

use std::fs;
use std::path::Path;
use std::process::Command;

use pneudrive_design::own_drive::rig_file;
use pneudrive_design::question::{Answers, question_of};
use pneudrive_sim::rigfile::builtin;
use pneudrive_studio::{Opened, Options, Studio};
use serde_json::json;

use crate::chromium::Browser;

const LAPTOP: [u32; 2] = [1440, 900];

/// A page of a studio that begins with a rig.
pub fn page_of(name: &str, text: &str) -> Browser {
    page_with(name, text, None)
}

/// The same with a rig at a port.
pub fn page_with(name: &str, text: &str, port: Option<&str>) -> Browser {
    let opened = Opened { name: name.to_owned(), text: text.to_owned() };
    let options =
        Options { listen: "127.0.0.1:0".to_owned(), token: None, opened, port: port.map(str::to_owned) };
    let studio = Studio::open(options).expect("a studio");
    let address = studio.address();
    std::thread::spawn(move || studio.serve());
    let mut page = Browser::open(&address, LAPTOP);
    wait_until_there(&mut page);
    page
}

/// Waits for the run of a page that was opened, and for what it rests on.
pub fn wait_until_there(page: &mut Browser) {
    page.wait_until("window.studio?.simulation.isAtRest && document.querySelector('.verdict.converged, .verdict.unconverged')");
}

pub fn page() -> Browser {
    page_of("servo-b-tuned", builtin("servo-b-tuned").expect("a built-in rig"))
}

/// The rig file of an own drive with a long path, as `rig new` writes it for its figures.
pub fn own_drive() -> (String, String) {
    let mut answers = Answers::default();
    let figures = [
        ("cylinder", "iso-15552-32"),
        ("stroke", "250 mm"),
        ("mass", "8 kg"),
        ("valve", "proportional-5-3-350"),
    ];
    for (question, figure) in figures {
        answers.answer(question_of(question).expect("a question"), figure);
    }
    let text = rig_file("press", &answers).expect("a rig file");
    ("/home/somebody/drives/of-the-second-line/press-with-the-long-name.toml".to_owned(), text)
}

/// Keeps a picture for the docs if that is asked for; it is no empty page in any case.
pub fn keep_picture(page: &mut Browser, name: &str) {
    let picture = page.picture();
    assert!(picture.len() > 40_000, "{name}: {} characters", picture.len());
    let Some(folder) = std::env::var_os("PNEUDRIVE_SHOTS") else { return };
    let file = Path::new(&folder).join(name);
    let encoded = file.with_extension("base64");
    fs::write(&encoded, picture).expect("written");
    let decoded = Command::new("base64").arg("-d").arg(&encoded).output().expect("base64");
    fs::write(&file, decoded.stdout).expect("written");
    fs::remove_file(encoded).expect("removed");
}

/// Runs the test of the page, and agrees that the drive goes to its start where the page asks; what it has asked.
pub fn run_the_test(page: &mut Browser) -> String {
    let button = "[...document.querySelectorAll('#commission button')].find((one) => one.textContent.startsWith('Run'))";
    let is_running = "document.querySelector('#commission .mode').textContent === 'running'";
    page.wait_until(&format!("{button}?.disabled === false"));
    page.evaluate(&format!("{button}.click()"));
    page.wait_until(&format!("document.getElementById('dialog') || {is_running}"));
    let asked = page.evaluate("document.querySelector('#dialog p')?.textContent ?? ''");
    page.evaluate("document.querySelector('#dialog button.main')?.click()");
    let problem = "document.querySelector('#commission .problem').textContent";
    let is_refused = format!("/^(not run|disarmed)/.test({problem})");
    page.wait_until(&format!("{is_running} || {is_refused}"));
    assert_eq!(page.evaluate(&is_refused), json!(false), "{}", page.evaluate(problem));
    asked.as_str().unwrap_or_default().to_owned()
}

/// Drops a file on the page.
pub fn drop_file(page: &mut Browser, name: &str, text: &str) {
    page.evaluate(&format!(
        "(() => {{ const files = new DataTransfer(); files.items.add(new File([{}], {name:?})); \
         document.dispatchEvent(new DragEvent('drop', {{ dataTransfer: files, bubbles: true, cancelable: true }})); }})()",
        json!(text)
    ));
}

/// Drops a file or a folder of this machine on the page, as a hand does.
pub fn drop_path(page: &mut Browser, path: &Path) {
    let data = json!({ "items": [], "files": [path], "dragOperationsMask": 1 });
    for kind in ["dragEnter", "dragOver", "drop"] {
        page.call("Input.dispatchDragEvent", json!({ "type": kind, "x": 500, "y": 400, "data": data }));
    }
}

/// Chooses a file or a folder of this machine in a field for files.
pub fn choose_path(page: &mut Browser, field: &str, path: &Path) {
    let expression = format!("document.querySelector({field:?})");
    let found = page.call("Runtime.evaluate", json!({ "expression": expression }));
    let object = &found["result"]["objectId"];
    page.call("DOM.setFileInputFiles", json!({ "files": [path], "objectId": object }));
}

/// From now on the page waits for the answers of these requests: `held[path]` has those that wait, `letGo(path)` hands the
/// first of them over.
pub fn hold(page: &mut Browser, paths: &[&str]) {
    page.evaluate(&format!(
        "(() => {{ const ask = window.fetch; window.held = {{}}; for (const path of {}) held[path] = []; \
         window.letGo = (path) => held[path].shift()(); \
         window.fetch = async (path, options) => {{ const answer = await ask(path, options); \
         if (path in held) await new Promise((go) => held[path].push(go)); return answer; }}; }})()",
        json!(paths)
    ));
}

/// What comes from now on is handed over at once.
pub fn hold_nothing(page: &mut Browser) {
    page.evaluate("for (const path of Object.keys(held)) { const all = held[path]; delete held[path]; all.forEach((go) => go()); }");
}

/// Time in which the page would do what it must not.
pub fn rest(page: &mut Browser) {
    page.evaluate("new Promise((go) => setTimeout(go, 400))");
}

/// In the form of an identification, leaves these alone of all that may be unknown.
pub fn leave_unknown(page: &mut Browser, keys: &[&str]) {
    page.wait_until("document.querySelector('#study .choices input')");
    page.evaluate(&format!(
        "for (const box of document.querySelectorAll('#study .choices input')) if (box.checked !== {}.includes(box.value)) box.click()",
        json!(keys)
    ));
}
