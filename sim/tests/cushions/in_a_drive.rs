//! Cushions in a drive: what goes together, the law by a model, sensors, tubes and the linear model.

use pneudrive_sim::{Accuracy, NotLinear, Plant, Rig};

use super::*;

/// A cushion that the load does not reach is no cushion, to the bit.
#[test]
fn a_cushion_that_is_not_reached_changes_nothing() {
    let open = ["test.moves=[[0.0, 600], [0.1, -600], [0.2, 0]]", "test.duration_s=0.3"];
    let positions = |more: &[&str]| {
        rows(&[&OPEN, &open, more]).iter().map(|row| row.plant.position.to_bits()).collect::<Vec<_>>()
    };
    assert_eq!(positions(&[]), positions(&[CUSHION, WITH_SPEAR]));
}

#[test]
fn what_does_not_go_together_is_refused_by_key() {
    for (settings, said) in [
        (&["actuator.cushion_1_length_m=0.03"][..], "has no effect with actuator.cushion = \"none\""),
        (
            &[CUSHION, "actuator.cushion_1_length_m=0.16"],
            "actuator.cushion_1_length_m: must not be above half of actuator.stroke_m",
        ),
        (
            &[CUSHION, "actuator.cushion_spear_diameter_m=0.02"],
            "must be between the rod of 0.025 m and the bore of 0.05 m at end 2",
        ),
        (
            &[CUSHION, "actuator.cushion_spear_diameter_m=0.06"],
            "must be between the rod of 0 m and the bore of 0.05 m at end 1",
        ),
        (
            &[CUSHION, "actuator.cushion_1_length_m=0", "actuator.cushion_2_length_m=0"],
            "actuator.cushion: \"adjustable\" has no length at either end: give actuator.cushion_1_length_m",
        ),
        (
            &[CUSHION, "actuator.vented=\"chamber-1\"", "actuator.cushion_2_length_m=0"],
            "actuator.cushion: \"adjustable\" has no length at either end: give actuator.cushion_2_length_m",
        ),
        (
            &[
                CUSHION,
                "actuator.cushion_spear_diameter_m=0.049",
                "actuator.cushion_dead_volume_percent=95",
                "load.stop_stiffness_n_per_m=1e6",
            ],
            "actuator.residual_volume_1_m3: the piston pressed into its stop at the highest pressure takes up",
        ),
        (
            &[CUSHION, "actuator.vented=\"chamber-2\"", "actuator.cushion_2_length_m=0.03"],
            "has no effect with actuator.vented = \"chamber-2\"",
        ),
        (
            &[CUSHION, "actuator.cushion_1_length_m=0", "actuator.cushion_1_conductance_m3_per_s_pa=2e-9"],
            "has no effect with actuator.cushion_1_length_m = 0",
        ),
        (
            &[
                CUSHION,
                "supply.model=\"receiver\"",
                "sensors.pressure=true",
                "sensors.pressure_lag_s=1e-3",
                "load.friction=\"lugre\"",
            ],
            "leave out one of supply.model",
        ),
    ] {
        let refused = refusal(settings);
        assert!(refused.contains(said), "{settings:?}: {refused}");
    }
}

/// The press, to and fro, with both cushions of 20 mm: the distances from its targets (mm) at the ends of its moves, NaN after a trip.
fn errors_of_the_press(targets: [f64; 4], more: &[&str]) -> Vec<f64> {
    let moves: Vec<String> =
        (0..4).map(|k| format!("[{:?}, {:?}]", 0.02 + 1.5 * k as f64, targets[k])).collect();
    let mut settings = vec![
        format!("test.moves_mm=[{}]", moves.join(", ")),
        "test.duration_s=6".to_owned(),
        CUSHION.to_owned(),
    ];
    settings.extend(more.iter().map(ToString::to_string));
    let rig = Rig::read_with("press", include_str!("../cascade/press.toml"), &settings)
        .unwrap_or_else(|problems| panic!("{problems}"));
    let run = pneudrive_sim::run(&rig, Accuracy::of(&rig)).expect("a transient");
    let until = run.fault.map_or(f64::INFINITY, |(_, sample)| 1e-3 * f64::from(sample));
    let end = |k: usize| {
        let at = 0.02 + 1.5 * (k + 1) as f64 - 0.03;
        let row = run.rows.iter().take_while(|row| row.time < at).last().expect("a row");
        if until < at { f64::NAN } else { 1e3 * row.plant.position - targets[k] }
    };
    (0..4).map(end).collect()
}

const THROTTLES: [&str; 3] = ["3e-9", "1e-9", "3e-10"];

/// In front of its cushions the law by a model ends within its tolerance, between moves of 0.2 m as well. In them it mostly does not,
/// whatever the throttle: docs/howto/own-drive.md says so.
#[test]
fn the_law_by_a_model_positions_in_front_of_the_cushions_and_not_in_them() {
    let (mut inside, mut tripped) = (Vec::new(), 0);
    for throttle in THROTTLES {
        for spear in ["0.0", "0.02"] {
            let c = [1, 2].map(|end| format!("actuator.cushion_{end}_conductance_m3_per_s_pa={throttle}"));
            let more = [c[0].as_str(), c[1].as_str(), &format!("actuator.cushion_spear_diameter_m={spear}")];
            let in_front = errors_of_the_press([225.0, 25.0, 228.0, 100.0], &more);
            assert!(in_front.iter().all(|mm| mm.abs() <= 0.05), "{more:?}: {in_front:?}");
            for targets in [[240.0, 245.0, 235.0, 243.0], [10.0, 5.0, 15.0, 7.0], [238.0, 12.0, 247.0, 3.0]] {
                let errors = errors_of_the_press(targets, &more);
                tripped += usize::from(errors.iter().any(|mm| mm.is_nan()));
                inside.extend(errors);
            }
        }
    }
    let within = inside.iter().filter(|mm| mm.abs() <= 0.05).count();
    let farthest = inside.iter().filter(|mm| !mm.is_nan()).fold(0.0_f64, |most, mm| most.max(mm.abs()));
    println!(
        "{within} of {} within 0.05 mm, {farthest:.2} mm at most, {tripped} of 18 runs tripped",
        inside.len()
    );
    assert!(within < inside.len() / 2 && tripped > 0, "{within} of {}, {tripped}", inside.len());
}

/// A sensor in the tube reads the air in front of the spear.
#[test]
fn the_pressure_sensors_read_the_ports() {
    let open = ["test.moves=[[0.0, 2000]]", "test.position_m=0.2", "test.duration_s=0.5", WITH_SPEAR];
    let rows = rows(&[&OPEN, &LONG, &open, &[CUSHION]]);
    let mut seen = 0;
    for row in rows.iter().filter(|row| row.plant.pressures[1] > 1.2 * port_pressure(row, 1)) {
        // 12 bits over 1 MPa, read at the last sample before the row.
        let sensed = f64::from(row.observation.pressure_2) * 1e6 / 4096.0;
        assert!((sensed - port_pressure(row, 1)).abs() < 0.05 * sensed + 2e3, "{} s: {sensed} Pa", row.time);
        seen += 1;
    }
    assert!(seen > 50, "{seen}");
}

/// A spear stays with its chamber.
#[test]
fn swapped_tubes_leave_the_cushions_where_they_are() {
    let of = |counts: i32, fault: &str| {
        let text = format!(
            "[valve]\nmodel = \"iso-6358\"\ncharacteristic = \"linear\"\nsonic_conductance_m3_per_s_pa = 2e-8\ncritical_ratio = 0.3\n[tubing]\nmodel = \"none\"\n[actuator]\ncushion = \"adjustable\"\ncushion_2_length_m = 0.1\ncushion_spear_diameter_m = 0.03\n[controller]\nloop = \"open\"\n[operator]\ndither_mm = 0\n[test]\nposition_m = 0.15\nmoves = [[0.0, {counts}]]\nduration_s = 0.4\n{fault}"
        );
        let rig = Rig::read("swapped", &text).unwrap_or_else(|problems| panic!("{problems}"));
        rows_at(&rig, 1e-10).last().expect("rows").plant.position
    };
    let fault = "[[faults.event]]\nkind = \"swapped-tubes\"\nat_s = 0.0\n";
    let (straight, crossed, back) = (of(1500, ""), of(-1500, fault), of(1500, fault));
    assert!((0.21..0.28).contains(&straight) && (straight - crossed).abs() < 1e-6, "{straight} {crossed}");
    assert!(back < 0.1, "{back}");
}

#[test]
fn a_linear_model_is_refused_in_a_cushion_and_not_in_front_of_it() {
    let at = |position: &str| {
        let rig = rig(&[&[CUSHION, position]]);
        let mut plant = Plant::new(&rig, Accuracy::of(&rig), 0);
        plant.sample().expect("a sample");
        plant.linearise()
    };
    let refused = at("test.position_m=0.01").expect_err("refused");
    assert!(
        refused == NotLinear::InCushion && refused.to_string().contains("in front of the cushion"),
        "{refused}"
    );
    assert!(at("test.position_m=0.15").is_ok());
}
