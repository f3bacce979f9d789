//! Logs of other people: read as they were written, or refused with line, column, cell and remedy.

use std::path::Path;

use pneudrive_logs::column_map::ColumnMap;
use pneudrive_logs::import::{Imported, import};
use pneudrive_logs::log::Log;
use pneudrive_protocol::RecordedSample;
use pneudrive_sim::Rig;

const MAP: &str = include_str!("fixtures/found/map.toml");

fn of_log(log: &Log, map: &str) -> Result<Imported, String> {
    let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig");
    let map = ColumnMap::from_text(map, 101_325.0).map_err(|problem| format!("{problem:#}"))?;
    import(log, &map, &rig, None).map_err(|problem| format!("{problem:#}"))
}

fn imported(name: &str, map: &str) -> Result<Imported, String> {
    let path = Path::new("tests/fixtures/found").join(name);
    of_log(&Log::read(&path).map_err(|problem| format!("{problem:#}"))?, map)
}

fn text(text: &str, map: &str) -> Result<Imported, String> {
    of_log(&Log::of_bytes("log.csv", text.as_bytes()).map_err(|problem| format!("{problem:#}"))?, map)
}

fn samples(imported: Result<Imported, String>) -> Vec<RecordedSample> {
    let imported = imported.unwrap_or_else(|problem| panic!("{problem}"));
    imported.file.samples.iter().map(|(_, sample)| *sample).collect()
}

#[test]
fn a_name_that_two_columns_have_is_refused_and_a_number_takes_one() {
    let map = include_str!("fixtures/found/same_head.toml");
    let told = imported("same_head.csv", map).expect_err("refused");
    assert!(
        told.starts_with("[position]: same_head.csv: line 1: 2 columns are called \"Value\": 2, 4;"),
        "{told}"
    );
    let numbered = map
        .replacen("column=\"Time\"", "column = 1", 1)
        .replacen("column=\"Value\"", "column = 2", 1)
        .replacen("column=\"Value\"", "column = 4", 1);
    let samples = samples(imported("same_head.csv", &numbered));
    // 100.0 mm at 12.05 um a count.
    assert_eq!((samples[0].position, samples[0].command), (8298, 7));
}

#[test]
fn a_sign_between_thousands_is_no_decimal_sign() {
    let map = include_str!("fixtures/found/thousands.toml");
    let told = imported("thousands.tsv", map).expect_err("refused");
    assert!(told.contains("line 12, column 2 (\"x\"): \"1,000\" may be 1000 or 1;"), "{told}");
    let said = map.replace("column=\"x\"", "column=\"x\"\ndecimal=\".\"");
    let samples = samples(imported("thousands.tsv", &said));
    // 998 um and 1000 um, at 12.05 um a count.
    assert_eq!((samples[9].position, samples[10].position), (82, 82));
    assert_eq!(samples[39].position, 87);
}

#[test]
fn lost_rows_are_a_gap_of_the_record_and_are_told() {
    let found = imported("gap.csv", MAP).expect("a record");
    let indices: Vec<i32> = found.file.samples.iter().map(|(index, _)| *index).collect();
    let jump = indices.windows(2).find(|pair| pair[1] - pair[0] > 1).expect("a gap");
    assert_eq!(jump[1] - jump[0] - 1, 170, "{jump:?}");
    assert_eq!(indices.len() as i32, indices[indices.len() - 1] + 1 - 170);
    let told = found
        .remarks
        .iter()
        .find(|remark| remark.starts_with("GAPS: 170 samples are missing"))
        .expect("told");
    assert!(told.contains(" s. They are gaps of the record, and no figure over them is decidable"), "{told}");
    let bridged =
        imported("gap.csv", &MAP.replace("unit = \"ms\"", "unit = \"ms\"\ngap = \"1 s\"")).expect("a record");
    assert!(bridged.remarks.iter().all(|remark| !remark.starts_with("GAPS")), "asked for");
}

/// Rows every 2 ms, but one that comes an hour and 0.7 ms later: the record is sampled again on both sides.
#[test]
fn a_clock_that_jumps_an_hour_invents_no_samples() {
    let row =
        |k: u32| format!("{},{},0\n", 2.0 * f64::from(k) + if k > 50 { 3_600_000.7 } else { 0.0 }, 100 + k);
    let log: String = "t,x,u\n".to_owned() + &(0..100).map(row).collect::<String>();
    let map = "[time]\ncolumn = \"t\"\nunit = \"ms\"\n[position]\ncolumn = \"x\"\nunit = \"mm\"\n[command]\ncolumn = \"u\"\nunit = \"counts\"\n";
    let found = text(&log, map).expect("a record");
    assert!(found.file.samples.len() < 200, "{} samples", found.file.samples.len());
    assert!(found.remarks.iter().any(|remark| remark.starts_with("GAPS: 2769")), "{:?}", found.remarks);
}

#[test]
fn a_position_outside_the_stroke_is_refused_whatever_made_it() {
    let map = |position: &str| {
        format!(
            "[time]\nperiod = \"1.3 ms\"\n[position]\ncolumn = \"x\"\n{position}\n[setpoint]\ncolumn = \"r\"\nunit = \"mm\"\n[command]\ncolumn = \"u\"\nunit = \"counts\"\n"
        )
    };
    let log = "x,r,u\n100,100,0\n101,100,0\n";
    for (log, position, told) in [
        (
            log,
            "unit = \"m\"",
            "position is 100000.000 mm in sample 0, outside the stroke of the rig, 0 to 300 mm; check unit, sign and offset",
        ),
        (log, "unit = \"mm\"\nsign = -1", "position is -100.000 mm in sample 0"),
        (log, "unit = \"km\"", "position is 100000000.000 mm"),
        ("x,r,u\n100,100,0\n1e300,100,0\n", "unit = \"mm\"", "in sample 1, outside the stroke"),
        ("x,r,u\n100,100,0\n100,320,0\n", "unit = \"mm\"", "setpoint is 320.000 mm in sample 1"),
        ("x,r,u\n100,100,0\n100,100,1e10\n", "unit = \"mm\"", "command is 10000000000 counts in sample 1"),
    ] {
        let refused = text(log, &map(position)).expect_err(told);
        assert!(refused.contains(told), "{refused}");
    }
    assert!(text(log, &map("unit = \"mm\"")).is_ok());
    let fast = map("unit = \"mm\"").replace("1.3 ms", "1 ns");
    assert!(text(log, &fast).expect_err("refused").contains("check the unit of its time"));
}

#[test]
fn one_log_is_the_same_record_in_whatever_dialect_it_was_written() {
    let expected = samples(imported("d_sep.csv", MAP));
    assert!(expected.len() > 500);
    for name in ["utf16.txt", "e_quoted_comma.csv", "i_iso.csv"] {
        assert!(samples(imported(name, MAP)) == expected, "{name}");
    }
    let heads = MAP
        .replace("\"t\"", "\"t, ms, rel\"")
        .replace("\"x\"", "\"x, mm, abs\"")
        .replace("\"p1\"", "\"p1, bar, abs\"");
    assert!(samples(imported("f_head_commas.csv", &heads)) == expected);
    let told = imported("f_head_commas.csv", MAP).expect_err("another name");
    assert!(
        told.contains("there is no column \"x\"; there are 1 \"t, ms, rel\", 2 \"x, mm, abs\""),
        "{told}"
    );
    let iso = imported("i_iso.csv", MAP).expect("a record");
    assert!(iso.remarks.iter().any(|remark| remark.contains("the unit in [time] is not used")));
    let without = MAP.replacen("unit = \"ms\"\n", "", 1);
    assert!(samples(imported("i_iso.csv", &without)) == expected);
    assert!(imported("d_sep.csv", &without).expect_err("no unit").contains("[time] needs a unit"));
}

#[test]
fn messages_out_of_order_are_read_in_the_order_of_their_times() {
    let map = include_str!("fixtures/found/unordered.toml");
    let found = imported("unordered.mcap", map).expect("a record");
    let log = Log::read(Path::new("tests/fixtures/found/unordered.mcap")).expect("a log");
    let clock = log.series[0].clock_s.clone().expect("a clock");
    assert!(clock.windows(2).all(|pair| pair[0] <= pair[1]) && clock[0] == 0.0);
    let positions: Vec<i32> = found.file.samples.iter().map(|(_, sample)| sample.position).collect();
    // A drive has no jumps: half a millimetre a sample is 0.4 m/s.
    assert!(positions.windows(2).all(|pair| pair[0].abs_diff(pair[1]) < 100), "{positions:?}");
}

#[test]
fn a_file_that_was_cut_is_named() {
    let bytes = std::fs::read("tests/fixtures/found/unordered.mcap").expect("there");
    for end in [10, bytes.len() / 2, bytes.len() - 8, bytes.len() - 1] {
        let told = format!("{:#}", Log::of_bytes("x", &bytes[..end]).expect_err("cut"));
        assert!(told.starts_with("it is cut"), "{end}: {told}");
    }
}

/// A file written by the crate of the reference library: channels, and messages as (channel, log time, text).
fn mcap(channels: &[&str], messages: &[(usize, u64, &str)]) -> Vec<u8> {
    use mcap::records::MessageHeader;
    let mut bytes = std::io::Cursor::new(Vec::new());
    let mut writer = mcap::WriteOptions::new().compression(None).create(&mut bytes).expect("a writer");
    // Of the same topic, but of another publisher.
    let id = |(k, topic): (usize, &&str)| {
        let about = std::collections::BTreeMap::from([("publisher".to_owned(), k.to_string())]);
        writer.add_channel(0, topic, "json", &about).expect("a channel")
    };
    let ids: Vec<u16> = channels.iter().enumerate().map(id).collect();
    for (sequence, (channel, log_time, text)) in (0..).zip(messages) {
        let header = MessageHeader {
            channel_id: ids[*channel],
            sequence,
            log_time: *log_time,
            publish_time: *log_time,
        };
        writer.write_to_known_channel(&header, text.as_bytes()).expect("written");
    }
    writer.finish().expect("finished");
    drop(writer);
    bytes.into_inner()
}

#[test]
fn a_first_stamp_of_zero_is_named_and_two_publishers_of_a_topic_are_two() {
    let unset = mcap(&["/d"], &[(0, 0, "{\"x\":1}"), (0, 1_700_000_000_000_000_000, "{\"x\":2}")]);
    let told = format!("{:#}", Log::of_bytes("x", &unset).expect_err("refused"));
    assert!(told.starts_with("/d: its first message has the log time 0"), "{told}");
    let from_zero = mcap(&["/d"], &[(0, 0, "{\"x\":1}"), (0, 1_000_000, "{\"x\":2}")]);
    assert_eq!(Log::of_bytes("x", &from_zero).expect("a log").series[0].values, [1.0, 2.0]);
    let two = mcap(&["/d", "/d"], &[(0, 1, "{\"x\":1}"), (1, 2, "{\"x\":7}"), (0, 3, "{\"x\":2}")]);
    let log = Log::of_bytes("x", &two).expect("a log");
    assert_eq!(
        log.series.iter().map(|one| one.values.clone()).collect::<Vec<_>>(),
        [vec![1.0, 2.0], vec![7.0]]
    );
    let told = format!("{:#}", log.get(&"/d.x".into()).expect_err("which"));
    assert!(told.contains("it has /d#"), "{told}");
}

#[test]
fn the_name_of_a_log_is_one_line_of_the_header() {
    let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig");
    let log = Log::of_bytes("a\n# crc32 = 0\u{1b}[2J.csv", b"x,u\n100,0\n100,0\n100,0\n").expect("a log");
    let map = "[time]\nperiod = \"1.3 ms\"\n[position]\ncolumn = \"x\"\nunit = \"mm\"\n[command]\ncolumn = \"u\"\nunit = \"counts\"\n";
    let file = import(&log, &ColumnMap::from_text(map, 101_325.0).expect("a map"), &rig, None)
        .expect("a record")
        .file;
    let read = pneudrive_records::target::TargetFile::from_text(&file.to_text()).expect("a TARGET file");
    assert_eq!(read.get("imported"), Some("a\\n# crc32 = 0\\u{1b}[2J.csv"));
}

/// The map of docs/howto/logs.md, and a log for it.
#[test]
fn the_map_of_the_page_on_logs_is_read() {
    let page = include_str!("../../../docs/howto/logs.md");
    let map = page.split("```toml").nth(1).and_then(|rest| rest.split("```").next()).expect("a map");
    let log = "t,x,p1,u\n0,25.5,5,5\n1.3,25.5,5,5\n2.6,25.5,5,7.5\n20,25.5,5,7.5\n21.3,25.5,5,7.5\n";
    let found = text(log, map).expect("a record");
    let sample = found.file.samples[2].1;
    // 99.5 mm at 12.05 um a count; half open.
    assert_eq!((sample.position, sample.command), (8257, 1024));
    assert!(found.remarks.iter().any(|remark| remark.starts_with("GAPS")), "over 5 ms: {:?}", found.remarks);
}
