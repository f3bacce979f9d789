//! Files, units, ports and signals as other people and programs have them.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use pneudrive_records::target::TargetFile;

use crate::program::{STROKES, folder, ok, recorded_with, transcript, unhurried_rig, virtual_rig};

fn fixture(name: &str) -> String {
    format!("{}/tests/fixtures/others/{name}", env!("CARGO_MANIFEST_DIR"))
}

/// A log with 170 lost rows gave 393 mm/s where 786 mm/s were true.
#[test]
fn no_figure_is_told_over_lost_rows() {
    let folder = folder();
    let path = folder.path();
    let logs = format!("{}/logs/tests/fixtures/found", env!("CARGO_MANIFEST_DIR"));
    let printed = ok(path, &format!("import {logs}/gap.csv servo-b-tuned --columns {logs}/map.toml"));
    assert!(printed.contains("GAPS: 170 samples are missing"), "{printed}");
    let refused = transcript(path, "eval TARGET01.DAT");
    assert!(refused.contains("samples are missing between") && refused.ends_with("= 1"), "{refused}");
}

#[test]
fn one_table_of_flows_tells_the_same_conductance_in_every_dialect() {
    let folder = folder();
    let told =
        |name: &str| ok(folder.path(), &format!("identify servo-b-tuned --conductance {}", fixture(name)));
    let [marked, quoted, semicolons] = ["bom.csv", "quoted.csv", "semicolon.csv"].map(told);
    assert!(marked.contains("(C = 2.0000 +- 0.0000 dm3/(s bar)"), "{marked}");
    assert_eq!((&quoted, &semicolons), (&marked, &marked));
}

/// A file of a rig as editors and systems of other people leave it.
fn changed(text: &str) -> [Vec<u8>; 4] {
    [
        format!("\u{feff}{text}").into_bytes(),
        text.replace('\n', "\r\n").into_bytes(),
        format!("{text}\n\n").into_bytes(),
        format!("\u{feff}{text}\r\n").replace('\n', "\r\n").replace("\r\r", "\r").into_bytes(),
    ]
}

#[test]
fn own_files_are_read_through_editors_and_systems_and_utf_16_is_named() {
    let folder = folder();
    let path = folder.path();
    fs::copy("tests/fixtures/TARGET-1.DAT", path.join("TARGET01.DAT")).expect("copied");
    ok(path, "simulate servo-b-tuned --set test.duration_s=0.05 --out run --no-report");
    let rig = virtual_rig("servo-b-tuned");
    ok(path, &format!("device --port {} config export config.txt", rig.port()));
    fs::write(path.join("rig.toml"), STROKES).expect("written");
    let import = format!("device --port {} config import config.txt", rig.port());
    let uses = [
        ("TARGET01.DAT", "eval TARGET01.DAT"),
        ("rig.toml", "rig check rig.toml --quick"),
        ("config.txt", &import),
        ("run/trace.csv", "eval run --ensemble 1"),
        ("run/run.json", "eval run --ensemble 1"),
    ];
    for (name, arguments) in uses {
        let text = fs::read_to_string(path.join(name)).expect("there");
        ok(path, arguments);
        for bytes in changed(&text) {
            fs::write(path.join(name), &bytes).expect("written");
            ok(path, arguments);
        }
        let wide: Vec<u8> = format!("\u{feff}{text}").encode_utf16().flat_map(u16::to_le_bytes).collect();
        fs::write(path.join(name), wide).expect("written");
        let refused = transcript(path, arguments);
        assert!(refused.contains("it is UTF-16: save it as UTF-8"), "{name}: {refused}");
        fs::write(path.join(name), text).expect("written");
    }
}

/// A file and its copy made intervals narrower by a factor of 1.41.
#[test]
fn the_same_record_twice_counts_once() {
    let folder = folder();
    let path = folder.path();
    let text = format!("{STROKES}[sensors]\nnoise_counts = 1\n");
    recorded_with(path, &text, &[("load.mass_kg", 1.7)]);
    fs::copy(path.join("TARGET01.DAT"), path.join("COPY.DAT")).expect("copied");
    let estimate = || {
        let json = fs::read_to_string(path.join("identified/identification.json")).expect("there");
        let found: serde_json::Value = serde_json::from_str(&json).expect("JSON");
        found["parameters"].to_string()
    };
    ok(path, "identify rig.toml TARGET01.DAT --fit load.mass_kg");
    let alone = estimate();
    let printed = transcript(path, "identify rig.toml TARGET01.DAT COPY.DAT TARGET01.DAT --fit load.mass_kg");
    assert!(printed.contains("COPY.DAT has the same samples as TARGET01.DAT, and counts once"), "{printed}");
    assert_eq!(estimate(), alone);
}

#[test]
fn a_stream_that_no_command_reads_is_refused_before_anything_moves() {
    let (folder, rig) = (folder(), virtual_rig("servo-b-tuned"));
    let run = format!("run servo-b-tuned --port {} --stream long.txt --for 8h", rig.port());
    let refused = transcript(folder.path(), &run);
    assert!(
        refused.contains("has 22153847 samples for the file, and a command reads 10000000 at most"),
        "{refused}"
    );
    assert!(refused.contains("--every 3") && !folder.path().join("long.txt").exists(), "{refused}");
}

/// Waits until a file has lines of samples.
fn wait_for_samples(path: &Path) {
    let begun = Instant::now();
    while fs::read_to_string(path).map_or(0, |text| text.lines().count()) < 200 {
        assert!(begun.elapsed() < Duration::from_secs(30), "no samples");
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[cfg(unix)]
#[test]
fn a_signal_to_end_stops_the_drive_and_ends_its_stream() {
    for signal in ["-TERM", "-HUP"] {
        let (folder, rig) = (folder(), unhurried_rig("servo-b-tuned"));
        let mut program = Command::new(env!("CARGO_BIN_EXE_pneudrive"))
            .current_dir(folder.path())
            .args(["run", "servo-b-tuned", "--port", rig.port(), "--stream", "run.txt", "--until-stopped"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the program runs");
        wait_for_samples(&folder.path().join("run.txt"));
        let sent = Command::new("kill").args([signal, &program.id().to_string()]).status().expect("kill");
        assert!(sent.success());
        assert!(program.wait().expect("it was started").success(), "{signal}");
        TargetFile::read(&folder.path().join("run.txt")).expect("a stream");
        let text = fs::read_to_string(folder.path().join("run.txt")).expect("there");
        assert!(text.contains("\n# crc32 = "), "{signal}: it has an end");
        let status = ok(folder.path(), &format!("device --port {} status", rig.port()));
        assert!(status.contains("disarmed"), "{signal}: {status}");
    }
}

#[test]
fn a_sweep_is_its_meaning_and_takes_a_key_with_its_unit() {
    let folder = folder();
    let path = folder.path();
    fs::write(path.join("rig.toml"), STROKES).expect("written");
    let sweep = "rig = \"rig.toml\"\n[vary]\nload.mass = [\"1 kg\", \"2000 g\"]\n[metrics]\nspeed = \"top_speed_mm_s\"\n";
    fs::write(path.join("s.toml"), sweep).expect("written");
    ok(path, "sweep s.toml --threads 100000");
    let csv = fs::read_to_string(path.join("s/sweep.csv")).expect("there");
    assert!(csv.starts_with("point,load.mass_kg,") && csv.contains("\n1,2.0,"), "{csv}");
    fs::write(path.join("rig.toml"), format!("# remarked\n{STROKES}").replace('\n', "\r\n"))
        .expect("written");
    let again = ok(path, "sweep s.toml");
    assert!(again.contains("2 points are already done"), "{again}");
}
