//! A rig's model held against recordings, as a sum of squares.
//!
//! Unknown are the parameters, and for each recording the state that it starts from: position and pressures,
//! as sensors tell these to a count only.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use anyhow::{Result, ensure};
use nalgebra::{DMatrix, DVector};
use pneudrive_sim::follow::Reading;
use pneudrive_sim::{Accuracy, Rig};

use super::ChannelFit;
use super::least_squares::Problem;
use super::parameter::Parameter;
use super::recording::{CHANNELS, Channel, Recording, STARTS, reading};

/// Deviation in u that the term of an unknown itself allows: a factor of e, what is plausible, or
/// [`COUNTS`] of an initial state.
const ALLOWED: f64 = 1.0;

/// What u = 1 is of a quantity of an initial state, counts.
const COUNTS: f64 = 10.0;

/// Difference in u for a derivative: large against the integrator's error, small against curvature. Of an
/// initial state a tenth of a count.
const DIFFERENCE: f64 = 1e-3;
const DIFFERENCE_OF_START: f64 = 0.1 / COUNTS;

/// Derivatives to both sides that differ by this factor have a jump of the residuals on one side: a spool that
/// swings once more, say.
const JUMP: f64 = 3.0;

/// Root of the mean squared error of rounding to whole counts.
const ROUNDING: f64 = 0.288_675_134_594_812_9;

/// The model, the data, and what is fitted.
#[derive(Debug)]
pub(super) struct Model<'a> {
    /// At the file's values.
    pub rig: Rig,
    /// The data.
    pub recordings: &'a [Recording],
    /// The first of the unknowns, in the order of u.
    pub parameters: Vec<Parameter>,
    /// Of the runs.
    accuracy: Accuracy,
    /// sigma of each channel, counts.
    pub noise: [f64; CHANNELS.len()],
    /// Share of each recording that counts.
    pub share: f64,
    /// Whether the search is fine: derivatives from differences to both sides.
    pub fine: bool,
    /// Runs of a recording so far.
    runs: AtomicUsize,
}

/// The rows of a channel of a recording among the residuals.
pub(super) struct Block {
    /// Place in [`CHANNELS`].
    pub channel: usize,
    /// The rows.
    pub rows: Range<usize>,
}

/// A recording to be followed at a point.
struct Job<'u> {
    u: &'u [f64],
    recording: usize,
}

impl<'a> Model<'a> {
    pub fn new(
        rig: &Rig,
        recordings: &'a [Recording],
        parameters: Vec<Parameter>,
        accuracy: Accuracy,
    ) -> Model<'a> {
        Model {
            rig: rig.clone(),
            recordings,
            parameters,
            accuracy,
            noise: std::array::from_fn(|channel| noise_at_rest(recordings, channel)),
            share: 1.0,
            fine: false,
            runs: AtomicUsize::new(0),
        }
    }

    /// How many numbers are unknown.
    pub fn unknowns(&self) -> usize {
        self.parameters.len() + STARTS * self.recordings.len()
    }

    /// Runs of a recording so far.
    pub fn runs(&self) -> usize {
        self.runs.load(Ordering::Relaxed)
    }

    /// The rig at a point.
    ///
    /// # Errors
    /// When it is not valid.
    pub fn rig_at(&self, u: &[f64]) -> Result<Rig> {
        let numbers =
            self.parameters.iter().zip(u).map(|(parameter, &u)| (parameter.key.path, parameter.value(u)));
        Ok(self.rig.with_numbers(&numbers.collect::<Vec<_>>())?)
    }

    /// Why there are no residuals at a point: the first recording that cannot be followed, and its error. None where
    /// there are.
    pub fn obstacle(&self, u: &[f64]) -> Option<anyhow::Error> {
        (0..self.recordings.len()).find_map(|recording| {
            let failed = self.try_to_follow(&Job { u, recording }).err()?;
            Some(failed.context(self.recordings[recording].name.clone()))
        })
    }

    /// How far the initial state of a recording is off the measured one at a point, counts.
    pub fn start_at(&self, u: &[f64], recording: usize) -> [f64; STARTS] {
        let first = self.parameters.len() + STARTS * recording;
        std::array::from_fn(|i| COUNTS * u[first + i])
    }

    fn samples(&self, recording: &Recording) -> usize {
        (recording.commands.len() as f64 * self.share).ceil() as usize
    }

    fn try_to_follow(&self, job: &Job<'_>) -> Result<DVector<f64>> {
        let recording = &self.recordings[job.recording];
        self.runs.fetch_add(1, Ordering::Relaxed);
        let start = self.start_at(job.u, job.recording);
        let rig = self.rig_at(job.u)?;
        let readings = recording.follow(&rig, self.accuracy, start, self.samples(recording))?;
        let residuals = self.compare(recording, &readings);
        ensure!(residuals.iter().all(|r| r.is_finite()), "the model's readings are no numbers");
        Ok(residuals)
    }

    /// The residuals of each job, on all cores.
    fn follow_all(&self, jobs: &[Job<'_>]) -> Vec<Option<DVector<f64>>> {
        let (next, done) = (AtomicUsize::new(0), Mutex::new(vec![None; jobs.len()]));
        let work = || {
            while let Some((i, job)) =
                Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|i| Some((i, jobs.get(i)?)))
            {
                let residuals = self.try_to_follow(job).ok();
                done.lock().unwrap_or_else(PoisonError::into_inner)[i] = residuals;
            }
        };
        let threads = std::thread::available_parallelism().map_or(1, usize::from).min(jobs.len());
        std::thread::scope(|scope| {
            for _ in 0..threads {
                scope.spawn(work);
            }
        });
        done.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    fn taken<'r>(&self, recording: &'r Recording, channel: usize) -> &'r [usize] {
        let taken = &recording.channels[channel].taken;
        &taken[..taken.partition_point(|&k| k < self.samples(recording))]
    }

    /// Measured less model, in counts over sigma.
    fn compare(&self, recording: &Recording, readings: &[Reading]) -> DVector<f64> {
        let mut residuals = Vec::new();
        for (channel, noise) in self.noise.iter().enumerate() {
            let Channel { measured, .. } = &recording.channels[channel];
            residuals.extend(self.taken(recording, channel).iter().map(|&k| {
                let model = reading(&readings[k], channel);
                (measured[k] - recording.channels[channel].counts(model)) / noise
            }));
        }
        DVector::from_vec(residuals)
    }

    /// The rows of each recording among the residuals.
    fn rows(&self) -> Vec<Range<usize>> {
        let of_each = |blocks: &[Block]| blocks[0].rows.start..blocks[CHANNELS.len() - 1].rows.end;
        self.blocks().chunks(CHANNELS.len()).map(of_each).collect()
    }

    /// Where each channel stands among the residuals.
    pub fn blocks(&self) -> Vec<Block> {
        let mut start = 0;
        let mut blocks = Vec::new();
        for recording in self.recordings {
            for channel in 0..CHANNELS.len() {
                let rows = start..start + self.taken(recording, channel).len();
                start = rows.end;
                blocks.push(Block { channel, rows });
            }
        }
        blocks
    }

    /// The mean square of the residuals at a point; infinite where there are none.
    pub fn mean_square(&self, u: &[f64]) -> f64 {
        self.residuals(u).map_or(f64::INFINITY, |r| r.norm_squared() / r.len() as f64)
    }

    /// What residuals say of each channel.
    pub fn channel_fits(&self, residuals: &DVector<f64>) -> [Option<ChannelFit>; CHANNELS.len()] {
        std::array::from_fn(|channel| {
            let blocks = self.blocks().into_iter().filter(|block| block.channel == channel);
            let (mut samples, mut squares, mut products) = (0, 0.0, 0.0);
            for block in blocks {
                let of = &residuals.as_slice()[block.rows];
                samples += of.len();
                squares += of.iter().map(|r| r * r).sum::<f64>();
                products += of.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>();
            }
            let after = self.noise[channel] * (squares / samples as f64).sqrt();
            let rest = rest(self.recordings, channel);
            (samples > 1).then_some(ChannelFit {
                samples,
                before: after,
                after,
                correlation: products / squares,
                noise: noise_at_rest(self.recordings, channel),
                rest: rest.freedom,
            })
        })
    }

    /// Column by column: the recordings that depend on an unknown are followed with it moved by `steps`.
    fn moved(&self, u: &[f64], step: impl Fn(usize) -> f64) -> Vec<Option<DVector<f64>>> {
        let points: Vec<Vec<f64>> = (0..self.unknowns())
            .map(|i| {
                let mut point = u.to_vec();
                point[i] += step(i);
                point
            })
            .collect();
        let jobs: Vec<Job<'_>> = points
            .iter()
            .enumerate()
            .flat_map(|(i, u)| self.recordings_of(i).map(move |recording| Job { u, recording }))
            .collect();
        let mut found = self.follow_all(&jobs).into_iter();
        (0..self.unknowns())
            .map(|i| {
                let parts: Vec<_> = found.by_ref().take(self.recordings_of(i).len()).collect();
                Some(stacked(parts.into_iter().collect::<Option<Vec<_>>>()?))
            })
            .collect()
    }

    /// The recordings that an unknown has to do with.
    fn recordings_of(&self, unknown: usize) -> Range<usize> {
        match unknown.checked_sub(self.parameters.len()) {
            None => 0..self.recordings.len(),
            Some(i) => i / STARTS..i / STARTS + 1,
        }
    }

    fn difference(&self, unknown: usize) -> f64 {
        if unknown < self.parameters.len() { DIFFERENCE } else { DIFFERENCE_OF_START }
    }

    /// The rows of the residuals that an unknown has to do with.
    fn rows_of(&self, unknown: usize) -> Range<usize> {
        let (rows, of) = (self.rows(), self.recordings_of(unknown));
        rows[of.start].start..rows[of.end - 1].end
    }

    /// Column by column, the derivatives from a difference of `part` steps.
    fn differences(&self, u: &[f64], at: &DVector<f64>, part: f64) -> Option<Vec<DVector<f64>>> {
        let moved = self.moved(u, |i| part * self.difference(i));
        let difference = |(i, moved): (usize, Option<DVector<f64>>)| {
            let rows = self.rows_of(i);
            Some((moved? - at.rows(rows.start, rows.len())) / (part * self.difference(i)))
        };
        moved.into_iter().enumerate().map(difference).collect()
    }

    /// The matrix of these columns, and the derivatives of the terms of the unknowns.
    fn matrix(&self, columns: Vec<DVector<f64>>) -> DMatrix<f64> {
        let data = self.rows().last().map_or(0, |rows| rows.end);
        let mut jacobian = DMatrix::zeros(data + self.unknowns(), self.unknowns());
        for (i, column) in columns.into_iter().enumerate() {
            jacobian.view_mut((self.rows_of(i).start, i), (column.len(), 1)).copy_from(&column);
            jacobian[(data + i, i)] = 1.0 / ALLOWED;
        }
        jacobian
    }
}

/// The mean of the derivatives to both sides; across a jump of the residuals, that of the side without it.
fn smooth(up: DVector<f64>, down: DVector<f64>) -> DVector<f64> {
    match up.norm() / down.norm() {
        ratio if ratio > JUMP => down,
        ratio if ratio < 1.0 / JUMP => up,
        _ => 0.5 * (up + down),
    }
}

/// Scatter of a channel in all rests together.
fn rest(recordings: &[Recording], channel: usize) -> super::recording::Rest {
    let mut sum = super::recording::Rest::default();
    for recording in recordings {
        sum.squares += recording.channels[channel].rest.squares;
        sum.freedom += recording.channels[channel].rest.freedom;
    }
    sum
}

/// Of a channel, counts; not less than rounding.
fn noise_at_rest(recordings: &[Recording], channel: usize) -> f64 {
    let rest = rest(recordings, channel);
    (rest.squares / rest.freedom.max(1.0)).sqrt().max(ROUNDING)
}

fn stacked(parts: Vec<DVector<f64>>) -> DVector<f64> {
    DVector::from_vec(parts.iter().flat_map(|part| part.iter().copied()).collect())
}

impl Problem for Model<'_> {
    fn residuals(&self, u: &[f64]) -> Option<DVector<f64>> {
        let jobs: Vec<_> = (0..self.recordings.len()).map(|recording| Job { u, recording }).collect();
        let mut parts = self.follow_all(&jobs).into_iter().collect::<Option<Vec<_>>>()?;
        parts.push(DVector::from_iterator(u.len(), u.iter().map(|u| u / ALLOWED)));
        Some(stacked(parts))
    }

    fn jacobian(&self, u: &[f64], at: &DVector<f64>) -> Option<DMatrix<f64>> {
        let up = self.differences(u, at, 1.0);
        // Where there is no valid rig on one side, there is on the other.
        let down = if self.fine || up.is_none() { self.differences(u, at, -1.0) } else { None };
        let columns = match (up, down) {
            (Some(up), Some(down)) => up.into_iter().zip(down).map(|(up, down)| smooth(up, down)).collect(),
            (up, down) => up.or(down)?,
        };
        Some(self.matrix(columns))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_derivative_does_not_reach_across_a_jump() {
        let [slope, jump] = [1.0, 800.0].map(|value| DVector::from_element(3, value));
        assert_eq!(smooth(slope.clone(), jump.clone()), slope);
        assert_eq!(smooth(jump, slope.clone()), slope);
        assert_eq!(smooth(slope.clone(), 1.2 * &slope)[0], 1.1);
    }
}
