//! The signals of a transient, in SI units, whatever file it comes from.
//!
//! Names are those of trace.csv, with their units: `position_m`, `pressure_1_pa`. Unknown values are not a number.

use std::path::Path;

use anyhow::Result;
use pneudrive_evaluate::transient::{COMMAND, ERROR, POSITION, SETPOINT, SPOOL, Transient};
use pneudrive_protocol::RecordedSample;
use pneudrive_records::run_folder::StoredRun;
use pneudrive_records::target::TargetFile;
use pneudrive_sim::rig::unit;

/// A quantity over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Signal {
    /// Its name, with the unit at the end.
    pub name: String,
    /// Its values, one for each sample; NaN where it is unknown.
    pub values: Vec<f64>,
}

/// The signals of a transient.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Signals {
    /// Facts about all samples: the header of a record, the rig of a run; the unit of each signal.
    pub about: Vec<(String, String)>,
    /// Times from the start of the test, s; they increase from sample to sample.
    pub time_s: Vec<f64>,
    /// The signals, each with one value per time.
    pub signals: Vec<Signal>,
}

impl Signals {
    /// The signals of a TARGET file, a streamed run or a run folder, by its contents.
    ///
    /// # Errors
    /// When it is none of them, or damaged.
    pub fn read(path: &Path) -> Result<Signals> {
        let mut signals = match path.is_dir() {
            true => Signals::of_run(StoredRun::read(path)?),
            // A transient cannot be made from a part of a run folder.
            false => Signals::of_record(&Transient::read(path)?, &TargetFile::read(path)?)?,
        };
        let units = signals.signals.iter().map(|signal| {
            let unit = unit(&signal.name).1;
            (format!("unit of {}", signal.name), unit.to_owned())
        });
        let units: Vec<(String, String)> = units.collect();
        signals.about.extend(units);
        Ok(signals)
    }

    /// Every column of a run, and its setpoint as a record has it.
    #[must_use]
    pub fn of_run(run: StoredRun) -> Signals {
        let values = Transient::of_run("", &run).channels[SETPOINT].iter().map(|mm| mm * 1e-3).collect();
        let setpoint = Signal { name: "setpoint_m".to_owned(), values };
        let about = [("rig", run.rig.clone()), ("mm_per_count", run.mm_per_count.to_string())];
        let mut columns = run.into_columns().map(|(name, values)| Signal { name: name.to_owned(), values });
        let time_s = columns.next().map(|time| time.values).unwrap_or_default();
        let about = about.map(|(key, value)| (key.to_owned(), value)).into();
        Signals { about, time_s, signals: columns.chain([setpoint]).collect() }
    }

    /// The channels of a record, with the lines of its header.
    ///
    /// # Errors
    /// When its header lacks a scale.
    pub fn of_record(transient: &Transient, file: &TargetFile) -> Result<Signals> {
        let channel = |channel: usize, factor: f64| {
            transient.channels[channel].iter().map(|value| value * factor).collect()
        };
        let [scale, offset] = [file.positive("pressure_scale_pa")?, file.number("pressure_offset_pa")?];
        let pressure = |name: &str, raw: fn(&RecordedSample) -> i16| {
            let known = if file.is_unknown(name) { f64::NAN } else { 1.0 };
            file.samples.iter().map(|(_, sample)| known * (f64::from(raw(sample)) * scale + offset)).collect()
        };
        let signals: [(&str, Vec<f64>); 8] = [
            ("setpoint_m", channel(SETPOINT, 1e-3)),
            ("position_counts", transient.counts.iter().copied().map(f64::from).collect()),
            ("error_counts", channel(ERROR, 1.0)),
            ("command_counts", channel(COMMAND, 1.0)),
            ("position_m", channel(POSITION, 1e-3)),
            ("pressure_1_pa", pressure("pressure_1", |sample| sample.pressure_1)),
            ("pressure_2_pa", pressure("pressure_2", |sample| sample.pressure_2)),
            ("spool_mm", channel(SPOOL, 1.0)),
        ];
        let signals = signals.map(|(name, values)| Signal { name: name.to_owned(), values }).into();
        Ok(Signals { about: file.header.clone(), time_s: transient.time.clone(), signals })
    }
}
