//! `pneudrive monitor`.

use std::fs::OpenOptions;
use std::io::{BufWriter, IsTerminal, Write, stdout};
use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Context, Result};
use pneudrive_controller::parameters::id;
use pneudrive_protocol::{Mode, Status};

use crate::cli::Monitor;
use crate::client::{Client, RigParameters};
use crate::output::{self, Stream};
use crate::words;

/// Header of the file.
const COLUMNS: &str = "time_s,mode,index,setpoint_counts,position_counts,error_counts,command_counts,pressure_1_raw,pressure_2_raw,spool_raw,recorded,damaged_frames\n";

pub(super) fn execute(arguments: &Monitor) -> Result<()> {
    let mut client = Client::connect(&arguments.port.port)?;
    let units = Units::of(&client.parameters()?);
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
            csv.write_all(row(begun.elapsed(), &status).as_bytes())
                .and_then(|()| csv.flush())
                .context("cannot write the file")?;
        }
        show(&units.line(&status, client.losses()));
        if output::is_broken() {
            break; // Whoever looked on has gone.
        }
    }
    if stdout().is_terminal() {
        say!("");
    }
    Ok(())
}

/// One line that is written anew on a terminal, a line each elsewhere.
fn show(line: &str) {
    if stdout().is_terminal() {
        Stream::Output.note(Stream::Output.write(format!("\r{line}\x1b[K").as_bytes()));
    } else {
        say!("{line}");
    }
}

fn new_csv(path: &Path) -> Result<BufWriter<std::fs::File>> {
    let file = OpenOptions::new().write(true).create_new(true).open(path);
    let mut csv = BufWriter::new(file.with_context(|| format!("cannot make {}", path.display()))?);
    csv.write_all(COLUMNS.as_bytes()).with_context(|| format!("cannot write {}", path.display()))?;
    Ok(csv)
}

fn row(time: Duration, s: &Status) -> String {
    format!(
        "{:.3},{},{},{},{},{},{},{},{},{},{},{}\n",
        time.as_secs_f64(),
        mode(s),
        s.index,
        s.setpoint,
        s.position,
        s.error,
        s.command,
        s.pressure_1,
        s.pressure_2,
        s.spool,
        s.recorded,
        s.damaged_frames
    )
}

fn mode(status: &Status) -> String {
    match status.mode {
        Mode::Disarmed => "disarmed".to_owned(),
        Mode::Armed => "armed".to_owned(),
        Mode::Running => "running".to_owned(),
        Mode::Done => "done".to_owned(),
        Mode::Fault => words::fault_code_name(status.fault),
    }
}

/// What the raw numbers of a rig mean.
struct Units {
    mm_per_count: f64,
    kpa_per_raw: f64,
    kpa_at_0: f64,
}

impl Units {
    fn of(parameters: &RigParameters) -> Units {
        let get = |id: u16| f64::from(parameters.values.get(id).unwrap_or(0));
        let full_scale = get(id::SENSOR_BITS).exp2() - 1.0;
        Units {
            mm_per_count: get(id::ENCODER_PM_PER_COUNT) / 1e9,
            kpa_per_raw: (get(id::PRESSURE_MAX_PA) - get(id::PRESSURE_MIN_PA)) / full_scale / 1e3,
            kpa_at_0: get(id::PRESSURE_MIN_PA) / 1e3,
        }
    }

    fn line(&self, s: &Status, (damaged, repeats): (u32, u32)) -> String {
        let mm = |counts: i32| f64::from(counts) * self.mm_per_count;
        let kpa = |raw: i16| f64::from(raw) * self.kpa_per_raw + self.kpa_at_0;
        let lost = match (s.damaged_frames + damaged, repeats) {
            (0, 0) => String::new(),
            (damaged, repeats) => format!("  link: {damaged} damaged, {repeats} asked again"),
        };
        format!(
            "{:<9} {:>9.3} mm  error {:>8.3} mm  command {:>5}  P1 {:>6.1} P2 {:>6.1} kPa  sample {}{lost}",
            mode(s),
            mm(s.position),
            mm(s.error),
            s.command,
            kpa(s.pressure_1),
            kpa(s.pressure_2),
            s.index
        )
    }
}
