//! A transient in engineering units, wherever it comes from.

use std::path::Path;

use anyhow::{Context, Result};

use crate::run_folder::StoredRun;
use crate::target::TargetFile;

/// What is compared and drawn: name and unit of each channel.
pub const CHANNELS: [(&str, &str); 7] = [
    ("setpoint", "mm"),
    ("position", "mm"),
    ("pressure 1", "kPa"),
    ("pressure 2", "kPa"),
    ("spool", "mm"),
    ("command", "counts"),
    ("error", "counts"),
];

/// Channels over time.
#[derive(Clone, Debug)]
pub struct Transient {
    /// Where it comes from, for legends.
    pub name: String,
    /// s, from the start of the test.
    pub time: Vec<f64>,
    /// In the order of [`CHANNELS`].
    pub channels: [Vec<f64>; CHANNELS.len()],
}

impl Transient {
    /// A TARGET file or a run folder, by what it is.
    ///
    /// # Errors
    /// When it is neither, or damaged.
    pub fn read(path: &Path) -> Result<Transient> {
        if path.is_dir() {
            Ok(Transient::of_run(&path.display().to_string(), &StoredRun::read(path)?))
        } else {
            let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
            Transient::of_target(&name, &TargetFile::read(path)?).with_context(|| path.display().to_string())
        }
    }

    /// A recorded transient by the scales in its header, on the time base that the board measured.
    ///
    /// # Errors
    /// When a scale is missing.
    pub fn of_target(name: &str, file: &TargetFile) -> Result<Transient> {
        let period = file.number("measured_period_us")? / 1e6;
        let mm = file.number("mm_per_count")?;
        let pressure = [file.number("pressure_scale_pa")? / 1e3, file.number("pressure_offset_pa")? / 1e3];
        let spool = [file.number("spool_scale_mm")?, file.number("spool_offset_mm")?];
        let open_loop = file.number("param.open_loop")? != 0.0;
        let scaled = |raw: i16, [scale, offset]: [f64; 2]| f64::from(raw) * scale + offset;
        let channel = |of: &dyn Fn(&pneudrive_protocol::RecordedSample) -> f64| {
            file.samples.iter().map(|(_, sample)| of(sample)).collect::<Vec<f64>>()
        };
        Ok(Transient {
            name: name.to_owned(),
            time: file.samples.iter().map(|(index, _)| f64::from(*index) * period).collect(),
            channels: [
                // The error is the setpoint less the position; open loop has neither.
                channel(&|s| {
                    if open_loop { f64::NAN } else { (f64::from(s.position) + f64::from(s.error)) * mm }
                }),
                channel(&|s| f64::from(s.position) * mm),
                channel(&|s| scaled(s.pressure_1, pressure)),
                channel(&|s| scaled(s.pressure_2, pressure)),
                channel(&|s| scaled(s.spool, spool)),
                channel(&|s| f64::from(s.command)),
                channel(&|s| f64::from(s.error)),
            ],
        })
    }

    /// A simulated transient.
    #[must_use]
    pub fn of_run(name: &str, run: &StoredRun) -> Transient {
        let scaled =
            |column: &str, factor: f64| run.column(column).iter().map(|value| value * factor).collect();
        Transient {
            name: name.to_owned(),
            time: run.column("time_s").to_vec(),
            channels: [
                scaled("setpoint_counts", run.mm_per_count),
                scaled("position_m", 1e3),
                scaled("pressure_1_pa", 1e-3),
                scaled("pressure_2_pa", 1e-3),
                scaled("spool_mm", 1.0),
                scaled("command_counts", 1.0),
                scaled("error_counts", 1.0),
            ],
        }
    }

    /// A channel at `time`, on the straight line between its neighbours; None outside the transient.
    #[must_use]
    pub fn at(&self, channel: usize, time: f64) -> Option<f64> {
        let values = &self.channels[channel];
        let after = self.time.partition_point(|&t| t < time);
        let (t1, v1) = (*self.time.get(after)?, *values.get(after)?);
        if t1 == time {
            return Some(v1);
        }
        let (t0, v0) = (*self.time.get(after.checked_sub(1)?)?, *values.get(after - 1)?);
        Some(v0 + (v1 - v0) * (time - t0) / (t1 - t0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_samples_a_channel_is_a_straight_line_and_outside_there_is_none() {
        let mut channels: [Vec<f64>; CHANNELS.len()] = std::array::from_fn(|_| vec![0.0; 3]);
        channels[1] = vec![10.0, 20.0, 0.0];
        let transient = Transient { name: String::new(), time: vec![0.0, 1.0, 2.0], channels };
        assert_eq!(transient.at(1, 0.25), Some(12.5));
        assert_eq!(transient.at(1, 1.0), Some(20.0));
        assert_eq!(transient.at(1, 0.0), Some(10.0));
        assert_eq!(transient.at(1, -0.1), None);
        assert_eq!(transient.at(1, 2.1), None);
    }
}
