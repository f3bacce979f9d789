//! `--json`: what every command that prints figures gives to programs, by the tables of `pneudrive::json::fields`.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use pneudrive::command::whole_command;
use pneudrive::json::fields;
use serde_json::Value;

use crate::program::{self, folder, pneudrive, unhurried_rig, virtual_rig, with_line};

/// The fields of a command as the program lists them, by their places: `moves[].rise_s` is of type `range`.
fn documented(command: &str) -> BTreeMap<String, String> {
    let figures = fields::of(command).unwrap_or_else(|| panic!("the fields of {command} are listed"));
    let all = figures.fields.iter().copied().flatten();
    all.flat_map(|field| field.places.split(", ").map(|place| (place.to_owned(), field.kind.to_owned())))
        .collect()
}

/// Compares a value with the fields; those that it has are added to `seen`.
fn compare(value: &Value, place: &str, fields: &BTreeMap<String, String>, seen: &mut BTreeSet<String>) {
    if let Some(kind) = fields.get(place) {
        seen.insert(place.to_owned());
        assert!(is_a(value, kind.trim_end_matches(", optional")), "{place} is no {kind}: {value}");
        return;
    }
    let below = |name: &str| if place.is_empty() { name.to_owned() } else { format!("{place}.{name}") };
    match value {
        Value::Array(all) => all.iter().for_each(|one| compare(one, &format!("{place}[]"), fields, seen)),
        Value::Object(all) => {
            let is_free = fields.keys().any(|field| field.starts_with(&below("*")));
            for (name, one) in all {
                compare(one, &below(if is_free { "*" } else { name }), fields, seen);
            }
        }
        _ => panic!("no listed field is {place}: {value}"),
    }
}

fn is_a(value: &Value, kind: &str) -> bool {
    match kind {
        "any" => true,
        "text" => value.is_string(),
        "bool" => value.is_boolean(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        "range" => {
            ["value", "least", "most"].iter().all(|end| is_a(&value[end], "number or null"))
                && value["runs_without"].is_u64()
        }
        _ => kind.strip_suffix(" or null").is_some_and(|kind| value.is_null() || is_a(value, kind)),
    }
}

/// Runs a command with `--json`: its result, whose fields are those of the tables.
fn result(folder: &Path, command: &str, arguments: &str) -> Value {
    result_of(folder, command, &format!("{command} {arguments}"))
}

/// The same of a command whose words are not all in front.
fn result_of(folder: &Path, command: &str, typed: &str) -> Value {
    let output = pneudrive(folder, &format!("{typed} --json"));
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    let document: Value =
        serde_json::from_str(&text).unwrap_or_else(|error| panic!("{command}: {error}: {text}{errors}"));
    assert_eq!(document["exit"], output.status.code().expect("it was not killed"), "{errors}");
    checked(command, document)
}

/// The result of a document, whose fields are those of the tables.
fn checked(command: &str, document: Value) -> Value {
    let head: Vec<&String> = document.as_object().expect("an object").keys().collect();
    assert_eq!(head, ["format", "program", "exit", "error", "result"]);
    let name = document["format"].as_str().expect("a text");
    assert_eq!(name, format!("pneudrive-{} 1", command.replace(' ', "-")));
    assert_eq!(document["program"], env!("CARGO_PKG_VERSION"));
    assert_eq!(document["exit"] == 0, document["error"].is_null());
    let (fields, mut seen) = (documented(command), BTreeSet::new());
    compare(&document["result"], "", &fields, &mut seen);
    for (field, kind) in &fields {
        assert!(
            seen.contains(field) || kind.ends_with(", optional"),
            "{command} has no {field}: {document:#}"
        );
    }
    document["result"].clone()
}

#[test]
fn every_command_that_prints_figures_has_the_option_and_a_list_of_its_fields() {
    // What these print is a text, a page, an address, or that something was done.
    let without = [
        "rig explain",
        "studio",
        "virtual",
        "device arm",
        "device disarm",
        "device stop",
        "device valve seek-null",
        "device valve at-null",
        "device config export",
        "device config import",
        "device config save",
        "device records remove",
        "device records load",
        "device records save",
        "completions",
        "man",
    ];
    fn below(command: &clap::Command, before: &str, all: &mut BTreeMap<String, bool>) {
        for one in command.get_subcommands() {
            let typed = format!("{before}{}", one.get_name());
            if one.has_subcommands() {
                below(one, &format!("{typed} "), all);
            } else {
                let has_option = one.get_arguments().any(|argument| argument.get_long() == Some("json"));
                all.insert(typed, has_option);
            }
        }
    }
    let mut all = BTreeMap::new();
    below(&whole_command(), "", &mut all);
    for (command, has_option) in &all {
        assert_eq!(*has_option, !without.contains(&command.as_str()), "{command}");
        if *has_option {
            assert!(!documented(command).is_empty());
        }
    }
    let listed: usize = fields::FIGURES.iter().map(|one| one.commands.len()).sum();
    assert_eq!(all.values().filter(|has_option| **has_option).count(), listed);
}

#[test]
fn figures_of_rigs() {
    let folder = folder();
    let at = folder.path();
    let rigs = result(at, "rig list", "");
    assert_eq!(rigs["rigs"].as_array().map(Vec::len), Some(pneudrive_sim::rigfile::BUILTIN.len()));
    let shown = result(at, "rig show", "servo-b --set load.mass_kg=2");
    assert_eq!(shown["keys"]["load.mass_kg"]["value"], 2.0);
    let differences = result(at, "rig diff", "servo-b servo-b-tuned");
    assert!(
        differences["differences"]
            .as_array()
            .expect("a list")
            .iter()
            .any(|one| one["key"] == "controller.velocity_gain")
    );
    assert!(result(at, "rig parts", "")["parts"].as_array().expect("a list").len() > 10);
    let one = result(at, "rig parts", "iso-15552-32");
    assert_eq!(one["parts"][0]["name"], "iso-15552-32");
    let answers = "--cylinder iso-15552-32 --stroke 250mm --mass 8kg --valve proportional-5-3-350";
    let made = result(at, "rig new", &format!("mine.toml {answers} --no-questions"));
    assert!(made["values"]["given"].as_u64() > Some(3), "{made}");
    let ranked = result(at, "rig check", "mine.toml");
    assert!(
        ranked["effects"].as_array().expect("a list").len() > 3
            && ranked["not_significant_below_mm"].is_number()
    );
}

#[test]
fn figures_of_runs_are_those_of_their_files() {
    let folder = folder();
    let at = folder.path();
    let short = "servo-b-tuned --set test.duration_s=0.6 --set test.moves=[[0.0,8192],[0.1,13171]]";
    let run = result(at, "simulate", &format!("{short} --out sim --no-report --ensemble 3"));
    let file: Value =
        serde_json::from_str(&fs::read_to_string(at.join("sim/run.json")).expect("written")).expect("JSON");
    assert_eq!(
        (&run["moves"], &run["converged"], &run["ensemble"]),
        (&file["moves"], &file["converged"], &Value::from(3))
    );
    let figures = result(at, "eval", "sim");
    assert_eq!(figures["moves"], file["moves"]);
    assert_eq!(figures["runs"], 3);
    result(at, "simulate", &format!("{short} --set load.mass_kg=2 --out other --no-report --ensemble 1"));
    let deviations = result(at, "overlay", "sim other");
    assert_eq!(deviations["others"][0]["deviations"][0]["channel"], "position");
    let spectrum = result(at, "spectrum", "sim spool");
    let peaks = spectrum["spectra"][0]["peaks"].as_array().expect("a list");
    assert!(peaks[0]["amplitude"].as_f64() >= peaks[1]["amplitude"].as_f64());
    let exported = result(at, "export", "sim --to csv --out run.csv");
    assert_eq!(exported["samples"], run["samples"]);
    let plant = result(at, "fmu", "servo-b-tuned --plant");
    assert_eq!((&plant["file"], &plant["inputs"]), (&"servo-b-tuned-plant.fmu".into(), &1.into()));
    let map = "[time]\ncolumn = \"time_s\"\nunit = \"s\"\n[position]\ncolumn = \"position_m\"\nunit = \"m\"\n[command]\ncolumn = \"command_counts\"\nunit = \"counts\"\n";
    fs::write(at.join("map.toml"), map).expect("written");
    assert_eq!(result(at, "import", "run.csv servo-b-tuned --columns map.toml")["file"], "./TARGET01.DAT");
}

#[test]
fn figures_of_a_drive() {
    let (folder, rig) = (folder(), virtual_rig("servo-b-tuned"));
    let (at, port) = (folder.path(), rig.port());
    let device = |action: &str, more: &str| {
        result_of(at, &format!("device {action}"), &format!("device --port {port} {action} {more}"))
    };
    assert_eq!(device("info", "")["board"], "virtual rig");
    let status = device("status", "");
    assert_eq!((&status["mode"], &status["position_counts"]), (&Value::from("disarmed"), &Value::from(8192)));
    assert!((status["position_mm"].as_f64().expect("mm") - 98.7136).abs() < 1e-3);
    assert!(device("status", "--counts")["position_mm"].is_null());
    assert_eq!(device("reference", "8192")["position_counts"], 8192);
    assert_eq!(device("config get", "velocity_gain")["parameters"][0]["value"], 2000.0);
    assert_eq!(device("config get", "gain_profile[3]")["parameters"][0]["entry"], 3);
    assert!(device("config get", "")["parameters"].as_array().expect("a list").len() > 50);
    assert_eq!(device("config set", "gain_profile[3] 2000")["parameters"][0]["value"], 2000.0);
    assert_eq!(device("records set", "3 to_mm=120")["records"][0]["number"], 3);
    assert_eq!(device("io", "run=on number=4")["inputs"]["number"], 4);
    assert_eq!(device("learned", "")["adapt"], "afresh");
    let table = device("records show", "");
    assert_eq!(
        (&table["records"][0]["dwell_samples"], &table["saved"]),
        (&Value::from(0), &Value::from(false))
    );
    let test = "servo-b-tuned --set test.duration_s=0.4";
    let run = result(at, "run", &format!("{test} --port {port} --stream run.txt"));
    assert_eq!((&run["ended_by"], &run["stream"]["missing"]), (&Value::from("the test"), &Value::from(0)));
    assert_eq!(result(at, "record", &format!("--port {port}"))["samples"], 308);
    let replay = result(at, "replay", "TARGET01.DAT");
    assert_eq!((&replay["samples"], &replay["differing"]), (&Value::from(308), &Value::from(0)));
    program::ok(at, &format!("device --port {port} stop"));
    let faults = device("faults", "");
    assert_eq!(faults["faults"][0]["name"], "stop");
    let checks = device("bring-up", "--yes --push-wait 0");
    assert_eq!(checks["checks"][0]["verdict"], "right");
}

#[test]
fn a_homed_drive_tells_where_it_is() {
    let (folder, rig) = (folder(), unhurried_rig("servo-b-tuned"));
    program::ok(folder.path(), &format!("device --port {} arm", rig.port()));
    let homed = result_of(folder.path(), "device home", &format!("device --port {} home", rig.port()));
    assert!(homed["position_mm"].is_number());
}

#[test]
fn a_drive_that_was_moved_by_hand_tells_from_where_to_where() {
    let (folder, rig) = (folder(), virtual_rig("servo-b-tuned"));
    for (command, asked) in [("device go", "go 110mm"), ("device jog", "jog -3mm")] {
        let asked = format!("device --port {} {asked} --rig servo-b-tuned", rig.port());
        let moved = result_of(folder.path(), command, &asked);
        assert!(moved["from_mm"].is_number() && moved["position_mm"].is_number(), "{moved}");
    }
}

#[test]
fn a_monitor_prints_a_document_a_line() {
    let (folder, rig) = (folder(), virtual_rig("servo-b-tuned"));
    let printed =
        program::ok(folder.path(), &format!("monitor --port {} --count 3 --every 0.01 --json", rig.port()));
    let lines: Vec<&str> = printed.lines().collect();
    assert_eq!(lines.len(), 3, "{printed}");
    let times: Vec<f64> = lines
        .iter()
        .map(|line| checked("monitor", serde_json::from_str(line).expect("JSON")))
        .map(|figures| figures["time_s"].as_f64().expect("s"))
        .collect();
    assert!(times.is_sorted() && times[2] > times[0], "{times:?}");
}

#[test]
fn a_failure_is_told_with_what_was_found_before() {
    let (folder, rig) = (folder(), virtual_rig("servo-b-tuned"));
    let (at, port) = (folder.path(), rig.port());
    program::ok(at, &format!("run servo-b-tuned --set test.duration_s=0.4 --port {port}"));
    program::ok(at, &format!("record --port {port}"));
    let text = fs::read_to_string(at.join("TARGET01.DAT")).expect("written");
    fs::write(at.join("other.dat"), with_line(&text, "param.velocity_gain", Some("1000"))).expect("written");
    let output = pneudrive(at, "replay other.dat --json");
    let document: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!((output.status.code(), &document["exit"]), (Some(7), &Value::from(7)));
    let replay = checked("replay", document.clone());
    assert!(
        replay["differing"].as_u64() > Some(0) && replay["first_difference"]["sample"].is_u64(),
        "{replay}"
    );
    let error = document["error"].as_str().expect("a text");
    assert_eq!(
        String::from_utf8_lossy(&output.stderr).lines().last(),
        Some(format!("error: {error}").as_str())
    );
    let output = pneudrive(at, "eval nothing.dat --json");
    let document: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!((&document["exit"], &document["result"]), (&Value::from(3), &serde_json::json!({})));
    assert!(pneudrive(at, "eval --json").stdout.is_empty(), "a wrong command line gives no document");
}

#[test]
fn figures_of_analyses() {
    let folder = folder();
    let at = folder.path();
    let swept = "rig = \"servo-b-tuned\"\n[set]\ntest.duration_s = 0.6\n[vary]\nload.mass_kg = [1.0, 2.0]\n[metrics]\nspeed = \"top_speed_mm_s\"\n[objective]\nmaximise = \"speed\"\n";
    fs::write(at.join("s.toml"), swept).expect("written");
    let rows = result(at, "sweep", "s.toml --ensemble 2 --out one");
    let best = rows["best"].as_u64().expect("a point") as usize;
    let speed = |point: usize| rows["rows"][point]["metrics"]["speed"]["value"].as_f64();
    assert!(speed(best) >= speed(1 - best) && rows["rows"][1]["levels"]["load.mass_kg"] == 2.0, "{rows}");
    assert_eq!(result(at, "merge", "one --out merged")["rows"], rows["rows"]);
    let short = "--set test.duration_s=0.3 --set test.moves=[[0.0,8192],[0.05,13171]]";
    let variants = result(at, "ladder", &format!("servo-b-tuned {short} --ensemble 1 --out ladder"));
    assert_eq!(variants["variants"][0]["model"], "complete");
    let tuned = result(at, "tune", "servo-a-tuned --generations 0 --draws 4 --settled 1 --out tuned");
    assert_eq!((&tuned["before"]["of"], tuned["changed"].as_bool()), (&Value::from(4), Some(false)));
    let curves = result(at, "characterise", "servo-b pressure-gain --out curves");
    assert!(curves["curves"][0]["figures"].as_array().is_some_and(|figures| !figures.is_empty()));
    assert!(result(at, "study", "list")["studies"].as_array().expect("a list").len() > 3);
    let thesis = result(at, "thesis", "--only 7.1.4 --out thesis");
    assert!(thesis["entries"].as_array().is_some_and(|entries| !entries.is_empty()));
    let demo = result(at, "demo", "--rig servo-a-tuned --out demo");
    assert_eq!(demo["others"][0]["deviations"][0]["channel"], "position");
}

#[test]
fn figures_of_fits() {
    let folder = folder();
    let at = folder.path();
    let table = "flow_g_s,ratio\n1,0.99\n2,0.97\n3,0.93\n4,0.89\n";
    fs::write(at.join("drop.csv"), table).expect("written");
    let only = |arguments: &str, field: &str| {
        let output = pneudrive(at, &format!("identify servo-b {arguments} --json"));
        let document: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        assert!(document["result"][field].is_object(), "{document:#}");
        let (fields, mut seen) = (documented("identify"), BTreeSet::new());
        compare(&document["result"], "", &fields, &mut seen);
    };
    only("--tubing drop.csv", "drop_slope");
    let rig = virtual_rig("servo-b-tuned");
    program::ok(at, &format!("run servo-b-tuned --set test.duration_s=1.2 --port {}", rig.port()));
    program::ok(at, &format!("record --port {}", rig.port()));
    let fit = result(at, "identify", "servo-b-tuned TARGET01.DAT --fit load.mass_kg --out fit");
    assert_eq!(
        (&fit["fits"], &fit["parameters"][0]["key"]),
        (&Value::from(true), &Value::from("load.mass_kg"))
    );
    let file: Value =
        serde_json::from_str(&fs::read_to_string(at.join("fit/identification.json")).expect("written"))
            .expect("JSON");
    assert_eq!(file["parameters"], fit["parameters"]);
}
