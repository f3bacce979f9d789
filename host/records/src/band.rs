//! The band of a run: the range of its perturbed runs and itself at each instant (see [`crate::judged`]).
//!
//! band.csv, beside trace.csv and with its rows: `time_s`, then for each channel of [`CHANNELS`] its lowest and its
//! highest value, `position_m_low,position_m_high,...`; SI except where the name says otherwise.

use std::path::Path;

use anyhow::{Context, Result, anyhow, bail};
use pneudrive_sim::Run;
use pneudrive_sim::trace::{COLUMNS, push_number};

use crate::text_file;

/// Columns of trace.csv that have a band.
pub const CHANNELS: [&str; 7] = [
    "position_m",
    "velocity_m_s",
    "pressure_1_pa",
    "pressure_2_pa",
    "spool_mm",
    "command_counts",
    "error_counts",
];

/// Lowest and highest values over time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Band {
    /// Times as in trace.csv, s.
    pub time_s: Vec<f64>,
    /// Lowest values, in the order of [`CHANNELS`], with their units.
    pub low: [Vec<f64>; CHANNELS.len()],
    /// Highest values, in the same order.
    pub high: [Vec<f64>; CHANNELS.len()],
}

impl Band {
    /// The band of a single run: its transient.
    #[must_use]
    pub fn of(run: &Run) -> Band {
        let columns = columns_of(run);
        Band { time_s: run.rows.iter().map(|row| row.time).collect(), low: columns.clone(), high: columns }
    }

    /// Includes another run of the same test. One that ended early widens the band up to its end.
    pub fn include(&mut self, run: &Run) {
        for (channel, values) in columns_of(run).iter().enumerate() {
            let ends = self.low[channel].iter_mut().zip(&mut self.high[channel]);
            for ((low, high), value) in ends.zip(values) {
                *low = low.min(*value);
                *high = high.max(*value);
            }
        }
    }

    /// band.csv.
    #[must_use]
    pub fn to_csv(&self) -> String {
        let mut text = header();
        for (row, time) in self.time_s.iter().enumerate() {
            text.push('\n');
            push_number(&mut text, *time);
            for (low, high) in self.low.iter().zip(&self.high) {
                for ends in [low, high] {
                    text.push(',');
                    push_number(&mut text, ends[row]);
                }
            }
        }
        text.push('\n');
        text
    }

    /// Reads band.csv.
    ///
    /// # Errors
    /// With the file and the line of the problem.
    pub fn read(path: &Path) -> Result<Band> {
        let text = text_file::read_own(path)?;
        Band::of_csv(&text).with_context(|| path.display().to_string())
    }

    fn of_csv(text: &str) -> Result<Band> {
        let mut lines = text.lines().enumerate();
        if lines.next().map(|(_, line)| line) != Some(header().as_str()) {
            bail!("line 1: expected the header {}", header());
        }
        let mut band = Band::default();
        for (number, line) in lines {
            let number_of = |cell: &str| cell.parse().ok().filter(|value: &f64| value.is_finite());
            let values: Option<Vec<f64>> = line.split(',').map(number_of).collect();
            let values = values.unwrap_or_default();
            let (time, ends) = values
                .split_first()
                .filter(|(_, ends)| ends.len() == 2 * CHANNELS.len())
                .ok_or_else(|| anyhow!("line {}: expected {} numbers", number + 1, 1 + 2 * CHANNELS.len()))?;
            band.time_s.push(*time);
            for (channel, ends) in ends.chunks_exact(2).enumerate() {
                band.low[channel].push(ends[0]);
                band.high[channel].push(ends[1]);
            }
        }
        Ok(band)
    }

    /// Lowest and highest values of a channel.
    ///
    /// # Panics
    /// When the channel has no band: a bug in the program.
    #[must_use]
    pub fn channel(&self, name: &str) -> [&[f64]; 2] {
        let index = CHANNELS.iter().position(|channel| *channel == name);
        let index = index.unwrap_or_else(|| panic!("{name} has no band"));
        [&self.low[index], &self.high[index]]
    }
}

/// First line of band.csv.
#[must_use]
pub fn header() -> String {
    CHANNELS.iter().fold(String::from("time_s"), |line, name| format!("{line},{name}_low,{name}_high"))
}

fn columns_of(run: &Run) -> [Vec<f64>; CHANNELS.len()] {
    let places = CHANNELS.map(|name| COLUMNS.iter().position(|column| *column == name).expect("a column"));
    let mut columns: [Vec<f64>; CHANNELS.len()] = std::array::from_fn(|_| Vec::with_capacity(run.rows.len()));
    for row in &run.rows {
        let values = row.values();
        for (column, place) in columns.iter_mut().zip(places) {
            column.push(values[place]);
        }
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneudrive_sim::{Accuracy, Rig, run};

    fn run_of(mass_kg: f64) -> Run {
        let rig = Rig::builtin("servo-b").expect("a built-in rig");
        let rig = rig.with_numbers(&[("load.mass_kg", mass_kg), ("test.duration_s", 0.4)]).expect("valid");
        run(&rig, Accuracy::of_motion(&rig)).expect("a run")
    }

    #[test]
    fn a_band_holds_every_run_that_it_was_made_of_and_touches_one_of_them() {
        let runs = [run_of(1.6), run_of(1.5), run_of(1.7)];
        let mut band = Band::of(&runs[0]);
        runs[1..].iter().for_each(|run| band.include(run));
        let [low, high] = band.channel("position_m");
        for (k, (low, high)) in low.iter().zip(high).enumerate() {
            let positions = runs.each_ref().map(|run| run.rows[k].plant.position);
            assert!(positions.iter().all(|position| (*low..=*high).contains(position)));
            assert!(positions.contains(low) && positions.contains(high));
        }
        assert!(low.iter().zip(high).any(|(low, high)| high > low));
    }

    #[test]
    fn a_band_reads_back_to_the_digits_of_a_trace_and_a_cut_one_is_refused() {
        let mut band = Band::of(&run_of(1.6));
        band.include(&run_of(1.7));
        let text = band.to_csv();
        let read = Band::of_csv(&text).expect("a band");
        assert_eq!(read.to_csv(), text);
        assert_eq!(read.time_s.len(), band.time_s.len());
        let error = Band::of_csv(&text[..text.len() - 30]).expect_err("cut");
        assert!(error.to_string().contains("expected 15 numbers"), "{error}");
    }
}
