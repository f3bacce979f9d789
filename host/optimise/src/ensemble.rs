//! A run with its perturbed runs: the same drive with very slightly different mass and starting position.
//!
//! A closed loop can depend on details that nobody knows of a rig: a hundred-thousandth of the mass may decide whether
//! a piston sticks here or a count further on. A single run is then one draw of many. Its perturbed runs show the others,
//! and every figure of the run is stated as the range over all of them.
//!
//! With a relative change s, the perturbed runs i = 0, 1, ... lie around the nominal rig,
//!
//! ```text
//! mass (1 + s cos a_i),   position + s stroke sin a_i,   a_i = 2 pi (b_i + 1/24)
//! ```
//!
//! with b_i = 0, 1/2, 1/4, 3/4, 1/8, ... , the binary digits of i after the point in reverse order (van der Corput). They
//! are nearly even for any number of them, and a longer sequence contains the shorter one, so a range only grows with it.
//!
//! The nominal run is integrated until it has converged (see [`pneudrive_sim::convergence`]); of its perturbed runs the error
//! is to be small beside s, for which a coarser tolerance will do.

use std::f64::consts::TAU;
use std::sync::Mutex;

use anyhow::{Context, Result};
use pneudrive_controller::Fault;
use pneudrive_records::band::Band;
use pneudrive_records::judged::{FailedMembers, Judged, Spacing};
use pneudrive_sim::keys;
use pneudrive_sim::rig::Problems;
use pneudrive_sim::trace::Extra;
use pneudrive_sim::{Accuracy, Convergence, Recording, Rig, Run, check_convergence, run_recorded};

use crate::runners::Runners;
use pneudrive_evaluate::cancel::{CancelToken, Cancelled};
use pneudrive_evaluate::parallel;

/// A run, and the measurements of it and of its perturbed runs.
#[derive(Clone, Debug)]
pub struct Ensemble<T> {
    /// The nominal run.
    pub nominal: Judged,
    /// The measurements of each run, the nominal one first; empty for a perturbed run that failed.
    pub measured: Vec<T>,
}

/// The work of one thread.
enum Job {
    Nominal,
    Convergence,
    Member(Rig),
}

/// The result of a job.
enum Done<T> {
    Measured(T, Option<Fault>),
    Converged(Convergence),
    Failed(String),
}

/// The rigs around a rig. If one is not valid, because a value is at a limit of its key, the problem takes its place.
#[must_use]
pub fn members(rig: &Rig, spacing: Spacing) -> Vec<Result<Rig, Problems>> {
    let (mass, position) = (rig.get(&keys::load::MASS_KG), rig.get(&keys::test::POSITION_M));
    let stroke = rig.get(&keys::actuator::STROKE_M);
    let count = spacing.runs.saturating_sub(1);
    let member = |i: usize| {
        let angle = TAU * (reversed(i, 2) + 1.0 / 24.0);
        let place = position + spacing.relative * stroke * libm::sin(angle);
        rig.with_numbers(&[
            (keys::load::MASS_KG.path, mass * (1.0 + spacing.relative * libm::cos(angle))),
            (keys::test::POSITION_M.path, place.clamp(0.0, stroke)),
        ])
    };
    (0..count).map(member).collect()
}

/// The digits of a number to a base behind the point, in the reverse order (van der Corput).
#[must_use]
pub fn reversed(mut number: usize, base: usize) -> f64 {
    let (mut value, mut place) = (0.0, 1.0);
    while number > 0 {
        place /= base as f64;
        value += place * (number % base) as f64;
        number /= base;
    }
    value
}

/// Runs a rig and its perturbed runs on all threads of the pool, and measures each. `progress` receives the work done
/// and the whole work, in samples of one run.
///
/// # Errors
/// When the rig itself cannot be simulated, or nobody waits for it any more ([`Cancelled`]); a run that has begun comes to
/// its end. Failures of perturbed runs are in [`Judged::lost`].
pub fn run_ensemble<T: Send>(
    rig: &Rig,
    accuracy: Accuracy,
    spacing: Spacing,
    measure: impl Fn(&Rig, &Run) -> T + Sync,
    mut progress: impl FnMut(u64, u64) + Send,
    cancel: CancelToken<'_>,
) -> Result<Ensemble<T>> {
    let samples = u64::from(rig.last_sample()).max(1);
    let all = samples * (spacing.runs as u64 + 1);
    let nominal = run_recorded(rig, accuracy, Recording::default(), |done, _| progress(u64::from(done), all))
        .with_context(|| format!("{} cannot be simulated", rig.name()))?;
    let band = Mutex::new(Band::of(&nominal));
    let (jobs, failed) = jobs(rig, spacing);
    let runners = Runners::default();
    let needed = Accuracy::of_member(rig, spacing.relative).tolerance;
    let of_members = Accuracy { tolerance: needed.max(accuracy.tolerance), ..accuracy };
    let carry_out = |job: &Job| match job {
        _ if !cancel.is_live() => Done::Failed(Cancelled.to_string()),
        Job::Nominal => Done::Measured(measure(rig, &nominal), None),
        Job::Convergence => {
            Done::Converged(check_convergence(rig, accuracy, &nominal).unwrap_or(Convergence::UNKNOWN))
        }
        Job::Member(member) => {
            let measured = runners.run(member, of_members, |one| {
                band.lock().expect("no thread panics with it").include(one);
                Done::Measured(measure(member, one), one.fault.map(|(fault, _)| fault))
            });
            measured.unwrap_or_else(|error| Done::Failed(error.to_string()))
        }
    };
    let done = parallel::map(&jobs, carry_out, |done| progress(samples * (done as u64).max(1), all));
    cancel.check()?;
    let Gathered { measured, convergence, lost } = Gathered::of(done, failed);
    let band = (spacing.runs > 1).then(|| band.into_inner().expect("no thread panics with it"));
    let columns = Extra::of_rig(rig);
    let nominal = Judged { run: nominal, accuracy, convergence, band, spacing, lost, columns };
    Ok(Ensemble { nominal, measured })
}

/// The jobs for a rig and its perturbed runs, and why some of the perturbed runs are not valid rigs.
fn jobs(rig: &Rig, spacing: Spacing) -> (Vec<Job>, Vec<String>) {
    let (mut jobs, mut failed) = (vec![Job::Nominal, Job::Convergence], Vec::new());
    for member in members(rig, spacing) {
        match member {
            Ok(member) => jobs.push(Job::Member(member)),
            Err(problems) => failed.push(problems.to_string().replace('\n', "; ")),
        }
    }
    (jobs, failed)
}

/// The results of all jobs.
struct Gathered<T> {
    measured: Vec<T>,
    convergence: Convergence,
    lost: FailedMembers,
}

impl<T> Gathered<T> {
    /// In the order of the jobs; `failed` says why some perturbed runs are not valid rigs.
    fn of(done: Vec<Done<T>>, failed: Vec<String>) -> Gathered<T> {
        let lost = FailedMembers { tripped: Vec::new(), failed };
        let mut all =
            Gathered { measured: Vec::with_capacity(done.len()), convergence: Convergence::UNKNOWN, lost };
        for one in done {
            match one {
                Done::Measured(figures, fault) => {
                    all.measured.push(figures);
                    all.lost.tripped.extend(fault);
                }
                Done::Converged(found) => all.convergence = found,
                Done::Failed(why) => all.lost.failed.push(why),
            }
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneudrive_sim::run;

    fn rig() -> Rig {
        let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig");
        rig.with_numbers(&[("test.duration_s", 0.5)]).expect("valid")
    }

    #[test]
    fn perturbed_runs_lie_around_the_rig_at_the_distance_asked_for_and_more_of_them_are_the_same_and_others()
    {
        let rigs = |runs| -> Vec<Rig> {
            let spacing = Spacing { runs, relative: 1e-5 };
            members(&rig(), spacing).into_iter().collect::<Result<_, _>>().expect("valid")
        };
        let others = rigs(9);
        assert_eq!(others.len(), 8);
        let change = |path: &str, scale: f64| -> Vec<f64> {
            let nominal = rig().number_at(path).expect("a number");
            others
                .iter()
                .map(|other| (other.number_at(path).expect("a number") - nominal) / (scale * 1e-5))
                .collect()
        };
        let mass = change("load.mass_kg", rig().get(&keys::load::MASS_KG));
        let position = change("test.position_m", rig().get(&keys::actuator::STROKE_M));
        for (mass, position) in mass.iter().zip(&position) {
            assert!((mass.hypot(*position) - 1.0).abs() < 1e-6, "{mass} {position}");
        }
        assert!(mass.iter().sum::<f64>().abs() < 1e-6 && position.iter().sum::<f64>().abs() < 1e-6);
        let masses = |rigs: &[Rig]| rigs.iter().map(|rig| rig.get(&keys::load::MASS_KG)).collect::<Vec<_>>();
        assert_eq!(masses(&rigs(5)), masses(&others)[..4]);
        assert!(rigs(1).is_empty());
    }

    #[test]
    fn the_nominal_run_is_the_run_without_its_perturbed_runs_and_its_band_holds_it() {
        let rig = rig();
        let accuracy = Accuracy::of(&rig);
        let end = |_: &Rig, run: &Run| run.rows.last().expect("rows").plant.position;
        let mut told = Vec::new();
        let found = run_ensemble(
            &rig,
            accuracy,
            Spacing::default(),
            end,
            |done, all| told.push((done, all)),
            CancelToken::NEVER,
        );
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
    fn runs_that_are_not_wanted_any_more_are_not_begun() {
        let rig = rig();
        let measured = Mutex::new(0);
        let measure = |_: &Rig, _: &Run| *measured.lock().expect("a lock") += 1;
        let wanted = || *measured.lock().expect("a lock") < 2;
        let found = run_ensemble(
            &rig,
            Accuracy::of(&rig),
            Spacing { runs: 64, relative: 1e-5 },
            measure,
            |_, _| {},
            CancelToken::cancelled_unless(&wanted),
        );
        assert!(found.expect_err("called off").is::<Cancelled>());
        let measured = measured.into_inner().expect("a lock");
        // One more is on its way on each thread at most.
        assert!((2..2 + parallel::threads().get()).contains(&measured), "{measured}");
    }

    #[test]
    fn one_run_has_no_band() {
        let rig = rig();
        let spacing = Spacing { runs: 1, ..Spacing::default() };
        let found = run_ensemble(&rig, Accuracy::of(&rig), spacing, |_, _| (), |_, _| {}, CancelToken::NEVER)
            .expect("a run");
        assert!(found.nominal.band.is_none() && found.measured.len() == 1);
        assert!(found.nominal.convergence.closest_edge.is_some());
    }

    /// At the largest mass that the key takes, there are no heavier perturbed runs.
    #[test]
    fn perturbed_runs_beyond_the_limits_are_told_and_the_run_is_there() {
        let rig = rig().with_numbers(&[("load.mass_kg", 1e5)]).expect("valid");
        let found = run_ensemble(
            &rig,
            Accuracy::of(&rig),
            Spacing::default(),
            |_, _| (),
            |_, _| {},
            CancelToken::NEVER,
        );
        let found = found.expect("the rig itself runs");
        let failed = found.nominal.lost.failed;
        assert!((1..7).contains(&failed.len()) && found.measured.len() == 8 - failed.len());
        assert!(failed[0].contains("load.mass_kg"), "{failed:?}");
    }

    /// Without velocity feedback a load of 58 kg swings into its ends, or not, by a few percent of it.
    #[test]
    fn perturbed_runs_that_trip_are_told_where_the_run_itself_does_not() {
        let text = pneudrive_sim::rigfile::builtin("servo-b-tuned").expect("a built-in rig");
        let settings = ["controller.velocity_gain=0", "load.mass_kg=58"].map(str::to_owned);
        let rig = Rig::read_with("heavy", text, &settings).unwrap_or_else(|problems| panic!("{problems}"));
        let spacing = Spacing { runs: 8, relative: 0.1 };
        let found = run_ensemble(
            &rig,
            Accuracy::of(&rig),
            spacing,
            |_, run| run.fault.is_some(),
            |_, _| {},
            CancelToken::NEVER,
        );
        let found = found.expect("runs");
        let tripped = found.measured.iter().filter(|tripped| **tripped).count();
        assert!(found.nominal.run.fault.is_none() && tripped > 0, "{:?}", found.measured);
        assert_eq!(found.nominal.lost.tripped.len(), tripped);
    }
}
