//! The orders of the page to the drive, and the stop, which waits for none of them.
//!
//! Needs Chromium, so `cargo xtask test web` runs it, and `cargo test --workspace` does not.

mod chromium;
mod opened;

use serde_json::json;

use opened::{page, page_with};

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
    let text = pneudrive_sim::rig::builtin("servo-b-tuned").expect("a built-in rig");
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
