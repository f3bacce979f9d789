//! The cost of the samples of a run on the emulated board.

use std::fmt;
use std::time::{Duration, Instant};

use pneudrive_app::plant_bus::{Next, Outputs};

/// Virtual time of an instruction, ns, as a power of two. A tick of the counter (25 MHz) is shorter, so the number of
/// instructions follows exactly from ticks.
pub(crate) const ICOUNT_SHIFT: u32 = 7;

/// Nanoseconds of a tick of the board's counter: 25 MHz.
const NS_PER_TICK: u64 = 40;

/// Minimum, mean and maximum of a number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Spread {
    /// The least.
    pub least: u64,
    /// The most.
    pub most: u64,
    sum: u64,
    count: u64,
}

impl Spread {
    fn add(&mut self, value: u64) {
        self.least = if self.count == 0 { value } else { self.least.min(value) };
        self.most = self.most.max(value);
        self.sum += value;
        self.count += 1;
    }

    /// The spread of both sets of numbers.
    #[must_use]
    pub fn and(self, other: Spread) -> Spread {
        match (self.count, other.count) {
            (0, _) => other,
            (_, 0) => self,
            _ => Spread {
                least: self.least.min(other.least),
                most: self.most.max(other.most),
                sum: self.sum + other.sum,
                count: self.count + other.count,
            },
        }
    }

    /// The mean; 0 of nothing.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.sum as f64 / self.count.max(1) as f64
    }
}

impl fmt::Display for Spread {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} / {:.0} / {}", self.least, self.mean(), self.most)
    }
}

/// Cost of the samples of all runs. Instructions are those of the emulated processor and the same in every repetition;
/// times are those of this computer and vary.
#[derive(Clone, Copy, Debug, Default)]
pub struct Figures {
    /// Samples of runs.
    pub samples: u64,
    /// Time of the computer from the beginning of the runs to their ends.
    pub elapsed: Duration,
    /// The part of it spent on the plant.
    pub in_plant: Duration,
    /// Instructions of `Control::on_sample`.
    pub sample_instructions: Spread,
    /// Instructions of `Control::on_output`, with the recorder.
    pub output_instructions: Spread,
    /// Both together, sample by sample, after the first samples of the runs.
    pub control_instructions: Spread,
    /// Both together at the first samples of the runs, where estimator and sequencer start.
    pub first_instructions: Spread,
    /// The most instructions of a piece of a request, for which a board with an interrupt locks it out.
    pub request_instructions: u64,
    since: Option<Instant>,
    is_first: bool,
}

impl Figures {
    /// Adds a turn of the board that the plant answered from `begun` to `ended`.
    pub(crate) fn add(&mut self, outputs: Outputs, begun: Instant, ended: Instant) {
        if outputs.next == Next::Advance {
            self.samples += 1;
            self.elapsed += ended - self.since.unwrap_or(begun);
            self.in_plant += ended - begun;
            self.add_instructions(instructions(outputs.ticks.sample), instructions(outputs.ticks.output));
        }
        self.is_first = matches!(outputs.next, Next::Begin { .. });
        let runs = matches!(outputs.next, Next::Advance | Next::Begin { .. });
        self.since = runs.then_some(ended);
    }

    /// Adds the ticks of a request.
    pub(crate) fn add_request(&mut self, ticks: u32) {
        self.request_instructions = self.request_instructions.max(instructions(ticks));
    }

    fn add_instructions(&mut self, sample: u64, output: u64) {
        self.sample_instructions.add(sample);
        self.output_instructions.add(output);
        let control =
            if self.is_first { &mut self.first_instructions } else { &mut self.control_instructions };
        control.add(sample + output);
    }

    /// Samples per second of emulator and bus if the plant took no time.
    #[must_use]
    pub fn samples_per_second_without_plant(&self) -> f64 {
        self.samples as f64 / self.elapsed.saturating_sub(self.in_plant).as_secs_f64().max(1e-9)
    }

    /// Samples per second.
    #[must_use]
    pub fn samples_per_second(&self) -> f64 {
        self.samples as f64 / self.elapsed.as_secs_f64().max(1e-9)
    }
}

impl fmt::Display for Figures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} samples, {:.0} a second ({:.0} without the plant); instructions least / mean / most: sample {}, output {}, both {}, both at the first sample {}",
            self.samples,
            self.samples_per_second(),
            self.samples_per_second_without_plant(),
            self.sample_instructions,
            self.output_instructions,
            self.control_instructions,
            self.first_instructions
        )
    }
}

/// Instructions in a number of ticks: each takes the same virtual time.
fn instructions(ticks: u32) -> u64 {
    let ns = u64::from(ticks) * NS_PER_TICK;
    (ns + (1 << (ICOUNT_SHIFT - 1))) >> ICOUNT_SHIFT
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneudrive_app::plant_bus::Ticks;

    #[test]
    fn ticks_tell_instructions_exactly() {
        for count in 0..5000_u64 {
            let ns = count << ICOUNT_SHIFT;
            // A reading is rounded down at both ends.
            for ticks in [ns / NS_PER_TICK, ns.div_ceil(NS_PER_TICK)] {
                assert_eq!(instructions(ticks as u32), count);
            }
        }
    }

    #[test]
    fn only_samples_of_runs_count() {
        let mut figures = Figures::default();
        let now = Instant::now();
        let turn = |next, sample| Outputs { next, ticks: Ticks { sample, output: 16 }, ..Outputs::OFF };
        figures.add(turn(Next::Stay, 9999), now, now);
        figures.add(turn(Next::Begin { period_us: 1300, delay_us: 500 }, 9999), now, now);
        figures.add(turn(Next::Advance, 32), now, now);
        figures.add(turn(Next::Advance, 96), now, now);
        figures.add(turn(Next::Stay, 9999), now, now);
        assert_eq!(figures.samples, 2);
        assert_eq!(figures.first_instructions.to_string(), "15 / 15 / 15");
        assert_eq!(figures.control_instructions.to_string(), "35 / 35 / 35");
        assert_eq!(figures.sample_instructions.to_string(), "10 / 20 / 30");
        assert_eq!(figures.output_instructions.to_string(), "5 / 5 / 5");
    }
}
