//! `pneudrive monitor`.

use std::fs::OpenOptions;
use std::io::{BufWriter, IsTerminal, Write, stdout};
use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Context, Result};
use pneudrive_protocol::{Mode, Status};
use pneudrive_records::units::Units;
use pneudrive_records::words;
use serde_json::{Value, json};

use crate::cli::Monitor;
use crate::json;
use crate::output::{self, Stream};

/// Header of the file.
const COLUMNS: &str = "time_s,mode,index,setpoint_counts,position_counts,error_counts,command_counts,pressure_1_raw,pressure_2_raw,spool_raw,recorded,damaged_frames\n";

pub(super) fn execute(arguments: &Monitor) -> Result<()> {
    let mut client = arguments.port.connect()?;
    let parameters = client.parameters()?;
    let units = if arguments.counts { Units::raw(&parameters) } else { Units::of(&parameters) };
    let mut csv = arguments.csv.as_deref().map(new_csv).transpose()?;
    let begun = Instant::now();
    for count in 0.. {
        if arguments.count.is_some_and(|wanted| count >= wanted) {
            break;
        }
        let due = Duration::from_secs_f64(arguments.every_s * f64::from(count));
        std::thread::sleep(due.saturating_sub(begun.elapsed()));
        let status = client.status()?;
        if let Some(csv) = &mut csv {
            csv.write_all(row(begun.elapsed(), &units, &status).as_bytes())
                .and_then(|()| csv.flush())
                .context("cannot write the file")?;
        }
        json::figures(|| figures(&units, &status, begun.elapsed()));
        json::line();
        show(&units, &status, client.losses());
        if output::is_broken() {
            break; // Nobody reads the output any more.
        }
    }
    if stdout().is_terminal() {
        say!("");
    }
    Ok(())
}

/// Characters of a narrow terminal, less the one that would wrap.
const WIDTH: usize = 79;

/// On a terminal that can, overwrites one line; elsewhere, writes a line per status.
fn show(units: &Units, status: &Status, losses: (u32, u32)) {
    if stdout().is_terminal() && !json::is_wanted() && output::takes_escapes() {
        let line: String = short_line(units, status, losses).chars().take(WIDTH).collect();
        Stream::Output.note(Stream::Output.write(format!("\r{line}\x1b[K").as_bytes()));
    } else {
        say!("{}", line(units, status, losses));
    }
}

/// A status for one line of a terminal: without units where all are the same.
fn short_line(units: &Units, s: &Status, (damaged, repeats): (u32, u32)) -> String {
    let lost = s.damaged_frames.saturating_add(damaged).saturating_add(repeats);
    let link = if lost == 0 { units.time(s.index) } else { format!("link: {lost} lost") };
    let pressures = [s.pressure_1, s.pressure_2].map(|raw| units.pressure(raw));
    let pressures = pressures.map(|text| text.trim_end_matches(" kPa").to_owned());
    format!(
        "{:<9} {:>10}  off {:>9}  u {:>5}  P {:>6} {:>6} kPa  {link}",
        mode(s),
        units.length(s.position),
        units.length(s.error),
        s.command,
        pressures[0],
        pressures[1],
    )
}

fn new_csv(path: &Path) -> Result<BufWriter<std::fs::File>> {
    let file = OpenOptions::new().write(true).create_new(true).open(path);
    let mut csv = BufWriter::new(file.with_context(|| format!("cannot make {}", path.display()))?);
    csv.write_all(COLUMNS.as_bytes()).with_context(|| format!("cannot write {}", path.display()))?;
    Ok(csv)
}

fn row(time: Duration, units: &Units, s: &Status) -> String {
    let pressure = |raw| units.raw_pressure(raw).map_or(String::new(), |raw| raw.to_string());
    format!(
        "{:.3},{},{},{},{},{},{},{},{},{},{},{}\n",
        time.as_secs_f64(),
        mode(s),
        s.index,
        s.setpoint,
        s.position,
        s.error,
        s.command,
        pressure(s.pressure_1),
        pressure(s.pressure_2),
        s.spool,
        s.recorded,
        s.damaged_frames
    )
}

fn mode(status: &Status) -> String {
    match status.mode {
        Mode::Disarmed => "disarmed".to_owned(),
        Mode::Armed => "armed".to_owned(),
        Mode::Homing => "homing".to_owned(),
        Mode::Running => "running".to_owned(),
        Mode::Done => "done".to_owned(),
        Mode::Fault => words::fault_code_name(status.fault),
    }
}

/// A status in integers, and in units if the rig states its scales.
fn figures(units: &Units, s: &Status, time: Duration) -> Value {
    let mut figures = status_figures(units, s);
    figures["time_s"] = json!(time.as_secs_f64());
    figures
}

/// The same without the time.
pub(super) fn status_figures(units: &Units, s: &Status) -> Value {
    json!({
        "mode": mode(s),
        "referenced": s.referenced,
        "index": s.index,
        "run_time_s": units.seconds(s.index),
        "setpoint_counts": s.setpoint,
        "position_counts": s.position,
        "position_mm": units.millimetres(s.position),
        "error_counts": s.error,
        "error_mm": units.millimetres(s.error),
        "command_counts": s.command,
        "pressure_1_raw": units.raw_pressure(s.pressure_1),
        "pressure_1_kpa": units.kilopascals(s.pressure_1),
        "pressure_2_raw": units.raw_pressure(s.pressure_2),
        "pressure_2_kpa": units.kilopascals(s.pressure_2),
        "spool_raw": s.spool,
        "spool_mm": units.spool_millimetres(s.spool),
        "recorded": s.recorded,
        "damaged_frames": s.damaged_frames,
    })
}

/// A status for the terminal, with the losses of the link.
fn line(units: &Units, s: &Status, (damaged, repeats): (u32, u32)) -> String {
    let lost = match (s.damaged_frames.saturating_add(damaged), repeats) {
        (0, 0) => String::new(),
        (damaged, repeats) => format!("  link: {damaged} damaged, {repeats} asked again"),
    };
    format!(
        "{:<9} {:>12}  error {:>11}  command {:>11}  P1 {:>10}  P2 {:>10}  at {}{lost}",
        mode(s),
        units.length(s.position),
        units.length(s.error),
        units.command(s.command.into()),
        units.pressure(s.pressure_1),
        units.pressure(s.pressure_2),
        units.time(s.index)
    )
}

#[cfg(test)]
mod tests {
    use pneudrive_controller::Parameters;
    use pneudrive_records::rig_info::RigParameters;

    use super::*;

    #[test]
    fn a_status_fits_into_eighty_columns() {
        let units = Units::of(&RigParameters { values: Parameters::default(), lacking: Vec::new() });
        let status = Status {
            position: 24_896,
            error: -20_000,
            command: -2048,
            pressure_1: 4095,
            pressure_2: 4095,
            index: 999_999,
            ..Status::default()
        };
        let line = short_line(&units, &status, (0, 0));
        assert!(line.chars().count() <= WIDTH && line.ends_with(" s"), "{} {line}", line.len());
        assert!(short_line(&units, &status, (3, 4)).ends_with("link: 7 lost"));
    }
}
