//! `export` and `import`: transients for other programs, and logs of other recorders.

use std::collections::BTreeMap;
use std::fs;

use pneudrive_logs::signals::Signals;
use pneudrive_records::target::TargetFile;
use pneudrive_sim::{Rig, keys};
use serde_json::Value;

use crate::program::{STROKES, folder, ok, transcript, virtual_rig};

/// A map of the columns that `export` writes of a record.
const MAP: &str = r#"
[time]
column = "time_s"
unit = "s"
[position]
column = "position_m"
unit = "m"
[setpoint]
column = "setpoint_m"
unit = "m"
[pressure_1]
column = "pressure_1_pa"
unit = "Pa"
[pressure_2]
column = "pressure_2_pa"
unit = "Pa"
[spool]
column = "spool_mm"
unit = "mm"
[command]
column = "command_counts"
unit = "counts"
"#;

#[test]
fn a_record_that_leaves_as_a_log_comes_back_in_every_integer() {
    let (folder, rig) = (folder(), virtual_rig("servo-b-tuned"));
    let path = folder.path();
    ok(path, &format!("run servo-b-tuned --set test.duration_s=0.5 --port {}", rig.port()));
    ok(path, &format!("record --port {}", rig.port()));
    let recorded = TargetFile::read(&path.join("TARGET01.DAT")).expect("a record");
    let in_mcap = MAP
        .replace("[time]\ncolumn = \"time_s\"\nunit = \"s\"\n", "")
        .replace("column = \"", "column = \"/drive.");
    for (format, map, number) in [("csv", MAP, 2), ("mcap", &*in_mcap, 3)] {
        fs::write(path.join("map.toml"), map).expect("written");
        ok(path, &format!("export TARGET01.DAT --to {format}"));
        let printed = ok(path, &format!("import TARGET01.{format} servo-b-tuned --columns map.toml"));
        assert!(
            printed.contains(&format!("TARGET0{number}.DAT: {} samples", recorded.samples.len())),
            "{printed}"
        );
        let imported = TargetFile::read(&path.join(format!("TARGET0{number}.DAT"))).expect("a record");
        assert!(imported.samples == recorded.samples, "{format}");
    }
    let printed = ok(path, "overlay TARGET01.DAT TARGET02.DAT");
    assert!(printed.contains("deviation of TARGET02.DAT from TARGET01.DAT"), "{printed}");
    let printed = transcript(path, "replay TARGET02.DAT");
    assert!(printed.contains("it was imported from TARGET01.csv"), "{printed}");
}

#[test]
fn what_a_record_shows_has_the_name_and_the_unit_that_it_has_in_a_run() {
    let folder = folder();
    let path = folder.path();
    fs::copy("tests/fixtures/TARGET-1.DAT", path.join("TARGET01.DAT")).expect("copied");
    ok(path, "simulate servo-b-tuned --ensemble 1 --out run --set test.duration_s=0.4");
    let [of_record, of_run] = ["TARGET01.DAT", "run"].map(|file| {
        let read = Signals::read(&path.join(file)).expect("signals");
        let unit = |name: &str| {
            let key = format!("unit of {name}");
            read.about.iter().find(|(of, _)| *of == key).map(|(_, unit)| unit.clone())
        };
        read.signals.iter().map(|one| (one.name.clone(), unit(&one.name))).collect::<BTreeMap<_, _>>()
    });
    assert_eq!(of_record["pressure_1_pa"].as_deref(), Some("Pa"));
    assert_eq!(of_record["setpoint_m"].as_deref(), Some("m"));
    for (name, unit) in of_record {
        assert_eq!(of_run.get(&name), Some(&unit), "{name}");
    }
}

#[test]
fn an_export_never_replaces_a_file_unasked_and_names_what_it_cannot_do() {
    let folder = folder();
    let path = folder.path();
    fs::copy("tests/fixtures/TARGET-1.DAT", path.join("TARGET01.DAT")).expect("copied");
    let printed = ok(path, "export TARGET01.DAT --out a.mat");
    assert!(printed.contains("a.mat: 8 signals, 77 samples"), "{printed}");
    for (arguments, told) in [
        (
            "export TARGET01.DAT --out a.mat",
            "a.mat already exists; choose another name with --out, or replace it with --overwrite",
        ),
        (
            "export TARGET01.DAT",
            "choose a format with --to (csv, mat, mcap, ros2, parquet), or a file with --out",
        ),
        ("export TARGET01.DAT --out a.xlsx", "\"xlsx\" is no format"),
        ("export nothing.DAT --to csv", "cannot read nothing.DAT"),
        ("import a.mat servo-b --columns none.toml", "cannot read none.toml"),
    ] {
        let printed = transcript(path, arguments);
        assert!(printed.contains(told), "{arguments}: {printed}");
    }
    ok(path, "export TARGET01.DAT --out a.mat --overwrite");
}

/// What another recorder makes of an exported run: a scale that is positive toward retraction and counts from its middle,
/// gauge pressures in bar, a command in volts.
fn as_another_recorder_has_it(exported: &str, exhaust_pa: f64) -> String {
    let mut rows = exported.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let names = rows.next().expect("a header");
    let place = |name: &str| names.iter().position(|other| *other == name).expect("a column");
    let wanted =
        ["time_s", "position_m", "pressure_1_pa", "pressure_2_pa", "spool_mm", "command_counts"].map(place);
    let mut log = String::from("t;x;p1;p2;y;u\n");
    for row in rows {
        let [t, x, p1, p2, y, u] = wanted.map(|place| row[place].parse::<f64>().expect("a number"));
        let gauge = |pressure: f64| (pressure - exhaust_pa) / 1e5;
        let (x, u) = (125.0 - 1e3 * x, 5.0 + 5.0 * u / 2048.0);
        log += &format!("{:.4};{x:.6};{:.6};{:.6};{y:.6};{u:.6}\n", 1e3 * t, gauge(p1), gauge(p2));
    }
    log
}

/// The map of those columns.
const ANOTHER_MAP: &str = r#"
[time]
column = "t"
unit = "ms"
[position]
column = "x"
unit = "mm"
sign = -1
offset = "125 mm"
[pressure_1]
column = "p1"
unit = "bar(g)"
[pressure_2]
column = "p2"
unit = "bar(g)"
[spool]
column = "y"
unit = "mm"
[command]
column = "u"
null = 5.0
full = 10.0
"#;

/// All keys that a fit usually has, from a log alone: what is hidden lies in the stated intervals, and what nobody changed
/// does, too.
#[test]
fn a_full_fit_to_an_imported_log_recovers_the_rig_within_the_stated_intervals() {
    let folder = folder();
    let path = folder.path();
    let hidden = [("load.mass_kg", 1.8), ("load.viscous_n_s_per_m", 26.0), ("supply.pressure_pa", 575e3)];
    fs::write(path.join("rig.toml"), STROKES).expect("written");
    let settings = hidden.map(|(key, value)| format!("--set {key}={value}")).join(" ");
    ok(path, &format!("simulate rig.toml {settings} --out truth --no-report --ensemble 1"));
    ok(path, "export truth --to csv --out truth.csv");
    let exported = fs::read_to_string(path.join("truth.csv")).expect("written");
    let exhaust_pa = Rig::read("rig.toml", STROKES).expect("valid").get(&keys::exhaust::PRESSURE_PA);
    fs::write(path.join("log.csv"), as_another_recorder_has_it(&exported, exhaust_pa)).expect("written");
    fs::write(path.join("map.toml"), ANOTHER_MAP).expect("written");
    let printed = ok(path, "import log.csv rig.toml --columns map.toml");
    assert!(printed.contains("TARGET01.DAT: 347 samples"), "{printed}");
    ok(path, "identify rig.toml TARGET01.DAT");
    let json = fs::read_to_string(path.join("identified/identification.json")).expect("there");
    let found: Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!((&found["fits"], &found["judged"]), (&true.into(), &true.into()), "{found:#}");
    let parameters = found["parameters"].as_array().expect("a list");
    let of = |key: &str| parameters.iter().find(|one| one["key"] == key);
    for (key, value) in hidden {
        let one = of(key).unwrap_or_else(|| panic!("{key} is seen: {found:#}"));
        assert_eq!(one["interval_is"], "95 %");
        let [low, high] = [0, 1].map(|end| one["interval"][end].as_f64().expect("a number"));
        assert!(low <= value && value <= high, "{key} = {value}: {one:#}");
        let [file, estimate] = ["file", "estimate"].map(|name| one[name].as_f64().expect("a number"));
        assert!((estimate - value).abs() < 0.2 * (file - value).abs(), "{key} = {value}: {one:#}");
    }
    let outside =
        parameters.iter().filter(|one| !hidden.iter().any(|(key, _)| one["key"] == *key)).filter(|one| {
            let [low, high] = [0, 1].map(|end| one["interval"][end].as_f64().expect("a number"));
            let file = one["file"].as_f64().expect("a number");
            !(low..=high).contains(&file)
        });
    // Of twenty intervals of 95 %, one may miss.
    assert!(outside.count() <= 1, "{found:#}");
}
