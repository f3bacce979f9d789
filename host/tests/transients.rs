//! `eval`, `overlay` and `spectrum` on records and run folders, whole and damaged.

use std::fs;
use std::path::Path;
use std::sync::OnceLock;

use crate::program::{exists, folder, ok, pneudrive, transcript, virtual_rig, with_line};

/// The test that the record and the run folder hold: at rest, then a step at 0.3 s.
const TEST: &str = "servo-b-tuned --set test.duration_s=0.45";

/// How each command reads a file, `{}`; `run` is a run folder.
const READERS: [&str; 5] = [
    "eval {}",
    "overlay run {}",
    "overlay {} run",
    "spectrum {} position",
    "spectrum run position --with {}",
];

/// A record of the virtual rig.
fn record() -> &'static str {
    static RECORD: OnceLock<String> = OnceLock::new();
    RECORD.get_or_init(|| {
        let folder = folder();
        let rig = virtual_rig("servo-b-tuned");
        ok(folder.path(), &format!("run {TEST} --port {}", rig.port()));
        ok(folder.path(), &format!("record --port {}", rig.port()));
        fs::read_to_string(folder.path().join("TARGET01.DAT")).expect("written")
    })
}

/// A folder with TARGET01.DAT and the run folder `run`.
fn transients() -> tempfile::TempDir {
    let folder = folder();
    fs::write(folder.path().join("TARGET01.DAT"), record()).expect("written");
    ok(folder.path(), &format!("simulate {TEST} --out run"));
    folder
}

/// Name and bytes of everything in a folder, and in those within.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut all = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            all.extend(contents(&path));
        } else {
            all.push((path.display().to_string(), fs::read(&path).expect("a file")));
        }
    }
    all.sort();
    all
}

/// Every reader refuses `name` with a message that begins with `error: ` and `says`, and leaves
/// everything as it was.
fn all_refuse(folder: &Path, name: &str, says: &str) {
    let before = contents(folder);
    for reader in READERS {
        let arguments = reader.replace("{}", name);
        let printed = transcript(folder, &arguments);
        let code = if folder.join(name).exists() { 1 } else { 3 };
        assert!(printed.ends_with(&format!("= {code}")), "{arguments}: {printed}");
        assert!(printed.contains(&format!("! error: {says}")), "{arguments}: {printed}");
    }
    assert_eq!(contents(folder), before, "{name}: a file has changed");
}

/// The numbers in the row of a table that begins with `first`.
fn figures(printed: &str, first: &str) -> Vec<f64> {
    let row =
        printed.lines().find(|line| line.starts_with(first)).unwrap_or_else(|| panic!("{first}: {printed}"));
    row.split_whitespace().skip(1).map(|word| word.parse().unwrap_or(f64::NAN)).collect()
}

#[test]
fn a_record_and_its_simulation_evaluate_to_the_same_moves() {
    let folder = transients();
    let recorded = ok(folder.path(), "eval TARGET01.DAT --rig servo-b-tuned --out a.html --csv a.csv");
    let simulated = ok(folder.path(), "eval run --out b.html");
    exists(folder.path(), &["a.html", "a.csv", "b.html"]);
    let [begins, from, to, end] = [0, 1, 2, 3].map(|column| figures(&recorded, "2 ")[column]);
    assert!((0.3..0.3013 + 1e-4).contains(&begins), "the first sample at or after 0.3 s: {begins}");
    assert!((to - 16384.0 * 0.01205).abs() < 1e-3, "{to}");
    assert!(from < end && end < to, "it is on its way when the test ends: {recorded}");
    for (column, value) in figures(&simulated, "2 ").into_iter().enumerate().take(4) {
        assert!((value - figures(&recorded, "2 ")[column]).abs() < 0.0121, "within a count: {simulated}");
    }
    let csv = fs::read_to_string(folder.path().join("a.csv")).expect("written");
    assert!(csv.starts_with("time_s,setpoint_mm,position_mm,pressure_1_kpa,"), "{csv}");
    assert_eq!(csv.lines().count(), 1 + 347, "samples 0 to 346 lie within 0.45 s");
}

/// Once the air of a record was told with any cylinder.
#[test]
fn a_record_is_not_evaluated_with_the_cylinder_of_another_rig_unsaid() {
    let folder = transients();
    fs::write(
        folder.path().join("short.toml"),
        "name = \"short\"\n[actuator]\nstroke_m = 0.05\n[test]\nposition_m = 0.02\nmoves = [[0.0, 2000]]\n",
    )
    .expect("written");
    let fine = folder.path().join("fine.toml");
    fs::write(&fine, "name = \"fine\"\n[encoder]\nmm_per_count = 0.01\n").expect("written");
    for (rig, says) in [
        ("short.toml", "TARGET01.DAT does not belong to short: it goes from 98.7 to"),
        ("fine.toml", "TARGET01.DAT does not belong to fine: its encoder has 0.01205 mm per count, not 0.01"),
    ] {
        let printed = transcript(folder.path(), &format!("eval TARGET01.DAT --rig {rig}"));
        assert!(printed.contains(&format!("! error: {says}")) && printed.ends_with("= 1"), "{printed}");
    }
    let printed = ok(folder.path(), "eval TARGET01.DAT --rig servo-c");
    let named = "The test is called servo-b-tuned, the rig servo-c: the air figures are valid only if servo-c has the same cylinder.";
    assert!(printed.contains(named), "{printed}");
    assert!(!ok(folder.path(), "eval TARGET01.DAT --rig servo-b-tuned").contains("The test is called"));
}

/// The pressures that the transmitters of thesis 7.2.1 (c) saw.
#[test]
fn a_run_may_have_the_air_inside_its_valve_and_a_record_be_laid_over_the_ports() {
    let folder = transients();
    let simulate = "simulate servo-b-tuned --set test.duration_s=0.45 --ensemble 2";
    ok(folder.path(), &format!("{simulate} --out plain"));
    ok(folder.path(), &format!("{simulate} --out all --columns valve"));
    ok(folder.path(), &format!("{simulate} --out ports --columns port_pressure_1_pa,port_pressure_2_pa"));
    let text = |name: &str| fs::read_to_string(folder.path().join(name)).expect("written");
    let (plain, all) = (text("plain/trace.csv"), text("all/trace.csv"));
    for (line, longer) in plain.lines().zip(all.lines()) {
        assert!(longer.starts_with(line) && longer.split(',').count() == 18 + 11, "{longer}");
    }
    for graph in [
        "pressures in supply and valve, kPa",
        "temperatures in supply and valve, K",
        "flows of supply and lands, g/s",
    ] {
        assert!(
            text("all/report.html").contains(graph) && !text("plain/report.html").contains(graph),
            "{graph}"
        );
    }
    let figures = |name: &str| ok(folder.path(), &format!("eval {name} --ensemble 1")).replace(name, "");
    assert_eq!(figures("plain"), figures("all"));
    assert!(
        ok(folder.path(), "eval ports").contains("Least and most are over 2 runs"),
        "the trace is its own"
    );

    let chambers = ok(folder.path(), "overlay TARGET01.DAT ports");
    let ports = ok(folder.path(), "overlay TARGET01.DAT ports --ports");
    assert!(
        ports.contains("Pressures of runs are those at the ports of the valve, P_1v and P_2v."),
        "{ports}"
    );
    assert_eq!(figures_of(&chambers, "position"), figures_of(&ports, "position"));
    assert_ne!(figures_of(&chambers, "pressure 1"), figures_of(&ports, "pressure 1"));
    let refused = transcript(folder.path(), "overlay TARGET01.DAT plain --ports");
    let says =
        "plain has no port_pressure_1_pa; simulate it with --columns port_pressure_1_pa,port_pressure_2_pa";
    assert!(refused.contains(says) && refused.ends_with("= 1"), "{refused}");
    let wrong = transcript(folder.path(), &format!("{simulate} --out x --columns pressure"));
    assert!(wrong.contains("there is no column pressure; `pneudrive simulate --help` lists them"), "{wrong}");
}

fn figures_of<'a>(printed: &'a str, channel: &str) -> Vec<&'a str> {
    let line = printed.lines().find(|line| line.starts_with(channel));
    line.unwrap_or_else(|| panic!("{channel}: {printed}")).split_whitespace().collect()
}

#[test]
fn a_part_names_the_move_that_it_cuts() {
    let folder = transients();
    let printed = ok(folder.path(), "eval TARGET01.DAT --from 0.32 --to 0.4");
    assert!(printed.contains("Move 2 begins earlier: only the figures of its end are known."), "{printed}");
    assert!(printed.contains("The last move continues after 0.39"), "{printed}");
    assert!(printed.lines().any(|line| line.starts_with("2  ")), "{printed}");
}

#[test]
fn an_interval_holds_the_samples_in_it_and_no_others() {
    let folder = transients();
    ok(folder.path(), "eval TARGET01.DAT --from 0.1 --to 0.2 --csv part.csv");
    let csv = fs::read_to_string(folder.path().join("part.csv")).expect("written");
    let first: f64 =
        csv.lines().nth(1).and_then(|line| line.split(',').next()?.parse().ok()).expect("a time");
    let last: f64 = csv.lines().last().and_then(|line| line.split(',').next()?.parse().ok()).expect("a time");
    assert_eq!(csv.lines().count(), 1 + 77);
    assert!((0.1..0.1013).contains(&first) && (0.1987..=0.2).contains(&last), "{first} {last}");
}

/// CRC-64 (XZ).
fn crc64(bytes: &[u8]) -> u64 {
    let shifted = |crc: u64| (crc >> 1) ^ if crc & 1 == 1 { 0xc96c_5795_d787_0f42 } else { 0 };
    !bytes.iter().fold(!0, |crc, &byte| (0..8).fold(crc ^ u64::from(byte), |crc, _| shifted(crc)))
}

/// The run folder `run` again, as `late`: everything happens `by` s later.
fn late(folder: &Path, by: f64) {
    let [from, to] = ["run", "late"].map(|name| folder.join(name));
    fs::create_dir(&to).expect("made");
    let shifted = |line: &str| match line.split_once(',') {
        Some((time, rest)) if !time.starts_with("time") => {
            format!("{:.4},{rest}\n", time.parse::<f64>().expect("a time") + by)
        }
        _ => format!("{line}\n"),
    };
    let mut run = fs::read_to_string(from.join("run.json")).expect("written");
    for name in ["trace.csv", "band.csv"] {
        let text = fs::read_to_string(from.join(name)).expect("written");
        let late: String = text.lines().map(shifted).collect();
        // Whoever changes a file of a run states its checksum anew.
        let [was, is] = [&text, &late].map(|text| format!("{:016x}", crc64(text.as_bytes())));
        assert!(run.contains(&was), "the checksum of {name}");
        run = run.replace(&was, &is);
        fs::write(to.join(name), late).expect("written");
    }
    fs::write(to.join("run.json"), run).expect("written");
}

#[test]
fn a_run_shifted_in_time_is_found_by_its_move_and_by_correlation() {
    let folder = transients();
    late(folder.path(), 0.0527);
    for align in ["move", "correlation"] {
        let printed = ok(folder.path(), &format!("overlay run late --align {align} --out {align}.html"));
        assert!(printed.starts_with("late is shifted by -52.700 ms.\n"), "{printed}");
        assert!(figures(&printed, "position")[3] < 1e-3, "mm: {printed}");
        exists(folder.path(), &[&format!("{align}.html")]);
    }
    let printed = ok(folder.path(), "overlay run late");
    assert!(figures(&printed, "position")[3] > 10.0, "mm, where they are not aligned: {printed}");
}

/// The dither of the spool is what its spectrum holds while the drive stands.
#[test]
fn the_spectrum_of_the_spool_has_its_peak_at_the_dither() {
    let folder = transients();
    for source in ["TARGET01.DAT", "run"] {
        let printed = ok(folder.path(), &format!("spectrum {source} spool --to 0.3 --ascii {source}.txt"));
        let first_number = |line: &str| line.split_whitespace().next()?.parse::<f64>().ok();
        let frequency = printed.lines().find_map(first_number).expect("a peak");
        assert!((frequency - 50.0).abs() < 1.0, "{printed}");
        let ascii = fs::read_to_string(folder.path().join(format!("{source}.txt"))).expect("written");
        let integers: Vec<i32> = ascii.lines().map(|line| line.parse().expect("an integer")).collect();
        assert_eq!(integers.len(), 231);
        assert!(integers.iter().all(|value| (-2048..=2048).contains(value)));
    }
}

#[test]
fn two_spectra_of_one_unit_share_a_graph() {
    let folder = transients();
    let printed = ok(folder.path(), "spectrum TARGET01.DAT pressure-1 --with run --with-channel pressure-2");
    assert!(
        printed.contains("peaks of pressure 1, TARGET01.DAT") && printed.contains("peaks of pressure 2, run")
    );
    let page = fs::read_to_string(folder.path().join("spectrum.html")).expect("written");
    assert_eq!(page.matches("amplitude, kPa").count(), 3, "a heading a table, and one axis");
}

#[test]
fn what_is_no_record_is_refused_by_what_is_wrong_with_it() {
    let folder = transients();
    let text = record();
    let data = text.find("index,").expect("a header") + 500;
    let cut_line = &text[..data];
    let cut_end = text.rsplitn(4, '\n').last().expect("lines").to_owned() + "\n";
    let flipped = text.replace("\n9,8192", "\n9,8193");
    assert_ne!(flipped, text);
    for (name, bytes, says) in [
        ("cut.dat", cut_line.as_bytes(), "cut.dat: line "),
        ("cut-end.dat", cut_end.as_bytes(), "cut-end.dat: it is damaged, truncated or changed: the CRC is"),
        ("flipped.dat", flipped.as_bytes(), "flipped.dat: it is damaged, truncated or changed: the CRC is"),
        ("empty.dat", b"".as_slice(), "empty.dat: the file ends before its data"),
        ("sheet.csv", b"a,b\n1,2\n", "sheet.csv: line 1: expected `# key = value`"),
        (
            "picture.png",
            b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\xff",
            "picture.png is neither a TARGET file nor a run folder: line 1 has the byte 89: it is no text",
        ),
    ] {
        fs::write(folder.path().join(name), bytes).expect("written");
        all_refuse(folder.path(), name, says);
    }
    all_refuse(folder.path(), "nothing.dat", "cannot read nothing.dat");
    all_refuse(folder.path(), "run/trace.csv", "run/trace.csv is part of a run; give its folder");
}

/// The CRC is that of the data: the header has to make sense of itself.
#[test]
fn a_header_that_cannot_be_is_refused_by_its_key() {
    let folder = transients();
    for (key, value, says) in [
        ("measured_period_us", "0", "the header's measured_period_us is 0; it must be more than 0"),
        ("measured_period_us", "-1300", "the header's measured_period_us is -1300; it must be more than 0"),
        ("mm_per_count", "inf", "the header's mm_per_count is \"inf\", not a number"),
        ("pressure_scale_pa", "-244.2", "the header's pressure_scale_pa is -244.2; it must be more than 0"),
        ("spool_scale_mm", "0", "the header's spool_scale_mm is 0; it must be more than 0"),
        ("pressure_scale_pa", "NaN", "the header's pressure_scale_pa is \"NaN\", not a number"),
        ("spool_scale_mm", "wide", "the header's spool_scale_mm is \"wide\", not a number"),
        (
            "param.velocity_window_samples",
            "0",
            "the header's param.velocity_window_samples is 0; it must be a whole number from 1 to 63",
        ),
        (
            "param.acceleration_window_samples",
            "999",
            "the header's param.acceleration_window_samples is 999; it must be a whole number from 1 to 63",
        ),
    ] {
        let text = with_line(record(), key, Some(value));
        fs::write(folder.path().join("header.dat"), text).expect("written");
        all_refuse(folder.path(), "header.dat", &format!("header.dat: {says}"));
    }
    let without = with_line(record(), "measured_period_us", None);
    fs::write(folder.path().join("header.dat"), without).expect("written");
    all_refuse(
        folder.path(),
        "header.dat",
        "header.dat: the header has no line `# measured_period_us = ...`",
    );
}

#[test]
fn a_folder_that_is_no_run_or_a_damaged_one_is_refused_by_file_and_line() {
    let folder = transients();
    fs::create_dir(folder.path().join("empty")).expect("made");
    all_refuse(folder.path(), "empty", "empty is not a run folder: it has no run.json");
    fs::create_dir(folder.path().join("bad")).expect("made");
    let [trace, json] = ["trace.csv", "run.json"]
        .map(|name| fs::read_to_string(folder.path().join("run").join(name)).expect("written"));
    let header = trace.lines().next().expect("a header").to_owned() + "\n";
    let nan = trace.replace("\n0.0013,8192", "\n0.0013,NaN");
    let back = trace.replace("\n0.0026,", "\n0.0006,");
    let no_scale = json.replace("\"encoder.mm_per_count\": 0.01205", "\"encoder.mm_per_count\": 0");
    let no_window = json.replace("velocity_window_samples\": 5", "velocity_window_samples\": 256");
    for (trace, json, says) in [
        (trace.as_str(), "{", "bad/run.json is not JSON"),
        (&trace, "", "bad/run.json is not JSON"),
        (&trace, "{\"format\": \"other 1\"}", "bad/run.json is not a run of this program"),
        (&trace, &no_scale, "bad/run.json: encoder.mm_per_count is 0; it must be a number above 0"),
        (
            &trace,
            &no_window,
            "bad/run.json: controller.velocity_window_samples is 256; it must be a whole number from 1 to 63",
        ),
        (&trace[..trace.len() - 40], &json, "bad/trace.csv: line 348: expected 18 numbers"),
        ("", &json, "bad/trace.csv: line 1: expected the header time_s,"),
        ("a,b\n1,2\n", &json, "bad/trace.csv: line 1: expected the header time_s,"),
        (&header, &json, "bad has no samples"),
        (&nan, &json, "bad/trace.csv: line 3: expected 18 numbers"),
        (&back, &json, "bad/trace.csv: line 4: its time is not after that of the line before"),
    ] {
        fs::write(folder.path().join("bad/trace.csv"), trace).expect("written");
        fs::write(folder.path().join("bad/run.json"), json).expect("written");
        all_refuse(folder.path(), "bad", says);
    }
    fs::write(folder.path().join("bad/trace.csv"), b"\x89PNG\xff").expect("written");
    fs::write(folder.path().join("bad/run.json"), &json).expect("written");
    all_refuse(folder.path(), "bad", "bad/trace.csv: line 1 has the byte 89, which is not UTF-8");
}

#[test]
fn an_interval_without_samples_is_refused_with_what_there_is() {
    let folder = transients();
    let before = contents(folder.path());
    for (arguments, says) in [
        (
            "eval TARGET01.DAT --from 3",
            "TARGET01.DAT has fewer than two samples in this interval; it goes from 0.0000 s to 0.4498 s",
        ),
        ("eval run --from 0.3 --to 0.2", "run has fewer than two samples in this interval"),
        ("overlay TARGET01.DAT run --to -1", "TARGET01.DAT has fewer than two samples in this interval"),
        ("spectrum run position --from 3", "run has fewer than two samples in this interval"),
        (
            "spectrum TARGET01.DAT position --with run --from 3",
            "TARGET01.DAT has fewer than two samples in this interval",
        ),
    ] {
        let printed = transcript(folder.path(), arguments);
        assert!(
            printed.contains(&format!("! error: {says}")) && printed.ends_with("= 1"),
            "{arguments}: {printed}"
        );
    }
    assert_eq!(contents(folder.path()), before);
}

#[test]
fn a_file_of_the_users_is_not_overwritten_and_pages_of_this_program_are() {
    let folder = transients();
    fs::write(folder.path().join("mine.html"), "<p>my own").expect("written");
    fs::write(folder.path().join("mine.csv"), "my,own\n").expect("written");
    let before = contents(folder.path());
    for arguments in [
        "eval run --out mine.html",
        "eval run --csv mine.csv",
        "eval run --out run",
        "overlay run TARGET01.DAT --out mine.html",
        "spectrum run position --out mine.html",
        "spectrum run position --ascii mine.csv",
    ] {
        let output = pneudrive(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(1), "{arguments}");
        assert!(output.stdout.is_empty(), "it is told before the work: {arguments}");
        assert_eq!(contents(folder.path()), before, "{arguments}");
    }
    for _ in 0..2 {
        ok(folder.path(), "eval run --out page.html --csv page.csv");
    }
}
