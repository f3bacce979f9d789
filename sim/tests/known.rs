//! What the law "cascade" knows of its drive, beside what is true on the twin.

use pneudrive_sim::keys;
use pneudrive_sim::rigfile::BUILTIN;
use pneudrive_sim::trace::{EXTRAS, Extra, Row};
use pneudrive_sim::{Accuracy, Rig, Run, run};

fn simulated(rig: &Rig) -> Run {
    run(rig, Accuracy::of(rig)).expect("runs")
}

fn column(name: &str, row: &Row) -> f64 {
    Extra::named(name).expect("a column").value(row)
}

#[test]
fn only_a_law_with_a_model_of_its_drive_has_columns_of_it() {
    for (name, _) in BUILTIN {
        let rig = Rig::builtin(name).expect("a built-in rig");
        let rig = rig.with_numbers(&[("test.duration_s", 0.1)]).unwrap_or(rig);
        let columns = Extra::of_rig(&rig);
        assert_eq!(!columns.is_empty(), *name == "press", "{name}");
        for row in &simulated(&rig).rows {
            assert_eq!(row.known.is_some(), *name == "press", "{name}");
            assert!(columns.iter().all(|extra| extra.value(row).is_finite()), "{name}, {} s", row.time);
        }
    }
}

#[test]
fn the_law_knows_place_speed_force_and_mass_of_a_drive_that_is_as_its_file_says() {
    let rig = Rig::builtin("press").expect("a built-in rig");
    let count_mm = rig.get(&keys::encoder::MM_PER_COUNT);
    let rows = simulated(&rig).rows;
    let fastest = rows.iter().map(|row| row.plant.velocity.abs()).fold(0.0, f64::max);
    for row in &rows {
        let at = row.time;
        // A sample is as old as the row.
        let [place, speed] = ["law_position_mm", "law_velocity_m_s"].map(|name| column(name, row));
        assert!(
            (place - 1e3 * row.plant.position).abs() < 4.0 * count_mm + 1e-3 * fastest,
            "{at} s: {place} mm"
        );
        assert!((speed - row.plant.velocity).abs() < 0.06 * fastest, "{at} s: {speed} m/s");
    }
    let last = rows.last().expect("rows");
    assert_eq!(column("law_phase", last), 0.0);
    let reference = column("law_reference_mm", last);
    assert!(
        (reference - (f64::from(last.observation.setpoint) + 0.5) * count_mm).abs() < 1e-9,
        "{reference} mm"
    );
    let force = column("law_force_n", last);
    assert!((force - last.plant.actuator_force).abs() < 3.0, "{force} for {} N", last.plant.actuator_force);
    let (mass, real) = (column("law_mass_kg", last), rig.get(&keys::load::MASS_KG));
    assert!((mass / real - 1.0).abs() < 0.1, "{mass} for {real} kg");
    let real =
        1e3 * rig.get(&keys::empirical::DAMPING_PER_S) / rig.get(&keys::empirical::STIFFNESS_PER_MASS_PER_S2);
    let lag = column("law_lag_ms", last);
    assert!((lag / real - 1.0).abs() < 0.1, "{lag} for {real} ms");
}

#[test]
fn a_law_is_under_way_while_its_load_moves() {
    let rig = Rig::builtin("press").expect("a built-in rig");
    for row in &simulated(&rig).rows {
        let is_under_way = column("law_phase", row) == 1.0;
        assert!(is_under_way || row.plant.velocity.abs() < 0.02, "{} s", row.time);
        assert!(is_under_way || column("law_reference_velocity_m_s", row) == 0.0, "{} s", row.time);
    }
    let names: Vec<&str> = EXTRAS.iter().map(|extra| extra.name).collect();
    let mut sorted = names.clone();
    sorted.sort_unstable();
    sorted.dedup();
    assert_eq!(sorted.len(), names.len(), "a name is there twice");
}
