//! The text of a record in TARGET files and streamed runs: lines `# key = value`, then one line of integers per sample.

use anyhow::{Result, anyhow};
use pneudrive_controller::parameters::{TABLE, id};
use pneudrive_protocol::{RecordedSample, frame};

use crate::parameter_names::parameter_text;
use crate::rig_info::{Info, RigParameters};
use crate::units::lacks_pressures;
use crate::untrusted::{NAME, sanitised};

/// Key of the channels that were not measured, separated by commas: `pressure_1,spool`. Their columns hold 0; without
/// a setpoint the column of the error does.
pub const UNKNOWN: &str = "unknown";

/// The channels of a rig without pressure sensors.
const PRESSURES: [&str; 2] = ["pressure_1", "pressure_2"];

/// Header of the data lines.
pub(crate) const COLUMNS: &str =
    "index,position_counts,pressure_1_raw,pressure_2_raw,dac_counts,error_counts,spool_raw";

/// Header lines with the rig and the parameters of the samples. Parameters that the firmware does not have are left out.
pub(crate) fn described(
    format: &str,
    test: &str,
    info: &Info,
    parameters: &RigParameters,
) -> Vec<(String, String)> {
    let RigParameters { values, lacking } = parameters;
    let get = |id: u16| f64::from(values.get(id).unwrap_or(0));
    let full_scale = f64::from((1u32 << values.get(id::SENSOR_BITS).unwrap_or(12)) - 1);
    let scale = |min: u16, max: u16| (get(max) - get(min)) / full_scale;
    let mut header: Vec<(String, String)> = Vec::new();
    let mut put = |key: &str, value: String| header.push((key.to_owned(), value));
    put("format", format.to_owned());
    if lacks_pressures(values) {
        put(UNKNOWN, PRESSURES.join(","));
    }
    // A line break in a name would make a header that cannot be read.
    put("test", sanitised(test, NAME));
    put("firmware", sanitised(&info.firmware, NAME));
    put("build", sanitised(&info.build, NAME));
    put("sample_period_us", format!("{}", get(id::PERIOD_US)));
    put("mm_per_count", format!("{}", get(id::ENCODER_PM_PER_COUNT) / 1e9));
    put("pressure_scale_pa", format!("{}", scale(id::PRESSURE_MIN_PA, id::PRESSURE_MAX_PA)));
    put("pressure_offset_pa", format!("{}", get(id::PRESSURE_MIN_PA)));
    put("spool_scale_mm", format!("{}", scale(id::SPOOL_MIN_NM, id::SPOOL_MAX_NM) / 1e6));
    put("spool_offset_mm", format!("{}", get(id::SPOOL_MIN_NM) / 1e6));
    for parameter in TABLE.iter().filter(|parameter| !lacking.contains(&parameter.id)) {
        put(&format!("param.{}", parameter.name), parameter_text(values, parameter.id, parameter.len));
    }
    header
}

/// The CRC-32 (ISO-HDLC) of a text, as written in files.
pub(crate) fn crc_text(text: &str) -> String {
    format!("{:08x}", frame::crc32(text.as_bytes()))
}

/// The text of header lines.
pub(crate) fn header_text(header: &[(String, String)]) -> String {
    header.iter().map(|(key, value)| format!("# {key} = {value}\n")).collect()
}

/// The lines of samples.
pub(crate) fn data_lines(samples: &[(i32, RecordedSample)]) -> String {
    samples.iter().map(|(index, sample)| data_line(i64::from(*index), sample)).collect()
}

/// A sample's line, with its LF.
pub(crate) fn data_line(index: i64, s: &RecordedSample) -> String {
    let RecordedSample { position, pressure_1, pressure_2, command, error, spool } = s;
    format!("{index},{position},{pressure_1},{pressure_2},{command},{error},{spool}\n")
}

/// The sample of a line, whose number counts from 0.
pub(crate) fn sample_of(number: usize, line: &str) -> Result<(i32, RecordedSample)> {
    fields(line).ok_or_else(|| anyhow!("line {}: expected seven whole numbers, found {line:?}", number + 1))
}

fn fields(line: &str) -> Option<(i32, RecordedSample)> {
    let mut fields = line.split(',');
    let mut next = || fields.next();
    let index = next()?.parse().ok()?;
    let sample = RecordedSample {
        position: next()?.parse().ok()?,
        pressure_1: next()?.parse().ok()?,
        pressure_2: next()?.parse().ok()?,
        command: next()?.parse().ok()?,
        error: next()?.parse().ok()?,
        spool: next()?.parse().ok()?,
    };
    fields.next().is_none().then_some((index, sample))
}
