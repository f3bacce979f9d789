//! Records of drives under the law "cascade", for the tests of the controller: shared/controller/tests/cascade/records/.
//!
//! ```text
//! cargo run --release -p pneudrive-sim --example law_records
//! ```
//!
//! A file has the parameters that are not the default ones, then a line for each sample: what the controller got and what it
//! commanded. It changes with the law, and with what `pneudrive-sim` makes of a rig file for it.

use std::fmt::Write;

use pneudrive_controller::Parameters;
use pneudrive_controller::parameters::TABLE;
use pneudrive_sim::{Accuracy, Rig, run};

/// Moves by 60 mm and by 2 mm, there and back, one of them redirected in fast motion.
const MOVES: &str = "test.moves=[[0.0, 6250], [0.02, 12250], [0.42, 12050], [0.72, 6250], [0.79, 9250]]";

/// The same for a drive with the thesis's encoder.
const SLOWER_MOVES: &str =
    "test.moves=[[0.0, 5187], [0.02, 10167], [0.52, 10001], [0.82, 5187], [0.9, 7677]]";

/// The drive, what the law knows of it beside, and what else its plant is.
const DRIVES: [(&str, &str, &[&str], &[&str]); 7] = [
    (
        "level",
        "press",
        &[],
        &["load.mass_kg=9.5", "load.coulomb_extend_n=20.0", "load.coulomb_retract_n=20.0"],
    ),
    (
        "upright",
        "press",
        &["load.incline_deg=90", "test.pressure_2_pa=330000.0"],
        &["load.mass_kg=6.5", "supply.pressure_pa=680000.0"],
    ),
    (
        "often",
        "press",
        &["controller.period_s=0.0005", "controller.delay_s=0.0002"],
        &["load.mass_kg=7.0", "supply.pressure_pa=730000.0"],
    ),
    (
        "slow",
        "press",
        &["sensors.pressure_lag_s=0.002"],
        &["load.mass_kg=9.0", "supply.pressure_pa=680000.0"],
    ),
    (
        "bristles",
        "press",
        &[],
        &["load.friction=lugre", "operator.stiffness_per_mass_per_s2=98696", "operator.damping_per_s=439.8"],
    ),
    (
        "spring",
        "servo-c",
        &[
            "controller.period_s=0.0005",
            "controller.delay_s=0.0002",
            "operator.dither_mm=0",
            "controller.law=cascade",
        ],
        &["load.mass_kg=1.9", "supply.pressure_pa=570000.0"],
    ),
    (
        "stepper",
        "servo-a",
        &["controller.period_s=0.0005", "controller.delay_s=0.0002", "controller.law=cascade"],
        &["load.mass_kg=1.9", "supply.pressure_pa=570000.0"],
    ),
];

fn settings(texts: &[&str]) -> Vec<String> {
    texts.iter().map(ToString::to_string).collect()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for (name, drive, known, unknown) in DRIVES {
        let is_of_thesis = drive != "press";
        let moves = if is_of_thesis { SLOWER_MOVES } else { MOVES };
        let test = [moves, "test.duration_s=1.2", "test.position_m=0.062505"];
        let rig = Rig::builtin(drive).ok_or(drive)?;
        let rig = rig.with_settings(&settings(&[&test, known].concat()))?;
        let rig = rig.with_plant(&settings(unknown))?.with_plant(&settings(&["sensors.noise_counts=1.0"]))?;
        let run = run(&rig, Accuracy::of(&rig))?;
        let mut text = String::new();
        let (parameters, usual) = (rig.parameters(), Parameters::default());
        for line in TABLE.iter().filter(|line| parameters.get(line.id) != usual.get(line.id)) {
            writeln!(text, "# param.{} = {}", line.name, parameters.get(line.id).unwrap_or(line.default))?;
        }
        text.push_str("position_counts,pressure_1_raw,pressure_2_raw,setpoint_counts,dac_counts");
        text.push_str(if is_of_thesis { ",spool_raw\n" } else { "\n" });
        for seen in &run.observations {
            let numbers = [seen.position, seen.pressure_1.into(), seen.pressure_2.into(), seen.setpoint];
            numbers.iter().try_for_each(|number| write!(text, "{number},"))?;
            write!(text, "{}", seen.command)?;
            if is_of_thesis {
                write!(text, ",{}", seen.spool)?;
            }
            text.push('\n');
        }
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/controller/tests/cascade/records");
        std::fs::write(format!("{folder}/{name}.csv"), text)?;
        println!("{name}: {} samples, {:?}", run.observations.len(), run.fault);
    }
    Ok(())
}
