//! Many runs of one rig: some keys vary, figures of the moves are collected, the best point is found.
//!
//! [`Sweep::read`] takes a TOML file and gives a fixed list of points: every combination of the varied values,
//! each with every draw of the distributions. A point is a number that always means the same rig, so points may be run
//! in any order, on any machine, and repeatedly.
//!
//! | module | holds |
//! |---|---|
//! | [`mod@file`] | the TOML file: its keys, and everything wrong with it by line and key |
//! | [`axis`] | the varied quantities: values, ranges, distributions, Latin hypercubes |
//! | [`metric`] | which figure of which move |
//! | [`point`] | one point run, and its row in the result |
//! | [`journal`] | the runs done so far, safe from kills |
//! | [`execution`] | the points on all cores |
//! | [`choice`] | which points are allowed and which is best |
//! | `parquet` | the result with types, if it was built with that |
//! | [`report`], [`numbers`] | the page, and the figures for other programs |

pub mod axis;
pub mod choice;
pub mod execution;
pub mod file;
pub mod journal;
pub mod metric;
pub mod numbers;
#[cfg(any(test, feature = "parquet"))]
pub mod parquet;
pub mod point;
pub mod report;

use crc::{CRC_64_XZ, Crc};
use pneudrive_sim::rig::all_keys;
use pneudrive_sim::{Accuracy, Rig};

pub use axis::Axis;
pub use choice::{Bound, Objective};
pub use metric::Metric;
pub use point::Row;

/// A file as it was read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// Its name, for messages.
    pub name: String,
    /// Its text.
    pub text: String,
}

/// Many runs of one rig.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// The file that it was read from.
    pub source: Source,
    /// The rig that is varied.
    pub rig_source: Source,
    /// The common settings of all points, as `key=value`.
    pub settings: Vec<String>,
    /// That rig with these settings.
    pub rig: Rig,
    /// Allowed error of a step; None: as each drive needs it.
    pub tolerance: Option<f64>,
    /// The varied quantities, in the order of the file.
    pub axes: Vec<Axis>,
    /// Number of runs of a point: the rig itself, and perturbed runs that differ very slightly.
    pub ensemble: usize,
    /// How many draws of the distributions each combination is run with; 1 without distributions.
    pub draws: usize,
    /// The collected figures.
    pub metrics: Vec<Metric>,
    /// The criterion by which a point is better than another.
    pub objective: Option<Objective>,
    /// The condition for a point to be allowed.
    pub constraints: Vec<Bound>,
}

impl Sweep {
    /// How many points there are.
    #[must_use]
    pub fn points(&self) -> usize {
        self.draws
            * self.axes.iter().filter(|axis| !axis.drawn).map(|axis| axis.levels.len()).product::<usize>()
    }

    /// The level of each axis at a point. Draws change fastest, then the last varied key.
    #[must_use]
    pub fn levels(&self, point: usize) -> Vec<&str> {
        let mut rest = point / self.draws;
        let mut levels: Vec<&str> = Vec::with_capacity(self.axes.len());
        for axis in self.axes.iter().rev() {
            let count = axis.levels.len();
            let level = if axis.drawn { point % self.draws } else { rest % count };
            rest = if axis.drawn { rest } else { rest / count };
            levels.push(&axis.levels[level]);
        }
        levels.reverse();
        levels
    }

    /// The settings of a point's rig, as `key=value`: those of the rig, and those that were drawn, of its plant alone.
    #[must_use]
    pub fn settings_of(&self, point: usize) -> [Vec<String>; 2] {
        let levels = self.levels(point);
        let (drawn, varied): (Vec<_>, Vec<_>) =
            self.axes.iter().zip(levels).partition(|(axis, _)| axis.drawn);
        let settings = |axes: Vec<(&Axis, &str)>| -> Vec<String> {
            axes.into_iter().flat_map(|(axis, level)| axis.settings(&self.rig, level)).collect()
        };
        [[self.settings.clone(), settings(varied)].concat(), settings(drawn)]
    }

    /// Whether a point is one of many draws, and not a single rig.
    #[must_use]
    pub fn is_drawn(&self) -> bool {
        self.axes.iter().any(|axis| axis.drawn)
    }

    /// The columns between those of the axes and the last two: the metrics; of an ensemble the ends of their ranges;
    /// and whether a point has converged, if it is no draw.
    #[must_use]
    pub(crate) fn figure_columns(&self) -> Vec<String> {
        let own = self.metrics.iter().map(|metric| metric.name.clone());
        let ends = self.metrics.iter().filter(|_| self.ensemble > 1);
        let ends = ends.flat_map(|metric| ENDS.map(|end| format!("{}{end}", metric.name)));
        let converged = (!self.is_drawn()).then(|| CONVERGED.to_owned());
        own.chain(ends).chain(converged).collect()
    }

    /// First line of the result: `point`, the axes, the figures, `fault`, `failure`.
    #[must_use]
    pub fn header(&self) -> String {
        let axes = self.axes.iter().map(|axis| axis.name.clone());
        let names = axes.chain(self.figure_columns());
        names.fold(String::from("point"), |line, name| line + "," + &name) + HEADER_END
    }

    /// The accuracy of a simulation: until it has converged, except for draws, which need not.
    fn accuracy_for(&self, rig: &Rig) -> Accuracy {
        let usual = if self.is_drawn() { Accuracy::of_draw(rig) } else { Accuracy::of(rig) };
        Accuracy { tolerance: self.tolerance.unwrap_or(usual.tolerance), ..usual }
    }

    /// All values of the rig with its settings, however its file is written.
    fn meaning(&self) -> Vec<String> {
        all_keys().filter_map(|key| Some(key.setting(self.rig.value(key.path)?))).collect()
    }

    /// A number that changes if any row of the result may change. It distinguishes the results of different sweeps.
    /// Objective and constraints do not count, nor do comments and line breaks.
    #[must_use]
    pub fn identity(&self) -> u64 {
        const CRC: Crc<u64> = Crc::<u64>::new(&CRC_64_XZ);
        let mut digest = CRC.digest();
        let about = (self.meaning(), self.tolerance, self.draws);
        digest.update(format!("{}", self.ensemble).as_bytes());
        digest.update(format!("{about:?}{}", env!("CARGO_PKG_VERSION")).as_bytes());
        digest.update(format!("{}", metric::REVISION).as_bytes());
        digest.update(format!("{:?}", self.axes).as_bytes());
        for metric in &self.metrics {
            digest.update(format!("{:?}", (&metric.name, metric.figure.name, metric.which)).as_bytes());
        }
        digest.finalize()
    }
}

/// The column that says whether a point has converged.
const CONVERGED: &str = "converged";

/// The endings of the columns for a metric's range.
const ENDS: [&str; 2] = ["_least", "_most"];

/// Ends the first line of every result, so that a result is known as one.
pub const HEADER_END: &str = ",fault,failure";

#[cfg(test)]
mod tests;
