//! Studies from the page in a browser: a sweep that is cancelled and one that comes to its end, gains that are taken over and
//! taken back, values from a record.
//!
//! Needs Chromium, so `cargo xtask test web` runs it, and `cargo test --workspace` does not. With `PNEUDRIVE_SHOTS=FOLDER`
//! it writes the picture of docs/howto/studio.md there.

use std::thread::sleep;
use std::time::Duration;

use pneudrive_link::client::Client;
use pneudrive_protocol::Mode;
use pneudrive_records::rig_text;
use pneudrive_records::target::TargetFile;
use pneudrive_rigs::virtual_rig::Background;
use pneudrive_session::test_run;
use pneudrive_sim::Rig;
use pneudrive_sim::rigfile::builtin;
use serde_json::json;

use crate::chromium::Browser;
use crate::opened::{drop_file, hold, hold_nothing, keep_picture, leave_unknown, page, page_of, rest};

/// The view of studies, with this task.
fn open_task(page: &mut Browser, task: &str) {
    page.click("#to-study");
    page.click(&format!("#study [data-task={task}]"));
    page.wait_until("document.getElementById('study-command').value");
}

fn value(page: &mut Browser, id: &str) -> String {
    let value = page.evaluate(&format!("document.getElementById('{id}').value"));
    value.as_str().expect("a text").to_owned()
}

#[test]
fn a_sweep_is_cancelled_and_another_shows_its_points_and_the_best_is_taken_over() {
    let mut page = page();
    open_task(&mut page, "sweep");
    assert_eq!(value(&mut page, "study-command"), "pneudrive sweep sweep.toml");
    page.type_into("#study .steps", "x");
    page.wait_until(
        "document.querySelector('#study .problem').textContent === 'load.mass_kg steps: write a number'",
    );
    assert_eq!(page.evaluate("document.getElementById('study-start').disabled"), json!(true));
    page.type_into("#study .steps", "9000");
    page.wait_until("document.getElementById('study-size').textContent === '9000 points x 8 runs'");
    page.click("#study-start");
    page.wait_until(
        "/^[1-9][0-9]* of 9000 points, about .* left$/.test(document.getElementById('study-at').textContent)",
    );
    page.click("#study-start");
    page.wait_until("document.getElementById('study-at').textContent === 'cancelled: nothing has changed'");
    page.type_into("#study .steps", "4");
    page.type_into("#sweep-runs", "3");
    page.wait_until("document.getElementById('study-size').textContent === '4 points x 3 runs'");
    page.click("#study-start");
    page.wait_until("document.querySelector('#exhibit table')");
    let shown = page.text("#exhibit");
    for part in [
        "4 points",
        "the best point (least overshoot_mm)",
        "over load.mass_kg",
        "very slightly different mass",
        "No point has a value of settling_s",
    ] {
        assert!(shown.contains(part), "{part}: {shown}");
    }
    assert_eq!(page.evaluate("document.querySelectorAll('#exhibit canvas').length"), json!(1));
    page.click("#study-take");
    page.wait_until("document.getElementById('command').value.includes('--set load.mass_kg=')");
    assert_eq!(page.complaints, Vec::<String>::new());
}

/// Every point is a line over axes, on which a part selects: by keys and by the pointer.
#[test]
fn points_over_many_keys_are_selected_on_parallel_axes() {
    let mut page = page();
    open_task(&mut page, "sweep");
    page.click("#sweep-more");
    page.evaluate(
        "(() => { const key = document.querySelectorAll('#study .vary select')[1]; key.value = 'operator.model'; key.dispatchEvent(new Event('change', { bubbles: true })); })()",
    );
    page.type_into("#study .steps", "3");
    page.type_into("#sweep-runs", "1");
    page.wait_until("document.getElementById('study-size').textContent === '12 points'");
    page.click("#study-start");
    page.wait_until("document.querySelector('#exhibit .parallel')");
    page.evaluate("document.querySelector('.parallel').scrollIntoView({ block: 'center' })");
    let told = |page: &mut Browser| page.text(".parallel [role=status]");
    assert_eq!(told(&mut page), "12 of 12 points selected");
    let lines = "[...document.querySelectorAll('.parallel .selected')].reduce((sum, one) => sum + one.getAttribute('d').split('M').length - 1, 0)";
    assert_eq!(page.evaluate(lines), json!(12));
    let end = |place: u32| format!("document.querySelectorAll('.parallel [role=slider]')[{place}]");
    assert_eq!(page.evaluate(&format!("{}.ariaLabel", end(0))), json!("load.mass_kg, least"));
    page.evaluate(&format!("{}.focus()", end(0)));
    page.press("ArrowUp", 38, false);
    assert_eq!(told(&mut page), "8 of 12 points selected", "without the lightest");
    assert_eq!(page.evaluate(lines), json!(8));
    page.evaluate(&format!("{}.focus()", end(3)));
    page.press("End", 35, false);
    for _ in 0..3 {
        page.press("ArrowDown", 40, false);
    }
    assert_eq!(told(&mut page), "2 of 12 points selected", "of one operator");
    assert_eq!(page.evaluate(&format!("{}.ariaValueText", end(3))), json!("solenoid"));
    page.click(".parallel .axis .ground");
    assert_eq!(told(&mut page), "3 of 12 points selected", "of all masses");
    let [x, y] = page.middle(".parallel .axis .ground");
    for (kind, by) in
        [("mousePressed", -20.0), ("mouseMoved", 0.0), ("mouseMoved", 20.0), ("mouseReleased", 20.0)]
    {
        page.mouse(kind, [x, y + by]);
    }
    assert!(
        told(&mut page).starts_with("1 of 12 points selected: load.mass_kg 2, operator.model solenoid, ")
    );
    keep_picture(&mut page, "studio-sweep.png");
    assert_eq!(page.complaints, Vec::<String>::new());
}

/// The answer for the task before comes when another one was chosen.
#[test]
fn the_plan_of_one_task_is_not_shown_as_that_of_another() {
    let mut page = page();
    hold(&mut page, &["/api/plan"]);
    page.click("#to-study");
    page.wait_until("held['/api/plan'].length === 1");
    page.evaluate("document.querySelector('#study [data-task=identify]').click(); letGo('/api/plan')");
    rest(&mut page);
    assert_eq!(value(&mut page, "study-command"), "");
    assert_eq!(page.text("#study .problem"), "");
    hold_nothing(&mut page);
    page.wait_until("document.getElementById('study-command').value === 'pneudrive identify servo-b-tuned --out identified'");
    assert_eq!(page.complaints, Vec::<String>::new());
}

#[test]
fn what_was_found_for_one_rig_is_not_taken_over_by_another() {
    let mut page = page();
    open_task(&mut page, "sweep");
    page.type_into("#study .steps", "2");
    page.type_into("#sweep-runs", "1");
    page.wait_until("document.getElementById('study-size').textContent === '2 points'");
    page.click("#study-start");
    page.wait_until("document.getElementById('study-take')?.disabled === false");
    for (rig, is_its_own) in [("servo-c", false), ("servo-b-tuned", true)] {
        page.evaluate(&format!(
            "(() => {{ const rigs = document.getElementById('rigs'); rigs.value = '{rig}'; rigs.dispatchEvent(new Event('change')); }})()"
        ));
        page.wait_until(&format!("document.getElementById('study-take').disabled !== {is_its_own}"));
        let words = page.text("#study-take + small");
        assert_eq!(words == "found for another rig", !is_its_own, "{words}");
        page.evaluate("document.getElementById('study-take').click()");
        rest(&mut page);
        page.wait_until("studio.simulation.isAtRest");
        let command = value(&mut page, "command");
        assert_eq!(command.contains("--set"), is_its_own, "{command}");
        page.click("#to-study");
    }
    assert_eq!(page.complaints, Vec::<String>::new());
}

#[test]
fn gains_are_found_taken_over_with_the_run_before_as_ghost_and_taken_back() {
    // Gains that any others are better than.
    let text = builtin("servo-a").expect("a built-in rig");
    let poor = ["controller.gain_profile=[65535]".to_owned()];
    let text = rig_text::with_settings(text, &poor, "poor").expect("a rig file");
    let mut page = page_of("mine.toml", &text);
    page.click("#picture [data-id=controller] .title");
    let before = value(&mut page, "command");
    open_task(&mut page, "tune");
    let goal = [
        ("settled_mm", "2"),
        ("overshoot_percent", "20"),
        ("population", "3"),
        ("generations", "2"),
        ("draws", "5"),
    ];
    for (name, number) in goal {
        page.type_into(&format!("#tune-{name}"), number);
    }
    page.wait_until("document.getElementById('study-command').value.includes('--draws 5 --population 3 --generations 2 ')");
    let command = value(&mut page, "study-command");
    assert!(
        command.starts_with("pneudrive tune mine.toml --step 60 --tolerance-mm 2 --overshoot 20 "),
        "{command}"
    );
    page.click("#study-start");
    page.wait_until("document.getElementById('study-at').textContent.includes('or less, estimated from')");
    page.wait_until("document.querySelector('#exhibit .verdict')");
    let shown = page.text("#exhibit");
    for part in [
        "The goal is met in",
        "95 % intervals",
        "in 5 fresh draws from the spread",
        "step in mid-stroke, rig of the file",
    ] {
        assert!(shown.contains(part), "{part}: {shown}");
    }
    page.wait_until("!document.getElementById('study-take').disabled");
    page.click("#study-take");
    page.wait_until("document.getElementById('command').value.includes('--set controller.')");
    page.wait_until("document.querySelectorAll('#runs .ghost').length === 1");
    assert!(page.text("#state").contains("Undo takes them back"), "{}", page.text("#state"));
    page.click("#undo");
    page.wait_until(&format!("document.getElementById('command').value === {}", json!(before)));
    assert_eq!(page.complaints, Vec::<String>::new());
}

/// An open loop with two strokes: what the mass and the friction show themselves in.
const STROKES: &str = include_str!("../../tests/fixtures/strokes.toml");

/// What a rig of this file has recorded whose mass and viscous friction are others than the file's.
fn record() -> String {
    let file = Rig::read("rig.toml", STROKES).expect("a rig");
    let real = file.with_numbers(&[("load.mass_kg", 1.8), ("load.viscous_n_s_per_m", 26.0)]).expect("a rig");
    let rig = Background::of(real).expect("a rig");
    let mut client = Client::connect(rig.port()).expect("a rig at the port");
    client.download_test(&file).expect("a test");
    test_run::start(&mut client, &file, &mut || Ok(())).expect("started");
    while client.status().expect("a status").mode == Mode::Running {
        sleep(Duration::from_millis(10));
    }
    let (info, parameters) = (client.info().expect("a rig"), client.parameters().expect("parameters"));
    let record = client.record(|_, _| {}).expect("a record");
    TargetFile::new(&record, &info, &parameters).expect("a TARGET file").to_text()
}

#[test]
fn values_are_found_from_a_record_with_their_intervals_and_taken_over() {
    let mut page = page_of("rig.toml", STROKES);
    drop_file(&mut page, "TARGET01.DAT", &record());
    page.wait_until("document.querySelector('#runs .record')");
    open_task(&mut page, "identify");
    leave_unknown(&mut page, &["load.mass_kg", "load.viscous_n_s_per_m"]);
    let command =
        "pneudrive identify rig.toml TARGET01.DAT --fit load.mass_kg,load.viscous_n_s_per_m --out identified";
    page.wait_until(&format!("document.getElementById('study-command').value === {}", json!(command)));
    page.click("#study-start");
    page.wait_until("document.querySelector('#exhibit canvas')");
    let shown = page.text("#exhibit");
    for part in ["load.mass_kg", "95 % interval", "after the fit", "residual", "correlation of the estimates"]
    {
        assert!(shown.contains(part), "{part}: {shown}");
    }
    keep_picture(&mut page, "studio-study.png");
    page.click("#study-take");
    page.wait_until("document.getElementById('command').value.includes('--set load.viscous_n_s_per_m=')");
    // What was found is what was hidden, and the record now lies on the run.
    let line = value(&mut page, "command");
    let mass = line.split("--set load.mass_kg=").nth(1).and_then(|rest| rest.split(' ').next());
    let mass: f64 = mass.expect("a mass").parse().expect("a number");
    assert!((mass - 1.8).abs() < 0.018, "{line}");
    page.click("#undo");
    page.wait_until("!document.getElementById('command').value.includes('--set')");
    assert_eq!(page.complaints, Vec::<String>::new());
}

/// The plan of the task is due when the study has failed already.
#[test]
fn why_a_study_has_failed_stays_until_the_next_one_begins() {
    let mut page = page();
    open_task(&mut page, "sweep");
    page.evaluate(
        "document.querySelector('#study [data-task=identify]').click(); document.getElementById('study-start').click()",
    );
    let why = "drop a TARGET file of the rig on the page first";
    page.wait_until(&format!("document.querySelector('#study .problem').textContent === '{why}'"));
    rest(&mut page);
    assert_eq!(page.text("#study .problem"), why);
    assert_eq!(page.evaluate("document.getElementById('study-start').disabled"), json!(false));
}

#[test]
fn what_is_unknown_of_one_rig_is_not_chosen_for_another() {
    let mut page = page();
    open_task(&mut page, "identify");
    leave_unknown(&mut page, &["load.mass_kg"]);
    page.wait_until("document.getElementById('study-command').value.includes('--fit load.mass_kg ')");
    page.evaluate("(() => { const rigs = document.getElementById('rigs'); rigs.value = 'servo-c'; rigs.dispatchEvent(new Event('change')); })()");
    page.wait_until(
        "document.getElementById('study-command').value === 'pneudrive identify servo-c --out identified'",
    );
    let unchecked = "[...document.querySelectorAll('#study .choices input')].filter((box) => !box.checked)";
    page.wait_until("document.querySelector('#study .choices input')");
    assert_eq!(page.evaluate(&format!("{unchecked}.length")), json!(0));
}

#[test]
fn a_point_that_is_not_sound_is_dashed_and_its_remarks_and_ranges_are_told() {
    let mut page = page();
    page.evaluate(
        "import('/parallel.js').then(({ parallelOf }) => { \
         const row = (point, more) => ({ point, levels: { mass: point }, metrics: { overshoot: { value: 1, least: null, most: null } }, converged: true, fault: '', failure: '', allowed: true, ...more }); \
         const ranged = { overshoot: { value: 1, least: 0.5, most: 2 } }; \
         window.told = (...rows) => { const made = parallelOf({ rows, best: null }); \
         return [made.querySelector('[role=status]').textContent, ['.all:not(.doubtful)', '.all.doubtful'].map((kind) => made.querySelector(kind).getAttribute('d').split('M').length - 1)]; }; \
         window.rows = [row(0), row(1, { converged: false, metrics: ranged }), row(2, { fault: 'overrun', allowed: false }), row(3, { allowed: false })]; })",
    );
    assert_eq!(page.evaluate("told(...rows)"), json!(["4 of 4 points selected", [1, 3]]));
    for (place, words) in [
        "mass 0, overshoot 1",
        "mass 1, overshoot 1 (0.5 to 2), not converged",
        "mass 2, overshoot 1, overrun",
        "mass 3, overshoot 1, breaks a constraint",
    ]
    .into_iter()
    .enumerate()
    {
        let told = page.evaluate(&format!("told(rows[{place}])[0]"));
        assert_eq!(told, json!(format!("1 of 1 points selected: {words}")));
    }
}

#[test]
fn an_identification_without_an_answer_offers_the_plan_that_would_give_one() {
    let mut page = page();
    drop_file(&mut page, "TARGET01.DAT", include_str!("../../tests/fixtures/TARGET-1.DAT"));
    page.wait_until("document.querySelector('#runs .record')");
    page.click("#to-study");
    page.click("#study [data-task=identify]");
    leave_unknown(&mut page, &["load.mass_kg"]);
    page.wait_until("document.getElementById('study-command').value.includes('--fit load.mass_kg')");
    assert_eq!(page.evaluate("document.getElementById('study-plan')"), json!(null), "nothing has failed yet");
    page.click("#study-start");
    page.wait_until("document.getElementById('study-plan')");
    let plan = page.evaluate("document.getElementById('study-plan').value");
    assert_eq!(plan, json!("pneudrive identify servo-b-tuned --plan PORT --out plan"));
    assert_eq!(page.evaluate("document.getElementById('study-take')?.disabled ?? true"), json!(true));
    page.click("#study [data-task=tune]");
    assert_eq!(page.evaluate("document.getElementById('study-plan')"), json!(null));
    assert_eq!(page.complaints, Vec::<String>::new());
}
