//! Runs of one rig after another in the same memory.
//!
//! A run of a few seconds fills a megabyte. If this memory goes back to the system between two runs, it is mapped and
//! cleared again, which takes a tenth of a short run.

use std::sync::{Mutex, PoisonError};

use pneudrive_sim::{Accuracy, IntegrationError, Rig, Run, Runner};

/// The memory of runs that are over, for those to come: no more than there have been at the same time.
#[derive(Debug, Default)]
pub struct Runners(Mutex<Vec<Runner>>);

impl Runners {
    /// Runs the test of a rig and measures the run.
    ///
    /// # Errors
    /// When the integration fails.
    pub fn run<T>(
        &self,
        rig: &Rig,
        accuracy: Accuracy,
        measure: impl FnOnce(&Run) -> T,
    ) -> Result<T, IntegrationError> {
        let mut runner = match self.spare(Vec::pop) {
            Some(mut runner) => {
                runner.take(rig, accuracy);
                runner
            }
            None => Runner::new(rig, accuracy),
        };
        let measured = runner.run().map(measure);
        self.spare(|spare| spare.push(runner));
        measured
    }

    fn spare<T>(&self, change: impl FnOnce(&mut Vec<Runner>) -> T) -> T {
        change(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneudrive_sim::run;

    /// Another rig, a longer test and one that a fault ends, in turns.
    #[test]
    fn a_run_in_the_memory_of_another_is_the_same_to_the_last_bit() {
        let rig = |name: &str, settings: &[&str]| {
            let settings: Vec<String> = settings.iter().map(|setting| (*setting).to_owned()).collect();
            Rig::builtin(name).expect("a built-in rig").with_settings(&settings).expect("valid")
        };
        let rigs = [
            rig("servo-b-tuned", &["test.duration_s=0.3"]),
            rig("servo-a", &["test.duration_s=0.6", "sensors.noise_counts=0.5"]),
            rig("servo-b-tuned", &["test.duration_s=0.5", "load.mass_kg=58", "controller.velocity_gain=0"]),
            rig("bang-bang", &["test.duration_s=0.4"]),
        ];
        let (runners, bits) = (Runners::default(), |run: &Run| {
            let rows: Vec<_> = run.rows.iter().map(|row| row.values().map(f64::to_bits)).collect();
            (rows, run.observations.clone(), run.commands.clone(), run.fault, run.work)
        });
        for rig in rigs.iter().chain(&rigs) {
            let accuracy = Accuracy::of_motion(rig);
            let again = runners.run(rig, accuracy, bits).expect("a transient");
            assert_eq!(again, bits(&run(rig, accuracy).expect("a transient")), "{}", rig.name());
        }
        assert_eq!(runners.spare(|spare| spare.len()), 1);
    }
}
