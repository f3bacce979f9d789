//! The orders of the page to the drive, and the stop, which waits for none of them.
//!
//! Needs Chromium, so `cargo xtask test web` runs it, and `cargo test --workspace` does not.

use std::thread::sleep;
use std::time::{Duration, Instant};

use pneudrive_link::client::Client;
use pneudrive_protocol::Mode;
use pneudrive_rigs::virtual_rig::{Background, Listener, Pace, VirtualRig};
use pneudrive_sim::Rig;
use pneudrive_sim::rigfile::builtin;
use serde_json::json;

use crate::chromium::Browser;
use crate::opened::{page, page_with};

/// No machine is so slow.
const PATIENCE: Duration = Duration::from_secs(30);

/// A page beside a virtual rig, and another program that looks at that.
fn beside_rig() -> (Browser, Background, Client) {
    let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig");
    let rig = VirtualRig::new(rig, 0, Pace { fast: false, live: true }).expect("a rig");
    let rig = Background::start(rig, Listener::open("tcp:127.0.0.1:0").expect("a port"));
    let text = builtin("servo-b-tuned").expect("a built-in rig");
    let page = page_with("servo-b-tuned", text, Some(rig.port()));
    let other = Client::connect(rig.port()).expect("a rig");
    (page, rig, other)
}

fn wait_for_fault(drive: &mut Client) {
    let begun = Instant::now();
    while drive.status().expect("a status").mode != Mode::Fault {
        assert!(begun.elapsed() < PATIENCE, "it is not stopped");
        sleep(Duration::from_millis(10));
    }
}

/// Orders with a server that answers when it is told to: `sent` has what has come there.
const ORDERS: &str = "import('/orders.js').then(({ Orders }) => {
  window.sent = [];
  window.answers = [];
  window.stopped = [];
  const post = (path, { order, number }) => {
    sent.push(number === undefined ? order : `${order} ${number}`);
    return new Promise((resolve, reject) => answers.push({ resolve, reject }));
  };
  window.orders = new Orders(post, { stopped: (problem) => stopped.push(problem) });
  window.settled = () => new Promise((go) => setTimeout(go));
})";

#[test]
fn a_confirmation_is_out_once_and_is_not_sent_when_its_button_was_let_go() {
    let mut page = page();
    page.evaluate(ORDERS);
    page.evaluate(
        "window.isHeld = true; orders.give(1, 'release'); \
         for (let k = 0; k < 5; k += 1) { orders.give(1, 'extend', {}, () => isHeld); orders.give(1, 'alive'); } settled()",
    );
    assert_eq!(page.evaluate("sent"), json!(["release 1"]));
    page.evaluate("answers.shift().resolve(); settled()");
    page.evaluate("answers.shift().resolve(); settled()");
    page.evaluate("answers.shift().resolve(); settled()");
    assert_eq!(page.evaluate("sent"), json!(["release 1", "extend 1", "alive 1"]));
    page.evaluate(
        "orders.give(1, 'alive'); orders.give(1, 'extend', {}, () => isHeld); isHeld = false; orders.give(1, 'release'); settled()",
    );
    page.evaluate("answers.shift().resolve(); settled()");
    let all = json!(["release 1", "extend 1", "alive 1", "alive 1", "release 1"]);
    assert_eq!(page.evaluate("sent"), all, "nobody holds it");
}

#[test]
fn what_waits_when_the_drive_is_stopped_is_not_carried_out_and_it_is_stopped_again() {
    let mut page = page();
    page.evaluate(ORDERS);
    page.evaluate(
        "orders.give(1, 'arm'); orders.give(1, 'run'); settled().then(() => { orders.stop(); orders.give(2, 'home'); return settled(); })",
    );
    assert_eq!(page.evaluate("sent"), json!(["arm 1", "stop"]), "the stop waits for nothing");
    page.evaluate("answers.splice(0).forEach(({ resolve }) => resolve()); settled()");
    assert_eq!(page.evaluate("sent"), json!(["arm 1", "stop", "stop"]), "the first may have come before");
    page.evaluate("answers.shift().reject(new Error('no rig')); settled()");
    assert_eq!(page.evaluate("sent"), json!(["arm 1", "stop", "stop", "home 2"]), "made behind the stop");
    assert_eq!(page.evaluate("stopped"), json!(["", "no rig"]));
}

/// Nothing listens at the port, and the page stands in another view.
#[test]
fn a_stop_that_fails_is_told_in_every_view() {
    let text = builtin("servo-b-tuned").expect("a built-in rig");
    let mut page = page_with("servo-b-tuned", text, Some("tcp://127.0.0.1:1"));
    page.press("Escape", 27, false);
    page.wait_until("document.querySelector('#state.wrong')?.textContent.startsWith('NOT STOPPED: ')");
    page.click("#to-study");
    assert!(page.text("#state").starts_with("NOT STOPPED: "));
}

#[test]
fn a_stream_that_is_left_and_a_request_that_is_called_off_hold_no_connection() {
    let mut page = page();
    page.evaluate(
        "window.ended = 0; window.fetch = async (path) => ({ ok: true, status: 200, json: () => new Promise(() => {}), \
         body: new ReadableStream({ start: (sink) => sink.enqueue(new TextEncoder().encode('{}\\n')), cancel: () => { ended += 1; } }) })",
    );
    page.evaluate(
        "import('/server.js').then(async ({ lines }) => { for (let k = 0; k < 9; k += 1) for await (const line of lines('/a')) break; })",
    );
    assert_eq!(page.evaluate("ended"), json!(9), "more than there are connections");
    page.evaluate(
        "import('/server.js').then(({ post }) => { for (let k = 0; k < 9; k += 1) post('/a', {}); \
         const end = new AbortController(); window.waits = post('/a', {}, end.signal).catch(({ name }) => name); end.abort(); })",
    );
    assert_eq!(page.evaluate("waits"), json!("AbortError"));
}

/// A browser opens six connections to a server; three of those that are not left to orders have slow requests.
#[test]
fn a_stop_waits_for_no_slow_request_of_the_page() {
    let (mut page, _rig, mut other) = beside_rig();
    let is = |mode: &str| format!("document.querySelector('#commission .mode').textContent === '{mode}'");
    page.click("#to-commission");
    page.click("#commission button.main");
    page.wait_until(&is("disarmed"));
    let arm = "[...document.querySelectorAll('#commission button')].find((one) => one.textContent === 'Arm')";
    page.wait_until(&format!("!{arm}.disabled"));
    page.evaluate(&format!("{arm}.click()"));
    page.wait_until(&is("armed"));
    page.evaluate(
        "import('/server.js').then(async ({ get, post }) => { const rig = await get('/api/rigs/servo-b-tuned'); \
         const ask = window.fetch; window.begun = 0; window.ended = 0; window.slow = new AbortController(); \
         window.fetch = (path, options) => { begun += path === '/api/ensemble'; return ask(path, options); }; \
         for (let k = 0; k < 12; k += 1) post('/api/ensemble', { ...rig, settings: ['test.duration_s=250'] }, slow.signal).finally(() => { ended += 1; }).catch(() => {}); })",
    );
    page.wait_until("begun >= 3");
    page.press("Escape", 27, false);
    wait_for_fault(&mut other);
    assert_eq!(page.evaluate("ended"), json!(0), "the slow requests were over before the stop");
    page.evaluate("slow.abort()");
    page.wait_until(&is("fault"));
    assert!(page.text("#commission").contains("a stop was requested"));
}

/// All but the dialog takes no clicks.
#[test]
fn a_drive_is_stopped_by_the_pointer_while_a_question_is_asked() {
    let (mut page, _rig, mut other) = beside_rig();
    other.arm().expect("armed");
    page.click("#compare");
    page.wait_until("document.querySelector('dialog[open] .stop')");
    page.click("dialog .stop");
    wait_for_fault(&mut other);
    assert_eq!(page.evaluate("document.querySelector('dialog').open"), json!(true), "the question stays");
}
