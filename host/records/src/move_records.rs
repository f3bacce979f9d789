//! Move records of a drive as text: the form in a file or on a command line, and the form in the drive.
//!
//! A file has a table `[[record]]` for each:
//!
//! | key | is |
//! |---|---|
//! | `number` | 1 to 14; the inputs of the drive select it |
//! | `dwell_s` | how long the axis stays at its target before it counts as in position; 0 if absent |
//! | others | those of `[[test.move]]` except `at_s` and `points`: `to_mm`, `profile`, `velocity_mm_s`, ... |
//!
//! A drive begins a record wherever it stands. So a ramp is computed for the longest distance to its target between the
//! soft limits of the drive: it is within its limits from anywhere, and takes the same time from anywhere.

use anyhow::{Context, Result, anyhow, bail, ensure};
use pneudrive_controller::parameters::id;
use pneudrive_controller::{Move, Profile};
use pneudrive_protocol::MOVE_RECORDS;
use pneudrive_sim::key::Key;
use pneudrive_sim::{Rig, keys};
use toml_edit::{ArrayOfTables, DocumentMut, Item, Table};

use crate::rig_info::RigParameters;
use crate::units::Units;

/// A move record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MoveRecord {
    /// 1 to 14.
    pub number: u8,
    /// Target, counts, and profile.
    pub next: Move,
    /// From the arrival until it counts as in position, samples.
    pub dwell: u32,
}

/// The records of a file, for a drive with these parameters; `source` names the file in messages.
///
/// # Errors
/// The first invalid record, or one whose number came before.
pub fn records_of(source: &str, text: &str, drive: &RigParameters) -> Result<Vec<MoveRecord>> {
    let mut document: DocumentMut = text.parse().with_context(|| source.to_owned())?;
    let entries = match document.remove("record") {
        Some(Item::ArrayOfTables(entries)) => entries,
        Some(_) => bail!("{source}: record is no list of tables; write [[record]] above each"),
        None => ArrayOfTables::new(),
    };
    if let Some((key, _)) = document.iter().next() {
        bail!("{source}: {key} is not known here; a file of move records has tables [[record]] alone");
    }
    let mut records: Vec<MoveRecord> = Vec::new();
    for (place, entry) in (1..).zip(entries.iter()) {
        let record =
            record_of(entry, None, drive).with_context(|| format!("{source}: [[record]] {place}"))?;
        ensure!(
            records.iter().all(|other| other.number != record.number),
            "{source}: [[record]] {place}: number {} came before; each number has one record",
            record.number
        );
        records.push(record);
    }
    Ok(records)
}

/// The record of this number by settings `key=value`, such as `to_mm=120` and `profile=s-curve`.
///
/// # Errors
/// When they make no record.
pub fn record_by_settings(number: u8, settings: &[String], drive: &RigParameters) -> Result<MoveRecord> {
    let mut text = String::new();
    for setting in settings {
        let (key, value) = setting
            .split_once('=')
            .ok_or_else(|| anyhow!("{setting} is no KEY=VALUE, such as to_mm=120 or profile=s-curve"))?;
        let (key, value) = (key.trim(), value.trim());
        // A word may be written without quotes here.
        let quoted =
            if key == "profile" { format!("{:?}", value.trim_matches('"')) } else { value.to_owned() };
        text += &format!("{key} = {quoted}\n");
    }
    let document: DocumentMut = text.parse().context("these settings")?;
    record_of(document.as_table(), Some(number), drive)
}

/// Moves to be followed from one instant to another, and no records.
const NOT_OF_A_RECORD: [&str; 2] = ["at_s", "points"];

/// The record that a table says; its number, unless it is known.
fn record_of(entry: &Table, number: Option<u8>, drive: &RigParameters) -> Result<MoveRecord> {
    let mut entry = entry.clone();
    let number = match number {
        Some(number) => i64::from(number),
        None => {
            entry.remove("number").and_then(|item| item.as_integer()).context("give its number = 1 to 14")?
        }
    };
    let number = u8::try_from(number).ok().filter(|number| (1..=MOVE_RECORDS).contains(number));
    let number =
        number.with_context(|| format!("numbers go from 1 to {MOVE_RECORDS}; number 15 homes the axis"))?;
    let dwell_s = match entry.remove("dwell_s") {
        Some(item) => number_in(&item).context("dwell_s is a number of seconds")?,
        None => 0.0,
    };
    let period_s = drive.values.get(id::PERIOD_US).map(|us| f64::from(us) / 1e6).unwrap_or(1.0);
    ensure!((0.0..=3600.0).contains(&dwell_s), "dwell_s = {dwell_s} is out of range: 0 to 3600 s");
    for key in NOT_OF_A_RECORD {
        ensure!(
            !entry.contains_key(key),
            "{key} is nothing of a record: it begins when the drive is told to"
        );
    }
    if !entry.contains_key("profile") {
        entry.insert("profile", toml_edit::value("step"));
    }
    let next = move_of(entry, drive)?;
    Ok(MoveRecord { number, next, dwell: (dwell_s / period_s).round() as u32 })
}

fn number_in(item: &Item) -> Option<f64> {
    item.as_float().or_else(|| Some(item.as_integer()? as f64))
}

/// The move that a table says, by the reader of rig files.
fn move_of(entry: Table, drive: &RigParameters) -> Result<Move> {
    let mut entries = ArrayOfTables::new();
    entries.push(entry);
    let mut test = Table::new();
    test.insert("move", Item::ArrayOfTables(entries));
    let mut document = DocumentMut::new();
    document.insert("test", Item::Table(test));
    let rig = Rig::read_with("the move", &document.to_string(), &settings_of(drive)?)?;
    let sequence = rig.sequence();
    let [next] = sequence.moves() else { bail!("this is more than one move") };
    Ok(*next)
}

/// The reader's knowledge of the drive: its scale, its clock, and its range.
fn settings_of(drive: &RigParameters) -> Result<Vec<String>> {
    let known = |id: u16| {
        let value = drive.values.get(id).filter(|_| !drive.lacking.contains(&id));
        value.map(f64::from).context("the scales of the drive are not known; update its firmware")
    };
    let mm = known(id::ENCODER_PM_PER_COUNT)? / 1e9;
    let [low, high] = [known(id::END_MIN_COUNTS)?, known(id::END_MAX_COUNTS)?];
    let period_us = known(id::PERIOD_US)?;
    // A quarter of a count beyond the ends, which the rounding of mm must not cut off.
    let [low_mm, high_mm] = [(low - 0.25) * mm, (high + 0.25) * mm];
    let exact = |key: &Key, number: f64| key.setting(format_args!("{number:e}"));
    Ok(vec![
        exact(&keys::encoder::MM_PER_COUNT, mm),
        exact(&keys::controller::PERIOD_S, period_us / 1e6),
        exact(&keys::controller::DELAY_S, (period_us / 2.0).floor() / 1e6),
        exact(&keys::actuator::STROKE_M, high_mm / 1e3),
        exact(&keys::safety::END_MIN_MM, low_mm),
        exact(&keys::safety::END_MAX_MM, high_mm),
        exact(&keys::test::POSITION_M, high_mm / 2e3),
    ])
}

/// A record in words: target, profile and dwell.
#[must_use]
pub fn in_words(record: &MoveRecord, units: &Units) -> String {
    let Move { target, profile, .. } = record.next;
    let motion = match profile {
        Profile::Step => "at once".to_owned(),
        Profile::Ramp(_) => format!("in {}", units.time(profile.samples())),
        Profile::Wave(_) | Profile::Noise(_) => {
            let amplitude = i32::try_from(profile.amplitude()).unwrap_or(i32::MAX);
            format!("about it by {} for {}", units.length(amplitude), units.time(profile.samples()))
        }
    };
    let dwell = match record.dwell {
        0 => String::new(),
        samples => format!(", dwell {}", units.time(samples)),
    };
    format!("{:>2}  to {}, {motion}{dwell}", record.number, units.length(target))
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneudrive_controller::profile::Ramp;

    fn drive() -> RigParameters {
        RigParameters::default()
    }

    fn settings(all: &[&str]) -> Vec<String> {
        all.iter().map(|&one| one.to_owned()).collect()
    }

    const FILE: &str = "[[record]]\nnumber = 1\nto_mm = 120.5\n\n[[record]]\nnumber = 3\nto_counts = 4000\nprofile = \"trapezoid\"\nvelocity_mm_s = 300\nacceleration_mm_s2 = 5000\ndwell_s = 0.13\n";

    #[test]
    fn a_file_of_records_is_read_in_the_units_of_the_drive() {
        let records = records_of("records.toml", FILE, &drive()).expect("two records");
        let [first, second] = records[..] else { panic!("{records:?}") };
        assert_eq!((first.number, first.next, first.dwell), (1, Move::step(0, 10_000), 0));
        assert_eq!((second.number, second.next.target, second.dwell), (3, 4000, 100));
        let words: Vec<String> = records.iter().map(|one| in_words(one, &Units::of(&drive()))).collect();
        assert_eq!(words[0], " 1  to 120.500 mm, at once");
        assert!(words[1].starts_with(" 3  to 48.200 mm, in 0.") && words[1].ends_with(" s, dwell 0.130 s"));
    }

    /// From 4000 counts to the far end, 24,896 counts of 0.01205 mm away, at 300 mm/s: 0.839 s and what the
    /// acceleration takes.
    #[test]
    fn a_ramp_is_within_its_limits_on_the_longest_distance_to_its_target() {
        let records = records_of("records.toml", FILE, &drive()).expect("two records");
        let Profile::Ramp(ramp) = records[1].next.profile else { panic!("no ramp") };
        let [velocity, acceleration, _] = Ramp::averages(&ramp);
        let distance_mm = f64::from(24_896 - 4000) * 0.01205;
        let fastest = distance_mm / (f64::from(velocity) * 1.3e-3);
        assert!((295.0..=300.0).contains(&fastest), "{fastest} mm/s");
        let steepest = fastest / (f64::from(acceleration) * 1.3e-3);
        assert!((4800.0..=5000.0).contains(&steepest), "{steepest} mm/s^2");
    }

    #[test]
    fn settings_on_the_command_line_make_the_same_record_as_a_file() {
        let given = settings(&["to_mm=120.5", "profile=s-curve", "dwell_s=1", "velocity_mm_s=200"]);
        let one = record_by_settings(7, &given, &drive()).expect("a record");
        let file = "[[record]]\nnumber=7\nto_mm=120.5\nprofile=\"s-curve\"\ndwell_s=1\nvelocity_mm_s=200\n";
        assert_eq!(records_of("f", file, &drive()).expect("a record"), [one]);
    }

    #[test]
    fn what_makes_no_record_is_refused_by_its_place_and_key() {
        let refused = |text: &str| format!("{:#}", records_of("f.toml", text, &drive()).expect_err(text));
        for (text, says) in [
            ("[[record]]\nto_mm = 1\n", "f.toml: [[record]] 1: give its number"),
            ("[[record]]\nnumber = 0\nto_mm = 1\n", "numbers go from 1 to 14; number 15 homes"),
            ("[[record]]\nnumber = 16\nto_mm = 1\n", "numbers go from 1 to 14; number 15 homes"),
            ("[[record]]\nnumber = 1\n", "give either to_mm or to_counts"),
            ("[[record]]\nnumber = 1\nto_mm = 400\n", "lies beyond it"),
            ("[[record]]\nnumber = 1\nto_mm = 1\nspeed = 3\n", "speed"),
            ("[[record]]\nnumber = 1\nto_mm = 1\nat_s = 3\n", "at_s is nothing of a record"),
            ("[[record]]\nnumber = 1\nto_mm = 1\ndwell_s = -1\n", "out of range: 0 to 3600 s"),
            ("[[record]]\nnumber=2\nto_mm=1\n[[record]]\nnumber=2\nto_mm=1\n", "number 2 came before"),
            ("[test]\n", "test is not known here"),
            ("record = 3\n", "is no list of tables"),
        ] {
            assert!(refused(text).contains(says), "{}", refused(text));
        }
        let error = record_by_settings(1, &settings(&["120"]), &drive()).expect_err("no key").to_string();
        assert!(error.contains("120 is no KEY=VALUE"), "{error}");
    }
}
