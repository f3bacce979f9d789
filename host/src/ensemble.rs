//! A run with its neighbours: the same drive, its mass and its starting position changed by next to nothing.
//!
//! A closed loop can depend on less than anyone knows of a rig: a part in a hundred thousand of the mass may decide
//! whether a piston sticks here or a count further on. One run is then one draw of many. Its neighbours show what the
//! others look like, and every figure of the run is stated as the range over all of them.
//!
//! With a relative change s, the neighbours i = 1..n lie evenly around the nominal rig,
//!
//! ```text
//! mass (1 + s cos a_i),   position + s stroke sin a_i,   a_i = 2 pi (i - 1/3) / n
//! ```
//!
//! The nominal run is integrated until it is decided (see [`pneudrive_sim::decision`]); its neighbours are draws, for
//! which a coarser tolerance will do.

use std::f64::consts::TAU;
use std::sync::Mutex;

use anyhow::{Context, Result};
use pneudrive_sim::rig::Problems;
use pneudrive_sim::{Accuracy, Decision, Rig, Run, decide, run, run_watched};

use crate::band::Band;
use crate::parallel;

/// How many runs, and how far they are apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spacing {
    /// Runs in all, the nominal one among them; 1: that alone.
    pub runs: usize,
    /// Relative change of the mass, and of the starting position over the stroke.
    pub relative: f64,
}

impl Default for Spacing {
    fn default() -> Self {
        Spacing { runs: 8, relative: 1e-5 }
    }
}

/// A run, and what is known of how far it can be trusted.
#[derive(Clone, Debug)]
pub struct Judged {
    /// The run of the rig as it is.
    pub run: Run,
    /// How exactly it was integrated.
    pub accuracy: Accuracy,
    /// Whether it is decided.
    pub decision: Decision,
    /// What it and its neighbours cover; None of a run alone.
    pub band: Option<Band>,
    /// How many neighbours it has, and how far away.
    pub spacing: Spacing,
}

/// A run and what was measured of it and of its neighbours.
#[derive(Clone, Debug)]
pub struct Ensemble<T> {
    /// The nominal run.
    pub nominal: Judged,
    /// What was measured of each run, the nominal one first.
    pub measured: Vec<T>,
}

/// What one thread does.
enum Job {
    Nominal,
    Decision,
    Neighbour(usize),
}

/// The rigs around a rig.
///
/// # Errors
/// When a neighbour is not valid: the file's values lie at a limit.
pub fn neighbours(rig: &Rig, spacing: Spacing) -> Result<Vec<Rig>, Problems> {
    let (mass, position) = (rig.number("load.mass_kg"), rig.number("test.position_m"));
    let stroke = rig.number("actuator.stroke_m");
    let count = spacing.runs.saturating_sub(1);
    let neighbour = |i: usize| {
        let angle = TAU * (i as f64 + 2.0 / 3.0) / count as f64;
        let place = position + spacing.relative * stroke * libm::sin(angle);
        rig.with_numbers(&[
            ("load.mass_kg", mass * (1.0 + spacing.relative * libm::cos(angle))),
            ("test.position_m", place.clamp(0.0, stroke)),
        ])
    };
    (0..count).map(neighbour).collect()
}

/// Runs a rig and its neighbours on all processors, and measures each. `progress` is given what is done and what is
/// to do, in samples of one run.
///
/// # Errors
/// When a run cannot be simulated.
pub fn run_ensemble<T: Send>(
    rig: &Rig,
    accuracy: Accuracy,
    spacing: Spacing,
    measure: impl Fn(&Rig, &Run) -> T + Sync,
    mut progress: impl FnMut(u64, u64),
) -> Result<Ensemble<T>> {
    let others =
        neighbours(rig, spacing).context("a neighbour of this rig is not valid; write --ensemble 1")?;
    let samples = u64::from(rig.last_sample()).max(1);
    let all = samples * (others.len() as u64 + 2);
    let nominal = run_watched(rig, accuracy, |done, _| progress(u64::from(done), all))
        .with_context(|| format!("{} cannot be simulated", rig.name()))?;
    let band = Mutex::new(Band::of(&nominal));
    let jobs: Vec<Job> =
        [Job::Nominal, Job::Decision].into_iter().chain((0..others.len()).map(Job::Neighbour)).collect();
    let draw = Accuracy { tolerance: Accuracy::of_draw(rig).tolerance.max(accuracy.tolerance), ..accuracy };
    let done = parallel::map(
        &jobs,
        parallel::processors(),
        |job| match job {
            Job::Nominal => Ok(Done::Measured(measure(rig, &nominal))),
            Job::Decision => Ok(Done::Decided(decide(rig, accuracy, &nominal).unwrap_or(Decision::UNKNOWN))),
            Job::Neighbour(i) => {
                let one = run(&others[*i], draw)
                    .with_context(|| format!("a neighbour of {} cannot be simulated", rig.name()))?;
                band.lock().expect("no thread panics with it").include(&one);
                Ok(Done::Measured(measure(&others[*i], &one)))
            }
        },
        |done| progress(samples * (done as u64).max(1), all),
    );
    let (mut measured, mut decision) = (Vec::with_capacity(spacing.runs), None);
    for one in done.into_iter().collect::<Result<Vec<_>>>()? {
        match one {
            Done::Measured(figures) => measured.push(figures),
            Done::Decided(found) => decision = Some(found),
        }
    }
    let band = band.into_inner().expect("no thread panics with it");
    let nominal = Judged {
        run: nominal,
        accuracy,
        decision: decision.expect("it is one of the jobs"),
        band: (!others.is_empty()).then_some(band),
        spacing,
    };
    Ok(Ensemble { nominal, measured })
}

enum Done<T> {
    Measured(T),
    Decided(Decision),
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rig() -> Rig {
        let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig");
        rig.with_numbers(&[("test.duration_s", 0.5)]).expect("valid")
    }

    #[test]
    fn neighbours_lie_evenly_around_the_rig_at_the_distance_asked_for() {
        let spacing = Spacing { runs: 8, relative: 1e-5 };
        let others = neighbours(&rig(), spacing).expect("valid");
        assert_eq!(others.len(), 7);
        let change = |path: &str, scale: f64| -> Vec<f64> {
            let nominal = rig().number(path);
            others.iter().map(|other| (other.number(path) - nominal) / (scale * 1e-5)).collect()
        };
        let mass = change("load.mass_kg", rig().number("load.mass_kg"));
        let position = change("test.position_m", rig().number("actuator.stroke_m"));
        for (mass, position) in mass.iter().zip(&position) {
            assert!((mass.hypot(*position) - 1.0).abs() < 1e-6, "{mass} {position}");
        }
        assert!(mass.iter().sum::<f64>().abs() < 1e-6 && position.iter().sum::<f64>().abs() < 1e-6);
        assert!(neighbours(&rig(), Spacing { runs: 1, relative: 1e-5 }).expect("none").is_empty());
    }

    #[test]
    fn the_nominal_run_is_the_run_without_its_neighbours_and_its_band_holds_it() {
        let rig = rig();
        let accuracy = Accuracy::of(&rig);
        let end = |_: &Rig, run: &Run| run.rows.last().expect("rows").plant.position;
        let mut told = Vec::new();
        let found = run_ensemble(&rig, accuracy, Spacing::default(), end, |done, all| told.push((done, all)));
        let found = found.expect("runs");
        let alone = run(&rig, accuracy).expect("a run");
        assert_eq!(found.nominal.run.rows.len(), alone.rows.len());
        assert!(found.nominal.run.rows.iter().zip(&alone.rows).all(|(a, b)| a.values() == b.values()));
        assert_eq!(found.measured.len(), 8);
        assert_eq!(found.measured[0], end(&rig, &alone));
        let band = found.nominal.band.expect("a band");
        let [low, high] = band.channel("position_m");
        assert!((low[low.len() - 1]..=high[high.len() - 1]).contains(&found.measured[0]));
        assert!(told.is_sorted() && told.last().is_some_and(|(done, all)| done == all), "{:?}", told.last());
    }

    #[test]
    fn one_run_has_no_band() {
        let rig = rig();
        let spacing = Spacing { runs: 1, ..Spacing::default() };
        let found = run_ensemble(&rig, Accuracy::of(&rig), spacing, |_, _| (), |_, _| {}).expect("a run");
        assert!(found.nominal.band.is_none() && found.measured.len() == 1);
        assert!(found.nominal.decision.closest_edge.is_some());
    }
}
