//! What is laid over a run in the browser, looked at and taken away: records, spectra, other rigs, a report.
//!
//! Needs Chromium, so `cargo xtask test web` runs it, and `cargo test --workspace` does not.

use pneudrive_design::difference::differences;
use pneudrive_evaluate::channel::Channel;
use pneudrive_evaluate::spectrum::{Spectrum, Window};
use pneudrive_evaluate::transient::Transient;
use pneudrive_records::run_folder::StoredRun;
use pneudrive_records::target::TargetFile;
use pneudrive_sim::{Accuracy, Rig, run};
use serde_json::{Value, json};

use crate::chromium::Browser;
use crate::opened::{choose_path, drop_file, drop_path, hold, hold_nothing, keep_picture, page, rest};
use crate::simulated::simulate;

/// A record of a virtual rig whose true values differ from the file's.
const RECORD: &str = include_str!("../../tests/fixtures/TARGET-1.DAT");

/// A page with the record over its run.
fn page_with_record() -> Browser {
    let mut page = page();
    drop_file(&mut page, "TARGET01.DAT", RECORD);
    page.wait_until("document.querySelector('#runs .record') && document.querySelector('table.deviation')");
    page
}

/// The first two cells of each row of a table.
fn rows(page: &mut Browser, table: &str) -> Vec<[String; 2]> {
    let script = format!(
        "[...document.querySelectorAll('{table} tbody tr')].map((row) => [0, 1].map((k) => row.children[k].textContent))"
    );
    serde_json::from_value(page.evaluate(&script)).expect("rows of texts")
}

fn click_button(page: &mut Browser, name: &str) {
    page.evaluate(&format!(
        "[...document.querySelectorAll('button')].find((one) => one.textContent === '{name}').click()"
    ));
}

fn peaks(transient: &Transient, channel: Channel) -> Vec<[String; 2]> {
    let spectrum = Spectrum::of(&channel.samples(transient), transient.period_s(), Window::Hann);
    spectrum
        .peaks(8)
        .iter()
        .map(|peak| [format!("{:.2}", peak.frequency), format!("{:.5}", peak.amplitude)])
        .collect()
}

#[test]
fn spectra_of_the_run_and_of_the_record_have_the_peaks_of_the_command() {
    let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig");
    let made = run(&rig, Accuracy::of(&rig)).expect("a run");
    let simulated = Transient::of_run(rig.name(), &StoredRun::of(&rig, &made));
    let recorded = TargetFile::from_text(RECORD).and_then(|file| Transient::of_target("TARGET01.DAT", &file));
    let recorded = recorded.expect("a record");
    let mut page = page_with_record();
    click_button(&mut page, "Spectrum…");
    for (channel, value) in [(Channel::Position, "position"), (Channel::Pressure(1), "pressure 2")] {
        page.evaluate(&format!(
            "(() => {{ const choice = document.getElementById('spectrum-channel'); \
             choice.value = '{value}'; choice.dispatchEvent(new Event('change')); }})()"
        ));
        let heading = format!("peaks of {value}, TARGET01.DAT");
        page.wait_until(&format!(
            "document.querySelector('.peaks table:nth-child(2) caption')?.textContent === '{heading}'"
        ));
        assert_eq!(rows(&mut page, ".peaks table:nth-child(1)"), peaks(&simulated, channel), "run, {value}");
        assert_eq!(
            rows(&mut page, ".peaks table:nth-child(2)"),
            peaks(&recorded, channel),
            "record, {value}"
        );
    }
    keep_picture(&mut page, "studio-spectrum.png");
    assert_eq!(page.complaints, Vec::<String>::new());
}

/// A comparison that comes when its record was taken away is of no use any more.
#[test]
fn a_record_that_is_dismissed_while_it_is_compared_does_not_come_back() {
    let mut page = page_with_record();
    hold(&mut page, &["/api/compare"]);
    page.click("#picture [data-id=load] .title");
    page.type_into("[data-key=\"load.mass_kg\"] input[type=text]", "3");
    page.press("Enter", 13, false);
    page.wait_until("held['/api/compare'].length === 1");
    assert_eq!(page.evaluate("document.querySelectorAll('#runs .record').length"), json!(1));
    page.click("#runs .record button");
    hold_nothing(&mut page);
    rest(&mut page);
    assert_eq!(page.evaluate("document.querySelectorAll('#runs .record, table.deviation').length"), json!(0));
    assert_eq!(page.evaluate("document.getElementById('align').hidden"), json!(true));
    assert_eq!(page.complaints, Vec::<String>::new());
}

#[test]
fn a_run_folder_is_dropped_or_chosen_and_lies_over_the_run_as_a_file_does() {
    let folder = tempfile::tempdir().expect("a folder");
    let [heavier, none] = ["heavier", "none"].map(|name| folder.path().join(name));
    let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig");
    simulate(&rig.with_settings(&["load.mass_kg=3".to_owned()]).expect("a rig"), &heavier);
    std::fs::create_dir(&none).expect("a folder");
    let mut page = page();
    for is_dropped in [true, false] {
        if is_dropped {
            drop_path(&mut page, &heavier)
        } else {
            choose_path(&mut page, "#folder", &heavier)
        }
        page.wait_until(
            "document.querySelector('#runs .record') && document.querySelector('table.deviation')",
        );
        assert_eq!(page.text("#runs .record span"), "heavier");
        let of = format!("from heavier, a run of {}", rig.name());
        assert!(page.text("table.deviation caption").ends_with(&of), "{of}");
        // It is compared with every run of the page, as a record is.
        let before = page.text("table.deviation");
        let table = "document.querySelector('table.deviation')?.textContent";
        page.click("#picture [data-id=load] .title");
        page.type_into("[data-key=\"load.mass_kg\"] input[type=text]", "2.2");
        page.press("Enter", 13, false);
        page.wait_until(&format!("({table} ?? {0}) !== {0}", json!(before)));
        page.click("#undo");
        page.wait_until(&format!("{table} === {}", json!(before)));
        page.click("#runs .record button");
        page.wait_until("!document.querySelector('#runs .record')");
    }
    drop_path(&mut page, &none);
    page.wait_until("document.getElementById('state').textContent === 'none is not the folder of a run: it has no run.json'");
    assert_eq!(page.complaints, Vec::<String>::new());
}

#[test]
fn a_record_is_aligned_in_three_ways_and_the_shift_is_told() {
    let mut page = page_with_record();
    assert!(!page.text("table.deviation caption").contains("shifted"));
    for (way, is_shifted) in [("correlation", true), ("start", false)] {
        page.evaluate(&format!(
            "(() => {{ const choice = document.getElementById('align'); \
             choice.value = '{way}'; choice.dispatchEvent(new Event('change')); }})()"
        ));
        page.wait_until(&format!(
            "document.querySelector('table.deviation caption')?.textContent.includes('shifted by') === {is_shifted}"
        ));
    }
    assert_eq!(page.complaints, Vec::<String>::new());
}

#[test]
fn two_rigs_are_held_against_each_other_key_by_key_and_the_other_runs_below() {
    let [tuned, other] = ["servo-b-tuned", "servo-c"].map(|name| Rig::builtin(name).expect("a built-in rig"));
    let wanted = differences(&tuned, &other);
    let mut page = page();
    page.click("#compare");
    page.evaluate("document.getElementById('other-rig').value = 'servo-c'");
    page.click("#dialog button.main");
    page.wait_until("document.querySelector('table.differences')");
    let found = rows(&mut page, "table.differences");
    let keys: Vec<&str> = found.iter().map(|[key, _]| key.as_str()).collect();
    assert_eq!(keys, wanted.iter().map(|one| one.key.path).collect::<Vec<_>>());
    keep_picture(&mut page, "studio-difference.png");
    page.click("#dialog button.main");
    page.wait_until("document.querySelector('#runs .ghost')?.textContent.startsWith('servo-c')");
    assert_eq!(page.complaints, Vec::<String>::new());
}

/// What the page offers for saving under a kind of file.
fn offered(page: &mut Browser, button: &str) -> Value {
    page.evaluate(&format!(
        "(async () => {{ const make = URL.createObjectURL; let blob = null; \
         URL.createObjectURL = (one) => {{ blob = one; return make(one); }}; \
         HTMLAnchorElement.prototype.click = function () {{ window.offeredName = this.download; }}; \
         [...document.querySelectorAll('#channels button')].find((one) => one.textContent === '{button}').click(); \
         while (blob === null) await new Promise(requestAnimationFrame); URL.createObjectURL = make; \
         return {{ name: window.offeredName, type: blob.type, text: await blob.text() }}; }})()"
    ))
}

#[test]
fn graphs_are_taken_away_as_a_drawing_and_figures_first_as_a_report() {
    let mut page = page_with_record();
    let svg = offered(&mut page, "SVG");
    assert_eq!((&svg["name"], &svg["type"]), (&json!("servo-b-tuned.svg"), &json!("image/svg+xml")));
    let text = svg["text"].as_str().expect("a text");
    let problem = page.evaluate(&format!(
        "new DOMParser().parseFromString({}, 'image/svg+xml').querySelector('parsererror')?.textContent ?? ''",
        json!(text)
    ));
    assert_eq!(problem, json!(""));
    for wanted in ["position, mm", "pressures, kPa", "time, s", "stroke-dasharray"] {
        assert!(text.contains(wanted), "{wanted}");
    }
    let report = offered(&mut page, "Report");
    assert_eq!(report["name"], json!("servo-b-tuned.html"));
    let text = report["text"].as_str().expect("a text");
    let places = ["class=\"verdict", "class=\"deviation", "<svg", "pneudrive simulate servo-b-tuned"];
    let places = places.map(|part| text.find(part).unwrap_or_else(|| panic!("{part}")));
    assert!(places.is_sorted(), "figures first: {places:?}");
    assert!(text.len() < 300_000, "{} bytes", text.len());
    assert!(text.contains("<style>") && text.contains("size: A4"), "it has its style with it");
    assert!(!text.contains("<script") && !text.contains("src="), "the page needs nothing beside it");
    if let Some(folder) = std::env::var_os("PNEUDRIVE_SHOTS") {
        std::fs::write(std::path::Path::new(&folder).join("report.html"), text).expect("written");
    }
    assert_eq!(page.complaints, Vec::<String>::new());
}

/// `simulate --out run` of two designs, in folders beside each.
#[test]
fn two_runs_whose_folders_are_called_alike_lie_beside_each_other() {
    let mut page = page();
    page.evaluate(
        "import('/records.js').then(({ Records }) => { \
         const ask = async () => ({ head: { shift_s: 0, deviation: null }, time: [], columns: [] }); \
         window.laid = new Records(ask, { changed() {}, failed() {} }); \
         window.run = (text) => laid.lay({ name: 'run', run_json: text, trace_csv: '' }); })",
    );
    page.evaluate(
        "run('a').then(() => run('b')).then(() => run('a')).then(() => laid.lay({ name: 'run', text: 'c' }))",
    );
    let names = "laid.all.map(({ name, content }) => [name, content.run_json ?? content.text]).sort()";
    let text = page.evaluate(names);
    assert_eq!(text, json!([["run (2)", "b"], ["run", "c"]]), "a file is laid anew");
    page.evaluate("laid.clear(); run('a').then(() => run('b')).then(() => laid.compareAgain())");
    assert_eq!(page.evaluate(names), json!([["run (2)", "b"], ["run", "a"]]));
}
