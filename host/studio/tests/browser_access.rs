//! The page for who uses a keyboard, a screen reader or a projector: what axe-core finds.
//!
//! Needs Chromium and axe-core (`PNEUDRIVE_AXE`, its `axe.min.js`), so `cargo xtask test web` runs it.

use pneudrive_rigs::virtual_rig::{Background, Listener, Pace, VirtualRig};
use pneudrive_sim::Rig;
use pneudrive_sim::rigfile::builtin;
use serde_json::{Value, json};

use crate::chromium::Browser;
use crate::opened::page_with;

/// Violations that keep somebody out.
const SERIOUS: [&str; 2] = ["serious", "critical"];

/// The serious violations on the page as it is: rule, and the elements.
fn violations(page: &mut Browser) -> Vec<String> {
    let found = page.evaluate(
        "axe.run(document, { resultTypes: ['violations'] }).then(({ violations }) => violations.map(({ id, impact, nodes }) => \
         ({ impact, text: `${id}: ${nodes.map(({ html, any }) => `${html} ${any.map(({ message }) => message)}`).join('; ')}` })))",
    );
    let found: Vec<Value> = serde_json::from_value(found).expect("violations");
    let serious = found.iter().filter(|one| SERIOUS.iter().any(|impact| one["impact"] == *impact));
    serious.map(|one| one["text"].to_string()).collect()
}

fn expect_none(page: &mut Browser, view: &str) {
    for scheme in ["light", "dark"] {
        let media = json!({ "features": [{ "name": "prefers-color-scheme", "value": scheme }] });
        page.call("Emulation.setEmulatedMedia", media);
        page.evaluate("new Promise(requestAnimationFrame)");
        assert_eq!(violations(page), Vec::<String>::new(), "{view}, {scheme}");
    }
}

/// Controls that the Tab key does not come to.
const UNREACHED: &str = "[...document.querySelectorAll('button, select, input, summary, a[href], [tabindex=\"0\"]')] \
    .filter((one) => one.checkVisibility({ visibilityProperty: true }) && !one.disabled && one.type !== 'file' && !reached.has(one)) \
    .map((one) => one.outerHTML.slice(0, 120))";

#[test]
fn every_control_of_every_view_is_reached_by_the_keyboard() {
    let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig");
    let rig = VirtualRig::new(rig, 0, Pace { fast: false, live: true }).expect("a rig");
    let rig = Background::start(rig, Listener::open("tcp:127.0.0.1:0").expect("a port"));
    let mut page = page_with("servo-b-tuned", builtin("servo-b-tuned").expect("a rig"), Some(rig.port()));
    for view in ["design", "study", "commission"] {
        page.evaluate(&format!("document.getElementById('to-{view}').click()"));
        page.evaluate("for (const one of document.querySelectorAll('details')) one.open = true");
        page.evaluate("window.reached = new Set(); document.addEventListener('focusin', ({ target }) => reached.add(target))");
        page.evaluate("document.querySelector('#views button').focus()");
        let all = page.evaluate(&format!("{UNREACHED}.length")).as_u64().expect("a number");
        for _ in 0..all + 12 {
            page.press("Tab", 9, false);
        }
        assert_eq!(page.evaluate(UNREACHED), json!([]), "{view}");
    }
    assert_eq!(page.complaints, Vec::<String>::new());
}

#[test]
fn no_serious_violation_is_found_in_any_view_light_or_dark() {
    let axe = std::env::var_os("PNEUDRIVE_AXE").expect("PNEUDRIVE_AXE: axe.min.js of axe-core");
    let axe = std::fs::read_to_string(axe).expect("axe-core");
    let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig");
    let rig = VirtualRig::new(rig, 0, Pace { fast: false, live: true }).expect("a rig");
    let rig = Background::start(rig, Listener::open("tcp:127.0.0.1:0").expect("a port"));
    let mut page = page_with("servo-b-tuned", builtin("servo-b-tuned").expect("a rig"), Some(rig.port()));
    page.evaluate(&format!("(() => {{ {axe} }})(); typeof axe"));
    expect_none(&mut page, "design");
    page.click("#picture [data-id=valve] .title");
    page.wait_until("document.querySelector('#inspector [data-key=\"valve.model\"]')");
    expect_none(&mut page, "valve");
    page.click("#compare");
    expect_none(&mut page, "a question");
    page.press("Escape", 27, false);
    page.wait_until("!document.getElementById('dialog')");
    page.click("#to-commission");
    expect_none(&mut page, "commission");
    page.click("#to-study");
    page.wait_until("document.getElementById('study-command').value");
    for task in ["sweep", "tune", "identify"] {
        page.click(&format!("#study [data-task={task}]"));
        expect_none(&mut page, task);
    }
    page.click("#study [data-task=sweep]");
    page.type_into("#study .steps", "2");
    page.type_into("#sweep-runs", "1");
    page.wait_until("document.getElementById('study-size').textContent === '2 points'");
    page.click("#study-start");
    page.wait_until("document.querySelector('#exhibit table')");
    expect_none(&mut page, "what a study has found");
    assert_eq!(page.complaints, Vec::<String>::new());
}
