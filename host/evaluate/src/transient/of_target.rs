//! The transient of a TARGET file or a streamed run.

use anyhow::{Context, Result};
use pneudrive_protocol::RecordedSample;
use pneudrive_records::target::TargetFile;
use pneudrive_records::window::{WHOLE_WINDOW, whole_window};

use super::{Cut, Transient};

impl Transient {
    /// A recorded or streamed transient by the scales in its header, on the time base that the board measured; of a
    /// stream on the one asked for.
    ///
    /// # Errors
    /// When a scale is missing.
    pub fn of_target(name: &str, file: &TargetFile) -> Result<Transient> {
        let period = file.period_us()? / 1e6;
        let mm = file.positive("mm_per_count")?;
        let pressure = [file.positive("pressure_scale_pa")? / 1e3, file.number("pressure_offset_pa")? / 1e3];
        let spool = [file.positive("spool_scale_mm")?, file.number("spool_offset_mm")?];
        let open_loop = file.number("param.open_loop")? != 0.0;
        // The first firmware has no such line.
        let stepper = file.get("param.stepper").is_some_and(|value| value != "0");
        let scaled = |raw: i16, [scale, offset]: [f64; 2]| f64::from(raw) * scale + offset;
        let known = |name: &str, value: f64| if file.is_unknown(name) { f64::NAN } else { value };
        let channel = |of: &dyn Fn(&RecordedSample) -> f64| {
            file.samples.iter().map(|(_, sample)| of(sample)).collect::<Vec<f64>>()
        };
        Ok(Transient {
            name: name.to_owned(),
            numbered: None,
            test: file.get("test").unwrap_or_default().to_owned(),
            time: file.samples.iter().map(|(index, _)| f64::from(*index) * period).collect(),
            channels: [
                setpoints(file, open_loop).into_iter().map(|counts| counts * mm).collect(),
                channel(&|s| f64::from(s.position) * mm),
                channel(&|s| known("pressure_1", scaled(s.pressure_1, pressure))),
                channel(&|s| known("pressure_2", scaled(s.pressure_2, pressure))),
                // SPLLOC counts steps: their length, and the true position of the spool, were not measured.
                channel(&|s| if stepper { f64::NAN } else { known("spool", scaled(s.spool, spool)) }),
                channel(&|s| f64::from(s.command)),
                channel(&|s| known("setpoint", f64::from(s.error))),
            ],
            counts: file.samples.iter().map(|(_, sample)| sample.position).collect(),
            mm_per_count: mm,
            windows: [
                window(file, "param.velocity_window_samples")?,
                window(file, "param.acceleration_window_samples")?,
            ],
            pressure_step_kpa: pressure[0].abs(),
            inflow_kg_s: None,
            grip: None,
            extras: Vec::new(),
            gaps: gaps(file, period),
            band: None,
            cut: Cut::default(),
        })
    }
}

/// The setpoint of each sample, counts: the error is the setpoint less the position. Open loop has neither. An error
/// at the limit of its 16 bits does not show it. Then the next sample with a usable error gives it, because a drive
/// comes nearer on its way.
fn setpoints(file: &TargetFile, open_loop: bool) -> Vec<f64> {
    let mut next = f64::NAN;
    let mut setpoints: Vec<f64> = file
        .samples
        .iter()
        .rev()
        .map(|(_, sample)| {
            if !open_loop && sample.error != i16::MAX && sample.error != i16::MIN {
                next = f64::from(sample.position) + f64::from(sample.error);
            }
            next
        })
        .collect();
    setpoints.reverse();
    setpoints
}

/// Where more than the samples between every Nth are missing.
fn gaps(file: &TargetFile, period_s: f64) -> Vec<[f64; 2]> {
    let every = file.number("decimation").unwrap_or(1.0);
    let times = |pair: &[(i32, RecordedSample)]| [pair[0].0, pair[1].0].map(f64::from);
    let pairs = file.samples.windows(2).map(times);
    pairs.filter(|[before, after]| after - before > every).map(|pair| pair.map(|k| k * period_s)).collect()
}

/// A window of the controller, samples, from a header.
fn window(file: &TargetFile, key: &str) -> Result<u8> {
    let samples = file.number(key)?;
    whole_window(samples).with_context(|| format!("the header's {key} is {samples}; {WHOLE_WINDOW}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_at_the_limit_of_its_bits_tells_no_setpoint_and_the_next_one_does() {
        let sample = |position: i32, error: i16| RecordedSample {
            position,
            pressure_1: 0,
            pressure_2: 0,
            command: 0,
            error,
            spool: 0,
        };
        // A step to 40,000 counts; the last error is not known any more.
        let samples =
            [(0, 0), (100, i16::MAX), (5000, i16::MAX), (8000, 32_000), (39_990, 10), (0, i16::MAX)];
        let samples = (0..).zip(samples.map(|(position, error)| sample(position, error))).collect();
        let file = TargetFile { header: Vec::new(), samples };
        let found = setpoints(&file, false);
        assert_eq!(found[..5], [0.0, 40_000.0, 40_000.0, 40_000.0, 40_000.0]);
        assert!(found[5].is_nan() && setpoints(&file, true).iter().all(|setpoint| setpoint.is_nan()));
    }
}
