//! The commission view in a browser, on a virtual rig: scope, parameters, record, bring-up.
//!
//! Needs Chromium, so `cargo xtask test web` runs it, and `cargo test --workspace` does not.

use pneudrive_controller::parameters::id;
use pneudrive_link::client::Client;
use pneudrive_protocol::Mode;
use pneudrive_rigs::virtual_rig::{Background, Listener, Pace, VirtualRig};
use pneudrive_rigs::wiring::Wiring;
use pneudrive_sim::Rig;
use pneudrive_sim::rigfile::builtin;
use serde_json::json;

use crate::chromium::Browser;
use crate::opened::{drop_file, keep_picture, leave_unknown, page_with, rest, run_the_test};

/// A page that commands a virtual rig in real time, and the wires of that.
fn commanding(name: &str) -> (Browser, Background, Wiring) {
    let text = builtin(name).expect("a built-in rig");
    commanding_rig(name, text, Rig::builtin(name).expect("a built-in rig"), true)
}

/// The same, with a rig on the page that may be another than the real one; `live`: its plant goes on between its runs.
fn commanding_rig(name: &str, text: &str, real: Rig, live: bool) -> (Browser, Background, Wiring) {
    let rig = VirtualRig::new(real, 0, Pace { fast: false, live }).expect("a rig");
    let wiring = rig.wiring().clone();
    let rig = Background::start(rig, Listener::open("tcp:127.0.0.1:0").expect("a port"));
    let mut page = page_with(name, text, Some(rig.port()));
    page.click("#to-commission");
    page.click("#commission button.main");
    wait_for_mode(&mut page, "disarmed");
    (page, rig, wiring)
}

fn wait_for_mode(page: &mut Browser, mode: &str) {
    page.wait_until(&format!("document.querySelector('#commission .mode').textContent === '{mode}'"));
}

/// An open loop with two strokes: what the mass and the friction show themselves in.
const STROKES: &str = include_str!("../../tests/fixtures/strokes.toml");

/// Clicks the button of the panel whose text begins so.
fn press(page: &mut Browser, text: &str) {
    let button = format!(
        "[...document.querySelectorAll('#commission button')].find((one) => one.textContent.startsWith('{text}'))"
    );
    page.wait_until(&format!("{button}?.disabled === false"));
    page.evaluate(&format!("{button}.click()"));
}

/// Chooses an option.
fn choose(page: &mut Browser, selector: &str, value: &str) {
    page.evaluate(&format!(
        "(() => {{ const one = document.querySelector('{selector}'); one.value = '{value}'; one.dispatchEvent(new Event('change', {{ bubbles: true }})); }})()"
    ));
}

/// Opens a part of the panel.
fn open(page: &mut Browser, part: &str) {
    page.evaluate(&format!("document.querySelector('#commission details.{part}').open = true"));
}

#[test]
fn parameters_are_compared_edited_refused_at_their_field_sent_and_saved() {
    let (mut page, rig, _) = commanding("servo-b-tuned");
    let mut other = Client::connect(rig.port()).expect("a rig");
    open(&mut page, "parameters");
    let field = |path: &str| format!("#commission [data-parameter=\"{path}\"]");
    let gain = field("controller.velocity_gain");
    page.wait_until(&format!("document.querySelector('{gain}')"));
    assert!(page.text(".parameters [role=status]").starts_with("0 of "));
    page.evaluate(&format!("document.querySelector('{gain} input').scrollIntoView({{ block: 'center' }})"));
    page.type_into(&format!("{gain} input"), "70000");
    press(&mut page, "Send 1 change");
    page.wait_until(&format!(
        "document.querySelector('{gain} .problem').textContent.includes('out of range: 0 to 65535')"
    ));
    page.type_into(&format!("{gain} input"), "99");
    assert_eq!(page.text(&format!("{gain} .origin")), "edited");
    press(&mut page, "Send 1 change");
    page.wait_until("document.querySelector('.parameters .unsaved')?.textContent.startsWith('1 of ')");
    assert_eq!(page.text(&format!("{gain} .origin")), "differs");
    let values = other.parameters().expect("an answer").values;
    assert_eq!(values.get(id::VELOCITY_GAIN), Some(99));
    assert!(!other.config_state().expect("an answer").saved, "not before it is asked for");
    page.evaluate("document.querySelector('.parameters').scrollIntoView({ block: 'start' })");
    keep_picture(&mut page, "studio-parameters.png");
    press(&mut page, "Save on the drive");
    page.wait_until("document.querySelector('.parameters [role=status]').textContent.endsWith('All are saved on the drive.')");
    assert!(other.config_state().expect("an answer").saved);
    press(&mut page, "Take over the design");
    press(&mut page, "Send 1 change");
    page.wait_until("document.querySelector('.parameters [role=status]').textContent.startsWith('0 of ')");
    assert_eq!(page.complaints, Vec::<String>::new());
}

#[test]
fn a_test_is_run_recorded_saved_and_laid_over_its_simulation() {
    let (mut page, _rig, _) = commanding("servo-b-tuned");
    // A download is a click on a link: what it would save is kept instead.
    page.evaluate(
        "window.saved = []; HTMLAnchorElement.prototype.click = function () { saved.push(this.download); }",
    );
    run_the_test(&mut page);
    wait_for_mode(&mut page, "holding");
    press(&mut page, "Record");
    page.wait_until("document.querySelector('#runs .record') && document.querySelector('table.deviation')");
    let name = page.text("#runs .record span");
    assert!(name.starts_with("TARGET-") && name.ends_with(".DAT"), "{name}");
    assert_eq!(page.evaluate("saved"), json!([name]));
    assert!(page.text("table.deviation").contains("position"));
    assert!(page.text(".scope [role=status]").starts_with("The graphs show the runs of the page."));
    press(&mut page, "Show live");
    page.wait_until("!document.querySelector('.scope [role=status]').textContent.startsWith('The graphs')");
    assert_eq!(page.complaints, Vec::<String>::new());
}

#[test]
fn a_record_is_handed_to_the_identification_with_one_button() {
    let file = Rig::read("rig.toml", STROKES).expect("a rig");
    let real = file.with_numbers(&[("load.mass_kg", 1.8), ("load.viscous_n_s_per_m", 26.0)]).expect("a rig");
    let (mut page, _rig, _) = commanding_rig("rig.toml", STROKES, real, false);
    page.evaluate(
        "window.saved = []; HTMLAnchorElement.prototype.click = function () { saved.push(this.download); }",
    );
    let identify =
        "[...document.querySelectorAll('#commission button')].find((one) => one.textContent === 'Identify')";
    assert_eq!(page.evaluate(&format!("{identify}.disabled")), json!(true), "there is no record yet");
    // A record that was not taken from here, and that cannot be fitted with this rig.
    drop_file(&mut page, "OTHER.DAT", include_str!("../../tests/fixtures/TARGET-1.DAT"));
    page.wait_until("document.querySelector('#runs .record')");
    assert_eq!(page.evaluate(&format!("{identify}.disabled")), json!(true), "it is not of this drive");
    // Two unknowns take no minute.
    page.click("#to-study");
    page.click("#study [data-task=identify]");
    leave_unknown(&mut page, &["load.mass_kg", "load.viscous_n_s_per_m"]);
    page.click("#to-commission");
    run_the_test(&mut page);
    wait_for_mode(&mut page, "holding");
    press(&mut page, "Record");
    press(&mut page, "Identify");
    let record = page.evaluate("saved[0]").as_str().expect("a record").to_owned();
    let command = format!(
        "pneudrive identify rig.toml {record} --fit load.mass_kg,load.viscous_n_s_per_m --out identified"
    );
    page.wait_until(&format!("document.getElementById('study-command').value === {}", json!(command)));
    page.wait_until("document.getElementById('study-at').textContent.startsWith('done in')");
    assert_eq!(page.text("#exhibit code"), command);
    let found = page.text("#study-take + small");
    let mass = found.strip_prefix("load.mass_kg=").and_then(|rest| rest.split(',').next());
    let mass: f64 = mass.expect("a mass").parse().expect("a number");
    assert!((mass - 1.8).abs() < 0.018, "{found}");
    // Its own figures stand beside those of the simulation.
    let own = page.evaluate("[...document.querySelectorAll('#figures table.recorded caption')].map((one) => one.textContent.split(': ')[0])");
    assert_eq!(own, json!(["OTHER.DAT", record]));
    // The page commands the drive all the time.
    page.click("#to-commission");
    wait_for_mode(&mut page, "holding");
    // Once the record is dismissed, there is nothing to be found from it.
    page.evaluate("for (const button of document.querySelectorAll('#runs .record button')) button.click()");
    page.wait_until(&format!("{identify}.disabled"));
    assert_eq!(page.complaints, Vec::<String>::new());
}

/// A page that stands still, as one whose browser is stopped, is not heard any more.
#[test]
fn a_test_whose_page_stands_still_ends() {
    let text =
        builtin("servo-b-tuned").expect("a built-in rig").replace("duration_s = 3.1", "duration_s = 20.0");
    let real = Rig::builtin("servo-b-tuned").expect("a built-in rig");
    let (mut page, rig, _) = commanding_rig("long", &text, real, true);
    run_the_test(&mut page);
    page.evaluate("{ const begun = performance.now(); while (performance.now() - begun < 1000); }");
    wait_for_mode(&mut page, "disarmed");
    assert_eq!(page.text("#commission .problem"), "disarmed: the page was silent");
    assert_eq!(Client::connect(rig.port()).expect("a rig").status().expect("a status").mode, Mode::Disarmed);
}

/// Whether the buttons that jog can be pressed.
fn can_jog(page: &mut Browser) -> bool {
    let enabled =
        page.evaluate("[...document.querySelectorAll('#commission .jog')].map((one) => !one.disabled)");
    assert!(enabled == json!([true, true]) || enabled == json!([false, false]), "{enabled}");
    enabled == json!([true, true])
}

/// A jog arms the drive by itself, so a drive that is disarmed can be jogged; one that has tripped or is not this page's
/// cannot.
#[test]
fn the_jog_is_disabled_where_the_drive_must_not_move() {
    let (mut page, rig, _) = commanding("servo-b-tuned");
    page.wait_until("!document.querySelector('#commission .jog').disabled");
    assert!(can_jog(&mut page));
    page.press("Escape", 27, false);
    wait_for_mode(&mut page, "fault");
    assert!(!can_jog(&mut page), "it has tripped");
    let place = page.middle("#commission .jog");
    page.mouse("mousePressed", place);
    rest(&mut page);
    page.mouse("mouseReleased", place);
    assert_eq!(Client::connect(rig.port()).expect("a rig").status().expect("a status").mode, Mode::Fault);
    press(&mut page, "Arm");
    wait_for_mode(&mut page, "armed");
    assert!(can_jog(&mut page));
    press(&mut page, "Leave");
    wait_for_mode(&mut page, "not connected");
    assert!(!can_jog(&mut page), "nobody commands it");
    assert_eq!(page.complaints, Vec::<String>::new());
}

/// The time of the cursor, s, and the position there, mm.
fn at_cursor(page: &mut Browser) -> [f64; 2] {
    let readout = page.text("#readout");
    let number = |before: &str| -> f64 {
        let rest = readout.split_once(before).expect("in the readout").1;
        rest.split(' ').next().expect("a number").parse().expect("a number")
    };
    [number("at "), number("position ")]
}

#[test]
fn the_scope_holds_the_samples_around_a_crossing_and_leaves_gaps_open() {
    let (mut page, _rig, _) = commanding("servo-b-tuned");
    for (field, value) in
        [("window", "0.5"), ("trigger", "single"), ("channel", "position"), ("slope", "rising")]
    {
        choose(&mut page, &format!("#scope-{field}"), value);
    }
    page.evaluate("document.getElementById('scope-level').value = 'high'");
    choose(&mut page, "#scope-before", "40");
    assert!(page.text(".scope .problem").starts_with("give the level as a number of mm"));
    choose(&mut page, "#scope-level", "150");
    assert_eq!(page.text(".scope .problem"), "");
    run_the_test(&mut page);
    page.wait_until("document.querySelector('.scope [role=status]').textContent.startsWith('The cursor is at the crossing.')");
    assert!(page.text(".scope [role=status]").contains("769 samples a second while a test runs"));
    let [at_s, mm] = at_cursor(&mut page);
    // The cursor stands at the first sample behind the crossing: one sample of 1.3 ms at 2 m/s at most.
    assert!((at_s - 0.2).abs() < 0.002 && (150.0..152.6).contains(&mm), "{at_s} s, {mm} mm");
    wait_for_mode(&mut page, "holding");
    keep_picture(&mut page, "studio-scope.png");
    assert_eq!(at_cursor(&mut page), [at_s, mm], "what is held stays");

    // Waits for no crossing that lies in a gap, and draws no line through one.
    let crossings = "import('/trigger.js').then(({ crossing }) => [[1, 2, 3], [1, NaN, 3]].map((values) => \
        crossing([0, 1, 2], values, { after: -1, level: 2.5, isRising: true })))";
    assert_eq!(page.evaluate(crossings), json!([2, null]));
    page.evaluate(LINES);
    assert_eq!(page.evaluate("strokes([0, 1, 2, 3], [1, 2, 3, 4])"), json!([3]));
    assert_eq!(page.evaluate("strokes([0, 1, 2, 3], [1, NaN, 3, 4])"), json!([0, 2]));
    let dense = "strokes(Array.from({ length: 9000 }, (_, k) => k / 3000), Array.from({ length: 9000 }, (_, k) => (k > 3000 && k < 6000 ? NaN : k)))";
    assert_eq!(page.evaluate(&format!("{dense}.length")), json!(2), "two pieces, of many samples a pixel");
    assert_eq!(page.complaints, Vec::<String>::new());
}

/// How many lines each piece of a drawn curve has: a canvas takes no point that is NaN.
const LINES: &str = "import('/panel.js').then(({ drawPanel }) => {
  window.strokes = (time, values) => {
    let pieces = [];
    const draw = {
      beginPath() { pieces = []; },
      moveTo() { pieces.push(0); },
      lineTo(x, y) {
        if (Number.isNaN(y)) return;
        if (pieces.length === 0) pieces.push(0);
        else pieces[pieces.length - 1] += 1;
      },
    };
    const context = new Proxy({}, { get: (_, name) => draw[name] ?? (() => {}), set: () => true });
    const run = { time, curves: new Map([['position', values]]) };
    const box = { left: 0, right: 300, top: 0, bottom: 100 };
    drawPanel(context, { id: 'position', curves: ['position'] }, box, [run], { from: 0, to: 3, ticks: [], colours: {} });
    return pieces;
  };
})";

/// Begins a bring-up and answers its questions, until it is over or a problem has ended it.
fn go_through(page: &mut Browser) {
    let asks = |what: &str| {
        format!(
            "document.querySelector('.bring-up .question').textContent.startsWith('{what}') || document.querySelector('.bring-up .problem').textContent"
        )
    };
    let is_ended = |page: &mut Browser| !page.text(".bring-up .problem").is_empty();
    press(page, "Begin");
    page.wait_until(&asks("The cylinder will move"));
    if is_ended(page) {
        return;
    }
    assert!(page.text(".checks").contains("right encoder by hand"), "{}", page.text(".checks"));
    // Taking a picture stops the page for a while, and one that says nothing ends a bring-up.
    if std::env::var_os("PNEUDRIVE_SHOTS").is_some() {
        keep_picture(page, "studio-bring-up.png");
    }
    press(page, "Yes");
    page.wait_until(&asks("Take the wire"));
    if is_ended(page) {
        return;
    }
    press(page, "No");
    // What it finds is for commission_tasks.rs: here the machine may be slower than the rig.
    page.wait_until(
        "document.querySelector('.bring-up .now').textContent.includes('checks right') || document.querySelector('.bring-up .problem').textContent",
    );
}

#[test]
fn a_bring_up_is_gone_through_from_the_page_and_its_report_saved() {
    let (mut page, rig, wiring) = commanding("servo-c");
    wiring.push_again_and_again();
    page.evaluate(
        "window.saved = []; HTMLAnchorElement.prototype.click = function () { saved.push(this.download); }",
    );
    open(&mut page, "bring-up");
    page.evaluate("document.getElementById('bring-up-most').value = '80'");
    press(&mut page, "Begin");
    page.wait_until("document.querySelector('.bring-up .problem').textContent.includes('3 to 50 %')");
    page.evaluate("document.getElementById('bring-up-most').value = '30'");
    // On a machine that starves the page, the page is silent, and that ends a bring-up.
    let is_done = (0..5).any(|_| {
        go_through(&mut page);
        !page.text(".bring-up .problem").contains("the page was silent")
    });
    assert!(is_done, "the page was silent each time");
    assert_eq!(page.text(".bring-up .problem"), "");
    // Its last check may be told behind its answer, which stays.
    page.wait_until("document.querySelector('.checks').textContent.includes('pulses')");
    rest(&mut page);
    assert!(page.text(".bring-up .now").contains("checks right"), "{}", page.text(".bring-up .now"));
    press(&mut page, "Save the report");
    assert_eq!(page.evaluate("saved"), json!(["bring-up.md"]));

    // Esc ends it, too, and leaves a drive that is stopped.
    press(&mut page, "Begin");
    page.wait_until("document.querySelector('.bring-up .now').textContent.startsWith('Push the slide OUT')");
    page.press("Escape", 27, false);
    wait_for_mode(&mut page, "fault");
    page.wait_until(
        "document.querySelector('.bring-up .problem').textContent.includes('the drive was stopped')",
    );
    assert_eq!(Client::connect(rig.port()).expect("a rig").status().expect("a status").mode, Mode::Fault);
    assert_eq!(page.complaints, Vec::<String>::new());
}

/// The figure of the readouts under a name, mm or kPa; None of a word.
fn readout(page: &mut Browser, figure: &str) -> Option<f64> {
    page.text(&format!("#readouts [data-figure={figure}]")).parse().ok()
}

/// What the page has sent to the drive since it was told to keep it.
const KEEP_ORDERS: &str = "window.sent = []; { const ask = window.fetch; window.fetch = (path, options) => { \
    if (path.endsWith('/api/order')) sent.push(JSON.parse(options.body)); return ask(path, options); }; }";

fn sent(page: &mut Browser, order: &str) -> serde_json::Value {
    page.evaluate(&format!("sent.filter((one) => one.order === '{order}')"))
}

#[test]
fn position_pressures_and_state_are_legible_from_two_metres_with_stop_at_hand() {
    let (mut page, _rig, _) = commanding("servo-b-tuned");
    page.wait_until("parseFloat(document.querySelector('#readouts [data-figure=position]').textContent) > 0");
    assert!(readout(&mut page, "pressure-1").is_some_and(|kpa| kpa > 90.0));
    assert_eq!(page.text("#readouts [data-figure=mode]"), "disarmed");
    for [width, height] in [[1024, 640], [1366, 768]] {
        let size = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        page.call("Emulation.setDeviceMetricsOverride", size);
        rest(&mut page);
        let least = "Math.min(...[...document.querySelectorAll('#readouts strong')].map((one) => parseFloat(getComputedStyle(one).fontSize)))";
        assert!(page.evaluate(least).as_f64() >= Some(48.0));
        let is_seen = "['#stop', '#readouts', '#commission .jog', '#go-mm'].every((one) => { \
            const { top, bottom, left, right } = document.querySelector(one).getBoundingClientRect(); \
            return top >= 0 && left >= 0 && bottom <= innerHeight && right <= innerWidth; })";
        assert_eq!(page.evaluate(is_seen), json!(true), "{width} x {height}");
        let one_line =
            "new Set([...document.querySelectorAll('#readouts p')].map((one) => one.offsetTop)).size";
        assert_eq!(page.evaluate(one_line), json!(1), "{width} x {height}");
    }
    assert_eq!(page.complaints, Vec::<String>::new());
}

#[test]
fn a_place_beyond_the_soft_limits_is_not_sent_and_a_step_goes_on_from_the_setpoint() {
    let text = builtin("servo-b-tuned").expect("a built-in rig");
    let limited = Rig::builtin("servo-b-tuned").expect("a built-in rig");
    let limited = limited.with_settings(&["safety.end_max_mm=200".to_owned()]).expect("valid");
    let (mut page, _rig, _) = commanding_rig("servo-b-tuned", text, limited, false);
    page.evaluate(KEEP_ORDERS);
    for (mm, told) in [
        ("200.5", "200.5 mm is out of reach: the drive goes from 0.0 to 200.0 mm; nothing was sent"),
        ("-1", "-1 mm is out of reach"),
        ("steam", "give the place in mm"),
    ] {
        page.type_into("#go-mm", mm);
        press(&mut page, "Go");
        let problem = page.text("#commission .problem");
        assert!(problem.starts_with(told), "{problem}");
    }
    rest(&mut page);
    assert_eq!(sent(&mut page, "go"), json!([]));
    page.type_into("#go-mm", "150");
    press(&mut page, "Go");
    wait_for_mode(&mut page, "running");
    wait_for_mode(&mut page, "holding");
    choose(&mut page, "#jog-step", "5");
    press(&mut page, "Step");
    page.wait_until("sent.filter((one) => one.order === 'go').length === 2");
    let to_mm = page.evaluate("sent.filter((one) => one.order === 'go')[1].mm").as_f64().expect("a place");
    assert!((to_mm - 155.0).abs() < 0.02 || (to_mm - 145.0).abs() < 0.02, "{to_mm} mm");
    assert_eq!(page.complaints, Vec::<String>::new());
}

#[test]
fn a_held_jog_asks_for_the_chosen_rate() {
    let (mut page, _rig, _) = commanding("servo-b-tuned");
    page.evaluate(KEEP_ORDERS);
    choose(&mut page, "#jog-rate", "2");
    let place = page.middle("#commission .jog:nth-of-type(2)");
    page.mouse("mousePressed", place);
    page.wait_until("sent.some((one) => one.order === 'extend')");
    page.mouse("mouseReleased", place);
    assert_eq!(page.evaluate("sent.find((one) => one.order === 'extend').mm_per_s"), json!(2));
}
