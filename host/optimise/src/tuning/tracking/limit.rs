//! How a run follows a sine, and its limit.
//!
//! Each sample of the swings belongs to the first of these that holds, and counts with its squared error:
//!
//! | | where | condition there | limit |
//! |---|---|---|
//! | the error is below the dead band, or one count | the law asks for nothing, or cannot see it | resolution |
//! | the command opens the valve fully, in the direction of the error | no gain could ask for more | valve flow |
//! | the piston is slower than a thousandth of the sine's top speed | it stands although it should move | friction |
//! | elsewhere | the piston moves, and the valve could do more | the law, if the error swings with the sine |
//!
//! With amplitude A and angular frequency w, the part of the error e that swings with the sine is, over whole swings,
//!
//! ```text
//! a = 2 mean(e cos wt),   b = 2 mean(e sin wt),   its share of mean(e^2): (a^2 + b^2)/2 / mean(e^2),   behind by a/(w A)
//! ```
//!
//! The limit of a run is the condition that holds where more than half of the squared error arises; the law is the
//! limit only if more than half of the error also swings with the sine. A limit holds for a drive if it holds for the
//! run of the rig of the file and for all its perturbed runs.

use std::f64::consts::TAU;

use pneudrive_sim::component::operator;
use pneudrive_sim::trace::Row;
use pneudrive_sim::{Rig, Run, keys};

use super::sine::Sine;

/// A piston slower than this part of the sine's top speed stands.
const STANDING: f64 = 1e-3;

/// More than this share of the squared error is most of it.
const MAX: f64 = 0.5;

/// The limit of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// Resolution: the dead band and the encoder.
    Resolution,
    /// Friction: the piston sticks.
    Friction,
    /// Valve flow: the valve is fully open.
    ValveFlow,
    /// The law: it needs an error to open the valve.
    Law,
}

/// How a run follows a sine, and where its squared error arises, as shares of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Following {
    /// Largest size of the setpoint less the position, mm.
    pub largest_mm: f64,
    /// Root of its mean square, mm.
    pub rms_mm: f64,
    /// Where the error is within dead band and count.
    pub in_dead_band: f64,
    /// Where the valve is fully open in the direction of the error.
    pub fully_open: f64,
    /// Where it is not, and the piston stands.
    pub standing: f64,
    /// The part of the whole squared error that swings with the sine.
    pub with_sine: f64,
    /// Its delay behind the sine, s.
    pub behind_s: f64,
}

impl Following {
    /// Of the run of a rig.
    ///
    /// # Errors
    /// When the run has no sample of the swings.
    pub(super) fn of(sine: &Sine, rig: &Rig, run: &Run) -> Result<Following, String> {
        let [from, to] = sine.measured_s();
        let swings = || run.rows.iter().filter(|row| (from..to).contains(&row.time));
        let count = swings().count();
        if count == 0 {
            return Err("it has no whole swing".to_owned());
        }
        let mean = |of: &dyn Fn(&Row) -> f64| swings().map(of).sum::<f64>() / count as f64;
        let error = |row: &Row| error_mm(sine, row);
        let phase = |row: &Row| TAU * sine.frequency_hz * (row.time - sine.begins_s);
        let square = mean(&|row| error(row).powi(2));
        let share = |part: f64| if square > 0.0 { part / square } else { 0.0 };
        let places = Places::of(sine, rig);
        let arises =
            |place| share(mean(&|row| if places.of_row(row) == place { error(row).powi(2) } else { 0.0 }));
        let (cosine, sine_part) = (
            2.0 * mean(&|row| error(row) * libm::cos(phase(row))),
            2.0 * mean(&|row| error(row) * libm::sin(phase(row))),
        );
        Ok(Following {
            largest_mm: swings().map(|row| error(row).abs()).fold(0.0, f64::max),
            rms_mm: square.sqrt(),
            in_dead_band: arises(Limit::Resolution),
            fully_open: arises(Limit::ValveFlow),
            standing: arises(Limit::Friction),
            with_sine: share((cosine * cosine + sine_part * sine_part) / 2.0),
            behind_s: cosine / sine.top_speed_mm_s(),
        })
    }

    /// Where the piston moves and the valve could do more.
    #[must_use]
    pub fn moving(&self) -> f64 {
        (1.0 - self.in_dead_band - self.standing - self.fully_open).max(0.0)
    }

    /// The limit of the run; None if it cannot be seen.
    #[must_use]
    pub fn limit(&self) -> Option<Limit> {
        let law = self.moving().min(self.with_sine);
        [
            (Limit::Resolution, self.in_dead_band),
            (Limit::Friction, self.standing),
            (Limit::ValveFlow, self.fully_open),
            (Limit::Law, law),
        ]
        .into_iter()
        .find_map(|(limit, share)| (share > MAX).then_some(limit))
    }
}

/// The limit of a drive: the limit of all its runs.
#[must_use]
pub fn common(runs: &[Result<Following, String>]) -> Option<Limit> {
    let mut limits = runs.iter().map(|run| run.as_ref().ok().and_then(Following::limit));
    let first = limits.next()??;
    limits.all(|limit| limit == Some(first)).then_some(first)
}

fn error_mm(sine: &Sine, row: &Row) -> f64 {
    f64::from(row.observation.setpoint) * sine.mm_per_count - 1e3 * row.plant.position
}

/// The condition at a sample, as the limit that it indicates.
struct Places {
    /// Counts.
    dead_band: i64,
    /// m/s.
    standing: f64,
    /// Counts, or steps.
    full: i64,
    /// Of a solenoid: the gain of its amplifier, and the most that it passes on, m.
    amplifier: Option<(f64, f64)>,
}

impl Places {
    fn of(sine: &Sine, rig: &Rig) -> Places {
        let model = rig.get(&keys::operator::MODEL);
        let amplifier =
            || (rig.get(&keys::amplifier::AMPLIFIER_GAIN), 1e-3 * rig.get(&keys::amplifier::SATURATION_MM));
        Places {
            dead_band: rig.get(&keys::controller::DEAD_BAND_COUNTS).max(1),
            standing: STANDING * 1e-3 * sine.top_speed_mm_s(),
            full: operator::largest_command(rig),
            amplifier: model.is_solenoid().then(amplifier),
        }
    }

    fn of_row(&self, row: &Row) -> Limit {
        let seen = &row.observation;
        if i64::from(seen.error).abs() <= self.dead_band {
            Limit::Resolution
        } else if self.is_fully_open(row) && i32::from(seen.command).signum() == seen.error.signum() {
            Limit::ValveFlow
        } else if row.plant.velocity.abs() < self.standing {
            Limit::Friction
        } else {
            Limit::Law
        }
    }

    fn is_fully_open(&self, row: &Row) -> bool {
        let saturates = |(gain, most): (f64, f64)| gain * row.plant.spool_command.abs() >= most;
        i64::from(row.observation.command).abs() >= self.full || self.amplifier.is_some_and(saturates)
    }
}
