//! The keys of a component: which come first, how one is found, and which are changed.
//!
//! Needs Chromium, so `cargo xtask test web` runs it, and `cargo test --workspace` does not.

use serde_json::json;

use crate::chromium::Browser;
use crate::opened::{own_drive, page_of};

/// The paths of the fields that can be seen, in their order.
fn seen(page: &mut Browser) -> Vec<String> {
    let shown = "[...document.querySelectorAll('#inspector .field')].filter((one) => one.checkVisibility()).map((one) => one.dataset.key)";
    serde_json::from_value(page.evaluate(shown)).expect("paths")
}

fn search(page: &mut Browser, letters: &str) {
    page.type_into("#key-search", letters);
}

#[test]
fn the_keys_that_matter_come_first_and_the_others_are_found_by_their_words() {
    let (name, text) = own_drive();
    let mut page = page_of(&name, &text);
    let first = seen(&mut page);
    assert!(first.len() <= 10, "{first:?}");
    for key in
        ["cascade_dead_time_factor", "cascade_flow_share", "cascade_observer_factor", "tolerance_counts"]
    {
        assert!(first.contains(&format!("controller.{key}")), "{key} of {first:?}");
    }
    assert!(page.text("#inspector .more summary").ends_with(" more"));
    search(&mut page, "silence");
    assert_eq!(seen(&mut page), ["safety.host_silence_s"], "behind the click");
    search(&mut page, "steam");
    assert_eq!(seen(&mut page), Vec::<String>::new());
    assert!(page.text("#inspector").contains("No key matches"));
    // The search stays while a key changes, and the change is counted where it cannot be seen.
    search(&mut page, "C(41)");
    assert_eq!(seen(&mut page), ["controller.period_s"], "by its name in the thesis");
    let hover = page.evaluate("document.querySelector('[data-key=\"controller.period_s\"] label').title");
    assert!(
        hover.as_str().is_some_and(
            |hover| hover.starts_with("Sample period") && hover.ends_with("In the thesis: C(41)")
        )
    );
    search(&mut page, "host silence");
    page.type_into("#inspector [data-key=\"safety.host_silence_s\"] input[type=text]", "0.7");
    page.press("Enter", 13, false);
    page.wait_until(
        "document.querySelector('[data-key=\"safety.host_silence_s\"]').classList.contains('changed')",
    );
    assert_eq!(page.evaluate("document.getElementById('key-search').value"), json!("host silence"));
    search(&mut page, "");
    assert!(page.text("#inspector .more summary").ends_with(" more, 1 changed from the file"));
    // Another law has other gains.
    page.evaluate("{ const law = document.getElementById('key-controller-law'); law.value = 'gain-profile'; law.dispatchEvent(new Event('change')); }");
    page.wait_until(
        "document.querySelector('#inspector [data-key=\"controller.gain_profile\"]')?.checkVisibility()",
    );
    assert!(!page.text("#inspector").contains("cascade flow share"));
    assert_eq!(page.complaints, Vec::<String>::new());
}

#[test]
fn a_problem_behind_the_click_is_shown() {
    let (name, text) = own_drive();
    let mut page = page_of(&name, &text);
    search(&mut page, "host silence");
    page.type_into("#inspector [data-key=\"safety.host_silence_s\"] input[type=text]", "-1");
    search(&mut page, "");
    page.evaluate("document.querySelector('#inspector .more').open = false");
    page.wait_until("document.querySelector('#inspector [data-key=\"safety.host_silence_s\"] .problem').checkVisibility()");
    assert_eq!(page.complaints, Vec::<String>::new());
}

#[test]
fn the_form_of_a_tuning_begins_with_what_is_searched_under_the_law_of_the_rig() {
    let (name, text) = own_drive();
    let mut page = page_of(&name, &text);
    page.click("#to-study");
    page.click("#study [data-task=tune]");
    let size = "['population', 'generations'].map((name) => document.getElementById(`tune-${name}`).value)";
    page.wait_until(
        "document.getElementById('study-command').value.includes('--population 8 --generations 6')",
    );
    assert_eq!(page.evaluate(size), json!(["8", "6"]));
    assert!(page.text("#study").contains("Searched: "), "{}", page.text("#study"));
    page.type_into("#tune-generations", "3");
    page.wait_until(
        "document.getElementById('study-command').value.includes('--population 8 --generations 3')",
    );
    // A rig with gains has more to look for.
    page.evaluate("{ const rigs = document.getElementById('rigs'); rigs.value = 'servo-b-tuned'; rigs.dispatchEvent(new Event('change')); }");
    page.wait_until(
        "document.getElementById('study-command').value.includes('--population 24 --generations 25')",
    );
    assert_eq!(page.complaints, Vec::<String>::new());
}
