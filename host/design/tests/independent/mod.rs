//! Drawn drives simulated twice: by pneudrive, and by `own_drive.py`, which was written from part I of
//! docs/explanation/equations.md.

use std::process::Command;

use pneudrive_design::own_drive::rig_file;
use pneudrive_design::question::Answers;
use pneudrive_design::values;
use pneudrive_sim::{Accuracy, Rig, Run, check_convergence, run};

use crate::drawn;

/// How far the two are apart.
#[derive(Clone, Copy, Debug)]
pub struct Apart {
    /// Until when they were compared, s.
    pub until: f64,
    /// The largest difference of positions, m.
    pub position: f64,
    /// The same of pressures, Pa.
    pub pressure: f64,
}

/// The drive of a seed with its valve on the cylinder and the gain profile, the law of docs/explanation/equations.md, and the
/// run of its test, of `duration` s; None where it is refused or a fault ends it.
pub fn drive(seed: u64, duration: f64) -> Option<(Rig, Run)> {
    let drawn = drawn::answers(seed);
    let mut answers = Answers::default();
    let law = [("law", "gain-profile")];
    for (name, text) in drawn.given().filter(|(name, _)| !name.starts_with("tube")).chain(law) {
        answers.answer(pneudrive_design::question::question_of(name)?, text);
    }
    let text = rig_file("drawn", &answers).ok()?;
    let rig = Rig::read("drawn", &text).ok()?.with_numbers(&[("test.duration_s", duration)]).ok()?;
    let run = run(&rig, Accuracy::of(&rig)).ok()?;
    run.fault.is_none().then_some((rig, run))
}

/// The rows of the independent program, whose encoder reads what that of the run has read: time, position and both pressures
/// at each sample.
fn independent(rig: &Rig, run: &Run) -> Vec<[f64; 4]> {
    let folder = tempfile::tempdir().expect("a folder");
    let [values, counts] = ["values.json", "counts"].map(|name| folder.path().join(name));
    let read: Vec<String> = run.observations.iter().map(|seen| format!("{}\n", seen.position)).collect();
    std::fs::write(&values, values::to_json(rig).to_string()).expect("a file");
    std::fs::write(&counts, read.concat()).expect("a file");
    let program = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/own_drive.py");
    let output = Command::new("python3").arg(program).args([values, counts]).output();
    let output = output.expect("python3 runs (apt-get install python3)");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let row = |line: &str| {
        let numbers: Vec<f64> = line.split(' ').map(|word| word.parse().expect("a number")).collect();
        numbers.try_into().expect("four columns")
    };
    String::from_utf8(output.stdout).expect("UTF-8").lines().map(row).collect()
}

/// How far the independent program is from a run, as far as that has converged.
pub fn apart(rig: &Rig, run: &Run) -> Apart {
    let convergence = check_convergence(rig, Accuracy::of(rig), run).expect("it runs again");
    let until = convergence.unconverged_from_s.unwrap_or(f64::INFINITY);
    let rows = independent(rig, run);
    assert_eq!(rows.len(), run.rows.len());
    let mut apart = Apart { until: 0.0, position: 0.0, pressure: 0.0 };
    for (row, [time, position, pressures @ ..]) in run.rows.iter().zip(rows) {
        assert!((row.time - time).abs() < 1e-9, "{} and {time} s", row.time);
        if time >= until {
            break;
        }
        apart.until = time;
        apart.position = apart.position.max((row.plant.position - position).abs());
        for (one, other) in row.plant.pressures.into_iter().zip(pressures) {
            apart.pressure = apart.pressure.max((one - other).abs());
        }
    }
    apart
}
