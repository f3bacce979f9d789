//! What a TARGET file holds, and what is noticed of it.

use super::*;
use crate::record::RecordHead;

fn record() -> Record {
    let samples = (0..4).map(|i| RecordedSample {
        position: 8192 + i,
        pressure_1: 1332,
        pressure_2: 1638,
        command: -3,
        error: 5,
        spool: 2047,
    });
    let head = RecordHead {
        test: "servo-b".to_owned(),
        samples: 4,
        decimation: 2,
        pre_trigger: 2,
        first_index: -3,
        measured_period_ns: 1_300_250,
        mean_spool_raw: 2047,
        crc32: 0,
    };
    Record { head, samples: samples.collect() }
}

fn info() -> Info {
    Info {
        version: 1,
        firmware: "pneudrive 0.1.0".to_owned(),
        build: "test".to_owned(),
        board: "virtual".to_owned(),
        record_capacity: 4389,
    }
}

fn file() -> TargetFile {
    TargetFile::new(&record(), &info(), &RigParameters::default()).expect("counted")
}

/// The whole text: whoever reads these files reads it so.
#[test]
fn the_text_is_the_fixed_format() {
    let text = file().to_text();
    let expected_start = "\
# format = pneudrive-target 1
# test = servo-b
# firmware = pneudrive 0.1.0
# build = test
# sample_period_us = 1300
# measured_period_us = 1300.25
# decimation = 2
# pre_trigger = 2
# mm_per_count = 0.01205
# pressure_scale_pa = 244.2002442002442
# pressure_offset_pa = 0
# spool_scale_mm = 0.0006105006105006105
# spool_offset_mm = -1.25
# mean_spool_raw = 2047
# param.period_us = 1300
";
    assert!(text.starts_with(expected_start), "{text}");
    let expected_end = "\
# param.gain_profile = 8192,6144,4096,2048,1280,768,512,384,320,288,256
# crc32 = df7b9f48
index,position_counts,pressure_1_raw,pressure_2_raw,dac_counts,error_counts,spool_raw
-3,8192,1332,1638,-3,5,2047
-1,8193,1332,1638,-3,5,2047
0,8194,1332,1638,-3,5,2047
2,8195,1332,1638,-3,5,2047
";
    assert!(text.ends_with(expected_end), "{text}");
}

#[test]
fn what_was_written_is_read_again() {
    assert_eq!(TargetFile::from_text(&file().to_text()).expect("whole"), file());
}

#[test]
fn every_cut_and_every_changed_digit_is_noticed() {
    let text = file().to_text();
    for end in 0..text.len() - 1 {
        assert!(TargetFile::from_text(&text[..end]).is_err(), "cut after {end} bytes");
    }
    for (at, digit) in text.char_indices().filter(|(_, c)| c.is_ascii_digit()) {
        let other = if digit == '7' { "8" } else { "7" };
        let changed = format!("{}{other}{}", &text[..at], &text[at + 1..]);
        assert!(TargetFile::from_text(&changed).is_err(), "changed digit at {at}");
    }
}

#[test]
fn another_scale_or_parameter_in_the_header_is_noticed() {
    for (was, is) in [
        ("# mm_per_count = 0.01205", "# mm_per_count = 0.0241"),
        ("# test = servo-b\n", "# test = servo-c\n"),
        ("# param.period_us = 1300\n", ""),
        ("# decimation = 2\n", "# decimation = 2\n# remark = x\n"),
    ] {
        let changed = file().to_text().replacen(was, is, 1);
        assert_ne!(changed, file().to_text());
        let error = TargetFile::from_text(&changed).expect_err("changed").to_string();
        assert!(error.contains("damaged, truncated or changed"), "{error}");
    }
}

#[test]
fn a_key_that_is_given_twice_is_refused_by_its_lines() {
    let twice = file().to_text().replacen("# mean_spool_raw", "# mm_per_count = 9\n# mean_spool_raw", 1);
    let error = TargetFile::from_text(&twice).expect_err("twice").to_string();
    assert!(error.contains("line 14: mm_per_count is already set in line 9"), "{error}");
}

#[test]
fn a_name_with_lines_and_escapes_stays_on_its_line() {
    let mut record = record();
    record.head.test = "x\n# mm_per_count = 9\r\u{1b}[2J".to_owned();
    let info = Info { build: "b\n".to_owned(), ..info() };
    let text = TargetFile::new(&record, &info, &RigParameters::default()).expect("counted").to_text();
    let file = TargetFile::from_text(&text).expect("whole");
    assert_eq!(file.get("test"), Some(r"x\n# mm_per_count = 9\r\u{1b}[2J"));
    assert_eq!((file.get("build"), file.get("mm_per_count")), (Some(r"b\n"), Some("0.01205")));
}

#[test]
fn ends_of_lines_belong_to_no_value() {
    let text = file().to_text().replacen("# test = servo-b\n", "# test = servo-b\r\r\n", 1);
    assert_eq!(TargetFile::from_text(&text).expect("whole").get("test"), Some("servo-b"));
}

#[test]
fn foreign_files_are_refused_by_what_they_are() {
    let error = |text: &str| format!("{:#}", TargetFile::from_text(text).expect_err("foreign"));
    assert!(error("").contains("ends before its data"));
    assert!(error("time_s,position_m\n0,1\n").contains("line 1"));
    let later = file().to_text().replace("pneudrive-target 1", "pneudrive-target 9");
    assert!(error(&later).contains("pneudrive-target 9"));
}

#[test]
fn files_get_the_next_free_number_and_never_replace_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let name = |path: PathBuf| path.file_name().expect("a name").to_string_lossy().into_owned();
    assert_eq!(name(file().write_next(folder.path()).expect("written")), "TARGET01.DAT");
    fs::write(folder.path().join("TARGET02.DAT"), "mine").expect("written");
    assert_eq!(name(file().write_next(folder.path()).expect("written")), "TARGET03.DAT");
    for number in 4..=99 {
        fs::write(folder.path().join(format!("TARGET{number:02}.DAT")), "").expect("written");
    }
    assert_eq!(name(file().write_next(folder.path()).expect("written")), "TARGET100.DAT");
    assert_eq!(fs::read_to_string(folder.path().join("TARGET02.DAT")).expect("there"), "mine");
    let left = fs::read_dir(folder.path()).expect("a folder").filter_map(Result::ok);
    assert!(left.map(|entry| entry.file_name()).all(|name| !name.to_string_lossy().contains("partial")));
}
