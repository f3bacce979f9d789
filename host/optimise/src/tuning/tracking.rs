//! How the drive follows a sine in mid-stroke, with the gains of the file and with those that were found.
//!
//! The setpoint swings about the middle of the range of the steps by a fifth of the stroke, 60 mm at most, or as far as that
//! range goes. It makes three swings. The first one begins at full speed and is left out.
//!
//! | run on | shows |
//! |---|---|
//! | the rig of the file and its perturbed runs | the figures with their range, and their limits ([`limit`]) |
//! | the first of the fresh draws | the range over the spread of load, friction and supply |
//!
//! `tune` does not search for a feed-forward. If the file has none, the sines are also followed with as much
//! feed-forward as feedback, so that the page shows its effect.

pub mod limit;
pub mod sine;

use anyhow::Result;
use pneudrive_sim::{Rig, keys};

use super::drive::{Meter, Stage};
use super::trial::{DWELL_S, MEMBERS, Trial};
use super::{Progress, Task, Tuned, Variant};
use limit::Following;
use pneudrive_evaluate::cancel::{CancelToken, Cancelled};
use pneudrive_evaluate::parallel;
use sine::Sine;

/// Frequencies of the sines, Hz.
pub const FREQUENCIES_HZ: [f64; 2] = [0.5, 1.0];

/// This many of the fresh draws are used.
const DRAWS: usize = 20;

/// The gains with which a sine is followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gains {
    /// The file's gains.
    OfFile,
    /// Those that were found.
    Found,
    /// The same gains or, if none were found, the file's, with as much feed-forward as feedback.
    FeedForward,
}

/// How a sine is followed.
#[derive(Clone, Debug)]
pub struct Tracked {
    /// The sine.
    pub sine: Sine,
    /// The gains.
    pub gains: Gains,
    /// The gains as `key=value`, if they are not the file's.
    pub settings: Vec<String>,
    /// The errors on the rig of the file, first, and on its perturbed runs; for a run that did not complete, the reason.
    pub runs: Vec<Result<Following, String>>,
    /// The errors on fresh draws.
    pub draws: Vec<Result<Following, String>>,
}

/// Follows the sines with the gains of the file, those that were found, and feed-forward; as many as there is time for, until
/// `cancel` ends it.
///
/// # Errors
/// When they cannot be simulated.
pub(crate) fn tracked(
    task: &Task,
    tuned: &Tuned,
    mut progress: impl FnMut(Progress) + Send,
    cancel: CancelToken<'_>,
) -> Result<Vec<Tracked>> {
    let trial = Trial::of(task, &[])?;
    let draws = &tuned.fresh[..tuned.fresh.len().min(DRAWS)];
    let all = gains(&trial, tuned)?;
    let mut meter = Meter::new(&mut progress);
    meter.begin(Stage::Sines, FREQUENCIES_HZ.len() * all.len() * (MEMBERS + draws.len()));
    let mut tracked = Vec::new();
    for frequency_hz in FREQUENCIES_HZ {
        let sine = Sine::of(&trial, frequency_hz);
        for (gains, settings) in all.iter().take_while(|_| cancel.is_live()) {
            let nominal = trial.rig_on(&sine.course(), settings, &Variant::NOMINAL)?;
            let follow = |rig: &Rig, run: &_| Following::of(&sine, rig, run);
            let runs = Trial::measure_members(&nominal, follow)?;
            meter.done(MEMBERS);
            let on_draw = |draw: &Variant| {
                if cancel.is_live() {
                    on_draw(&trial, &sine, settings, draw)
                } else {
                    Err(Cancelled.to_string())
                }
            };
            let draws = parallel::map(draws, on_draw, |_| meter.done(1));
            tracked.push(Tracked { sine, gains: *gains, settings: settings.clone(), runs, draws });
        }
    }
    Ok(tracked)
}

/// How long the sines take, in runs of the step.
#[must_use]
pub fn steps_worth(task: &Task) -> f64 {
    let sines: f64 = FREQUENCIES_HZ.iter().map(|hz| sine::lasts_s(*hz)).sum();
    let step = DWELL_S + 2.0 * task.goal.time_s;
    sines / step * (3 * (MEMBERS + task.draws.min(DRAWS))) as f64
}

fn on_draw(trial: &Trial, sine: &Sine, gains: &[String], draw: &Variant) -> Result<Following, String> {
    let rig = trial.rig_on(&sine.course(), gains, draw).map_err(|problems| problems.to_string())?;
    trial.measure(&rig, |run| Following::of(sine, &rig, run))
}

/// Every set of gains that the sines are followed with, as `key=value`.
fn gains(trial: &Trial, tuned: &Tuned) -> Result<Vec<(Gains, Vec<String>)>> {
    let found = &tuned.after.settings;
    let mut all = vec![(Gains::OfFile, Vec::new())];
    if tuned.is_changed() {
        all.push((Gains::Found, found.clone()));
    }
    let rig = trial.with(found)?;
    if !rig.knows_its_drive() && !feeds_forward(&rig) {
        let as_feedback = [
            (keys::controller::VELOCITY_FEED_FORWARD.path, rig.get(&keys::controller::VELOCITY_GAIN)),
            (keys::controller::ACCELERATION_FEED_FORWARD.path, rig.get(&keys::controller::ACCELERATION_GAIN)),
        ];
        let more = as_feedback.map(|(key, gain)| format!("{key}={gain}"));
        all.push((Gains::FeedForward, found.iter().cloned().chain(more).collect()));
    }
    Ok(all)
}

/// Whether a rig's law adds the setpoint's own motion.
#[must_use]
pub(crate) fn feeds_forward(rig: &Rig) -> bool {
    rig.get(&keys::controller::VELOCITY_FEED_FORWARD) != 0
        || rig.get(&keys::controller::ACCELERATION_FEED_FORWARD) != 0
}
