//! A drive without pressure sensors: run, recorded and looked at like any other, and no pressure of it is a number.

use std::fs;
use std::path::Path;

use crate::program::{folder, ok, transcript, virtual_rig_of};
use pneudrive_records::target::TargetFile;
use pneudrive_rigs::virtual_rig::Background;
use pneudrive_sim::Rig;
use serde_json::Value;

/// A built-in rig without its pressure sensors.
fn text_of(name: &str) -> String {
    let text = pneudrive_sim::rigfile::builtin(name).expect("a built-in rig");
    text.replacen("[sensors]", "[sensors]\npressure = false\n#", 1)
}

/// The tuned drive B, as a file, and as a rig.
fn rig_in(folder: &Path) -> Background {
    let text = text_of("servo-b-tuned");
    fs::write(folder.join("rig.toml"), &text).expect("written");
    virtual_rig_of(Rig::read("rig", &text).unwrap_or_else(|problems| panic!("{problems}")))
}

/// Its record.
fn recorded(folder: &Path) -> Background {
    let rig = rig_in(folder);
    ok(folder, &format!("run rig.toml --port {}", rig.port()));
    ok(folder, &format!("record --port {}", rig.port()));
    rig
}

#[test]
fn status_and_monitor_say_that_pressures_are_not_measured() {
    let folder = folder();
    let rig = rig_in(folder.path());
    let call = |what: &str| transcript(folder.path(), &what.replace("PORT", rig.port()));
    for more in ["", " --counts"] {
        let printed = call(&format!("device --port PORT{more} status"));
        assert!(printed.contains("\npressures   not measured\nspool "), "{printed}");
        let printed = call(&format!("monitor --port PORT --count 1{more}"));
        assert!(printed.contains("P1 not measured  P2 not measured"), "{printed}");
    }
    let json = ok(folder.path(), &format!("device --port {} status --json", rig.port()));
    let json: Value = serde_json::from_str(&json).expect("JSON");
    for key in ["pressure_1_raw", "pressure_2_raw", "pressure_1_kpa", "pressure_2_kpa"] {
        assert_eq!(json["result"].get(key), Some(&Value::Null), "{key}: {json}");
    }
    call("monitor --port PORT --count 1 --csv seen.csv");
    let csv = fs::read_to_string(folder.path().join("seen.csv")).expect("written");
    let row: Vec<&str> = csv.lines().nth(1).expect("a row").split(',').collect();
    assert_eq!(row[7..9], ["", ""], "{csv}");
    let printed = call("device --port PORT config get sensors.pressure");
    assert!(printed.starts_with("sensors.pressure = false"), "{printed}");
}

#[test]
fn its_record_says_which_channels_are_none_and_no_figure_shows_them() {
    let folder = folder();
    recorded(folder.path());
    let text = fs::read_to_string(folder.path().join("TARGET01.DAT")).expect("a record");
    assert!(text.contains("\n# unknown = pressure_1,pressure_2\n"), "{text:.500}");
    assert!(text.contains("\n# param.pressure_sensors = 0\n"));
    let file = TargetFile::from_text(&text).expect("a TARGET file");
    assert!(!file.samples.is_empty());
    assert!(file.samples.iter().all(|(_, sample)| [sample.pressure_1, sample.pressure_2] == [0, 0]));

    let said = ok(folder.path(), "replay TARGET01.DAT");
    assert!(said.contains("samples, every command as recorded"), "{said}");
    let said = ok(folder.path(), "eval TARGET01.DAT --rig rig.toml");
    assert!(!said.contains("NaN") && !said.contains("kPa"), "{said}");
    ok(folder.path(), "eval TARGET01.DAT --csv eval.csv");
    let csv = fs::read_to_string(folder.path().join("eval.csv")).expect("written");
    let names: Vec<&str> = csv.lines().next().expect("a header").split(',').collect();
    let known = |name: &str| {
        let place = names.iter().position(|one| *one == name).unwrap_or_else(|| panic!("{name}: {names:?}"));
        csv.lines().skip(1).filter(|line| line.split(',').nth(place) != Some("")).count()
    };
    assert_eq!(["pressure_1_kpa", "pressure_2_kpa"].map(known), [0, 0], "{names:?}");
    assert_eq!(known("position_mm"), file.samples.len());
    ok(folder.path(), "simulate rig.toml --ensemble 1 --no-report --out sim");
    let said = ok(folder.path(), "overlay TARGET01.DAT sim");
    let figure =
        |line: &str| line.split_whitespace().any(|word| word.contains('.') && word.parse::<f64>().is_ok());
    assert!(!said.contains("pressure "), "a pressure has no row: {said}");
    assert!(said.lines().any(|line| line.contains("position") && figure(line)), "{said}");
    let said = transcript(folder.path(), "spectrum TARGET01.DAT pressure-1");
    assert!(said.contains("its pressure 1 is not known at every sample"), "{said}");
}

/// From the position alone force and mass cannot be told apart; nor is a drive moved for it.
#[test]
fn it_is_not_identified_and_its_start_is_that_of_the_rig_file() {
    let folder = folder();
    let rig = recorded(folder.path());
    let plan = |file: &str| format!("identify {file} --plan {}", rig.port());
    for call in ["identify rig.toml TARGET01.DAT".to_owned(), plan("rig.toml"), plan("servo-b-tuned")] {
        let said = transcript(folder.path(), &call);
        assert!(said.contains("a fit needs both pressures. From the position alone mass"), "{said}");
        assert!(said.contains("Put a pressure transmitter at each chamber"), "{said}");
    }
    let said =
        ok(folder.path(), "simulate rig.toml --from TARGET01.DAT --ensemble 1 --no-report --out again");
    assert!(
        said.contains("its pressures were not measured: those at the start are the rig file's"),
        "{said}"
    );
}

#[test]
fn a_law_that_feeds_back_pressures_is_refused_by_the_file_and_by_the_rig() {
    let folder = folder();
    let rig = rig_in(folder.path());
    fs::write(folder.path().join("burrows.toml"), text_of("burrows")).expect("written");
    let said = transcript(folder.path(), "rig check burrows.toml");
    assert!(
        said.contains("controller.pressure_feedback_gain")
            && said.contains("must be 0 with sensors.pressure = false"),
        "{said}"
    );
    let device = |what: &str| transcript(folder.path(), &format!("device --port {} {what}", rig.port()));
    let said = device("config set controller.law on-off");
    assert!(said.contains("must be 0 where pressure_sensors is 0"), "{said}");
}
