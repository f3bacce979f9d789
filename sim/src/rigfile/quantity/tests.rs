use super::*;
use crate::rig::all_keys;

fn value(text: &str, unit: &str) -> f64 {
    let reading = read(text, unit).unwrap_or_else(|message| panic!("{text}: {message}"));
    assert!(!reading.gauge, "{text}");
    reading.value
}

#[test]
fn catalogue_units_become_those_of_keys() {
    for (text, unit, expected) in [
        ("250 mm", "m", 0.25),
        ("32mm", "m", 0.032),
        ("2 in", "mm", 50.8),
        ("5.89 bar", "Pa", 589e3),
        ("5.89 bar(a)", "Pa", 589e3),
        ("0.6 MPa", "Pa", 6e5),
        ("20 degC", "K", 293.15),
        ("-5 °C", "K", 268.15),
        ("300 K", "K", 300.0),
        ("22 cm3", "m3", 22e-6),
        ("22 cm^3", "m3", 22e-6),
        ("0.5 l", "m3", 5e-4),
        ("2 dm3/(s bar)", "m3/(s Pa)", 2e-8),
        ("350 l/min", "m3/s", 350e-3 / 60.0),
        ("0.4 N/mm", "N/m", 400.0),
        ("30 N s/m", "N s/m", 30.0),
        ("1.3 ms", "s", 1.3e-3),
        ("8 kg", "kg", 8.0),
        ("500 g", "kg", 0.5),
        ("2.5 kN", "N", 2500.0),
        ("90 deg", "deg", 90.0),
        ("1 J/(kg K)", "J/(kg K)", 1.0),
        ("5 %", "%", 5.0),
        ("3.6 mm/h", "mm/h", 3.6),
    ] {
        let got = value(text, unit);
        assert!((got - expected).abs() <= 1e-14 * expected.abs(), "{text}: {got}");
    }
}

#[test]
fn gauge_is_told_from_absolute() {
    for text in ["6 bar(g)", "6 barg", "6 bar (g)", "600 kPa(g)", "600 kPag"] {
        assert_eq!(
            read(text, "Pa"),
            Ok(Reading { value: 6e5, gauge: true, says_from_where: true }),
            "{text}"
        );
    }
    assert!(read("14.5 psig", "Pa").expect("a pressure").gauge);
    assert_eq!(value("6 bara", "Pa"), 6e5);
    assert!(read("6 g", "kg").is_ok_and(|reading| !reading.gauge), "a gram is no gauge pressure");
}

#[test]
fn what_is_wrong_is_said_with_what_would_be_right() {
    for (text, unit, expected) in [
        ("6", "Pa", "needs a unit: write it as \"6 bar(g)\", or in another unit"),
        ("six bar", "Pa", "must be a number with a unit, such as \"6 bar(g)\", is \"six bar\""),
        ("6 foo", "Pa", "foo is not a known unit; use Pa"),
        ("6 mm", "Pa", "mm is not a unit of the same quantity as Pa"),
        ("6 bar(g)", "N", "bar(g) is not a unit of the same quantity as N"),
        ("6 mm", "counts", "is in counts, which cannot be converted from another unit"),
        ("inf mm", "m", "must be a number with a unit"),
        ("1e308 km", "m", "1e308 km is too large"),
        ("250", "m", "needs a unit: write it as \"250 mm\", or in another unit"),
        ("20", "K", "needs a unit: write it as \"20 degC\""),
        ("1,500 kg", "kg", "\"1,500\" may be 1500 or 1.500: write one of these"),
        ("1,2,3 kg", "kg", "must be a number with a unit"),
        ("350 Nl/min", "m3/s", "Nl/min is not a known unit"),
        ("5 kg (ANR)", "kg", "kg (ANR) is not a known unit"),
        ("6 bar(g) s", "Pa", "bar(g) s is not a unit of the same quantity"),
    ] {
        let message = read(text, unit).expect_err(text);
        assert!(message.starts_with(expected), "{text}: {message}");
    }
}

#[test]
fn every_unit_of_a_key_is_understood() {
    let counted = ["", "%", "samples", "counts", "mm/count", "mm/step"];
    for key in all_keys().filter(|key| !counted.contains(&key.unit()) && key.unit() != "1/s2") {
        assert_eq!(value(&format!("7 {}", key.unit()), key.unit()), 7.0, "{}", key.path);
    }
}

/// An interval has no zero; a temperature has.
#[test]
fn a_temperature_on_a_scale_with_its_own_zero_is_no_interval() {
    for (text, kelvin) in [
        ("300 degF", 422.038_888_888_888_9),
        ("300 \u{b0}F", 422.038_888_888_888_9),
        ("300 F", 422.038_888_888_888_9),
        ("300 \u{2109}", 422.038_888_888_888_9),
        ("68 deg F", 293.15),
        ("20 \u{ba}C", 293.15),
        ("20 \u{2da}C", 293.15),
        ("20 \u{2103}", 293.15),
        ("20 deg C", 293.15),
        ("20 Celsius", 293.15),
        ("540 degR", 300.0),
        ("300 \u{b0}K", 300.0),
    ] {
        let got = value(text, "K");
        assert!((got - kelvin).abs() < 1e-10, "{text}: {got}");
    }
    assert_eq!(value("9 J/(kg degF)", "J/(kg K)"), 16.2, "between two temperatures there is no zero");
    assert_eq!(value("9 J/(kg degC)", "J/(kg K)"), 9.0);
}

#[test]
fn units_are_read_as_people_write_them() {
    for (text, unit, expected) in [
        ("5 \u{b5}m", "mm", 5e-3),
        ("5 \u{3bc}m", "mm", 5e-3),
        ("5 um", "mm", 5e-3),
        ("90\u{ba}", "deg", 90.0),
        ("\u{2212}5 \u{b0}", "deg", -5.0),
        ("30 Ns/m", "N s/m", 30.0),
        ("30 N.s/m", "N s/m", 30.0),
        ("30 N\u{22c5}s/m", "N s/m", 30.0),
        ("30 N\u{b7}s/m", "N s/m", 30.0),
        ("30 N/(m/s)", "N s/m", 30.0),
        ("30 N\u{2215}(m/s)", "N s/m", 30.0),
        ("2 m/s/s", "m/s2", 2.0),
        ("2 m s-2", "m/s2", 2.0),
        ("2 m\u{b7}s\u{207b}\u{b2}", "m/s2", 2.0),
        ("10 lbs", "kg", 4.535924),
        ("350 l/min (ANR)", "m3/s", 350e-3 / 60.0),
        ("350 l/min(ANR)", "m3/s", 350e-3 / 60.0),
        ("2 dm3/(s bar) (ANR)", "m3/(s Pa)", 2e-8),
        ("8,5 kg", "kg", 8.5),
        ("0,125 kg", "kg", 0.125),
        (".5 kg", "kg", 0.5),
        ("8\u{a0}kg", "kg", 8.0),
        ("6 Bar", "Pa", 6e5),
        ("1e3 mm", "m", 1.0),
        ("1 m2 s/m2", "s", 1.0),
    ] {
        let got = value(text, unit);
        assert!((got - expected).abs() <= 1e-14 * expected.abs(), "{text}: {got}");
    }
}

/// Whether a pressure says what it counts from is in its unit, however that is spelt.
#[test]
fn a_pressure_says_what_it_counts_from_or_does_not() {
    for text in ["6 bar", "0.6 MPa", "600 kPa", "600000 Pa", "87 psi", "6 kgf/cm2"] {
        assert!(read(text, "Pa").is_ok_and(|reading| !reading.says_from_where), "{text}");
    }
    for (text, gauge) in [
        ("6 bar(g)", true),
        ("87 psig", true),
        ("87 PSIG", true),
        ("6 bar gauge", true),
        ("600000 Pa(g)", true),
        ("0.6 MPa(a)", false),
        ("87 psia", false),
        ("6 bar abs", false),
    ] {
        let reading = read(text, "Pa").unwrap_or_else(|message| panic!("{text}: {message}"));
        assert_eq!((reading.gauge, reading.says_from_where), (gauge, true), "{text}");
    }
}

/// What an error tells to write can be written.
#[test]
fn every_suggestion_is_understood() {
    let units = all_keys().map(|key| key.unit()).filter(|unit| !unit.is_empty());
    let numbers = [0.0, 1e-9, 0.3, 6.0, 250.0, 20e3, 6e5, -5.0, 1e12];
    for (unit, number) in units.flat_map(|unit| numbers.map(|number| (unit, number))) {
        let message = read(&number.to_string(), unit).expect_err("no unit");
        let suggested = message.split('"').nth(1).unwrap_or_else(|| panic!("{message}"));
        assert!(read(suggested, unit).is_ok(), "{message}");
    }
    let example = read("six", "Pa").expect_err("no number");
    assert!(read(example.split('"').nth(1).expect("an example"), "Pa").is_ok());
}

/// What docs/howto/own-drive.md shows is read, and what it says to be refused is.
#[test]
fn the_page_on_own_drives_says_what_units_are_read() {
    let page = include_str!("../../../../docs/howto/own-drive.md");
    let part = |from: &str, to: &str| {
        let begin = page.find(from).unwrap_or_else(|| panic!("{from}"));
        page[begin..]
            .split(to)
            .next()
            .expect("a part")
            .split('`')
            .filter_map(|text| text.strip_prefix('"'))
            .filter_map(|text| text.strip_suffix('"'))
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    let shown = part("Any unit of a quantity", "A number without");
    assert!(shown.len() > 10, "{shown:?}");
    for text in shown {
        let units = ["m", "m3/s", "m3/(s Pa)", "mm", "N s/m", "K", "kg"];
        assert!(units.iter().any(|unit| read(&text, unit).is_ok()), "{text}");
    }
    assert!(read("1,500 kg", "kg").is_err());
}
