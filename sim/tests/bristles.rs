//! A drive whose load is on bristles (`load.friction = "lugre"`): it converges, comes to rest, and says whether it is
//! converged.

use pneudrive_sim::{Accuracy, Rig, Run, check_convergence, run};

/// A built-in rig on bristles, with settings.
fn rig(name: &str, settings: &[&str]) -> Rig {
    let settings = [&["load.friction=lugre"], settings].concat();
    let settings: Vec<String> = settings.iter().map(|&one| one.to_owned()).collect();
    Rig::builtin(name).expect("a built-in rig").with_settings(&settings).expect("a valid rig")
}

fn at(rig: &Rig, tolerance: f64) -> Run {
    run(rig, Accuracy { tolerance, ..Accuracy::default() }).unwrap_or_else(|error| panic!("{error}"))
}

/// The largest distance between the positions of two runs, up to a time, m.
fn apart(one: &Run, other: &Run, until: f64) -> f64 {
    assert_eq!(one.rows.len(), other.rows.len());
    let pairs = one.rows.iter().zip(&other.rows).take_while(|(row, _)| row.time < until);
    pairs.map(|(one, other)| (one.plant.position - other.plant.position).abs()).fold(0.0, f64::max)
}

const ALL: f64 = f64::INFINITY;

/// To and fro in open loop, with a halt in between.
const OPEN: [&str; 3] = [
    "controller.loop=open",
    "test.moves=[[0.0, 600], [0.15, 0], [0.25, -600], [0.4, 0]]",
    "test.duration_s=0.5",
];

#[test]
fn an_open_loop_converges_with_the_tolerance_from_soft_bristles_to_stiff_ones() {
    for stiffness in ["1e4", "1e5", "1e6", "1e7"] {
        let stiffness = format!("load.bristle_stiffness_n_per_m={stiffness}");
        let rig = rig("servo-a", &[&OPEN[..], &[&stiffness]].concat());
        let exact = at(&rig, 1e-12);
        let runs = [1e-6, 1e-8, 1e-10].map(|tolerance| at(&rig, tolerance));
        let errors = [0, 1, 2].map(|i| apart(&runs[i], &exact, ALL));
        println!("{stiffness}: {errors:?} m, {} evaluations", runs[2].work.integrator.n_rhs_evaluations);
        assert!(errors[0] < 1e-5 && errors[1] < 1e-6 && errors[2] < 2e-8, "{stiffness}: {errors:?}");
    }
}

/// Its valve is shut by an overlap without clearance, so that the air rests.
#[test]
fn a_load_that_starts_under_a_force_below_its_stiction_is_held_by_its_bristles() {
    let shut = [
        "controller.loop=open",
        "test.moves=[[0.0, 0]]",
        "test.duration_s=0.5",
        "operator.dither_mm=0",
        "valve.underlap_mm=0.1",
        "valve.spool_diameter_mm=10",
        "test.pressure_1_pa=340000",
    ];
    let run = at(&rig("servo-b", &shut), 1e-9);
    let [first, last] = [&run.rows[0], run.rows.last().expect("rows")].map(|row| row.plant);
    assert!((15.0..60.0).contains(&first.actuator_force), "{} N", first.actuator_force);
    assert!((last.position - first.position).abs() < 1e-9 && last.velocity.abs() < 1e-9, "{last:?}");
    assert!((last.friction - last.actuator_force).abs() < 1e-6, "{} N", last.friction);
}

/// What is called converged is the transient of a far finer integration; the others say from when on they are not.
#[test]
fn a_closed_loop_on_bristles_says_whether_it_is_converged() {
    let mut converged = 0;
    for name in ["servo-b-tuned", "servo-a-tuned", "lut-stepper"] {
        let rig = rig(name, &["test.duration_s=1.0"]);
        let accuracy = Accuracy::of(&rig);
        let usual = run(&rig, accuracy).expect("a run");
        let convergence = check_convergence(&rig, accuracy, &usual).expect("a convergence");
        let fine = run(&rig, Accuracy { tolerance: 1e-13, ..accuracy }).expect("a run");
        let off = apart(&usual, &fine, convergence.unconverged_from_s.unwrap_or(ALL));
        println!("{name}: {convergence:?}, {off} m off, {:?}", usual.work.integrator);
        assert!(off < 1e-5, "{name}: {off} m off, {convergence:?}");
        converged += usize::from(convergence.is_converged());
    }
    assert!(converged >= 1, "none has converged");
}
