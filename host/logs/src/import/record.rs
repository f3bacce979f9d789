//! Channels on one clock as the integers of a record.

use anyhow::{Context, Result, anyhow, bail};
use pneudrive_controller::Parameters;
use pneudrive_controller::parameters::{id, lookup};
use pneudrive_protocol::RecordedSample;
use pneudrive_records::record::{Record, RecordHead};
use pneudrive_records::rig_info::{Info, RigParameters};
use pneudrive_records::target::{IMPORTED, TargetFile, UNKNOWN};
use pneudrive_records::untrusted::{SENTENCE, sanitised};
use pneudrive_sim::component::encoder::mm_per_count;
use pneudrive_sim::{Rig, keys};

use super::{Imported, Table};
use crate::column_map::{CHANNELS, COMMAND, POSITION, PRESSURES, SETPOINT, SPOOL};
use crate::log::Log;

/// Least and most of a command, counts.
const COMMANDS: [f64; 2] = [-2048.0, 2048.0];

/// The record of a log.
///
/// # Errors
/// When a value is outside the range of the rig's sensors or its valve.
pub fn of(log: &Log, rig: &Rig, table: &Table) -> Result<Imported> {
    let parameters = parameters(rig, table)?;
    let converters = Converters::of(rig, &parameters);
    let samples = samples(table, &converters)?;
    let spool = samples.iter().map(|sample| f64::from(sample.spool)).sum::<f64>() / samples.len() as f64;
    let head = RecordHead {
        test: rig.name().to_owned(),
        samples: samples.len(),
        first_index: 0,
        decimation: 1,
        pre_trigger: 0,
        measured_period_ns: whole(1e9 * table.period_s).context("the period, ns")?,
        mean_spool_raw: whole(spool).context("the spool")?,
        crc32: 0,
    };
    let info = Info {
        version: 0,
        firmware: "none".to_owned(),
        build: "none".to_owned(),
        board: "none".to_owned(),
        record_capacity: 0,
    };
    let parameters = RigParameters { values: parameters, lacking: Vec::new() };
    let mut file = TargetFile::new(&Record { head, samples }, &info, &parameters)?;
    for ((index, _), of_log) in file.samples.iter_mut().zip(&table.indices) {
        *index = *of_log;
    }
    let unknown: Vec<&str> = (0..CHANNELS.len())
        .filter(|&channel| table.channels[channel].is_none())
        .map(|channel| CHANNELS[channel].name)
        .collect();
    // The quantities of the log were measured, whatever the rig file says; the others were not.
    file.header.retain(|(key, _)| key != UNKNOWN);
    file.header.insert(1, (IMPORTED.to_owned(), sanitised(&log.name, SENTENCE)));
    if !unknown.is_empty() {
        file.header.insert(2, (UNKNOWN.to_owned(), unknown.join(",")));
    }
    file.seal();
    let remarks = remarks(table, &converters, rig.get(&keys::controller::DELAY_S), &unknown);
    let hidden = hidden_setpoints(&file).into_iter();
    Ok(Imported {
        remarks: remarks.into_iter().chain(missing(&file, table.period_s)).chain(hidden).collect(),
        file,
    })
}

/// The rig's parameters at the log's period; without setpoints in open loop.
fn parameters(rig: &Rig, table: &Table) -> Result<Parameters> {
    let mut parameters = rig.parameters();
    let period_us: i32 =
        whole(1e6 * table.period_s).filter(|period_us| *period_us > 0).with_context(|| {
            format!("the log has a sample every {:e} s; check the unit of its time", table.period_s)
        })?;
    let delay_us = parameters.get(id::DELAY_US).unwrap_or(0);
    if delay_us >= period_us {
        bail!(
            "in the rig file a command reaches the valve {delay_us} us after its sample, in the log the next sample comes after {period_us} us; set controller.delay_s to the delay of what was logged"
        );
    }
    parameters.set(id::PERIOD_US, period_us).map_err(|_| {
        let most = lookup(id::PERIOD_US).map_or(0, |parameter| parameter.max);
        anyhow!("a sample every {period_us} us is more than the {most} us of a controller; choose a shorter --period")
    })?;
    if table.channels[SETPOINT].is_none() {
        parameters.set(id::OPEN_LOOP, 1).map_err(|_| anyhow!("the rig cannot be one of an open loop"))?;
    }
    Ok(parameters)
}

/// The rig's sensors.
struct Converters {
    mm_per_count: f64,
    /// mm.
    stroke: f64,
    pressure: Converter,
    spool: Converter,
}

/// A converter of this many codes from 0, over a range.
struct Converter {
    least: f64,
    most: f64,
    codes: f64,
}

impl Converters {
    fn of(rig: &Rig, parameters: &Parameters) -> Converters {
        let get = |id: u16| f64::from(parameters.get(id).unwrap_or(0));
        let codes = f64::from((1u32 << parameters.get(id::SENSOR_BITS).unwrap_or(12)) - 1);
        Converters {
            mm_per_count: mm_per_count(rig),
            stroke: 1e3 * rig.get(&keys::actuator::STROKE_M),
            pressure: Converter { least: get(id::PRESSURE_MIN_PA), most: get(id::PRESSURE_MAX_PA), codes },
            spool: Converter {
                least: get(id::SPOOL_MIN_NM) * 1e-6,
                most: get(id::SPOOL_MAX_NM) * 1e-6,
                codes,
            },
        }
    }
}

impl Converter {
    fn step(&self) -> f64 {
        (self.most - self.least) / self.codes
    }

    /// None outside its range.
    fn code(&self, value: f64) -> Option<i16> {
        let code = || whole((value - self.least) / self.step());
        if (self.least..=self.most).contains(&value) { code() } else { None }
    }
}

fn samples(table: &Table, converters: &Converters) -> Result<Vec<RecordedSample>> {
    let rows = table.channels[POSITION].as_ref().map_or(0, Vec::len);
    (0..rows).map(|row| sample(table, converters, row)).collect()
}

fn sample(table: &Table, converters: &Converters, row: usize) -> Result<RecordedSample> {
    let value = |channel: usize| table.channels[channel].as_ref().map(|values| values[row]);
    let code = |channel: usize, converter: &Converter, show: fn(f64) -> String| {
        match value(channel) {
        None => Ok(0),
        Some(value) => converter.code(value).ok_or_else(|| {
            anyhow!(
                "{} is {} in sample {}, outside the range of the rig's sensor, {} to {}; check unit and sign, or give the rig the sensor that was used",
                CHANNELS[channel].name,
                show(value),
                table.indices[row],
                show(converter.least),
                show(converter.most)
            )
        }),
    }
    };
    let counts = |channel: usize| {
        value(channel).map(|metres| converters.count(channel, metres, table.indices[row])).transpose()
    };
    let position = counts(POSITION)?.unwrap_or(0);
    let setpoint = counts(SETPOINT)?.unwrap_or(position);
    Ok(RecordedSample {
        position,
        pressure_1: code(PRESSURES[0], &converters.pressure, kilopascals)?,
        pressure_2: code(PRESSURES[1], &converters.pressure, kilopascals)?,
        command: command(value(COMMAND).unwrap_or(0.0), table.indices[row])?,
        error: error(setpoint - position),
        spool: code(SPOOL, &converters.spool, millimetres)?,
    })
}

impl Converters {
    /// The count of a position or setpoint, m.
    ///
    /// # Errors
    /// When it is further outside the stroke than any stop yields.
    fn count(&self, channel: usize, metres: f64, sample: i32) -> Result<i32> {
        let (mm, beyond) = (1e3 * metres, BEYOND * self.stroke);
        let count = if (-beyond..=self.stroke + beyond).contains(&mm) {
            encoder_count(mm / self.mm_per_count)
        } else {
            None
        };
        count.with_context(|| {
            format!(
                "{} is {mm:.3} mm in sample {sample}, outside the stroke of the rig, 0 to {} mm; check unit, sign and offset: 0 is where the piston is fully retracted",
                CHANNELS[channel].name, self.stroke
            )
        })
    }
}

/// How far beyond its ends a position may be, parts of the stroke: stops yield, and an encoder is not set to the last count.
const BEYOND: f64 = 0.02;

/// A number rounded to a whole one; None of one that the type does not hold.
fn whole<T: TryFrom<i64>>(number: f64) -> Option<T> {
    const MAX: f64 = 9e15;
    let number = Some(number.round()).filter(|number| number.abs() < MAX)?;
    T::try_from(number as i64).ok()
}

/// The count of a position in counts. One that was itself counted stands on an edge, and may have lost its last digit.
fn encoder_count(position: f64) -> Option<i32> {
    const LAST_DIGITS: f64 = 1e-6;
    whole((position + LAST_DIGITS).floor())
}

/// The error as a controller records it: at the limits of its 16 bits it does not show the setpoint.
fn error(counts: i32) -> i16 {
    i16::try_from(counts).unwrap_or(if counts > 0 { i16::MAX } else { i16::MIN })
}

/// The remark on setpoints that a record cannot hold.
fn hidden_setpoints(file: &TargetFile) -> Option<String> {
    let is_hidden = |(_, sample): &&(i32, RecordedSample)| matches!(sample.error, i16::MAX | i16::MIN);
    let samples = file.samples.iter().filter(is_hidden).count();
    (samples > 0).then(|| {
        format!("In {samples} samples the setpoint is more than {} counts from the position: a record does not hold it there, and shows the one of the next sample that does.", i16::MAX)
    })
}

/// The remark on gaps, with the first ones.
fn missing(file: &TargetFile, period_s: f64) -> Option<String> {
    const SHOWN: usize = 3;
    let gaps: Vec<[i32; 2]> = file
        .samples
        .windows(2)
        .map(|pair| [pair[0].0, pair[1].0])
        .filter(|[before, after]| after - before > 1)
        .collect();
    let samples: i64 = gaps.iter().map(|[before, after]| i64::from(after - before) - 1).sum();
    let place = |[before, after]: &[i32; 2]| {
        let [from, to] = [before, after].map(|index| f64::from(*index) * period_s);
        format!("{from:.4} to {to:.4} s")
    };
    let places: Vec<String> = gaps.iter().take(SHOWN).map(place).collect();
    let more = if gaps.len() > SHOWN { format!(" and {} more", gaps.len() - SHOWN) } else { String::new() };
    (!gaps.is_empty()).then(|| {
        format!(
            "GAPS: {samples} samples are missing, {}{more}. They are gaps of the record, and no figure over them is decidable. If the recorder holds its values that long, set a longer gap in [time] of the map.",
            places.join(", ")
        )
    })
}

fn command(counts: f64, sample: i32) -> Result<i16> {
    let [least, most] = COMMANDS;
    let rounded = counts.round();
    let command = if (least..=most).contains(&rounded) { whole(rounded) } else { None };
    command.with_context(|| {
        format!(
            "command is {rounded} counts in sample {sample}, beyond a fully open valve ({least} to {most}); check unit, null and full"
        )
    })
}

fn kilopascals(pascals: f64) -> String {
    format!("{:.1} kPa", 1e-3 * pascals)
}

fn millimetres(value: f64) -> String {
    format!("{value:.3} mm")
}

fn remarks(table: &Table, converters: &Converters, delay_s: f64, unknown: &[&str]) -> Vec<String> {
    let mut remarks = vec![format!(
        "Values are rounded to the rig's sensors: the position to {} mm, pressures to {:.3} kPa, commands to a count. A rig with finer ones keeps more.",
        converters.mm_per_count,
        1e-3 * converters.pressure.step()
    )];
    remarks.push(format!(
        "A command is taken to reach the valve {:.3} ms after its row, as in the rig file (controller.delay_s).",
        1e3 * delay_s
    ));
    remarks.extend(table.remark.clone());
    if !unknown.is_empty() {
        remarks.push(format!(
            "The log has no {}: no curve and no figure of a record shows them.",
            unknown.join(", ")
        ));
    }
    if table.channels[SETPOINT].is_none() {
        remarks.push("Without setpoints, the moves are the commands, as in an open loop.".to_owned());
    }
    remarks
}
