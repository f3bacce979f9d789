//! Arguments of the commands that talk to a rig.

use std::num::NonZeroU16;
use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use pneudrive_controller::Fault;
use pneudrive_link::client::Client;
use pneudrive_link::port::address;
use pneudrive_records::words;

/// The name of a port in the form that `port::open` takes.
fn port(text: &str) -> Result<String, String> {
    match address(text) {
        Some(address) => match address.rsplit_once(':') {
            Some((_, number)) if number.parse::<NonZeroU16>().is_ok() => Ok(format!("tcp://{address}")),
            Some((_, number)) => Err(format!("{number:?} is not a port number, 1 to 65535")),
            None => Err("the port number is missing; write tcp://HOST:PORT".to_owned()),
        },
        None if text.is_empty() || text == "pty:" => {
            Err("the name is empty; write pty:PATH or a device".to_owned())
        }
        None => Ok(text.to_owned()),
    }
}

/// The port of a rig.
#[derive(Debug, Args)]
pub struct PortChoice {
    /// A device (/dev/ttyACM0, COM3), pty:PATH or tcp://HOST:PORT
    #[arg(long, short, value_name = "PORT", value_parser = port)]
    pub port: String,
    /// Arm the drive though its parameters switch these checks off: host-silent, no-motion, ...
    #[arg(long, value_name = "CHECKS", value_delimiter = ',', value_parser = check)]
    pub without: Vec<Fault>,
}

impl PortChoice {
    /// Finds the rig at the port.
    ///
    /// # Errors
    /// As for [`Client::connect`].
    pub fn connect(&self) -> anyhow::Result<Client> {
        let mut client = Client::connect(&self.port)?;
        client.accept_without(&self.without);
        Ok(client)
    }
}

/// The check with this name.
fn check(name: &str) -> Result<Fault, String> {
    let named = Fault::ALL.into_iter().find(|fault| words::fault_name(*fault) == name);
    named.ok_or_else(|| {
        format!("there is no check {name:?}; `pneudrive device arm` names those that are switched off")
    })
}

/// Arguments of `run`.
#[derive(Debug, Args)]
pub struct Run {
    /// The rig whose [test] to run: a built-in rig or a rig file
    #[arg(value_name = "TEST")]
    pub rig: String,
    /// The port.
    #[command(flatten)]
    pub port: PortChoice,
    /// Change a key of the test, such as test.duration_s=2; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub settings: Vec<String>,
    /// Move through the points of a CSV table with the columns time_s and position_mm, in straight lines; within
    /// test.velocity_mm_s and test.acceleration_mm_s2
    #[arg(long, value_name = "FILE")]
    pub points: Option<PathBuf>,
    /// Also download the controller's parameters of the rig
    #[arg(long)]
    pub config: bool,
    /// Run the test for this long instead, such as 90s, 20min, 8h or 3d
    #[arg(long = "for", value_name = "TIME", value_parser = lasting, conflicts_with = "until_stopped")]
    pub lasting: Option<Duration>,
    /// Run the test until Ctrl-C, which disarms the drive
    #[arg(long)]
    pub until_stopped: bool,
    /// Stream the run to this file while it lasts, however long that is
    #[arg(long, value_name = "FILE")]
    pub stream: Option<PathBuf>,
    /// Stream every Nth sample
    #[arg(long, value_name = "N", default_value_t = 1, requires = "stream", value_parser = clap::value_parser!(u16).range(1..))]
    pub every: u16,
}

/// A time such as 90s, 20min, 8h or 3d.
fn lasting(text: &str) -> Result<Duration, String> {
    let (number, unit) = text.split_at(text.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(text.len()));
    let seconds = match unit {
        "s" => 1.0,
        "min" => 60.0,
        "h" => 3600.0,
        "d" => 86_400.0,
        _ => return Err("write a number and s, min, h or d, such as 90s or 8h".to_owned()),
    };
    let number: f64 = number.trim().parse().map_err(|_| format!("{number:?} is not a number"))?;
    if number > 0.0 && number * seconds < 1e8 {
        Ok(Duration::from_secs_f64(number * seconds))
    } else {
        Err("must be above 0 and below 3 years".to_owned())
    }
}

/// Arguments of `record`.
#[derive(Debug, Args)]
pub struct Record {
    /// The port.
    #[command(flatten)]
    pub port: PortChoice,
    /// Folder for the file
    #[arg(long, value_name = "DIR", default_value = ".")]
    pub dir: PathBuf,
}

/// Arguments of `monitor`.
#[derive(Debug, Args)]
pub struct Monitor {
    /// The port.
    #[command(flatten)]
    pub port: PortChoice,
    /// Also write the values to this file
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Show figures as the rig sends them, in counts and samples, instead of mm, kPa and s
    #[arg(long)]
    pub counts: bool,
    /// Interval between values, s
    #[arg(long = "every", value_name = "S", default_value_t = 0.2, value_parser = interval)]
    pub every_s: f64,
    /// End after this many values
    #[arg(long, value_name = "N")]
    pub count: Option<u32>,
}

fn interval(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if (0.01..=3600.0).contains(&value) {
        Ok(value)
    } else {
        Err("must be between 0.01 and 3600 seconds".to_owned())
    }
}
