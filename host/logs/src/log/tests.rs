use proptest::prelude::*;

use super::*;
use crate::export::{Format, file};
use crate::signals::{Signal, Signals};

/// Logs written by the reference library of MCAP in Python (tests/fixtures/make.py).
const LZ4: &[u8] = include_bytes!("../../tests/fixtures/protobuf-lz4.mcap");
const ROS2: &[u8] = include_bytes!("../../tests/fixtures/ros2-cdr.mcap");
const ZSTD: &[u8] = include_bytes!("../../tests/fixtures/protobuf-zstd.mcap");
const JSON: &[u8] = include_bytes!("../../tests/fixtures/json.mcap");

fn names(series: &[Series]) -> Vec<&str> {
    series.iter().map(|series| &*series.name).collect()
}

fn series_of(bytes: &[u8]) -> Result<Vec<Series>> {
    let log = Log::of_bytes("log", bytes)?;
    let Some(table) = &log.table else { return Ok(log.series) };
    let of = |name: String| log.get(&Source { column: Column::Named(name), decimal: None });
    let mut series: Vec<Series> = table.names().into_iter().map(of).collect::<Result<_>>()?;
    series.iter_mut().zip(table.names()).for_each(|(one, name)| one.name = name);
    Ok(series)
}

#[test]
fn what_is_no_log_is_refused_with_what_to_do() {
    let problem = |bytes: &[u8]| format!("{:#}", series_of(bytes).expect_err("no log"));
    assert_eq!(problem(b""), "it is empty");
    assert!(problem(&[0xfe, 0xed, 0, 1]).contains("it is no text"));
    assert!(problem(b"a,b\n1,2\n3\n").contains("line 3"), "{}", problem(b"a,b\n1,2\n3\n"));
    for length in [9, LZ4.len() / 10, LZ4.len() / 2] {
        assert!(series_of(&LZ4[..length]).is_err(), "the first {length} bytes");
    }
}

#[test]
fn files_of_the_reference_library_are_read_compressed_or_not() {
    for (bytes, what) in [(LZ4, "lz4"), (ZSTD, "zstd")] {
        let series = series_of(bytes).unwrap_or_else(|problem| panic!("{what}: {problem:#}"));
        assert_eq!(
            names(&series),
            ["/axis.position.x", "/axis.position.valid", "/axis.currents.0", "/axis.currents.1"]
        );
        assert_eq!(series[0].values.len(), 300, "{what}");
        assert_eq!(series[0].values[299], 29.9, "{what}");
        assert_eq!(series[3].values[2], -2.0, "{what}");
        let clock = series[0].clock_s.as_ref().expect("a clock");
        assert_eq!((clock[0], clock[299]), (0.0, 0.299), "{what}");
    }
    let series = series_of(JSON).expect("a log");
    assert_eq!(names(&series), ["/state.x", "/state.inner.y", "/state.list.0"]);
    assert_eq!(series[1].values[1], 2.5);
    assert!(series[2].values[0].is_nan(), "the first message has no list");
}

/// Written by the package mcap-ros2-support of the format's authors.
#[test]
fn a_bag_of_ros_2_is_read() {
    let series = series_of(ROS2).expect("a log");
    let last = |name: &str| series.iter().find(|one| one.name == name).map(|one| one.values[4]);
    for (name, value) in [
        ("/axis.header.stamp.sec", 1_700_000_000.0),
        ("/axis.header.stamp.nanosec", 4e6),
        ("/axis.position.0", 0.4),
        ("/axis.position.1", -1.5),
        ("/axis.pressure.0", 600_004.0),
        ("/axis.command", -400.0),
        ("/axis.mode", 2.0),
        ("/axis.armed", 1.0),
        ("/axis.cells.1.id", 4.0),
        ("/axis.cells.1.force.y", -8.0),
        ("/axis.count", -4e12),
        ("/axis.temperature", 21.5),
    ] {
        assert_eq!(last(name), Some(value), "{name}");
    }
    assert_eq!(series.len(), 17, "constants and texts are none: {:?}", names(&series));
    assert_eq!(series[0].clock_s.as_ref().expect("a clock")[4], 0.004);
}

#[test]
fn a_changed_byte_never_ends_the_program() {
    for file in [ZSTD, ROS2] {
        for place in 0..file.len() {
            let mut bytes = file.to_vec();
            bytes[place] ^= 0x55;
            let _ = series_of(&bytes);
        }
    }
}

proptest! {
    #[test]
    fn every_number_is_read_as_it_was_written(values in proptest::collection::vec(any::<f64>().prop_filter("finite", |value| value.is_finite()), 1..20)) {
        let signal = Signal { name: "x".to_owned(), values: values.clone() };
        let time_s = (0..values.len()).map(|k| k as f64).collect();
        let signals = Signals { about: Vec::new(), time_s, signals: vec![signal] };
        for format in [Format::Csv, Format::Mcap] {
            let series = series_of(&file(&signals, format).expect("a file")).expect("a log");
            let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
            prop_assert_eq!(bits(&series[1].values), bits(&values));
        }
    }
}
