//! The files of the page: nothing inline, nothing from elsewhere, and colours that can be read.

use std::collections::BTreeMap;

use pneudrive_page::assets::ASSETS;

fn asset(name: &str) -> &'static str {
    ASSETS.iter().find(|(asset, ..)| *asset == name).expect(name).2
}

#[test]
fn no_file_has_an_inline_script_or_style_or_asks_another_server() {
    for (name, _, text) in ASSETS {
        for forbidden in ["style=\"", "onclick", "innerHTML", "eval(", "https://", "@import url"] {
            assert!(!text.contains(forbidden), "{name}: {forbidden}");
        }
        let addresses = text.matches("http://").count();
        assert_eq!(addresses, text.matches("http://www.w3.org/2000/svg").count(), "{name}");
    }
    let page = asset("index.html");
    assert_eq!(page.matches("<script").count(), page.matches("<script type=\"module\" src=").count());
    assert!(!page.contains("<style"));
}

#[test]
fn every_module_and_style_sheet_that_is_asked_for_is_served() {
    for sheet in asset("index.html").split("href=\"").skip(1).filter_map(|rest| rest.split('"').next()) {
        assert!(sheet == "data:," || ASSETS.iter().any(|(asset, ..)| *asset == sheet), "{sheet}");
    }
    for (name, _, text) in ASSETS.iter().filter(|(name, ..)| name.ends_with(".js")) {
        for line in text.lines().filter(|line| line.starts_with("import ")) {
            let module = line.split('\'').nth(1).expect("a module").trim_start_matches("./");
            assert!(ASSETS.iter().any(|(asset, ..)| *asset == module), "{name} imports {module}");
        }
    }
}

/// The colours of a scheme by name: those of the light one, and what the dark one changes.
fn colours(is_dark: bool) -> BTreeMap<String, [f64; 3]> {
    let css = asset("colours.css");
    let (light, dark) = css.split_once("@media (prefers-color-scheme: dark)").expect("two schemes");
    let text = if is_dark { format!("{light}{dark}") } else { light.to_owned() };
    let lines = text.lines().filter_map(|line| line.trim().strip_prefix("--")?.split_once(": #"));
    lines.map(|(name, digits)| (name.to_owned(), rgb(digits.trim_end_matches(';')))).collect()
}

fn rgb(digits: &str) -> [f64; 3] {
    [0, 2, 4].map(|at| f64::from(u8::from_str_radix(&digits[at..at + 2], 16).expect("two digits")) / 255.0)
}

/// Relative luminance of WCAG 2.
fn luminance(colour: [f64; 3]) -> f64 {
    let linear =
        colour.map(|part| if part <= 0.04045 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) });
    0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
}

/// Contrast of WCAG 2, 1 to 21.
fn contrast(one: [f64; 3], other: [f64; 3]) -> f64 {
    let [one, other] = [luminance(one), luminance(other)];
    (one.max(other) + 0.05) / (one.min(other) + 0.05)
}

/// WCAG AA asks 4.5 of text and 3 of curves.
#[test]
fn text_and_curves_can_be_read_in_both_schemes() {
    for is_dark in [false, true] {
        let colours = colours(is_dark);
        for text in ["text", "muted", "accent", "wrong", "doubt", "sound"] {
            for ground in ["surface", "ground"] {
                let found = contrast(colours[text], colours[ground]);
                assert!(found >= 4.5, "{text} on {ground}, dark {is_dark}: {found:.2}");
            }
        }
        assert!(contrast(colours["on-accent"], colours["accent"]) >= 4.5);
        for (name, colour) in colours.iter().filter(|(name, _)| name.starts_with("curve-")) {
            let found = contrast(*colour, colours["surface"]);
            assert!(found >= 3.0, "{name}, dark {is_dark}: {found:.2}");
        }
    }
    assert!((contrast([0.0; 3], [1.0; 3]) - 21.0).abs() < 1e-9);
}
