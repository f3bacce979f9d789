//! A transient in engineering units, whatever its source.

mod friction_use;
mod of_simulation;
mod of_target;

use std::path::Path;

use anyhow::{Context, Result, bail};
use pneudrive_records::band::Band;
use pneudrive_records::run_folder::{Numbered, StoredRun};
use pneudrive_records::target::TargetFile;
use pneudrive_sim::trace::Extra;

pub use friction_use::FrictionUse;

/// The channels that are compared and drawn: name and unit of each.
pub const CHANNELS: [(&str, &str); 7] = [
    ("setpoint", "mm"),
    ("position", "mm"),
    ("pressure 1", "kPa"),
    ("pressure 2", "kPa"),
    ("spool", "mm"),
    ("command", "counts"),
    ("error", "counts"),
];

/// This many changes of the setpoint, none later than this after the one before, are a profile: s.
const PROFILE_CHANGES: usize = 5;
const PROFILE_GAP_S: f64 = 0.05;

/// Setpoints closer than this are one, mm or counts: they come from sums of rounded numbers.
const SAME: f64 = 1e-9;

/// Index of the setpoint in [`CHANNELS`].
pub const SETPOINT: usize = 0;
/// Index of the position, mm.
pub const POSITION: usize = 1;
/// Indices of the pressures, kPa.
pub const PRESSURES: [usize; 2] = [2, 3];
/// Columns of the pressures at the ports of the valve.
const PORTS: [&str; 2] = ["port_pressure_1_pa", "port_pressure_2_pa"];
/// Index of the spool position, mm.
pub const SPOOL: usize = 4;
/// Index of the command, counts.
pub const COMMAND: usize = 5;
/// Index of the error, counts.
pub const ERROR: usize = 6;

/// Channels over time.
#[derive(Clone, Debug, Default)]
pub struct Transient {
    /// Where it comes from, for legends.
    pub name: String,
    /// Number and date of a simulated run that has been written.
    pub numbered: Option<Numbered>,
    /// The name of its test; the tests of built-in rigs have the names of their rigs.
    pub test: String,
    /// Times from the start of the test, s.
    pub time: Vec<f64>,
    /// Values of each channel, in the order of [`CHANNELS`].
    pub channels: [Vec<f64>; CHANNELS.len()],
    /// The encoder count at each instant.
    pub counts: Vec<i32>,
    /// mm of stroke per encoder count.
    pub mm_per_count: f64,
    /// Windows of the controller's velocity and acceleration, samples.
    pub windows: [u8; 2],
    /// A step of the converters of the pressures, kPa; 0 of a run.
    pub pressure_step_kpa: f64,
    /// Air that flows into the chambers, kg/s; None of a record, which has no flows.
    pub inflow_kg_s: Option<Vec<f64>>,
    /// How firmly friction holds the load; None of a record, which does not show it, and without friction.
    pub grip: Option<FrictionUse>,
    /// Columns that not every trace has, in their own units.
    pub extras: Vec<(&'static Extra, Vec<f64>)>,
    /// Times before and after each place where samples are missing, s.
    pub gaps: Vec<[f64; 2]>,
    /// The range of a simulated run and its perturbed runs, if it has some.
    pub band: Option<ChannelBand>,
    /// The moves that a part of a longer transient has lost; nothing for a whole one.
    pub cut: Cut,
}

/// Where a part of a transient cuts its moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cut {
    /// Moves that begin before its first sample.
    pub moves_before: usize,
    /// Whether the last of those continues at the first sample.
    pub at_start: bool,
    /// Whether its last move continues after the last sample.
    pub at_end: bool,
}

/// Lowest and highest values of each channel of [`CHANNELS`], at the instants of its transient; none of the setpoint.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChannelBand {
    /// Lowest values.
    pub low: [Vec<f64>; CHANNELS.len()],
    /// Highest values.
    pub high: [Vec<f64>; CHANNELS.len()],
}

impl ChannelBand {
    fn of(band: &Band) -> ChannelBand {
        let scaled = |name: &str, factor: f64| {
            band.channel(name).map(|values| values.iter().map(|value| value * factor).collect::<Vec<f64>>())
        };
        let [mut low, mut high]: [[Vec<f64>; CHANNELS.len()]; 2] = Default::default();
        for (channel, name, factor) in BANDS {
            [low[channel], high[channel]] = scaled(name, factor);
        }
        ChannelBand { low, high }
    }

    /// Linear interpolation between two places.
    fn between(&self, first: usize, end: usize) -> ChannelBand {
        let part = |channels: &[Vec<f64>; CHANNELS.len()]| {
            channels.each_ref().map(|values| values.get(first..end).unwrap_or_default().to_vec())
        };
        ChannelBand { low: part(&self.low), high: part(&self.high) }
    }
}

/// Channels with a band, with their columns in band.csv and the factor to the channel's unit.
const BANDS: [(usize, &str, f64); 6] = [
    (POSITION, "position_m", 1e3),
    (PRESSURES[0], "pressure_1_pa", 1e-3),
    (PRESSURES[1], "pressure_2_pa", 1e-3),
    (SPOOL, "spool_mm", 1.0),
    (COMMAND, "command_counts", 1.0),
    (ERROR, "error_counts", 1.0),
];

impl Transient {
    /// The transient of a TARGET file, a streamed run or a run folder, by its contents.
    ///
    /// # Errors
    /// When it is none of them, or damaged.
    pub fn read(path: &Path) -> Result<Transient> {
        if path.file_name().is_some_and(|name| name == "trace.csv" || name == "run.json") {
            bail!("{} is part of a run; give its folder", path.display());
        }
        if path.is_dir() {
            Ok(Transient::of_run(&path.display().to_string(), &StoredRun::read(path)?))
        } else {
            let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
            Transient::of_target(&name, &TargetFile::read(path)?).with_context(|| path.display().to_string())
        }
    }

    /// A simulated transient.
    #[must_use]
    pub fn of_run(name: &str, run: &StoredRun) -> Transient {
        let scaled =
            |column: &str, factor: f64| run.column(column).iter().map(|value| value * factor).collect();
        let asked = if run.open_loop { f64::NAN } else { run.mm_per_count };
        let inflow = |flows: (&f64, &f64)| flows.0.max(0.0) + flows.1.max(0.0);
        let flows = run.column("mass_flow_1_kg_s").iter().zip(run.column("mass_flow_2_kg_s"));
        Transient {
            name: name.to_owned(),
            numbered: run.numbered.clone(),
            test: run.rig.clone(),
            time: run.column("time_s").to_vec(),
            channels: [
                scaled("setpoint_counts", asked),
                scaled("position_m", 1e3),
                scaled("pressure_1_pa", 1e-3),
                scaled("pressure_2_pa", 1e-3),
                scaled("spool_mm", 1.0),
                scaled("command_counts", 1.0),
                scaled("error_counts", 1.0),
            ],
            counts: run.column("position_counts").iter().map(|&count| count as i32).collect(),
            mm_per_count: run.mm_per_count,
            windows: run.windows,
            pressure_step_kpa: 0.0,
            inflow_kg_s: Some(flows.map(inflow).collect()),
            grip: run
                .holding
                .as_ref()
                .and_then(|holding| FrictionUse::of(holding, run.column("friction_n").iter().copied())),
            extras: run.extras.iter().map(|extra| (*extra, run.column(extra.name).to_vec())).collect(),
            gaps: Vec::new(),
            band: run.band.as_ref().map(ChannelBand::of),
            cut: Cut::default(),
        }
    }

    /// Whether the setpoint is unknown throughout: the moves are commands.
    #[must_use]
    pub fn is_open_loop(&self) -> bool {
        self.channels[SETPOINT].iter().all(|setpoint| setpoint.is_nan())
    }

    /// Whether both pressures are known anywhere: some drives have no sensors of them, and some logs no channels.
    #[must_use]
    pub fn has_pressures(&self) -> bool {
        PRESSURES.iter().all(|&channel| self.channels[channel].iter().any(|kpa| kpa.is_finite()))
    }

    /// Time between two samples, s; 0 of a transient of less than two.
    #[must_use]
    pub fn period_s(&self) -> f64 {
        match (self.time.first(), self.time.last()) {
            (Some(first), Some(last)) if last > first => (last - first) / (self.time.len() - 1) as f64,
            _ => 0.0,
        }
    }

    /// The part between two times, s, both included.
    #[must_use]
    pub fn between(&self, from: f64, to: f64) -> Transient {
        let first = self.time.partition_point(|&time| time < from);
        let end = self.time.partition_point(|&time| time <= to).max(first);
        Transient {
            name: self.name.clone(),
            numbered: self.numbered.clone(),
            test: self.test.clone(),
            time: self.time[first..end].to_vec(),
            channels: std::array::from_fn(|channel| self.channels[channel][first..end].to_vec()),
            counts: self.counts[first..end].to_vec(),
            mm_per_count: self.mm_per_count,
            windows: self.windows,
            pressure_step_kpa: self.pressure_step_kpa,
            inflow_kg_s: self.inflow_kg_s.as_ref().map(|flow| flow[first..end].to_vec()),
            grip: self.grip.as_ref().map(|grip| grip.between(first, end)),
            extras: self.extras.iter().map(|(extra, of)| (*extra, of[first..end].to_vec())).collect(),
            gaps: self
                .gaps
                .iter()
                .copied()
                .filter(|[before, after]| *before >= from && *after <= to)
                .collect(),
            band: self.band.as_ref().map(|band| band.between(first, end)),
            cut: self.cut_between(first, end),
        }
    }

    /// The same with the pressures at the ports of the valve, P_1v and P_2v, for those in the chambers: there the
    /// transmitters of thesis 7.2.1 (c) were. A record stays as it is, as nobody knows where its transmitters were.
    ///
    /// # Errors
    /// When a run does not have them.
    pub fn at_ports(mut self) -> Result<Transient> {
        if self.inflow_kg_s.is_none() {
            return Ok(self);
        }
        for (channel, name) in PRESSURES.into_iter().zip(PORTS) {
            let Some((_, values)) = self.extras.iter().find(|(extra, _)| extra.name == name) else {
                bail!("{} has no {name}; simulate it with --columns {}", self.name, PORTS.join(","));
            };
            self.channels[channel] = values.iter().map(|pascals| pascals * 1e-3).collect();
            if let Some(band) = &mut self.band {
                (band.low[channel], band.high[channel]) = (Vec::new(), Vec::new());
            }
        }
        Ok(self)
    }

    /// Indices of the first sample of each move: where the setpoint changes or, in open loop, the command. The first
    /// move begins at the start of the test, or with the transient if that is later. Changes that follow each other
    /// closely are one profile, which begins with the first of them.
    #[must_use]
    pub fn beginnings(&self) -> Vec<usize> {
        let start = self.time.partition_point(|&time| time < 0.0);
        let changes = self.changes(start + 1..self.time.len());
        let firsts = changes
            .chunk_by(|&a, &b| self.time[b] - self.time[a] <= PROFILE_GAP_S)
            .flat_map(|chain| if chain.len() < PROFILE_CHANGES { chain } else { &chain[..1] });
        (start < self.time.len()).then_some(start).into_iter().chain(firsts.copied()).collect()
    }

    /// The samples of a profile within a move: from the first change of the setpoint to the last one; None of a step.
    #[must_use]
    pub fn profile(&self, begin: usize, end: usize) -> Option<std::ops::RangeInclusive<usize>> {
        let changes = self.changes(begin.max(1)..end);
        (changes.len() >= PROFILE_CHANGES).then(|| changes[0]..=changes[changes.len() - 1])
    }

    /// Where the setpoint or, in open loop, the command differs from that of the sample before.
    fn changes(&self, samples: std::ops::Range<usize>) -> Vec<usize> {
        let asked = &self.channels[if self.is_open_loop() { COMMAND } else { SETPOINT }];
        // A setpoint behind an error at the limit of its 16 bits cannot be known.
        samples.filter(|&k| (asked[k] - asked[k - 1]).abs() > SAME).collect()
    }

    /// The moves of this transient that the samples from `first` until before `end` lose.
    fn cut_between(&self, first: usize, end: usize) -> Cut {
        let begins: Vec<usize> = self.beginnings().into_iter().skip(usize::from(self.cut.at_start)).collect();
        let before =
            |sample: usize| self.cut.moves_before + begins.iter().filter(|&&begin| begin < sample).count();
        let goes_on = |sample: usize| before(sample) > 0 && !begins.contains(&sample);
        Cut {
            moves_before: before(first),
            at_start: goes_on(first),
            at_end: if end < self.time.len() { goes_on(end) } else { self.cut.at_end },
        }
    }

    /// Gives its error in counts of this length, mm, as a transient from another encoder has it.
    pub fn error_in_counts_of(&mut self, mm_per_count: f64) {
        let factor = self.mm_per_count / mm_per_count;
        let band = self.band.iter_mut().flat_map(|band| [&mut band.low[ERROR], &mut band.high[ERROR]]);
        band.chain([&mut self.channels[ERROR]]).flatten().for_each(|error| *error *= factor);
    }

    /// Moves it in time, s.
    pub fn shift(&mut self, by: f64) {
        self.time.iter_mut().chain(self.gaps.as_flattened_mut()).for_each(|time| *time += by);
    }

    /// A channel at `time`, on the straight line between its samples; None outside the transient.
    #[must_use]
    pub fn at(&self, channel: usize, time: f64) -> Option<f64> {
        self.interpolated(&self.channels[channel], time)
    }

    /// Lowest and highest value of a channel at `time` over a run and its perturbed runs; None without a band.
    #[must_use]
    pub(crate) fn band_at(&self, channel: usize, time: f64) -> Option<[f64; 2]> {
        let band = self.band.as_ref()?;
        Some([self.interpolated(&band.low[channel], time)?, self.interpolated(&band.high[channel], time)?])
    }

    fn interpolated(&self, values: &[f64], time: f64) -> Option<f64> {
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
        let mut transient = Transient { time: vec![0.0, 1.0, 2.0], ..Transient::default() };
        transient.channels[1] = vec![10.0, 20.0, 0.0];
        assert_eq!(transient.at(1, 0.25), Some(12.5));
        assert_eq!(transient.at(1, 1.0), Some(20.0));
        assert_eq!(transient.at(1, 0.0), Some(10.0));
        assert_eq!(transient.at(1, -0.1), None);
        assert_eq!(transient.at(1, 2.1), None);
    }
}
