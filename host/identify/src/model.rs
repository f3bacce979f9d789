//! The comparison of a rig's model with recordings, as a sum of squares.
//!
//! The unknowns are the parameters and, for each recording, its initial state: position and pressures, which sensors
//! resolve only to a count.

use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use anyhow::{Result, ensure};
use nalgebra::DVector;
use pneudrive_sim::component::sensors::calibration::Calibration;
use pneudrive_sim::follow::Reading;
use pneudrive_sim::keys;
use pneudrive_sim::{Accuracy, Rig};
use statrs::statistics::Statistics;

use super::ChannelFit;
use super::budget::Budget;
use super::limits::Limit;
use super::parameter::Parameter;
use super::recording::{AIR, CHANNELS, Channel, PRESSURES, Recording, SIDE, STARTS, reading, remembers};
use pneudrive_evaluate::cancel::CancelToken;
use pneudrive_evaluate::parallel;

/// What u = 1 is of a quantity of an initial state, counts; its prior standard deviation.
const COUNTS: f64 = 10.0;

/// The same of the side of a hysteresis, of which no place is more likely than another: 1 / sqrt(3).
const OF_SIDE: f64 = 0.577_350_269_189_625_8;

/// The same of the temperature of a chamber, K: what a second of rest leaves of the warmth of a move.
const KELVINS: f64 = 10.0;

/// In the order of an initial state.
const OF_START: [f64; STARTS] = [COUNTS, COUNTS, COUNTS, KELVINS, KELVINS, OF_SIDE];

/// Pressures that scatter by so many standard deviations of their noise are not the same.
const CLEARLY: f64 = 5.0;

/// Longest step of a search along a quantity of an initial state, in u.
const LONGEST_OF_START: f64 = 0.3;

/// Root of the mean squared error of rounding to whole counts.
pub(super) const ROUNDING: f64 = 0.288_675_134_594_812_9;

/// Coulomb friction is not above stiction.
const FRICTIONS: [(&str, &str); 3] = [
    (keys::friction::COULOMB_EXTEND_N.key.path, keys::friction::STATIC_EXTEND_N.key.path),
    (keys::friction::COULOMB_RETRACT_N.key.path, keys::friction::STATIC_RETRACT_N.key.path),
    (keys::solenoid::COULOMB_FRICTION_N.key.path, keys::solenoid::STATIC_FRICTION_N.key.path),
];

/// By how much of it, at least: what is equal but for rounding is no valid rig.
const APART: f64 = 1e-9;

/// The model, the data, and what is fitted.
#[derive(Clone, Debug)]
pub(super) struct FittedModel<'a> {
    /// The rig with the file's values.
    pub rig: Rig,
    /// The recordings.
    pub recordings: &'a [Recording],
    /// The first of the unknowns, in the order of u.
    pub parameters: Vec<Parameter>,
    /// The quantities of an initial state that are unknown, by their places.
    starts: Vec<usize>,
    /// Accuracy of the runs.
    accuracy: Accuracy,
    /// sigma of each channel, counts.
    pub noise: [f64; CHANNELS.len()],
    /// Share of each recording that counts.
    pub share: f64,
    /// Whether the search is fine: derivatives from differences to both sides.
    pub fine: bool,
    /// Whether somebody waits for the fit.
    pub cancel: CancelToken<'a>,
    /// Runs of a recording so far, counted together with those of its copies.
    runs: Arc<AtomicUsize>,
    /// What may be spent, likewise.
    pub budget: Budget,
}

/// The rows of a channel of a recording among the residuals.
pub(super) struct Block {
    /// Place in [`CHANNELS`].
    pub channel: usize,
    /// The rows.
    pub rows: Range<usize>,
}

/// A recording to be followed at a point.
pub(super) struct Job<'u> {
    /// The point.
    pub u: &'u [f64],
    /// Place of the recording.
    pub recording: usize,
}

impl<'a> FittedModel<'a> {
    pub fn new(
        rig: &Rig,
        recordings: &'a [Recording],
        parameters: Vec<Parameter>,
        accuracy: Accuracy,
    ) -> FittedModel<'a> {
        let (remembers, goes_on) = (remembers(rig), goes_on(recordings));
        let is_unknown = |place: &usize| match *place {
            SIDE => remembers,
            place => goes_on || !AIR.contains(&place),
        };
        FittedModel {
            rig: rig.clone(),
            recordings,
            parameters,
            starts: (0..STARTS).filter(is_unknown).collect(),
            accuracy,
            noise: first_noise(recordings),
            share: 1.0,
            fine: false,
            cancel: CancelToken::NEVER,
            runs: Arc::default(),
            budget: Budget::default(),
        }
    }

    /// The same model of another rig.
    pub fn of_rig(&self, rig: Rig) -> FittedModel<'a> {
        FittedModel { rig, ..self.clone() }
    }

    /// The same model with more parameters.
    pub fn with(&self, more: &[Parameter]) -> FittedModel<'a> {
        FittedModel { parameters: [&self.parameters[..], more].concat(), ..self.clone() }
    }

    /// Unknowns of the initial state of a recording.
    pub fn unknowns_of_start(&self) -> usize {
        self.starts.len()
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.parameters.len() + self.starts.len() * self.recordings.len()
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
        Ok(self.rig.with_numbers(&self.values_at(u).collect::<Vec<_>>())?)
    }

    /// The values of the parameters at a point, each with its key.
    fn values_at(&self, u: &[f64]) -> impl Iterator<Item = (&'static str, f64)> {
        self.parameters.iter().zip(u).map(|(parameter, &u)| (parameter.key.path, parameter.value(u)))
    }

    /// Why there are no residuals at a point: the first recording that cannot be followed, and its error. None where
    /// there are.
    pub fn failure(&self, u: &[f64]) -> Option<anyhow::Error> {
        (0..self.recordings.len()).find_map(|recording| {
            let failed = self.try_to_follow(&Job { u, recording }).err()?;
            Some(failed.context(self.recordings[recording].name.clone()))
        })
    }

    /// How far the initial state of a recording is off the measured one at a point, counts, and the side of its hysteresis.
    pub fn start_at(&self, u: &[f64], recording: usize) -> [f64; STARTS] {
        let first = self.parameters.len() + self.starts.len() * recording;
        let mut off = [0.0; STARTS];
        for (i, &place) in self.starts.iter().enumerate() {
            off[place] = OF_START[place] * u[first + i];
        }
        off
    }

    /// The calibration errors at a point.
    fn calibration_at(&self, u: &[f64]) -> Calibration {
        let found = |path: &str| {
            let place = self.parameters.iter().position(|parameter| parameter.key.path == path)?;
            Some(self.parameters[place].value(u[place]))
        };
        Calibration::of(|key| found(key.path).unwrap_or_else(|| self.rig.get(key)))
    }

    fn samples(&self, recording: &Recording) -> usize {
        (recording.commands.len() as f64 * self.share).ceil() as usize
    }

    fn try_to_follow(&self, job: &Job<'_>) -> Result<DVector<f64>> {
        self.cancel.check()?;
        let recording = &self.recordings[job.recording];
        self.runs.fetch_add(1, Ordering::Relaxed);
        let off = self.start_at(job.u, job.recording);
        let start = recording.start(&self.rig, off, &self.calibration_at(job.u));
        let values = self.values_at(job.u).chain(start).collect::<Vec<_>>();
        let rig = self.rig.with_numbers(&values)?;
        let samples = self.samples(recording);
        let (readings, spent) = recording.follow(&rig, self.accuracy, samples, Budget::of_a_run(samples));
        self.budget.spend(spent);
        let residuals = self.compare(recording, &readings?);
        ensure!(residuals.iter().all(|r| r.is_finite()), "the model's readings are not finite numbers");
        Ok(residuals)
    }

    /// The residuals of each job, on all cores.
    pub fn follow_all(&self, jobs: &[Job<'_>]) -> Vec<Option<DVector<f64>>> {
        parallel::map(jobs, |job| self.try_to_follow(job).ok(), |_| {})
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
    pub fn rows(&self) -> Vec<Range<usize>> {
        let of_each = |blocks: &[Block]| blocks[0].rows.start..blocks[CHANNELS.len() - 1].rows.end;
        self.blocks().chunks(CHANNELS.len()).map(of_each).collect()
    }

    /// The range of each channel within the residuals.
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

    /// The rows of a channel, and what was measured there, counts.
    pub fn rows_of_channel(&self, channel: usize) -> impl Iterator<Item = (usize, f64)> {
        let blocks = self.blocks().into_iter().filter(move |block| block.channel == channel);
        blocks.zip(self.recordings).flat_map(move |(block, recording)| {
            let taken = self.taken(recording, channel).iter();
            block.rows.zip(taken.map(move |&k| recording.channels[channel].measured[k]))
        })
    }

    /// The mean square of the residuals at a point; infinite where there are none.
    pub fn mean_square(&self, u: &[f64]) -> f64 {
        self.residuals_at(u).map_or(f64::INFINITY, |r| r.norm_squared() / r.len() as f64)
    }

    /// The residuals of each channel.
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
            (samples > 1).then_some(ChannelFit {
                samples,
                before: after,
                after,
                correlation: products / squares,
                noise: self.noise[channel],
            })
        })
    }

    /// Standard deviation of an unknown before there are data, in u.
    pub fn prior(&self, unknown: usize) -> f64 {
        self.parameters.get(unknown).map_or(1.0, |parameter| parameter.prior)
    }

    /// Longest step of a search along an unknown, in u.
    pub fn longest(&self, unknown: usize) -> f64 {
        self.parameters.get(unknown).map_or(LONGEST_OF_START, |parameter| parameter.longest)
    }

    /// The residuals at a point, and after them the terms of the unknowns; None where it cannot be evaluated.
    pub fn residuals_at(&self, u: &[f64]) -> Option<DVector<f64>> {
        let jobs: Vec<_> = (0..self.recordings.len()).map(|recording| Job { u, recording }).collect();
        let mut parts = self.follow_all(&jobs).into_iter().collect::<Option<Vec<_>>>()?;
        parts.push(DVector::from_iterator(u.len(), u.iter().enumerate().map(|(i, u)| u / self.prior(i))));
        Some(stacked(parts))
    }

    /// What parameters keep: the ranges of their keys, and Coulomb friction below stiction.
    pub fn limits(&self) -> Vec<Limit> {
        let ranges = self.parameters.iter().enumerate().flat_map(|(i, parameter)| {
            let [low, high] = parameter.limits();
            [Limit::at_least(i, low), Limit::at_most(i, high)]
        });
        let frictions = FRICTIONS.iter().filter_map(|(coulomb, stiction)| self.below(coulomb, stiction));
        // A side is from -1 to 1.
        let first = self.parameters.len();
        let is_side = |i: &usize| self.starts[(i - first) % self.starts.len()] == SIDE;
        let sides = (first..self.unknowns()).filter(is_side);
        let sides =
            sides.flat_map(|i| [Limit::at_least(i, -1.0 / OF_SIDE), Limit::at_most(i, 1.0 / OF_SIDE)]);
        ranges.chain(frictions).chain(sides).filter(|limit| limit.bound.is_finite()).collect()
    }

    /// The value of one key is not above that of another, where either is fitted.
    fn below(&self, low: &str, high: &str) -> Option<Limit> {
        let place = |path: &str| self.parameters.iter().position(|parameter| parameter.key.path == path);
        match (place(low), place(high)) {
            (Some(low), Some(high)) => {
                let bound = (self.parameters[high].start / self.parameters[low].start).ln() - APART;
                Some(Limit { above: Some(low), below: Some(high), bound })
            }
            (Some(i), None) => Some(Limit::at_most(
                i,
                self.parameters[i].u(self.rig.number_at(high).unwrap_or(f64::INFINITY)) - APART,
            )),
            (None, Some(i)) => Some(Limit::at_least(
                i,
                self.parameters[i].u(self.rig.number_at(low).unwrap_or(f64::NEG_INFINITY)) + APART,
            )),
            (None, None) => None,
        }
    }
}

/// Whether a drive goes on between its tests: its pressures at their starts scatter by more than noise. It then has air that is as
/// warm as its last moves have left it. One that begins each test anew, as a simulated one does, has the same air each time.
fn goes_on(recordings: &[Recording]) -> bool {
    PRESSURES.into_iter().any(|channel| {
        let starts = recordings.iter().map(|recording| recording.channels[channel].measured[0]);
        starts.std_dev() > CLEARLY * noise_at_rest(recordings, channel)
    })
}

/// Scatter of a channel in all rests together.
pub(super) fn rest(recordings: &[Recording], channel: usize) -> super::recording::Rest {
    let mut sum = super::recording::Rest::default();
    for recording in recordings {
        sum.squares += recording.channels[channel].rest.squares;
        sum.freedom += recording.channels[channel].rest.freedom;
    }
    sum
}

/// What the search begins with, counts. Under a dither the rests do not tell the noise of the spool, which sticks and
/// slips; its converter is taken to be as good as those of the pressures.
pub(super) fn first_noise(recordings: &[Recording]) -> [f64; CHANNELS.len()] {
    let mut noise = std::array::from_fn(|channel| noise_at_rest(recordings, channel));
    noise[3] = noise[3].min(noise[1].max(noise[2]));
    noise
}

/// Standard deviation of a channel, counts; at least that of rounding.
pub(super) fn noise_at_rest(recordings: &[Recording], channel: usize) -> f64 {
    let rest = rest(recordings, channel);
    (rest.squares / rest.freedom.max(1.0)).sqrt().max(ROUNDING)
}

/// One below the other.
pub(super) fn stacked(parts: Vec<DVector<f64>>) -> DVector<f64> {
    DVector::from_vec(parts.iter().flat_map(|part| part.iter().copied()).collect())
}
