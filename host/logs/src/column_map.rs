//! Which column of a log is what, as a TOML file:
//!
//! ```toml
//! [time]
//! column = "t"          # or, where the log has no time: period = "1 ms"; an MCAP file has a time of its own
//! unit = "ms"
//!
//! [position]            # also [setpoint] and [spool]
//! column = "x"
//! unit = "mm"
//! sign = -1             # 1 if it is left out
//! offset = "125 mm"     # added behind the sign
//!
//! [pressure_1]          # of the blind side; also [pressure_2]
//! column = "p1"
//! unit = "bar(g)"
//!
//! [command]             # positive toward extension
//! column = "u"
//! null = 5.0            # in the column's unit: the valve at null, and fully open toward extension
//! full = 10.0           # or, in the place of both, unit = "counts" or "%"
//! ```
//!
//! A channel in SI units is `scale * value + offset`.

use anyhow::{Result, anyhow, bail};
use pneudrive_sim::rig::read_quantity;
use toml_edit::{DocumentMut, Item, Table};

/// The command of a fully open valve, counts.
const FULL: f64 = 2048.0;

/// What is read of a log, in the order of [`CHANNELS`].
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnMap {
    /// When the samples were taken.
    pub time: Time,
    /// One column each; None of what the log does not have.
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

/// A column, and what turns its values into the channel's unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// The name of the series.
    pub series: String,
    /// Unit of the channel per unit of the column, with the sign.
    pub scale: f64,
    /// In the unit of the channel.
    pub offset: f64,
}

/// When the samples were taken.
#[derive(Clone, Debug, PartialEq)]
pub enum Time {
    /// A column, and s per unit of it.
    Column(String, f64),
    /// At this distance, s.
    Period(f64),
    /// As the file says.
    OfFile,
}

impl ColumnMap {
    /// Reads a map. Gauge pressures count from `ambient_pa`.
    ///
    /// # Errors
    /// With the table and what is wrong in it.
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
        let time = match table(&document, "time")? {
            Some(table) => time(table).map_err(|problem| anyhow!("[time]: {problem:#}"))?,
            None => Time::OfFile,
        };
        Ok(ColumnMap { time, channels })
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

fn time(table: &Table) -> Result<Time> {
    only(table, &["column", "unit", "period"])?;
    match (text(table, "column")?, text(table, "period")?) {
        (Some(column), None) => {
            let unit = text(table, "unit")?.ok_or_else(|| anyhow!("needs a unit, such as \"ms\""))?;
            Ok(Time::Column(column.to_owned(), worth(unit, "s")?.0))
        }
        (None, Some(period)) => match quantity(period, "s", "period")? {
            period if period > 0.0 => Ok(Time::Period(period)),
            _ => bail!("period must be more than 0"),
        },
        _ => bail!("needs either a column with its unit, or a period"),
    }
}

fn column(channel: &Channel, table: &Table, ambient_pa: f64) -> Result<Column> {
    let is_command = channel.unit == "counts";
    let known: &[&str] =
        if is_command { &["column", "unit", "null", "full"] } else { &["column", "unit", "sign", "offset"] };
    only(table, known)?;
    let series = text(table, "column")?.ok_or_else(|| anyhow!("needs a column"))?.to_owned();
    let (scale, offset) = if is_command { command(table)? } else { physical(channel, table, ambient_pa)? };
    Ok(Column { series, scale, offset })
}

fn physical(channel: &Channel, table: &Table, ambient_pa: f64) -> Result<(f64, f64)> {
    let unit =
        text(table, "unit")?.ok_or_else(|| anyhow!("needs a unit, such as {:?}", example(channel.unit)))?;
    let (scale, is_gauge) = worth(unit, channel.unit)?;
    let sign = match number(table, "sign")? {
        None => 1.0,
        Some(sign) if sign.abs() == 1.0 => sign,
        Some(sign) => bail!("sign must be 1 or -1, is {sign}"),
    };
    let offset = text(table, "offset")?.map_or(Ok(0.0), |offset| quantity(offset, channel.unit, "offset"))?;
    Ok((sign * scale, offset + if is_gauge { ambient_pa } else { 0.0 }))
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

/// What one of a unit is in another, and whether it counts from the surroundings.
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
