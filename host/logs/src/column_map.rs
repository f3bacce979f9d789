//! The assignment of columns of a log, as a TOML file:
//!
//! ```toml
//! [time]
//! column = "t"          # or, where the log has no time: period = "1 ms"; an MCAP file has a time of its own
//! unit = "ms"           # times with a date need none
//! gap = "5 ms"          # more between two samples is a gap; three mean steps if it is left out
//!
//! [position]            # also [setpoint] and [spool]
//! column = "x"          # or its number, from 1: column = 2
//! unit = "mm"
//! decimal = ","         # where its cells leave open what is decimal: "," or "."; also in [time]
//! sign = -1             # 1 if it is left out
//! offset = "125 mm"     # added behind the sign
//!
//! [pressure_1]          # of the blind side; also [pressure_2]
//! column = "p1"
//! unit = "bar(g)"
//!
//! [pressure_2]
//! column = "U2"
//! points = [[0.5, "0 bar(g)"], [4.5, "10 bar(g)"]]  # of a sensor in volts; in the place of unit, sign and offset
//!
//! [command]             # positive toward extension
//! column = "u"
//! null = 5.0            # in the column's unit: the valve at null, and fully open toward extension
//! full = 10.0           # or, in the place of both, unit = "counts" or "%"
//! ```
//!
//! A channel in SI units is `scale * value + offset`.

use anyhow::{Result, anyhow, bail};
use pneudrive_sim::rigfile::read_quantity;
use pneudrive_tables::{Column as Place, Sign};
use toml_edit::{DocumentMut, Item, Table, Value};

/// The command of a fully open valve, counts.
const FULL: f64 = 2048.0;

/// The quantities that are read from a log, in the order of [`CHANNELS`].
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnMap {
    /// When the samples were taken.
    pub time: Time,
    /// More than this between two samples is a gap, s; None of three mean steps.
    pub gap_s: Option<f64>,
    /// One column each; None for a quantity that the log does not have.
    pub channels: [Option<Column>; CHANNELS.len()],
}

/// A channel that a log may have.
#[derive(Clone, Copy, Debug)]
pub struct Channel {
    /// Its table in the file.
    pub name: &'static str,
    /// Its unit in the record.
    pub unit: &'static str,
    /// Whether the value holds from sample to sample, in the place of a straight line between them.
    pub holds: bool,
}

/// All channels. Position and command are needed.
pub const CHANNELS: [Channel; 6] = [
    Channel { name: "position", unit: "m", holds: false },
    Channel { name: "pressure_1", unit: "Pa", holds: false },
    Channel { name: "pressure_2", unit: "Pa", holds: false },
    Channel { name: "spool", unit: "mm", holds: false },
    Channel { name: "command", unit: "counts", holds: true },
    Channel { name: "setpoint", unit: "m", holds: true },
];

/// Places in [`CHANNELS`].
pub const POSITION: usize = 0;
/// The pressures.
pub const PRESSURES: [usize; 2] = [1, 2];
/// The spool.
pub const SPOOL: usize = 3;
/// The command.
pub const COMMAND: usize = 4;
/// The setpoint.
pub const SETPOINT: usize = 5;

/// A column, and the conversion of its values to the channel's unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Which it is.
    pub of: Source,
    /// Unit of the channel per unit of the column, with the sign.
    pub scale: f64,
    /// In the unit of the channel.
    pub offset: f64,
}

/// Where numbers are in a log.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// The column of a table, or the field of a message.
    pub column: Place,
    /// Its decimal sign, where its cells leave it open.
    pub decimal: Option<Sign>,
}

impl From<&str> for Source {
    fn from(name: &str) -> Source {
        Source { column: Place::from(name), decimal: None }
    }
}

/// When the samples were taken.
#[derive(Clone, Debug, PartialEq)]
pub enum Time {
    /// A column, and s per unit of it; None of times with a date.
    Column(Source, Option<f64>),
    /// At this distance, s.
    Period(f64),
    /// As the file says.
    OfFile,
}

impl ColumnMap {
    /// Reads a map. Gauge pressures count from `ambient_pa`.
    ///
    /// # Errors
    /// The table and its problem.
    pub fn from_text(text: &str, ambient_pa: f64) -> Result<ColumnMap> {
        let document: DocumentMut = text.parse()?;
        for (name, _) in document.iter() {
            if name != "time" && CHANNELS.iter().all(|channel| channel.name != name) {
                let names: Vec<&str> = CHANNELS.iter().map(|channel| channel.name).collect();
                bail!("[{name}] is not known; there are time, {}", names.join(", "));
            }
        }
        let mut channels: [Option<Column>; CHANNELS.len()] = Default::default();
        for (channel, column) in CHANNELS.iter().zip(&mut channels) {
            *column = table(&document, channel.name)?
                .map(|table| self::column(channel, table, ambient_pa))
                .transpose()
                .map_err(|problem| anyhow!("[{}]: {problem:#}", channel.name))?;
        }
        for needed in [POSITION, COMMAND] {
            if channels[needed].is_none() {
                bail!("needs a table [{}]: without it there is nothing to compare", CHANNELS[needed].name);
            }
        }
        let (time, gap_s) = match table(&document, "time")? {
            Some(table) => time(table).map_err(|problem| anyhow!("[time]: {problem:#}"))?,
            None => (Time::OfFile, None),
        };
        Ok(ColumnMap { time, gap_s, channels })
    }
}

fn table<'a>(document: &'a DocumentMut, name: &str) -> Result<Option<&'a Table>> {
    match document.get(name) {
        None => Ok(None),
        Some(Item::Table(table)) => Ok(Some(table)),
        Some(_) => bail!("{name} must be a table: write [{name}], and its column under it"),
    }
}

fn only(table: &Table, known: &[&str]) -> Result<()> {
    match table.iter().find(|(key, _)| !known.contains(key)) {
        Some((key, _)) => bail!("{key} is not known; there are {}", known.join(", ")),
        None => Ok(()),
    }
}

fn text<'a>(table: &'a Table, key: &str) -> Result<Option<&'a str>> {
    match table.get(key) {
        None => Ok(None),
        Some(item) => item.as_str().map(Some).ok_or_else(|| anyhow!("{key} must be a text in quotes")),
    }
}

fn number(table: &Table, key: &str) -> Result<Option<f64>> {
    match table.get(key) {
        None => Ok(None),
        Some(item) => {
            let number = item.as_float().or_else(|| item.as_integer().map(|number| number as f64));
            number
                .filter(|number| number.is_finite())
                .map(Some)
                .ok_or_else(|| anyhow!("{key} must be a number"))
        }
    }
}

fn time(table: &Table) -> Result<(Time, Option<f64>)> {
    only(table, &["column", "unit", "period", "decimal", "gap"])?;
    let gap_s = text(table, "gap")?.map(|gap| duration(gap, "gap")).transpose()?;
    let time = match (source(table)?, text(table, "period")?) {
        (Some(source), None) => {
            let seconds = |unit| worth(unit, "s").map(|(seconds, _)| seconds);
            Time::Column(source, text(table, "unit")?.map(seconds).transpose()?)
        }
        (None, Some(period)) => Time::Period(duration(period, "period")?),
        (None, None) if gap_s.is_some() => Time::OfFile,
        _ => bail!("needs either a column with its unit, or a period"),
    };
    Ok((time, gap_s))
}

fn duration(text: &str, key: &str) -> Result<f64> {
    match quantity(text, "s", key)? {
        duration if duration > 0.0 => Ok(duration),
        _ => bail!("{key} must be more than 0"),
    }
}

/// The column that a table names; None if it names none.
fn source(table: &Table) -> Result<Option<Source>> {
    let decimal = match text(table, "decimal")? {
        None => None,
        Some(sign) => {
            Some(Sign::named(sign).ok_or_else(|| anyhow!("decimal must be \".\" or \",\", is {sign:?}"))?)
        }
    };
    let column = match table.get("column") {
        None => return Ok(None),
        Some(item) => {
            match (item.as_str(), item.as_integer().and_then(|number| usize::try_from(number).ok())) {
                (Some(name), _) => Place::from(name),
                (None, Some(number)) => Place::Numbered(number),
                (None, None) => bail!("column must be a name in quotes, or a number from 1"),
            }
        }
    };
    Ok(Some(Source { column, decimal }))
}

fn column(channel: &Channel, table: &Table, ambient_pa: f64) -> Result<Column> {
    let is_command = channel.unit == "counts";
    let known: &[&str] = if is_command {
        &["column", "unit", "decimal", "null", "full"]
    } else {
        &["column", "unit", "decimal", "sign", "offset", "points"]
    };
    only(table, known)?;
    let of = source(table)?.ok_or_else(|| anyhow!("needs a column"))?;
    let (scale, offset) = if is_command { command(table)? } else { physical(channel, table, ambient_pa)? };
    Ok(Column { of, scale, offset })
}

fn physical(channel: &Channel, table: &Table, ambient_pa: f64) -> Result<(f64, f64)> {
    if let Some(points) = table.get("points") {
        return through(points, channel, table, ambient_pa);
    }
    let unit = text(table, "unit")?
        .ok_or_else(|| anyhow!("needs a unit, such as {:?}, or two points", example(channel.unit)))?;
    let (scale, is_gauge) = worth(unit, channel.unit)?;
    let sign = match number(table, "sign")? {
        None => 1.0,
        Some(sign) if sign.abs() == 1.0 => sign,
        Some(sign) => bail!("sign must be 1 or -1, is {sign}"),
    };
    let offset = text(table, "offset")?.map_or(Ok(0.0), |offset| quantity(offset, channel.unit, "offset"))?;
    Ok((sign * scale, offset + if is_gauge { ambient_pa } else { 0.0 }))
}

/// The straight line through two points: the column's value, and the quantity there.
fn through(points: &Item, channel: &Channel, table: &Table, ambient_pa: f64) -> Result<(f64, f64)> {
    if let Some(key) = ["unit", "sign", "offset"].into_iter().find(|key| table.contains_key(key)) {
        bail!("points say all: leave out {key}");
    }
    let point = |point: &Value| -> Result<(f64, f64)> {
        let pair = point.as_array().filter(|pair| pair.len() == 2);
        let number =
            |value: &Value| value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64));
        let value = pair.and_then(|pair| pair.get(0).and_then(number)).filter(|value| value.is_finite());
        let text = pair.and_then(|pair| pair.get(1)?.as_str());
        let (Some(value), Some(text)) = (value, text) else {
            bail!("a point is the column's value and the quantity there: [0.5, {:?}]", at_zero(channel.unit));
        };
        let read = read_quantity(text, channel.unit).map_err(|problem| anyhow!("points: {problem}"))?;
        Ok((value, read.value + if read.gauge { ambient_pa } else { 0.0 }))
    };
    let points: Vec<&Value> = points.as_array().map(|points| points.iter().collect()).unwrap_or_default();
    let [one, other] = points[..] else {
        bail!("points must be two: [[0.5, {:?}], [4.5, ...]]", at_zero(channel.unit))
    };
    let ((from, low), (to, high)) = (point(one)?, point(other)?);
    if from == to || low == high {
        bail!("the two points must differ, both the values and the quantities");
    }
    let scale = (high - low) / (to - from);
    Ok((scale, low - from * scale))
}

fn at_zero(unit: &str) -> String {
    format!("0 {}", example(unit))
}

fn example(unit: &str) -> &str {
    if unit == "Pa" { "bar(g)" } else { "mm" }
}

fn command(table: &Table) -> Result<(f64, f64)> {
    match (text(table, "unit")?, number(table, "null")?, number(table, "full")?) {
        (Some("counts"), None, None) => Ok((1.0, 0.0)),
        (Some("%"), None, None) => Ok((FULL / 100.0, 0.0)),
        (None, Some(null), Some(full)) if null != full => {
            let scale = FULL / (full - null);
            Ok((scale, -null * scale))
        }
        _ => bail!(
            "needs either unit = \"counts\" or \"%\", or null and full: the column's values at null and where the valve is fully open toward extension"
        ),
    }
}

/// The value of one unit in another, and whether it counts from the surroundings.
fn worth(unit: &str, target: &str) -> Result<(f64, bool)> {
    let one = read_quantity(&format!("1 {unit}"), target).map_err(|problem| anyhow!("unit: {problem}"))?;
    Ok((one.value, one.gauge))
}

/// A difference with its unit.
fn quantity(text: &str, target: &str, key: &str) -> Result<f64> {
    match read_quantity(text, target).map_err(|problem| anyhow!("{key}: {problem}"))? {
        reading if reading.gauge => bail!("{key}: a difference is neither gauge nor absolute; leave out (g)"),
        reading => Ok(reading.value),
    }
}

#[cfg(test)]
mod tests;
