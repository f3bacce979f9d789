use pneudrive_evaluate::replay::replay;
use pneudrive_evaluate::transient::{COMMAND, ERROR, POSITION, PRESSURES, SETPOINT, SPOOL, Transient};
use pneudrive_identify::recording::Recording;
use pneudrive_records::run_folder::StoredRun;
use pneudrive_sim::{Accuracy, run};

use super::*;
use crate::log::Series;
use crate::signals::{Signal, Signals};

/// A map of the columns of trace.csv.
const MAP: &str = r#"
[time]
column = "time_s"
unit = "s"
[position]
column = "position_m"
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
[setpoint]
column = "setpoint_m"
unit = "m"
"#;

fn rig() -> Rig {
    Rig::builtin("servo-b-tuned")
        .expect("a built-in rig")
        .with_settings(&["test.duration_s=0.3".to_owned()])
        .expect("a shorter test")
}

/// What another recorder would have logged of a run.
fn log(rig: &Rig) -> (StoredRun, Log) {
    let run = StoredRun::of(rig, &run(rig, Accuracy::of(rig)).expect("a run"));
    let Signals { time_s, mut signals, .. } = Signals::of_run(run.clone());
    signals.push(Signal { name: "time_s".to_owned(), values: time_s });
    let series = |signal: Signal| Series { name: signal.name, clock_s: None, values: signal.values };
    (run, Log { name: "log.csv".to_owned(), series: signals.into_iter().map(series).collect(), table: None })
}

fn map(text: &str) -> ColumnMap {
    ColumnMap::from_text(text, 101_325.0).expect("a map")
}

fn transient(imported: &Imported) -> Transient {
    Transient::of_target("TARGET01.DAT", &imported.file).expect("a transient")
}

#[test]
fn an_even_log_becomes_a_record_sample_by_sample_within_the_steps_of_the_sensors() {
    let rig = rig();
    let (run, log) = log(&rig);
    let imported = import(&log, &map(MAP), &rig, None).expect("a record");
    let (found, expected) = (transient(&imported), Transient::of_run("run", &run));
    assert_eq!(found.time.len(), expected.time.len());
    assert_eq!(found.channels[SETPOINT], expected.channels[SETPOINT]);
    assert_eq!(found.channels[COMMAND], expected.channels[COMMAND]);
    for (channel, step) in
        [(POSITION, run.mm_per_count), (PRESSURES[0], 0.1222), (PRESSURES[1], 0.1222), (SPOOL, 3.1e-4)]
    {
        for (found, expected) in found.channels[channel].iter().zip(&expected.channels[channel]) {
            assert!((found - expected).abs() <= step, "channel {channel}: {found} for {expected}");
        }
    }
}

#[test]
fn a_record_that_was_imported_is_read_back_and_fitted_but_not_replayed() {
    let rig = rig();
    let imported = import(&log(&rig).1, &map(MAP), &rig, None).expect("a record");
    let read = TargetFile::from_text(&imported.file.to_text()).expect("a TARGET file");
    assert_eq!(read, imported.file);
    assert!(Recording::of("TARGET01.DAT", &read, &rig).is_ok());
    let refusal = replay(&read).expect_err("no replay").to_string();
    assert!(refusal.contains("imported from log.csv"), "{refusal}");
}

#[test]
fn what_a_log_does_not_have_is_unknown_and_not_0() {
    let rig = rig();
    let few: String = MAP.split("[pressure_1]").next().expect("a beginning").to_owned()
        + "[command]\ncolumn = \"command_counts\"\nunit = \"counts\"\n";
    let imported = import(&log(&rig).1, &map(&few), &rig, None).expect("a record");
    let transient = transient(&imported);
    for channel in [SETPOINT, PRESSURES[0], PRESSURES[1], SPOOL, ERROR] {
        assert!(transient.channels[channel].iter().all(|value| value.is_nan()), "channel {channel}");
    }
    assert!(transient.channels[POSITION].iter().all(|value| value.is_finite()));
    assert!(transient.is_open_loop());
    let refusal = format!("{:#}", Recording::of("x", &imported.file, &rig).expect_err("no fit"));
    assert!(refusal.contains("has no pressure_1: a fit needs both pressures"), "{refusal}");
    assert!(imported.remarks.iter().any(|remark| remark.contains("pressure_1, pressure_2, spool, setpoint")));
}

#[test]
fn an_uneven_log_is_sampled_again_on_straight_lines_and_commands_hold() {
    let series =
        |name: &str, values: &[f64]| Series { name: name.to_owned(), clock_s: None, values: values.to_vec() };
    let log = Log {
        name: "log.csv".to_owned(),
        series: vec![
            series("t", &[10.0, 11.0, 14.0]),
            series("x", &[0.0, 10.0, 40.0]),
            series("u", &[100.0, 200.0, 300.0]),
        ],
        table: None,
    };
    let map = map(
        "[time]\ncolumn = \"t\"\nunit = \"ms\"\n[position]\ncolumn = \"x\"\nunit = \"mm\"\n[command]\ncolumn = \"u\"\nunit = \"counts\"\n",
    );
    let imported = import(&log, &map, &rig(), Some(2e-3)).expect("a record");
    let found = transient(&imported);
    assert_eq!(found.time, [0.0, 0.002, 0.004]);
    assert_eq!(found.channels[COMMAND], [100.0, 200.0, 300.0]);
    for (found, expected) in found.channels[POSITION].iter().zip([0.0, 20.0, 40.0]) {
        assert!((found - expected).abs() <= found.max(0.01205), "{found}");
        assert!((expected - found).abs() <= 0.01205, "{found} for {expected}");
    }
    assert!(
        imported.remarks.iter().any(|remark| remark.contains("1.333 ms") || remark.contains("2.000 ms")),
        "{:?}",
        imported.remarks
    );
}

#[test]
fn each_topic_of_an_mcap_file_has_its_own_clock() {
    let series = |name: &str, clock: &[f64], values: &[f64]| Series {
        name: name.to_owned(),
        clock_s: Some(clock.to_vec()),
        values: values.to_vec(),
    };
    let log = Log {
        name: "log.mcap".to_owned(),
        series: vec![
            series("/a.x", &[0.0, 0.01], &[0.0, 0.1]),
            series("/b.u", &[0.0005, 0.0045, 0.02], &[1.0, 2.0, 3.0]),
        ],
        table: None,
    };
    let map =
        map("[position]\ncolumn = \"/a.x\"\nunit = \"m\"\n[command]\ncolumn = \"/b.u\"\nunit = \"counts\"\n");
    let imported = import(&log, &map, &rig(), Some(1e-3)).expect("a record");
    let found = transient(&imported);
    assert_eq!(found.time.len(), 10, "from 0.5 ms to 9.5 ms");
    assert_eq!(found.channels[COMMAND][..6], [1.0, 1.0, 1.0, 1.0, 2.0, 2.0]);
}

#[test]
fn what_does_not_fit_is_named_with_its_place_and_what_to_do() {
    let rig = rig();
    let (_, log) = log(&rig);
    let problem = |log: &Log, from: &str, to: &str, period: Option<f64>| {
        assert!(MAP.contains(from), "{from}");
        let map = map(&MAP.replacen(from, to, 1));
        let refusal = import(log, &map, &rig, period).err();
        format!("{:#}", refusal.unwrap_or_else(|| panic!("{to} is taken")))
    };
    assert!(
        problem(&log, "\"position_m\"", "\"postion\"", None)
            .contains("has no column \"postion\"; it has setpoint_counts")
    );
    assert!(
        problem(&log, "column = \"time_s\"\nunit = \"s\"", "period = \"1 s\"", None)
            .contains("choose a shorter --period")
    );
    let gauge = problem(
        &log,
        "column = \"pressure_1_pa\"\nunit = \"Pa\"",
        "column = \"pressure_1_pa\"\nunit = \"kPa\"",
        None,
    );
    assert!(gauge.contains("pressure_1 is 3") && gauge.contains("check unit and sign"), "{gauge}");
    assert!(problem(&log, "unit = \"counts\"", "unit = \"%\"", None).contains("beyond a fully open valve"));
    assert!(problem(&log, "", "", Some(1.0)).contains("less than two periods"));
    assert!(problem(&log, "", "", Some(1e-4)).contains("controller.delay_s"));
    let mut holed = log.clone();
    holed.series.iter_mut().for_each(|series| series.values[7] = f64::NAN);
    assert!(problem(&holed, "", "", None).contains("message 8 of \"position_m\" is not a number"));
    let mut back = log.clone();
    back.series.iter_mut().filter(|series| series.name == "time_s").for_each(|series| series.values[7] = 0.0);
    assert!(
        problem(&back, "", "", None)
            .contains("message 8 of \"time_s\": its time, 0 s, is not after that of the row before")
    );
}
