//! What outlives a page: edits, undo, view, rig and graphs.
//!
//! Needs Chromium, so `cargo xtask test web` runs it, and `cargo test --workspace` does not.

use std::fs;

use serde_json::json;

use crate::chromium::Browser;
use crate::opened::{page, page_of, wait_until_there};

const MASS: &str = "[data-key=\"load.mass_kg\"] input[type=text]";

/// Sets the moving mass.
fn weigh(page: &mut Browser, mass: &str) {
    page.click("#picture [data-id=load] .title");
    page.wait_until(&format!("document.querySelector('{MASS}')"));
    page.type_into(MASS, mass);
    page.press("Enter", 13, false);
    page.wait_until(&format!("document.getElementById('command').value.includes('load.mass_kg={mass} ')"));
    page.wait_until("studio.simulation.isAtRest");
}

fn command(page: &mut Browser) -> String {
    page.evaluate("document.getElementById('command').value").as_str().expect("a command").to_owned()
}

/// Does something that loads the page again, and waits for it.
fn load_again(page: &mut Browser, method: &str, parameters: serde_json::Value) {
    page.evaluate("window.isOld = true");
    page.call(method, parameters);
    page.wait_until("!window.isOld && document.readyState === 'complete'");
    wait_until_there(page);
}

#[test]
fn a_reload_a_closed_tab_and_back_lose_no_edit() {
    let mut page = page();
    weigh(&mut page, "3");
    weigh(&mut page, "4");
    load_again(&mut page, "Page.reload", json!({}));
    assert!(command(&mut page).contains("load.mass_kg=4 "), "{}", command(&mut page));
    assert_eq!(page.text("#state"), "1 change is back that is in no file yet");
    page.click("#undo");
    page.wait_until("document.getElementById('command').value.includes('load.mass_kg=3 ')");
    page.click("#redo");
    page.wait_until("document.getElementById('command').value.includes('load.mass_kg=4 ')");
    // Another rig, and back.
    page.evaluate("{ const rigs = document.getElementById('rigs'); rigs.value = 'servo-c'; rigs.dispatchEvent(new Event('change')); }");
    page.wait_until("document.getElementById('command').value === 'pneudrive simulate servo-c --out sim'");
    page.evaluate("history.back()");
    page.wait_until(
        "document.getElementById('command').value.includes('servo-b-tuned --set load.mass_kg=4 ')",
    );
    assert_eq!(page.evaluate("document.getElementById('rigs').value"), json!("servo-b-tuned"));
    // The token is the tab's own; the address of the studio has it again.
    let address = page.evaluate("`${location.origin}/#token=${sessionStorage.getItem('pneudrive-token')}`");
    page.evaluate("window.isOld = true");
    let before = page.open_tab(address.as_str().expect("an address"));
    page.wait_until("document.readyState === 'complete'");
    wait_until_there(&mut page);
    assert!(command(&mut page).contains("load.mass_kg=4 "), "{}", command(&mut page));
    page.go_to(before);
    assert_eq!(page.complaints, Vec::<String>::new());
}

#[test]
fn the_address_has_view_rig_and_graphs() {
    let mut page = page();
    page.evaluate("[...document.querySelectorAll('#channels button')].find((one) => one.textContent === 'velocity').click()");
    page.click("#to-study");
    let hash = page.evaluate("location.hash");
    assert_eq!(hash, json!("#view=study&rig=servo-b-tuned&graphs=position,pressures,spool,velocity"));
    page.evaluate("history.back()");
    page.wait_until("!document.getElementById('drive').hidden");
    page.evaluate("history.forward()");
    page.wait_until("!document.getElementById('study').hidden");
    load_again(&mut page, "Page.reload", json!({}));
    assert_eq!(page.evaluate("document.getElementById('study').hidden"), json!(false));
    assert_eq!(page.evaluate("studio.plot.shown"), json!(["position", "pressures", "spool", "velocity"]));
    page.evaluate("location.hash = '#view=design&rig=servo-c&graphs=error'");
    page.wait_until("document.getElementById('command').value === 'pneudrive simulate servo-c --out sim'");
    assert_eq!(page.evaluate("studio.plot.shown"), json!(["error"]));
    assert_eq!(page.complaints, Vec::<String>::new());
}

/// Saves under the name that is offered.
fn save(page: &mut Browser) {
    page.click("#save");
    page.wait_until("document.getElementById('file-name')");
    page.press("Enter", 13, false);
}

#[test]
fn undo_takes_a_saved_change_back_and_two_tabs_on_a_file_know_of_each_other() {
    let folder = tempfile::tempdir().expect("a folder");
    let own = folder.path().join("own.toml");
    let text = "[load]\nmass_kg = 8.0  # given: weighed\n";
    fs::write(&own, text).expect("written");
    let mut page = page_of(own.to_str().expect("a path"), text);
    weigh(&mut page, "9");
    save(&mut page);
    page.wait_until("document.getElementById('state').textContent === 'own.toml is saved'");
    page.click("#undo");
    page.wait_until("document.getElementById('command').value.includes('own.toml --set load.mass_kg=8')");
    page.click("#redo");
    page.wait_until("!document.getElementById('command').value.includes('--set')");
    // What was saved is what a tab that is opened now begins with.
    let address = page
        .evaluate("`${location.origin}/#token=${sessionStorage.getItem('pneudrive-token')}&rig=own.toml`");
    assert_eq!(page.evaluate("document.getElementById('others').hidden"), json!(true));
    let first = page.open_tab(address.as_str().expect("an address"));
    page.wait_until("document.readyState === 'complete'");
    wait_until_there(&mut page);
    page.wait_until("!document.getElementById('others').hidden");
    assert_eq!(page.text("#others"), "This file is open in another tab, too.");
    weigh(&mut page, "10");
    save(&mut page);
    page.wait_until("document.getElementById('state').textContent === 'own.toml is saved'");
    assert!(fs::read_to_string(&own).expect("there").contains("mass_kg = 10"));
    // The first tab has not seen that, and asks.
    page.go_to(first);
    page.wait_until("!document.getElementById('others').hidden");
    weigh(&mut page, "11");
    save(&mut page);
    page.wait_until("document.getElementById('dialog-title')?.textContent === 'Replace the file?'");
    assert!(page.text("#dialog").contains("own.toml was saved by another page since this one opened it"));
    assert!(fs::read_to_string(&own).expect("there").contains("mass_kg = 10"));
    assert_eq!(page.complaints, Vec::<String>::new());
}
