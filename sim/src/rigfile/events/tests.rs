//! Fault events of a rig file: what is accepted, and what every refusal says.

use crate::component::faults::{EVENTS, FaultEvent, FaultKind, OpenSensor};
use crate::key::Kind;
use crate::rig::{Problems, explain};
use crate::values::Rig;

fn read(text: &str) -> Result<Rig, Vec<String>> {
    Rig::read("rig.toml", text)
        .map_err(|Problems(problems)| problems.iter().map(ToString::to_string).collect())
}

fn events(text: &str) -> Vec<FaultEvent> {
    read(text).unwrap_or_else(|problems| panic!("{problems:?}")).fault_events()
}

fn only_problem(text: &str) -> String {
    let found = read(text).expect_err("refused");
    assert_eq!(found.len(), 1, "{found:?}");
    found.into_iter().next().expect("one")
}

#[test]
fn every_kind_is_read_with_the_defaults_of_its_fields() {
    use FaultKind::{EncoderJump, EncoderLoss, Leak, SensorOpen, StuckSpool, SupplyDip, SwappedTubes};
    let kinds = [
        SwappedTubes,
        StuckSpool,
        // Midway between 589 and 101.3 kPa.
        SupplyDip { pressure: 345_150.0, duration_us: 500_000 },
        Leak { chamber: 0, diameter: 1e-3 },
        EncoderLoss,
        EncoderJump { counts: 1000 },
        SensorOpen(OpenSensor::Pressure1),
    ];
    let text: String = EVENTS
        .words
        .iter()
        .map(|(kind, _)| format!("[[faults.event]]\nkind = \"{kind}\"\nat_s = 0.25\n"))
        .collect();
    let expected: Vec<FaultEvent> =
        kinds.into_iter().map(|kind| FaultEvent { at_us: 250_000, kind }).collect();
    assert_eq!(events(&text), expected);
    assert_eq!(events(""), []);
    assert_eq!(events("[faults]\nevent = []\n"), []);
}

#[test]
fn fields_that_are_given_count() {
    let text = "[[faults.event]]\nkind = \"leak\"\nat_s = 0\nchamber = 2\ndiameter_mm = 3\n\
        [[faults.event]]\nkind = \"sensor-open\"\nat_s = 1\nsensor = \"spool\"\n\
        [[faults.event]]\nkind = \"supply-dip\"\nat_s = 1e-6\npressure_pa = 200000\nduration_s = 2\n";
    let kinds: Vec<FaultKind> = events(text).iter().map(|event| event.kind).collect();
    assert_eq!(
        kinds,
        [
            FaultKind::Leak { chamber: 1, diameter: 3e-3 },
            FaultKind::SensorOpen(OpenSensor::Spool),
            FaultKind::SupplyDip { pressure: 2e5, duration_us: 2_000_000 },
        ]
    );
}

#[test]
fn a_list_in_one_line_is_the_same_in_a_file_and_as_a_setting() {
    let list = "[{kind = \"leak\", at_s = 0.5}, {kind = \"stuck-spool\", at_s = 1}]";
    let tables =
        "[[faults.event]]\nkind = \"leak\"\nat_s = 0.5\n[[faults.event]]\nkind = \"stuck-spool\"\nat_s = 1\n";
    assert_eq!(events(&format!("[faults]\nevent = {list}\n")), events(tables));
    let setting = |value: &str| Rig::read_with("rig.toml", tables, &[format!("faults.event={value}")]);
    assert_eq!(setting(list).expect("valid").fault_events(), events(tables));
    assert_eq!(setting("[]").expect("valid").fault_events(), [], "what is typed last holds");
    for (value, expected) in [
        ("leak", "--set: faults.event: write each event as a table: [[faults.event]]"),
        ("[{kind = \"leak\", at_s = -1}]", "--set: faults.event.at_s: must be between 0 s and 4000 s, is -1"),
    ] {
        let message = setting(value).expect_err("refused").to_string();
        assert!(message.starts_with(expected), "{message}");
    }
}

/// Every refusal names the line of its field, or of its event where a field is missing.
#[test]
fn every_slip_is_named_with_file_line_and_key() {
    let leak = "[load]\nmass_kg = 2\n\n[[faults.event]]\nkind = \"leak\"\n";
    for (field, expected) in [
        ("at_s = -0.1", "6: faults.event.at_s: must be between 0 s and 4000 s, is -0.1"),
        ("at_s = 1.0000005", "6: faults.event.at_s: must be a whole number of microseconds"),
        ("at_s = \"now\"", "6: faults.event.at_s: must be a number in s without the unit, not a string"),
        ("chamber = 1", "4: faults.event.at_s: every event needs its at_s"),
        ("at_s = 1\nchamber = 3", "7: faults.event.chamber: must be between 1 and 2, is 3"),
        ("at_s = 1\nchamber = 1.0", "7: faults.event.chamber: must be a whole number, not a float"),
        ("at_s = 1\ndiameter_mm = 20", "7: faults.event.diameter_mm: must be between 0.001 mm and 10 mm"),
        ("at_s = 1\ndiameter = 2", "7: faults.event.diameter: unknown key; did you mean diameter_mm?"),
        (
            "at_s = 1\ncounts = 2",
            "7: faults.event.counts: does not belong to a fault of the kind leak, but to encoder-jump",
        ),
    ] {
        let message = only_problem(&format!("{leak}{field}\n"));
        assert!(message.starts_with(&format!("rig.toml:{expected}")), "{message}");
    }
}

#[test]
fn an_event_without_a_kind_or_of_an_unknown_one_is_refused() {
    let message = only_problem("[[faults.event]]\nat_s = 1\n");
    assert_eq!(message, "rig.toml:1: faults.event.kind: every event needs its kind");
    let message = only_problem("[[faults.event]]\nat_s = 1\nkind = \"flood\"\n");
    assert!(message.starts_with("rig.toml:3: faults.event.kind: must be one of \"swapped-tubes\""));
    let message = only_problem("[faults.event]\nkind = \"leak\"\n");
    assert!(message.contains("faults.event: write each event as a table: [[faults.event]]"), "{message}");
}

#[test]
fn a_dip_that_is_none_is_refused() {
    for pressure in [589_000, 101_300, 600_000] {
        let text = format!("\n[[faults.event]]\nkind = \"supply-dip\"\nat_s = 0\npressure_pa = {pressure}\n");
        let message = only_problem(&text);
        assert!(
            message.contains(&format!("faults.event: pressure_pa = {pressure} is not a dip")),
            "{message}"
        );
    }
}

#[test]
fn the_gain_bug_is_for_the_laws_that_it_was_in() {
    let bug = "[faults]\ngain_bug = \"positive-error\"\n";
    for (controller, refused) in [
        ("law = \"on-off\"", Some("gain-profile and proportional")),
        ("law = \"moore-proportional\"", Some("gain-profile and proportional")),
        ("loop = \"open\"", Some("an open loop has no gain")),
        ("law = \"proportional\"", None),
        ("law = \"gain-profile\"", None),
    ] {
        let result = read(&format!("{bug}[controller]\n{controller}\n"));
        match refused {
            None => assert!(result.is_ok(), "{controller}"),
            Some(why) => {
                let message = &result.expect_err("refused")[0];
                assert!(message.starts_with("rig.toml:2: faults.gain_bug: ") && message.contains(why));
            }
        }
    }
    let other = "[faults]\ngain_bug = \"last-gain\"\n";
    assert!(only_problem(&format!("{other}[controller]\nlaw = \"proportional\"\n")).contains("gain-profile"));
    assert!(read(other).is_ok());
    let continuous = "[controller]\nmodel = \"continuous\"\n[operator]\nhysteresis_percent = 0\n";
    assert!(only_problem(&format!("{bug}{continuous}")).contains("of the sampled controller"));
}

#[test]
fn the_list_is_explained_with_all_kinds_and_fields() {
    let text = explain("faults.event").expect("a key");
    for (kind, meaning) in EVENTS.words {
        assert!(text.contains(kind) && text.contains(meaning), "{text}");
    }
    for field in EVENTS.fields {
        assert!(text.contains(field.path) && text.contains(field.meaning), "{text}");
        assert!(text.contains(&field.models.join(", ")));
    }
    for fact in ["unit       mm", "default    0.5", "range      0.001 to 10", "kinds      leak"] {
        assert!(text.contains(fact), "{fact}: {text}");
    }
    assert!(explain("faults.event.counts").expect("a field").contains("encoder-jump"));
}

#[test]
fn kinds_have_the_names_that_the_field_takes() {
    let Kind::Choice(options) = EVENTS.fields[0].kind else { panic!("a choice") };
    let names: Vec<&str> = options.iter().map(|(name, _)| *name).collect();
    assert_eq!(names, EVENTS.words.iter().map(|(name, _)| *name).collect::<Vec<_>>());
}

#[test]
fn events_are_written_as_they_are_read() {
    let text = "[[faults.event]]\nkind = \"encoder-jump\"\nat_s = 0.5\ncounts = -7\n";
    let rig = read(text).expect("valid");
    let written = rig.value(EVENTS.path).expect("events").to_string();
    assert_eq!(written, "[{ kind = \"encoder-jump\", at_s = 0.5, counts = -7 }]");
    assert_eq!(events(&format!("[faults]\nevent = {written}\n")), rig.fault_events());
}
