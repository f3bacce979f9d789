//! A plant under known commands: the commands recorded on a rig drive its model.
//!
//! The loop is not closed a second time. With a model instead of the rig, a controller would give other commands, and
//! the two closed loops would diverge. With the recorded commands, a deviation is due to the plant alone.

use pneudrive_controller::Command;

pub use crate::component::sensors::calibration::Reading;
use crate::plant::{Accuracy, Plant};
use crate::values::Rig;
use pneudrive_solver::IntegrationError;

/// Sample period and delay of the output after the sample, whole microseconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timing {
    /// From sample to sample.
    pub period_us: u64,
    /// From a sample to its output; less than the period.
    pub delay_us: u64,
}

/// The result of following commands.
#[derive(Clone, Debug)]
pub struct Followed {
    /// The readings, sample by sample; fewer than commands if the run was given up or failed.
    pub readings: Vec<Reading>,
    /// Evaluations of the right-hand side that it took.
    pub evaluations: u64,
    /// Why it failed, if it did.
    pub failed: Option<IntegrationError>,
}

/// The readings at the samples 0, 1, 2... of the plant of `rig`, in the initial state of its test, under the commands
/// computed from these samples. There are as many readings as commands. They are true values, without the errors of
/// the sensors' scales.
///
/// ```
/// use pneudrive_sim::follow::{Timing, follow};
/// use pneudrive_sim::{Accuracy, Rig, run};
///
/// // The commands of a run lead its own plant along the same way.
/// let rig = Rig::builtin("servo-a").expect("a built-in rig").with_settings(&["test.duration_s=0.2"])?;
/// let (run, timing) = (run(&rig, Accuracy::of(&rig))?, Timing { period_us: 1300, delay_us: 500 });
/// let readings = follow(&rig, Accuracy::default(), timing, &run.commands)?;
/// let off = run.readings.iter().zip(&readings).map(|(one, other)| (one.position - other.position).abs());
/// assert_eq!(readings.len(), run.commands.len());
/// assert!(off.fold(0.0, f64::max) < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When the integration fails.
pub fn follow(
    rig: &Rig,
    accuracy: Accuracy,
    timing: Timing,
    commands: &[Command],
) -> Result<Vec<Reading>, IntegrationError> {
    let Followed { readings, failed, .. } = follow_within(rig, accuracy, timing, commands, u64::MAX);
    failed.map_or(Ok(readings), Err)
}

/// The same, given up at the first sample that takes more than `most` evaluations of the right-hand side altogether.
#[must_use]
pub fn follow_within(
    rig: &Rig,
    accuracy: Accuracy,
    timing: Timing,
    commands: &[Command],
    most: u64,
) -> Followed {
    let mut plant = Plant::new(rig, accuracy, 0).with_timing(timing.period_us, timing.delay_us);
    let mut readings = Vec::with_capacity(commands.len());
    let mut sample = |plant: &mut Plant, command: Command| {
        readings.push(plant.reading()?);
        plant.command(command);
        plant.next_sample()
    };
    let evaluations = |plant: &Plant| plant.work().integrator.n_rhs_evaluations;
    let mut failed = None;
    for &command in commands {
        failed = sample(&mut plant, command).err();
        if failed.is_some() || evaluations(&plant) > most {
            break;
        }
    }
    Followed { evaluations: evaluations(&plant), readings, failed }
}
