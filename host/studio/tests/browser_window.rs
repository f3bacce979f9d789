//! The page in windows of all sizes: what may lie outside them, and what may not.
//!
//! Needs Chromium, so `cargo xtask test web` runs it, and `cargo test --workspace` does not.

use pneudrive_rigs::virtual_rig::{Background, Listener, Pace, VirtualRig};
use pneudrive_sim::Rig;
use serde_json::json;

use crate::chromium::Browser;
use crate::opened::{own_drive, page_of, page_with};

/// Windows, pixels: a small laptop, common ones, and a screen on a desk.
const WINDOWS: [[u32; 2]; 4] = [[1024, 640], [1366, 768], [1440, 900], [1920, 1080]];

/// The page in a window of this size, at a zoom.
fn resize(page: &mut Browser, [width, height]: [u32; 2], zoom: u32) {
    let size =
        json!({ "width": width / zoom, "height": height / zoom, "deviceScaleFactor": zoom, "mobile": false });
    page.call("Emulation.setDeviceMetricsOverride", size);
    page.evaluate("new Promise((go) => requestAnimationFrame(() => requestAnimationFrame(go)))");
}

/// What is wrong with the page as it is, a line each.
const PROBLEMS: &str = "(async () => {
  const problems = [];
  const root = document.documentElement;
  const name = (one) => `${one.tagName} ${one.id || one.getAttribute('aria-label') || one.textContent.trim().slice(0, 30)}`;
  const isInside = ({ left, right, top, bottom }) => left >= -0.5 && top >= -0.5 && right <= innerWidth + 0.5 && bottom <= innerHeight + 0.5;
  if (root.scrollWidth > innerWidth) problems.push(`the page is ${root.scrollWidth} px wide`);
  const stop = document.getElementById('stop');
  for (const end of [0, root.scrollHeight]) {
    window.scrollTo(0, end);
    await new Promise(requestAnimationFrame);
    const box = stop.getBoundingClientRect();
    const hit = document.elementFromPoint(box.x + box.width / 2, box.y + box.height / 2);
    if (!isInside(box) || hit !== stop) problems.push(`STOP is not at hand at ${window.scrollY}: ${JSON.stringify(box)}, ${hit && name(hit)}`);
  }
  const controls = [...document.querySelectorAll('button, select, input, summary, a[href], [tabindex=\"0\"]')];
  for (const one of controls.filter((one) => one.checkVisibility({ visibilityProperty: true }) && one.id !== 'plot' && one.id !== 'figures')) {
    one.scrollIntoView({ block: 'nearest', inline: 'nearest' });
    const box = one.getBoundingClientRect();
    if (box.width * box.height === 0) continue;
    if (!isInside(box)) problems.push(`${name(one)} lies at ${Math.round(box.left)} to ${Math.round(box.right)}, ${Math.round(box.top)} to ${Math.round(box.bottom)}`);
    for (let outer = one.parentElement; outer; outer = outer.parentElement) if (outer.scrollLeft > 0) problems.push(`${name(one)} lies aside in ${name(outer)}`);
    if (one.closest('svg')) continue;
    const hit = document.elementFromPoint(box.x + box.width / 2, box.y + box.height / 2);
    if (hit !== one && !one.contains(hit) && !one.disabled) problems.push(`${name(one)} is covered by ${hit && name(hit)}`);
  }
  window.scrollTo(0, 0);
  const figures = document.getElementById('figures');
  if (figures.scrollHeight > figures.clientHeight + 1) problems.push('the figures scroll in a box');
  const plot = document.getElementById('plot');
  const shown = document.querySelectorAll('#channels [aria-pressed=\"true\"]').length;
  if (plot.clientHeight && plot.clientHeight < 140 * shown) problems.push(`${shown} graphs have ${plot.clientHeight} px`);
  return problems;
})()";

#[test]
fn every_control_can_be_reached_in_every_window_and_the_stop_never_leaves_it() {
    let (name, text) = own_drive();
    let rig = VirtualRig::new(Rig::read(&name, &text).expect("a rig"), 0, Pace { fast: false, live: true });
    let rig = Background::start(rig.expect("a rig"), Listener::open("tcp:127.0.0.1:0").expect("a port"));
    let mut page = page_with(&name, &text, Some(rig.port()));
    let mut found = Vec::new();
    for view in ["design", "study", "commission"] {
        page.evaluate(&format!("document.getElementById('to-{view}').click()"));
        // All there is to be reached.
        page.evaluate("for (const one of document.querySelectorAll('details')) one.open = true");
        for (window, zoom) in WINDOWS.into_iter().flat_map(|window| [(window, 1), (window, 2)]) {
            resize(&mut page, window, zoom);
            let problems = page.evaluate(PROBLEMS);
            let problems = problems.as_array().expect("a list").iter();
            found.extend(problems.map(|problem| format!("{view}, {window:?}, zoom {zoom}: {problem}")));
        }
    }
    assert_eq!(found, Vec::<String>::new());
    assert_eq!(page.complaints, Vec::<String>::new());
}

/// Sentence, table, and what they rest on behind one click.
#[test]
fn the_verdict_is_a_sentence_on_the_moves_and_says_first_what_makes_it_doubtful() {
    let (name, text) = own_drive();
    let mut page = page_of(&name, &text);
    let sentence = page.text("#verdict summary");
    assert!(sentence.starts_with("Settles within 0.05 mm after 0.3"), "{sentence}");
    assert!(sentence.contains(" s; ") && sentence.ends_with(" l of air a move."), "{sentence}");
    let is_seen = "document.querySelector('#verdict .remark').checkVisibility()";
    assert_eq!(page.evaluate(is_seen), json!(false));
    page.click("#verdict summary");
    assert_eq!(page.evaluate(is_seen), json!(true));
    let basis = page.text("#verdict");
    assert!(
        basis.contains("Converged: positions are off by about") && basis.contains("7 perturbed runs"),
        "{basis}"
    );
    // What makes the figures doubtful stands before them.
    let report = page.evaluate("import('/figures.js').then(({ Figures }) => { \
        const [verdict, table] = [document.createElement('details'), document.createElement('section')]; \
        new Figures(verdict, table).showJudged({ verdict: 'rests 0.73 mm short', figures: { heading: '', columns: [], rows: [] }, \
        notes: ['a run', 'not converged from 0.3000 s on: the exact transient may differ from there'], converged: false, remarks: [] }, null); \
        return verdict.firstChild.textContent; })");
    assert_eq!(report, json!("Not converged from 0.3000 s on. Rests 0.73 mm short."));
    assert_eq!(page.complaints, Vec::<String>::new());
}
