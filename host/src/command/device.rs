//! `pneudrive device`.

mod bring_up;
mod by_hand;
mod config;
mod io;
mod learned;
mod records;
mod units;
mod valve;

use anyhow::{Context, Result};
use pneudrive_controller::parameters::{id, line};
use pneudrive_link::client::{Client, Commander};
use pneudrive_protocol::{
    ConfigState, Event, HISTOGRAM_BINS, Mode, Motion, Presence, Spread, Status, UNTIL_STOPPED,
};
use pneudrive_records::units::Units;
use pneudrive_records::words;
use pneudrive_session::drive::{self, Homed};
use serde_json::{Value, json};

pub(super) use bring_up::asked;

use super::interrupts::Interrupts;
use super::monitor::status_figures;
use crate::cli::{Device, DeviceAction, Position};
use crate::exit::Exit;
use crate::json;

pub(super) fn execute(arguments: &Device) -> Result<()> {
    let mut client = arguments.port.connect()?;
    match &arguments.action {
        DeviceAction::Info => info(&mut client),
        DeviceAction::Status => status(&mut client, arguments.counts),
        DeviceAction::Arm => {
            drive::arm(&mut client)?;
            say!("armed: the drive is enabled, the valve at null");
            Ok(())
        }
        DeviceAction::Disarm => {
            client.disarm()?;
            match client.status()?.mode {
                Mode::Fault => say!("the drive is disabled; the fault stays until `device arm`"),
                _ => say!("disarmed: the drive is disabled"),
            }
            Ok(())
        }
        DeviceAction::Stop => {
            client.stop().map(|()| say!("stopped: the drive is disabled until `device arm`"))
        }
        DeviceAction::Reference { position } => reference(&mut client, *position, arguments.counts),
        DeviceAction::Home => home(&mut client, arguments.counts),
        DeviceAction::Go { to_mm, rig } => by_hand::go(&mut client, rig, *to_mm),
        DeviceAction::Jog { by_mm, rig } => by_hand::jog(&mut client, rig, *by_mm),
        DeviceAction::Valve(action) => valve::execute(&mut client, *action),
        DeviceAction::Faults => faults(&mut client, arguments.counts),
        DeviceAction::Learned { rig, forget } => learned::execute(&mut client, rig.as_deref(), *forget),
        DeviceAction::Config(action) => config::execute(&mut client, action),
        DeviceAction::Io { settings } => io::execute(&mut client, settings),
        DeviceAction::Records(action) => records::execute(&mut client, action, arguments.counts),
        DeviceAction::BringUp(arguments) => bring_up::execute(&mut client, arguments),
    }
}

/// Sets the encoder's counter to the current position.
fn reference(client: &mut Client, position: Position, counts: bool) -> Result<()> {
    let units = Units::of(&client.parameters()?);
    let count = match position {
        Position::Counts(count) => count,
        Position::Millimetres(mm) => units.count_at(mm).with_context(|| {
            format!("{mm} mm is out of the range of its encoder, or the scale of the encoder is not known; give the position in counts")
        })?,
    };
    let zero = drive::reference(client, count)?;
    let zero_mm = zero.and_then(|zero| units.millimetres(zero));
    json::figures(|| {
        json!({
            "position_counts": count, "position_mm": units.millimetres(count),
            (line(id::ENCODER_ZERO_COUNTS).name): zero, "encoder_zero_mm": zero_mm,
        })
    });
    let position = if counts { format!("{count} counts") } else { units.length(count) };
    say!("referenced: the axis is at {position}");
    if let Some(zero) = zero {
        let in_file =
            zero_mm.map_or(String::new(), |mm| format!("; in the rig file it is encoder.zero_mm = {mm:.3}"));
        say!(
            "the encoder is absolute: encoder_zero_counts is now {zero}, which `device config save` keeps over a reset{in_file}"
        );
    }
    Ok(())
}

fn info(client: &mut Client) -> Result<()> {
    let info = client.info()?;
    json::figures(|| {
        json!({
            "firmware": info.firmware, "build": info.build, "board": info.board, "protocol": info.version,
            "record_capacity": info.record_capacity,
        })
    });
    say!("firmware    {}", info.firmware);
    say!("build       {}", info.build);
    say!("board       {}", info.board);
    say!("protocol    version {}", info.version);
    say!("record      up to {} samples", info.record_capacity);
    let state = client.config_state()?;
    say!("parameters  {:08x}, {}", state.hash, provenance(&state));
    let [interval, latency] = client.timing()?;
    json::figures(|| {
        let spread = |times: &Spread| {
            let Spread { count, least_us, most_us, bins } = times;
            json!({ "count": count, "least_us": least_us, "most_us": most_us, "bins": bins })
        };
        json!({
            "parameters_hash": format!("{:08x}", state.hash), "parameters_stored": state.saves,
            "parameters_saved": state.saved, "sample_interval": spread(&interval), "output_delay": spread(&latency),
        })
    });
    say!("samples     every {}", spread(&interval));
    say!("outputs     after {}", spread(&latency));
    Ok(())
}

/// A spread in words: minimum, maximum, and how many are off by how much.
fn spread(times: &Spread) -> String {
    if times.count == 0 {
        return "nothing measured yet".to_owned();
    }
    let off = |bin: usize| match bin {
        0 => "exact".to_owned(),
        1 => "1 us off".to_owned(),
        last if last == HISTOGRAM_BINS - 1 => format!("{} us off or more", 1 << (last - 1)),
        bin => format!("{} to {} us off", 1 << (bin - 1), (1 << bin) - 1),
    };
    let bins = times.bins.iter().enumerate().filter(|(_, count)| **count > 0);
    let bins: Vec<String> = bins.map(|(bin, count)| format!("{count} {}", off(bin))).collect();
    format!("{} to {} us: {}", times.least_us, times.most_us, bins.join(", "))
}

/// Where the parameters come from, in words.
fn provenance(state: &ConfigState) -> String {
    let source = match state.source {
        0 => "never stored".to_owned(),
        1 => format!("stored {} times", state.saves),
        2 => format!("stored by another version of the firmware, {} values ignored", state.ignored),
        _ => "the stored parameters are damaged; import a configuration and save it".to_owned(),
    };
    let changed = matches!(state.source, 1 | 2) && !state.saved;
    if changed { format!("{source}, changed since") } else { source }
}

/// Homes the axis and waits for the end. Ctrl-C stops it.
fn home(client: &mut Client, counts: bool) -> Result<()> {
    let interrupts = Interrupts::watch();
    let mut goes_on =
        || match interrupts.look() {
            false => Ok(()),
            true => Err(Exit::Interrupted
                .error("homing was stopped by Ctrl-C; `pneudrive device arm` clears the fault")),
        };
    match drive::home(client, &mut goes_on) {
        Ok(Homed::Moved) => tell_home(client, counts, ["homed", ", armed"]),
        Ok(Homed::Absolute) => {
            tell_home(client, counts, ["no homing is needed, as the encoder is absolute", ""])
        }
        Err(error) => interrupts.explain(Err(error)),
    }
}

/// Where the axis is whose counts mean positions.
fn tell_home(client: &mut Client, counts: bool, [how, mode]: [&str; 2]) -> Result<()> {
    let (units, position) = (units::of(client, counts), client.status()?.position);
    let position_mm = units.millimetres(position);
    json::figures(|| json!({ "position_counts": position, "position_mm": position_mm }));
    say!("{how}: the axis is at {}{mode}", units.length(position));
    Ok(())
}

fn faults(client: &mut Client, counts: bool) -> Result<()> {
    let events = client.events()?;
    json::figures(|| json!({ "faults": events.iter().map(event_figures).collect::<Vec<_>>() }));
    if events.is_empty() {
        say!("no faults");
        return Ok(());
    }
    let units = units::of(client, counts);
    for event in events {
        say!(
            "reset {:>4}  {:>12.3} s  {:<22} {:>12} into the run  at {:>12}  {}",
            event.boot,
            event.time_us as f64 / 1e6,
            words::fault_code_name(event.code),
            units.time(event.index),
            units.length(event.position),
            words::fault_meaning(event.code)
        );
    }
    Ok(())
}

fn event_figures(event: &Event) -> Value {
    json!({
        "reset": event.boot, "time_s": event.time_us as f64 / 1e6, "name": words::fault_code_name(event.code),
        "meaning": words::fault_meaning(event.code), "index": event.index, "position_counts": event.position,
    })
}

/// The progress of the moves, in words.
fn moves(motion: &Motion) -> String {
    let arrival = match motion.arrival {
        0 => return "none has begun".to_owned(),
        1 => "on its way",
        2 => "arrived",
        4 => "rests outside its tolerance",
        _ => "not reached",
    };
    let learned = match motion.learned_null_offset {
        0 => String::new(),
        counts => format!("; null offset learned: {counts} counts"),
    };
    format!("number {} {arrival}, {} not reached{learned}", motion.begun, motion.not_reached)
}

/// The owner of the drive, in words.
fn words_of(owner: &Commander) -> String {
    let (host, silent_s) = (&owner.host, f64::from(owner.silent_ms) / 1e3);
    match owner.presence {
        Presence::Nobody => "nobody".to_owned(),
        Presence::There => format!("{host}, last heard {silent_s:.2} s ago"),
        Presence::Gone => format!("{host}, which has gone; last heard {silent_s:.2} s ago"),
    }
}

fn status(client: &mut Client, counts: bool) -> Result<()> {
    let status = client.status()?;
    let Status { fault, index, duration_samples, .. } = status;
    let parameters = client.scalars();
    let units = units::by(&parameters, counts);
    let motion = client.motion()?;
    json::figures(|| status_figures(&units, &status));
    json::figures(|| {
        let moves = json!({
            "homing": status.mode == Mode::Homing, "begun": motion.begun, "not_reached": motion.not_reached,
            "learned_null_offset_counts": motion.learned_null_offset,
        });
        json!({ "duration_samples": (duration_samples != UNTIL_STOPPED).then_some(duration_samples), "moves": moves })
    });
    let mode = match status.mode {
        Mode::Disarmed => "disarmed".to_owned(),
        Mode::Armed => "armed".to_owned(),
        Mode::Homing => "homing".to_owned(),
        Mode::Running if duration_samples == UNTIL_STOPPED => {
            format!("running until stopped, {} so far", units.time(index))
        }
        Mode::Running => format!("running, {} of {}", units.time(index), units.time(duration_samples)),
        Mode::Done => "done, holding".to_owned(),
        Mode::Fault => format!("fault {}: {}", words::fault_code_name(fault), words::fault_meaning(fault)),
    };
    say!("mode        {mode}");
    say!("referenced  {}", if status.referenced { "yes" } else { "no" });
    say!("moves       {}", moves(&motion));
    let changed = parameters.as_ref().ok().and_then(learned::changed);
    json::figures(|| json!({ "learned_changed": changed.map(|(word, _)| word) }));
    if let Some((_, advice)) = changed {
        say!("learned     {advice}");
    }
    let owner = client.owner()?;
    json::figures(|| json!({ "owner": (owner.presence == Presence::There).then_some(&owner.host) }));
    say!("owner       {}", words_of(&owner));
    // A disarmed drive has no setpoint: its controller does not run.
    let controlled = status.mode != Mode::Disarmed;
    if controlled {
        say!("setpoint    {}", units.setpoint(status.setpoint));
    }
    say!("position    {}", units.length(status.position));
    if controlled {
        say!("error       {}", units.length(status.error));
    }
    say!("command     {}", units.command(status.command.into()));
    match units.raw_pressure(status.pressure_1) {
        Some(_) => {
            say!(
                "pressures   {} and {}",
                units.pressure(status.pressure_1),
                units.pressure(status.pressure_2)
            );
        }
        None => say!("pressures   not measured"),
    }
    say!("spool       {}", units.spool(status.spool));
    say!("recorded    {} samples", status.recorded);
    say!("damaged     {} frames", status.damaged_frames);
    Ok(())
}
