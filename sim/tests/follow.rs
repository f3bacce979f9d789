//! The plant under recorded commands does what it did in the run they come from.

use pneudrive_controller::Command;
use pneudrive_sim::component::operator;
use pneudrive_sim::follow::Timing;
use pneudrive_sim::keys;
use pneudrive_sim::{Accuracy, Rig, follow, run};

fn repeated(name: &str, settings: &[&str]) {
    let text = pneudrive_sim::rigfile::builtin(name).expect("a built-in rig");
    let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
    let rig = Rig::read_with(name, text, &settings).expect("a rig");
    let run = run(&rig, Accuracy::default()).expect("a run");
    let stepper = rig.get(&keys::operator::MODEL) == operator::OperatorKind::Stepper;
    let commands = run.observations.iter().map(|seen| {
        // SPLLOC is noted before the pulse of the sample's output.
        let step = if stepper { (seen.command - seen.spool).signum() } else { 0 };
        Command { counts: seen.command, step: step as i8, drive_enable: true }
    });
    let timing = Timing {
        period_us: rig.period_us().get().into(),
        delay_us: rig.microseconds(&keys::controller::DELAY_S),
    };
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

/// The weight on an incline is in the balance of forces what friction is that is stronger one way, at any speed and at
/// rest: no test of a drive tells the two apart.
#[test]
fn an_incline_is_friction_that_is_stronger_one_way() {
    let base = "[controller]\nloop = \"open\"\n[operator]\ndither_mm = 0.0\n[test]\nposition_m = 0.15\npressure_1_pa = 325000\n";
    let force = 1.6 * 9.806_65 * 3f64.to_radians().sin();
    let friction = |force: f64| {
        format!(
            "[load]\nstatic_extend_n = {}\ncoulomb_extend_n = {}\nstatic_retract_n = {}\ncoulomb_retract_n = {}\n",
            70.0 + force,
            40.0 + force,
            40.0 - force,
            11.0 - force
        )
    };
    let incline = format!("{base}{}incline_deg = 3.0\n", friction(0.0));
    let level = format!("{base}{}", friction(force));
    let commands: Vec<Command> = (0..900)
        .map(|k| {
            let counts = [0, 300, 900, -500, -1200, 0, 600][k / 130];
            Command { counts, step: 0, drive_enable: true }
        })
        .collect();
    let timing = Timing { period_us: 1300, delay_us: 500 };
    let accuracy = Accuracy { tolerance: 1e-12, ..Accuracy::default() };
    let [incline, level] = [incline, level].map(|text| {
        let rig = Rig::read("rig.toml", &text).expect("valid");
        follow(&rig, accuracy, timing, &commands).expect("followed")
    });
    let moved = incline.iter().map(|reading| (reading.position - 0.15).abs()).fold(0.0, f64::max);
    assert!(moved > 0.05, "it moves by {moved} m");
    for (k, (one, other)) in incline.iter().zip(&level).enumerate() {
        assert!((one.position - other.position).abs() < 1e-9, "{k}: {one:?}, {other:?}");
        for (p, q) in one.pressures.iter().zip(other.pressures) {
            assert!((p - q).abs() < 0.01, "{k}: {one:?}, {other:?}");
        }
    }
}
