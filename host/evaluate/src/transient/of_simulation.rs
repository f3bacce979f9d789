//! The transient of a run that has not been written.

use pneudrive_records::run_folder::Holding;
use pneudrive_sim::component::controller::Loop;
use pneudrive_sim::component::encoder::mm_per_count;
use pneudrive_sim::keys::controller;
use pneudrive_sim::trace::Row;
use pneudrive_sim::{Rig, Run};

use super::{Cut, FrictionUse, Transient};

impl Transient {
    /// The form of a stored run that [`Transient::of_run`] gives, without the columns that no channel needs.
    #[must_use]
    pub fn of_simulation(name: &str, rig: &Rig, run: &Run) -> Transient {
        let column = |of: &dyn Fn(&Row) -> f64| run.rows.iter().map(of).collect::<Vec<f64>>();
        let mm_per_count = mm_per_count(rig);
        let asked = if rig.get(&controller::LOOP) == Loop::Open { f64::NAN } else { mm_per_count };
        let [v, a] = [&controller::VELOCITY_WINDOW_SAMPLES, &controller::ACCELERATION_WINDOW_SAMPLES];
        Transient {
            name: name.to_owned(),
            numbered: None,
            test: rig.name().to_owned(),
            time: column(&|row| row.time),
            channels: [
                column(&|row| f64::from(row.observation.setpoint) * asked),
                column(&|row| row.plant.position * 1e3),
                column(&|row| row.plant.pressures[0] * 1e-3),
                column(&|row| row.plant.pressures[1] * 1e-3),
                column(&|row| row.plant.spool * 1e3),
                column(&|row| f64::from(row.observation.command)),
                column(&|row| f64::from(row.observation.error)),
            ],
            counts: run.rows.iter().map(|row| row.observation.position).collect(),
            mm_per_count,
            windows: [v, a].map(|window| rig.get(window) as u8),
            pressure_step_kpa: 0.0,
            inflow_kg_s: Some(column(&|row| {
                let [one, two] = row.plant.mass_flows;
                one.max(0.0) + two.max(0.0)
            })),
            grip: FrictionUse::of(&Holding::of(rig), run.rows.iter().map(|row| row.plant.friction)),
            extras: Vec::new(),
            gaps: Vec::new(),
            band: None,
            cut: Cut::default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneudrive_records::run_folder::StoredRun;
    use pneudrive_sim::{Accuracy, run};

    #[test]
    fn it_is_the_transient_of_the_stored_run() {
        for settings in [&["test.duration_s=0.4"][..], &["controller.loop=open", "test.moves=[[0.1, 700]]"]] {
            let settings: Vec<String> = settings.iter().map(|setting| (*setting).to_owned()).collect();
            let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig");
            let rig = rig.with_settings(&settings).expect("a valid rig");
            let run = run(&rig, Accuracy::of_motion(&rig)).expect("a transient");
            let stored = Transient::of_run("one", &StoredRun::of(&rig, &run));
            // Debug writes every bit of a number, and NaN as such.
            assert_eq!(format!("{:?}", Transient::of_simulation("one", &rig, &run)), format!("{stored:?}"));
        }
    }
}
