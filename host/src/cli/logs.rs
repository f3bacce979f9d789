//! Arguments of the commands that exchange transients with other programs.

use std::path::PathBuf;

use clap::Args;
use pneudrive_logs::export::FORMATS;

use super::RigChoice;

/// Arguments of `export`.
#[derive(Debug, Args)]
#[command(after_help = "\
Names and units are those of trace.csv: position_m, pressure_1_pa, spool_mm, command_counts. time_s counts from the start
of the test. What is unknown is empty (csv), NaN (mat, mcap) or null (parquet).

  mcap      PlotJuggler, Foxglove: one message a sample on /drive
  ros2      ros2 bag play: MCAP with a topic for each signal, of std_msgs/Float64
  mat       MATLAB, Octave, SciPy (loadmat): one variable a signal
  parquet   pandas, Polars, DuckDB; in a program built with --features parquet
  csv       everything else")]
pub struct Export {
    /// A TARGET file, a streamed run, or a run folder
    pub file: PathBuf,
    /// The kind of file: a table as text, MATLAB 5, MCAP with protobuf messages, MCAP with messages of ROS 2, Parquet
    /// [default: by the name of --out]
    #[arg(long, value_name = "FORMAT", value_parser = FORMATS.map(|(_, word, _)| word))]
    pub to: Option<String>,
    /// The file to write [default: FILE with the ending of the format, in the current folder]
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Replace the file if there is one
    #[arg(long)]
    pub overwrite: bool,
}

/// Arguments of `import`.
#[derive(Debug, Args)]
#[command(after_help = "\
The map says which column is what:

  [time]
  column = \"t\"              # or period = \"1 ms\"; an MCAP file has a time of its own
  unit = \"ms\"

  [position]                # also [setpoint] and [spool]
  column = \"x\"
  unit = \"mm\"
  sign = -1                 # if it is positive toward retraction
  offset = \"125 mm\"

  [pressure_1]              # of the blind side; also [pressure_2]
  column = \"p1\"
  unit = \"bar(g)\"

  [command]
  column = \"u\"
  null = 5.0                # the column at null, and where the valve is fully open toward extension;
  full = 10.0               # or unit = \"counts\" or \"%\"

Position and command are needed. The fields of an MCAP file are columns such as \"/drive.position_m\".")]
pub struct Import {
    /// A CSV or MCAP file
    pub log: PathBuf,
    /// The rig that was logged: its sensors and parameters
    #[command(flatten)]
    pub rig: RigChoice,
    /// The meaning of the columns: a TOML file
    #[arg(long, value_name = "MAP.toml")]
    pub columns: PathBuf,
    /// Time between samples, such as "1 ms" [default: that of the log if it is even, else the rig's]
    #[arg(long, value_name = "TIME", value_parser = period)]
    pub period: Option<f64>,
    /// Folder for the next free TARGETxx.DAT
    #[arg(long, value_name = "DIR", default_value = ".")]
    pub out: PathBuf,
}

fn period(text: &str) -> Result<f64, String> {
    let reading = pneudrive_sim::rigfile::read_quantity(text, "s")?;
    if reading.value > 0.0 { Ok(reading.value) } else { Err("must be more than 0".to_owned()) }
}
