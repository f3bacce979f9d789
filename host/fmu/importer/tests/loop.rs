//! What the command writes, loaded by another program: the integers of `pneudrive simulate`, and refusals.

use std::fs;
use std::path::Path;
use std::process::Command;

use fmi::fmi3::GetSet;
use pneudrive_fmu_importer::Fmu;

const PERIOD_S: f64 = 0.0013;

/// Runs the command.
fn pneudrive(folder: &Path, arguments: &str) {
    let program = std::env::var_os("PNEUDRIVE").expect("the command is built, and PNEUDRIVE says where");
    let done =
        Command::new(program).args(arguments.split(' ')).current_dir(folder).output().expect("it starts");
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
}

fn part(folder: &Path, part: &str) -> Fmu {
    pneudrive(folder, &format!("fmu servo-b-tuned --{part} --overwrite"));
    Fmu::load(&folder.join(format!("servo-b-tuned-{part}.fmu")))
}

/// Position and command at each sample of the simulated test, counts.
fn simulated(folder: &Path) -> Vec<[i32; 2]> {
    pneudrive(folder, "simulate servo-b-tuned --out run --ensemble 1 --no-report");
    let trace = fs::read_to_string(folder.join("run/trace.csv")).expect("a trace");
    let mut lines = trace.lines().filter(|line| !line.starts_with('#'));
    let names: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let column = |name: &str| names.iter().position(|other| *other == name).expect("a column");
    let columns = ["position_counts", "command_counts"].map(column);
    let row = |line: &str| {
        let values: Vec<&str> = line.split(',').collect();
        columns.map(|column| values[column].parse().expect("a whole number"))
    };
    lines.map(row).collect()
}

#[test]
fn controller_and_plant_in_a_loop_equal_the_simulation() {
    let folder = tempfile::tempdir().expect("a folder");
    let rows = simulated(folder.path());
    assert!(rows.len() > 2000);
    let (mut plant, mut controller) = (part(folder.path(), "plant"), part(folder.path(), "controller"));
    let run_test = controller.reference("run_test");
    controller.instance.set_boolean(&[run_test], &[true]).expect("a parameter");
    [&mut plant, &mut controller].into_iter().for_each(Fmu::start);
    for (k, [position, command]) in rows.into_iter().enumerate() {
        assert_eq!(plant.integer("position_counts"), position, "sample {k}");
        for name in ["position_counts", "pressure_1_raw", "pressure_2_raw", "spool_raw"] {
            controller.set_integer(name, plant.integer(name));
        }
        assert!(controller.step(k as f64 * PERIOD_S, PERIOD_S));
        assert_eq!(controller.integer("command_counts"), command, "sample {k}");
        plant.set_integer("command_counts", command);
        assert!(plant.step(k as f64 * PERIOD_S, PERIOD_S));
    }
}

#[test]
fn a_step_that_is_no_multiple_of_the_sample_and_values_that_are_none_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut drive = part(folder.path(), "drive");
    drive.start();
    assert!(!drive.step(0.0, 0.001));
    let setpoint = drive.reference("setpoint_m");
    assert!(drive.instance.set_float64(&[setpoint], &[f64::NAN]).is_err());
    assert!(drive.instance.get_float64(&[77_777], &mut [0.0]).is_err());
    assert!(drive.step(0.0, PERIOD_S), "nothing of this has harmed it");
}
