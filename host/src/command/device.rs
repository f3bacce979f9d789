//! `pneudrive device`.

use anyhow::{Result, anyhow, bail};
use pneudrive_controller::parameters::{Parameter, TABLE, by_name};
use pneudrive_protocol::{Mode, Status};

use super::load_rig;
use crate::cli::{ConfigAction, Device, DeviceAction};
use crate::client::Client;
use crate::target::parameter_text;
use crate::words;

pub(super) fn execute(arguments: &Device) -> Result<()> {
    let mut client = Client::connect(&arguments.port.port)?;
    match &arguments.action {
        DeviceAction::Info => info(&mut client),
        DeviceAction::Status => status(&mut client),
        DeviceAction::Arm => client.arm().map(|()| say!("armed: the drive is enabled, the valve at null")),
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
        DeviceAction::Reference { counts } => {
            client.reference(*counts).map(|()| say!("referenced: the axis stands at {counts} counts"))
        }
        DeviceAction::Config(action) => config(&mut client, action),
    }
}

fn info(client: &mut Client) -> Result<()> {
    let info = client.info()?;
    say!("firmware    {}", info.firmware);
    say!("build       {}", info.build);
    say!("board       {}", info.board);
    say!("protocol    version {}", info.version);
    say!("record      up to {} samples", info.record_capacity);
    Ok(())
}

fn status(client: &mut Client) -> Result<()> {
    let status = client.status()?;
    let Status { fault, index, duration_samples, .. } = status;
    let mode = match status.mode {
        Mode::Disarmed => "disarmed".to_owned(),
        Mode::Armed => "armed".to_owned(),
        Mode::Running => format!("running, sample {index} of {duration_samples}"),
        Mode::Done => "done, holding".to_owned(),
        Mode::Fault => format!("fault {}: {}", words::fault_code_name(fault), words::fault_meaning(fault)),
    };
    say!("mode        {mode}");
    say!("referenced  {}", if status.referenced { "yes" } else { "no" });
    say!("setpoint    {} counts", status.setpoint);
    say!("position    {} counts", status.position);
    say!("error       {} counts", status.error);
    say!("command     {} counts", status.command);
    say!("pressures   {} and {} raw", status.pressure_1, status.pressure_2);
    say!("spool       {} raw", status.spool);
    say!("recorded    {} samples", status.recorded);
    say!("damaged     {} frames", status.damaged_frames);
    Ok(())
}

fn config(client: &mut Client, action: &ConfigAction) -> Result<()> {
    match action {
        ConfigAction::Get { name: None } => {
            let parameters = client.parameters()?;
            for parameter in &TABLE {
                let value = parameter_text(&parameters, parameter.id, parameter.len);
                say!("{:<28} {value:>12} {:<14} {}", parameter.name, parameter.unit, parameter.meaning);
            }
            Ok(())
        }
        ConfigAction::Get { name: Some(name) } => {
            let parameters = client.parameters()?;
            if let Some(list) = by_name(name).filter(|parameter| parameter.len > 1) {
                say!("{name} = {}", parameter_text(&parameters, list.id, list.len));
                return Ok(());
            }
            let (parameter, entry) = parameter_of(name)?;
            let value = parameters.get(parameter.id + entry).unwrap_or(0);
            say!("{}", format!("{name} = {value} {}", parameter.unit).trim_end());
            Ok(())
        }
        ConfigAction::Set { name, value } => {
            let (parameter, entry) = parameter_of(name)?;
            client.set_parameters(parameter.id + entry, &[*value])?;
            say!("{}", format!("{name} = {value} {}", parameter.unit).trim_end());
            Ok(())
        }
        ConfigAction::Import { rig } => {
            let rig = load_rig(rig, &[])?;
            client.import_parameters(&rig.parameters())?;
            say!("took over the controller's parameters of {}", rig.name());
            Ok(())
        }
    }
}

/// A parameter and the entry meant, from `name` or `name[entry]`.
fn parameter_of(text: &str) -> Result<(&'static Parameter, u16)> {
    let (name, entry) = match text.strip_suffix(']').and_then(|text| text.split_once('[')) {
        Some((name, entry)) => (name, entry.parse::<u16>().ok()),
        None => (text, Some(0)),
    };
    let parameter = by_name(name)
        .ok_or_else(|| anyhow!("there is no parameter {name}; `pneudrive device config get` lists them"))?;
    if parameter.len > 1 && !text.ends_with(']') {
        bail!(
            "{name} is a list: name an entry, such as {name}[3], with the entries 0 to {}",
            parameter.len - 1
        );
    }
    match entry {
        Some(entry) if entry < parameter.len => Ok((parameter, entry)),
        _ => bail!("{name} has the entries 0 to {}", parameter.len - 1),
    }
}
