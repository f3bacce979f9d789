use super::*;
use crate::log::Log;
use crate::signals::Signal;

/// Two samples with every kind of number; the spool is unknown in the first.
fn two_samples() -> Signals {
    let signal = |name: &str, values: [f64; 2]| Signal { name: name.to_owned(), values: values.into() };
    Signals {
        about: vec![("rig".to_owned(), "servo-b".to_owned())],
        time_s: vec![-0.0013, 0.0],
        signals: vec![signal("position_m", [0.1 + 0.2, -1e-300]), signal("spool_mm", [f64::NAN, 0.5])],
    }
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

#[test]
fn a_table_has_all_digits_and_leaves_unknown_values_empty() {
    let text = String::from_utf8(file(&two_samples(), Format::Csv).expect("a file")).expect("text");
    let (head, lines) = text.split_once('\n').expect("a header");
    assert_eq!(head, "time_s,position_m,spool_mm");
    assert!(lines.starts_with("-0.0013,0.30000000000000004,\n0,-0.0000"), "{lines}");
}

#[test]
fn a_matrix_stands_in_a_mat_file_byte_by_byte_as_the_format_says() {
    let mut signals = two_samples();
    signals.signals.truncate(1);
    signals.about.clear();
    let bytes = file(&signals, Format::Mat).expect("a file");
    assert_eq!(&bytes[..10], b"MATLAB 5.0");
    assert_eq!(bytes[124..128], [0x00, 0x01, b'I', b'M'], "version 0x0100, the order of its bytes");
    // An empty text, then the time: tag, flags, dimensions, name, two doubles.
    let about = 8 + 16 + 16 + 16 + 8;
    let time = &bytes[128 + about..][..80];
    let words: Vec<u32> =
        time.chunks(4).map(|word| u32::from_le_bytes(word.try_into().expect("4 bytes"))).collect();
    assert_eq!(words[..2], [14, 72]);
    assert_eq!(words[2..6], [6, 8, 6, 0], "of doubles");
    assert_eq!(words[6..10], [5, 8, 2, 1], "two rows, one column");
    assert_eq!((words[10..12].to_vec(), &time[48..56]), (vec![1, 6], &b"time_s\0\0"[..]));
    assert_eq!(words[14..16], [9, 16]);
    assert_eq!(time[64..72], (-0.0013f64).to_le_bytes());
    assert_eq!(bytes.len() % 8, 0);
}

#[test]
fn a_name_that_matlab_does_not_take_is_refused() {
    let mut signals = two_samples();
    signals.signals[0].name = "x".repeat(64);
    let refusal = file(&signals, Format::Mat).expect_err("too long");
    assert!(refusal.to_string().contains("choose mcap or csv"), "{refusal}");
}

#[test]
fn a_file_for_ros_2_has_a_topic_for_each_signal_in_every_bit() {
    let signals = two_samples();
    let bytes = file(&signals, Format::Ros2).expect("a file");
    assert!(bytes.windows(20).any(|part| part == b"std_msgs/msg/Float64"));
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("x.mcap");
    std::fs::write(&path, bytes).expect("written");
    let log = Log::read(&path).expect("a log");
    for signal in &signals.signals {
        let name = format!("/drive/{}.data", signal.name);
        let series = log.get(&name.as_str().into()).expect("a series");
        assert_eq!(bits(&series.values), bits(&signal.values), "{}", signal.name);
        assert_eq!(series.clock_s, Some(vec![0.0, 0.0013]));
    }
}

#[test]
fn an_mcap_file_describes_its_messages_and_reads_back_in_every_bit() {
    let signals = two_samples();
    let bytes = file(&signals, Format::Mcap).expect("a file");
    assert_eq!(bytes, file(&signals, Format::Mcap).expect("a file"), "the same bytes each time");
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("x.mcap");
    std::fs::write(&path, bytes).expect("written");
    let log = Log::read(&path).expect("a log");
    let series = |name: &str| log.get(&name.into()).expect("a series");
    assert_eq!(bits(&series("/drive.time_s").values), bits(&signals.time_s));
    assert_eq!(bits(&series("/drive.position_m").values), bits(&signals.signals[0].values));
    let spool = series("/drive.spool_mm").values;
    assert!(spool[0].is_nan() && spool[1] == 0.5, "{spool:?}");
    assert_eq!(series("/drive.spool_mm").clock_s, Some(vec![0.0, 0.0013]));
}

#[test]
fn a_parquet_file_reads_back_in_every_bit_with_null_for_what_is_unknown() {
    use ::parquet::file::reader::{FileReader, SerializedFileReader};
    use ::parquet::record::Field;

    let bytes = parquet::file(&two_samples()).expect("a file");
    let reader = SerializedFileReader::new(bytes::Bytes::from(bytes)).expect("Parquet");
    let rows = reader.get_row_iter(None).expect("rows");
    let rows: Vec<Vec<(String, Field)>> = rows.map(|row| row.expect("a row").into_columns()).collect();
    let field = |name: &str, field: Field| (name.to_owned(), field);
    assert_eq!(rows[0][1], field("position_m", Field::Double(0.1 + 0.2)));
    assert_eq!(rows[0][2], field("spool_mm", Field::Null));
    assert_eq!(rows[1][0], field("time_s", Field::Double(0.0)));
}

#[cfg(not(feature = "parquet"))]
#[test]
fn a_program_without_parquet_says_how_to_get_it() {
    let refusal = file(&two_samples(), Format::Parquet).expect_err("not built in");
    assert!(refusal.to_string().contains("--features parquet"), "{refusal}");
}

/// Files that are read by SciPy and the reference library of MCAP in host/python/tests/test_logs.py.
#[test]
fn the_files_that_other_libraries_read_are_those_of_this_version() {
    let fixtures = [
        (Format::Mat, &include_bytes!("../../tests/fixtures/two-samples.mat")[..]),
        (Format::Mcap, &include_bytes!("../../tests/fixtures/two-samples.mcap")[..]),
    ];
    for (format, golden) in fixtures {
        assert!(
            file(&two_samples(), format).expect("a file") == golden,
            "{format:?}: make it anew, and run the Python tests"
        );
    }
}
