//! Pictures that are taken away or printed.
//!
//! Needs Chromium, so `cargo xtask test web` runs it, and `cargo test --workspace` does not.

use pneudrive_sim::rigfile::builtin;
use serde_json::{Value, json};

use crate::chromium::Browser;
use crate::opened::{page, page_of};

/// What a button would save: name and text, of a PNG its size in pixels.
fn saved(page: &mut Browser, button: &str) -> Value {
    page.evaluate(&format!(
        "(async () => {{ \
           let [name, content] = [null, null]; \
           HTMLAnchorElement.prototype.click = function () {{ name = this.download; }}; \
           URL.createObjectURL = (blob) => {{ content = blob; return 'data:,'; }}; \
           {button}.click(); \
           while (!name) await new Promise(requestAnimationFrame); \
           if (content.type !== 'image/png') return {{ name, text: await content.text() }}; \
           const {{ width, height }} = await createImageBitmap(content); \
           return {{ name, width, height }}; }})()"
    ))
}

fn tool(label: &str) -> String {
    format!("[...document.querySelectorAll('#channels button')].find((one) => one.textContent === '{label}')")
}

#[test]
fn every_picture_says_what_it_is_of_which_rig_when_and_by_which_version() {
    let mut page = page();
    let today = page.evaluate("new Date().toISOString().slice(0, 10)");
    let origin = format!(
        "servo-b-tuned · {} · pneudrive {}",
        today.as_str().expect("a day"),
        env!("CARGO_PKG_VERSION")
    );
    for (label, file, part) in
        [("SVG", "servo-b-tuned.svg", "position, mm"), ("Drive", "servo-b-tuned.drive.svg", "Cylinder")]
    {
        let svg = saved(&mut page, &tool(label));
        assert_eq!(svg["name"], json!(file));
        let text = svg["text"].as_str().expect("a text");
        for wanted in ["One test", origin.as_str(), part] {
            assert!(text.contains(wanted), "{label}: {wanted}");
        }
        assert!(!text.contains("class=") && !text.contains("var("), "{label}: it needs no style sheet");
    }
    let png = saved(&mut page, &tool("PNG"));
    let height = page.evaluate("document.getElementById('plot').clientHeight").as_f64().expect("a height");
    assert_eq!(png["height"].as_f64(), Some(height + 46.0), "with two lines above the graphs");
    page.evaluate(&format!("{}.click()", tool("Spectrum…")));
    page.wait_until("document.querySelector('.spectra .save-picture')");
    let spectrum = saved(&mut page, "document.querySelector('.spectra .save-picture')");
    assert!(spectrum["text"].as_str().expect("a text").contains(&origin));
    page.press("Escape", 27, false);
    page.click("#to-study");
    page.type_into("#study .steps", "2");
    page.type_into("#sweep-runs", "1");
    page.wait_until("document.getElementById('study-size').textContent === '2 points'");
    page.click("#study-start");
    page.wait_until("document.querySelector('#exhibit .save-picture')");
    let chart = saved(&mut page, "document.querySelector('#exhibit .save-picture')");
    assert!(
        chart["name"].as_str().expect("a name").ends_with(".png") && chart["height"].as_f64() > Some(400.0),
        "{chart}"
    );
    assert_eq!(page.complaints, Vec::<String>::new());
}

/// Whether the graphs are drawn in a colour of `colours.css`.
fn is_drawn_in(page: &mut Browser, [red, green, blue]: [u8; 3]) -> Value {
    page.evaluate(&format!(
        "(() => {{ const canvas = document.querySelector('#plot canvas'); \
         const {{ data }} = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height); \
         for (let k = 0; k < data.length; k += 4) if (data[k] === {red} && data[k + 1] === {green} && data[k + 2] === {blue} && data[k + 3] === 255) return true; \
         return false; }})()"
    ))
}

#[test]
fn a_dark_page_is_printed_light() {
    let mut page = page();
    let dark = json!({ "features": [{ "name": "prefers-color-scheme", "value": "dark" }] });
    page.call("Emulation.setEmulatedMedia", dark);
    page.evaluate("new Promise((go) => requestAnimationFrame(() => requestAnimationFrame(go)))");
    let grids = [[0xe4, 0xe9, 0xed], [0x27, 0x31, 0x3a]];
    assert_eq!(grids.map(|grid| is_drawn_in(&mut page, grid)), [json!(false), json!(true)]);
    page.evaluate("dispatchEvent(new Event('beforeprint'))");
    assert_eq!(grids.map(|grid| is_drawn_in(&mut page, grid)), [json!(true), json!(false)]);
    assert_eq!(page.evaluate("getComputedStyle(document.body).backgroundColor"), json!("rgb(243, 245, 247)"));
    page.evaluate("dispatchEvent(new Event('afterprint'))");
    assert_eq!(grids.map(|grid| is_drawn_in(&mut page, grid)), [json!(false), json!(true)]);
    assert_eq!(page.complaints, Vec::<String>::new());
}

/// The angle of the small axis beside the drive, degrees clockwise; None where there is none.
fn drawn_angle(page: &mut Browser) -> Option<f64> {
    page.evaluate(
        "(() => { const axis = document.getElementById('incline'); if (getComputedStyle(axis).display === 'none') return null; \
         const { a, b } = axis.querySelector('.barrel').getCTM(); return Math.round(Math.atan2(b, a) * 180 / Math.PI); })()",
    )
    .as_f64()
}

#[test]
fn a_vertical_axis_is_drawn_upright_and_an_inclined_one_at_its_angle() {
    for (degrees, drawn) in [("90", Some(-90.0)), ("-90", Some(90.0)), ("30", Some(-30.0)), ("0", None)] {
        let text = builtin("servo-b-tuned").expect("a built-in rig");
        let text = text.replace("[load]\n", &format!("[load]\nincline_deg = {degrees}\n"));
        let mut page = page_of("inclined.toml", &text);
        assert_eq!(drawn_angle(&mut page), drawn, "{degrees} degrees");
        assert_eq!(page.complaints, Vec::<String>::new());
    }
}
