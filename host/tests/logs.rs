//! `export` and `import`: transients for other programs, and logs of other recorders.

mod program;

use std::fs;

use pneudrive_records::target::TargetFile;

use program::{folder, ok, transcript, virtual_rig};

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
fn an_export_never_replaces_a_file_unasked_and_names_what_it_cannot_do() {
    let folder = folder();
    let path = folder.path();
    fs::copy("tests/fixtures/TARGET-2.DAT", path.join("TARGET01.DAT")).expect("copied");
    let printed = ok(path, "export TARGET01.DAT --out a.mat");
    assert!(printed.contains("a.mat: 8 signals, 77 samples"), "{printed}");
    for (arguments, told) in [
        (
            "export TARGET01.DAT --out a.mat",
            "a.mat already exists; choose another name with --out, or replace it with --overwrite",
        ),
        ("export TARGET01.DAT", "choose a format with --to csv, mat, mcap or parquet"),
        ("export TARGET01.DAT --out a.xlsx", "\"xlsx\" is no format"),
        ("export nothing.DAT --to csv", "cannot read nothing.DAT"),
        ("import a.mat servo-b --columns none.toml", "cannot read none.toml"),
    ] {
        let printed = transcript(path, arguments);
        assert!(printed.contains(told), "{arguments}: {printed}");
    }
    ok(path, "export TARGET01.DAT --out a.mat --overwrite");
}
