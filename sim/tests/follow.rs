//! The plant under recorded commands does what it did in the run they come from.

use pneudrive_controller::Command;
use pneudrive_sim::follow::Timing;
use pneudrive_sim::{Accuracy, Rig, follow, run};

fn repeated(name: &str, settings: &[&str]) {
    let text = pneudrive_sim::rig::builtin(name).expect("a built-in rig");
    let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
    let rig = Rig::read_with(name, text, &settings).expect("a rig");
    let run = run(&rig, Accuracy::default()).expect("a run");
    let stepper = rig.word("operator.model") == "stepper";
    let commands = run.observations.iter().map(|seen| {
        // SPLLOC is noted before the pulse of the sample's output.
        let step = if stepper { (seen.command - seen.spool).signum() } else { 0 };
        Command { counts: seen.command, step: step as i8, drive_enable: true }
    });
    let timing =
        Timing { period_us: rig.period_us().get().into(), delay_us: rig.microseconds("controller.delay_s") };
    let readings =
        follow(&rig, Accuracy::default(), timing, &commands.collect::<Vec<_>>()).expect("readings");
    assert_eq!(readings.len(), run.rows.len());
    for (reading, row) in readings.iter().zip(&run.rows) {
        assert_eq!(reading.position, row.plant.position, "{name} at {} s", row.time);
        assert_eq!(reading.pressures, row.plant.pressures, "{name} at {} s", row.time);
    }
}

#[test]
fn a_solenoid_drive_under_its_recorded_commands_repeats_its_run_in_every_bit() {
    repeated("servo-b-tuned", &["test.duration_s=0.8"]);
}

#[test]
fn a_stepper_drive_under_its_recorded_pulses_repeats_its_run_in_every_bit() {
    repeated("lut-stepper", &["test.duration_s=0.8"]);
}
